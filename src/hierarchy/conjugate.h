/* Conjugate gradients by PETSc for operators that are functions. */
#ifndef EQM_CONJUGATE_H
#define EQM_CONJUGATE_H

#include <petscksp.h>

/* `to` from `from`, each as long as this rank's part of a vector. As collective as the operator. */
typedef PetscErrorCode (*EqmOperator)(void *context, const PetscReal *from, PetscReal *to);

/* Solve A x = b with preconditioner B, both symmetric and positive definite, from zero, until the error is down to
   `tolerance` of what it was (energy norm), or for so many iterations that more would not pay: the solution is then as
   good as they made it. `n`: entries on this rank. `success` is false where an operator turns out not to be definite.
   Collective. */
PETSC_INTERN PetscErrorCode EqmConjugateGradients(MPI_Comm comm, PetscInt n, EqmOperator multiply,
                                                  EqmOperator precondition, void *context, PetscReal *b, PetscReal *x,
                                                  PetscReal tolerance, PetscInt *iterations, PetscBool *success);

#endif
