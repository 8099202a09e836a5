/* Statistics of a distributed sample. */
#ifndef EQM_QUANTILE_H
#define EQM_QUANTILE_H

#include <equimap/map.h>

PETSC_INTERN PetscErrorCode EqmStatisticsOf(MPI_Comm comm, PetscInt n, PetscReal *sample, EqmStatistics *statistics);
PETSC_INTERN PetscErrorCode EqmMeanBetween(MPI_Comm comm, PetscInt n, PetscReal *sample, PetscReal from, PetscReal to,
                                           PetscReal *mean);

#endif
