/* Statistics of a distributed sample. */
#ifndef EQM_QUANTILE_H
#define EQM_QUANTILE_H

#include <equimap/map.h>

/* Statistics of the union of all ranks' samples; the sample is sorted in place. Quantiles interpolate linearly between
   neighbouring order statistics. An empty union gives zeros. Collective. */
PETSC_INTERN PetscErrorCode EqmStatisticsOf(MPI_Comm comm, PetscInt n, PetscReal *sample, EqmStatistics *statistics);
/* Mean of the entries of the union of all ranks' samples between two quantiles, these included; the sample is sorted in
   place. An empty union gives zero. Collective. */
PETSC_INTERN PetscErrorCode EqmMeanBetween(MPI_Comm comm, PetscInt n, PetscReal *sample, PetscReal from, PetscReal to,
                                           PetscReal *mean);

#endif
