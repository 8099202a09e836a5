/* Order statistics of a distributed sample. */
#ifndef EQM_ORDER_H
#define EQM_ORDER_H

#include <equimap/base.h>

enum { EQM_MOST_ORDERS = 16 };

/* For each of `count` targets, at most EQM_MOST_ORDERS, the smallest entry of the union of all ranks' samples up to
   which the amount is at least the target. sorted - this rank's n entries, ascending; cumulative - per entry the amount
   of all entries of this rank up to it, or NULL, where every entry counts 1. No entry is gathered: the value is found
   by bisection in 64 rounds. Collective. */
PETSC_INTERN PetscErrorCode EqmOrderStatistics(MPI_Comm comm, PetscInt n, const PetscReal *sorted,
                                               const PetscReal *cumulative, PetscInt count, const PetscReal *target,
                                               PetscReal *value);

#endif
