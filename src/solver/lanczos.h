/* The smallest eigenvalues of a symmetric matrix that a shift below all of them makes definite. */
#ifndef EQM_LANCZOS_H
#define EQM_LANCZOS_H

#include <equimap/solver.h>

/* y = (H - shift)^-1 x. Collective. */
typedef PetscErrorCode (*EqmApplyShifted)(void *context, Vec x, Vec y);

/* Are `wanted` of the eigenvalues to be had, of which this rank has `num_owned`? `found` is zero then. Errors:
   EQM_ERR_USAGE (built without SLEPc, or too many wanted). Collective. */
PETSC_INTERN PetscErrorCode EqmLanczosCheck(MPI_Comm comm, PetscInt num_owned, PetscInt wanted, PetscInt *found);
/* The `wanted` smallest, ascending, for vectors like `like`; `found` tells how many converged. Options: -hessian_eps_*
   (SLEPc). Collective. */
PETSC_INTERN PetscErrorCode EqmLanczos(MPI_Comm comm, EqmApplyShifted apply, void *context, Vec like, PetscReal shift,
                                       PetscInt wanted, PetscReal *values, PetscInt *found);

#endif
