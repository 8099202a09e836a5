/* The dense end of substructuring: what is left when every rank has eliminated the unknowns that it alone knows. */
#ifndef EQM_INTERFACE_H
#define EQM_INTERFACE_H

#include <petscsys.h>

/* Cholesky of a sum of dense matrices, one per rank, over a fixed binary tree of the ranks: neighbours in rank merge
   their matrices into a front, eliminate the unknowns that no rank outside shares, and pass the rest on. Which numbers
   are added in which order depends on the tree alone, never on who is first to finish. A front is on the rank that
   leads its group, or, if it is large, dealt to all ranks of the group in blocks (ScaLAPACK). */
typedef struct _p_EqmInterface *EqmInterface;

/* `unknown`: global numbers of the unknowns that this rank shares, each once, in any order; `span`: per unknown the
   lowest and the highest rank that has it; `shared_front`: fronts of more unknowns are shared, where ScaLAPACK is
   there. Collective. */
PETSC_INTERN PetscErrorCode EqmInterfaceCreate(MPI_Comm comm, PetscInt num_shared, const PetscInt *unknown,
                                               const PetscInt *span, PetscInt shared_front, EqmInterface *tree);
PETSC_INTERN PetscErrorCode EqmInterfaceDestroy(EqmInterface *tree);
/* Unknowns of the largest front, and of the largest that is on one rank; the ranks that share a front, at most; bytes
   that this rank needs at most at once; floating-point operations of the fronts that it leads. */
typedef struct {
  PetscInt largest, largest_on_one, most_ranks;
  PetscReal bytes, flops;
} EqmInterfaceCost;
/* Collective. */
PETSC_INTERN PetscErrorCode EqmInterfaceGetCost(EqmInterface tree, EqmInterfaceCost *cost);
/* Factor the sum of the ranks' matrices: `share` is this rank's, by columns, of which the lower triangle counts, in the
   order of `unknown`; it is freed. `success` is false on every rank if the sum is not positive definite. Collective. */
PETSC_INTERN PetscErrorCode EqmInterfaceFactor(EqmInterface tree, PetscScalar **share, PetscBool *success);
/* Solve with the sum of the ranks' right-hand sides: columns of num_shared on entry, on return the solution at them.
   Collective. */
PETSC_INTERN PetscErrorCode EqmInterfaceSolve(EqmInterface tree, PetscInt num_rhs, PetscScalar *columns);

/* Is ScaLAPACK there, so that fronts can be shared? Not collective. */
PETSC_INTERN PetscBool EqmInterfaceCanShare(void);

#endif
