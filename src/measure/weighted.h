/* Ratios weighted by the measure of their cells. */
#ifndef EQM_WEIGHTED_H
#define EQM_WEIGHTED_H

#include <equimap/map.h>

/* Statistics of the ratios of n cells of this rank and of those of all others, weighted by `weight` (positive, in any
   unit). Collective. */
PETSC_INTERN PetscErrorCode EqmWeightedRatioOf(MPI_Comm comm, PetscInt n, const PetscReal *ratio,
                                               const PetscReal *weight, EqmWeightedRatio *weighted);

/* The histogram of the ratios of n cells of this rank and of those of all others; `sd` is their weighted standard
   deviation, which says how wide the bins are. Collective. */
PETSC_INTERN PetscErrorCode EqmRatioHistogramOf(MPI_Comm comm, PetscInt n, const PetscReal *ratio,
                                                const PetscReal *weight, PetscReal sd, EqmRatioHistogram *histogram);

#endif
