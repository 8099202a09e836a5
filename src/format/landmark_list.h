/* Pairs of corresponding points, as a file lists them. */
#ifndef EQM_LANDMARK_LIST_H
#define EQM_LANDMARK_LIST_H

#include <equimap/base.h>

typedef struct {
  PetscInt num;
  PetscInt width;    /* what follows the vertex of A: 1: a vertex of B; 2 or 3: the coordinates of a point */
  PetscInt *vertex;  /* of A, input numbers */
  PetscReal *other;  /* width each */
  PetscReal *weight; /* of a column `weight`, positive; else 1 */
  PetscInt
      *curve; /* of a column `curve`: the feature curve that the landmark is a vertex of; else, and below 0, none */
  PetscBool has_weights, has_curves;
} EqmLandmarkList;

/* Read a CSV file: a header line, then per line a vertex of A and a vertex of B, or a vertex of A and the coordinates
   of a point; then the columns that the header calls `weight` and `curve`, if there are any. The list is the same on
   every rank. `num_vertices` of A and B; B's is not looked at where it is negative. Errors: EQM_ERR_IO (missing,
   unreadable), EQM_ERR_USAGE (no such vertex, twice the same vertex, a weight or curve that is none). Collective. */
PETSC_INTERN PetscErrorCode EqmLandmarkListRead(MPI_Comm comm, const char *file, PetscInt num_vertices_a,
                                                PetscInt num_vertices_b, EqmLandmarkList *list);
PETSC_INTERN PetscErrorCode EqmLandmarkListReset(EqmLandmarkList *list);

#endif
