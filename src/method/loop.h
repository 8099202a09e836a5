/* A disk's boundary loop: functions on it, gathered on rank 0 in the loop's order. */
#ifndef EQM_LOOP_H
#define EQM_LOOP_H

#include <equimap/mesh.h>

/* The loop is short, the square root of the mesh's size: what goes around it is done on rank 0. */
typedef struct _p_EqmLoop *EqmLoop;
struct _p_EqmLoop {
  MPI_Comm comm;
  PetscInt count;        /* vertices of the loop on rank 0, nothing elsewhere */
  PetscInt num, *vertex; /* owned boundary vertices, their local numbers */
  PetscReal *mine;       /* two per owned boundary vertex: scratch */
  PetscSF gather;        /* roots: on rank 0 the vertices in the loop's order; leaves: owned boundary vertices */
};

/* `vertex`: the local numbers of the `num` owned boundary vertices. Collective. */
PETSC_INTERN PetscErrorCode EqmLoopCreate(EqmMesh mesh, PetscInt num, const PetscInt *vertex, EqmLoop *loop);
PETSC_INTERN PetscErrorCode EqmLoopDestroy(EqmLoop *loop);
/* One real per owned boundary vertex to `whole`, `count` reals on rank 0, and back. Collective. */
PETSC_INTERN PetscErrorCode EqmLoopGather(EqmLoop loop, const PetscReal *values, PetscReal *whole);
PETSC_INTERN PetscErrorCode EqmLoopScatter(EqmLoop loop, const PetscReal *whole, PetscReal *values);
/* Gaps from each vertex to the next, as angles, of places on the unit circle (two reals per local vertex), to rank 0.
   `point` has room for 2 `count` reals. Collective. */
PETSC_INTERN PetscErrorCode EqmLoopGaps(EqmLoop loop, const PetscReal *x, PetscReal *point, PetscReal *gap);

#endif
