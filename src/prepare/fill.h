/* Solids from closed surfaces. */
#ifndef EQM_FILL_H
#define EQM_FILL_H

#include <equimap/soup.h>

typedef struct {
  PetscReal quality; /* radius over shortest edge of a tetrahedron, at most */
  PetscReal volume;  /* of a tetrahedron, at most, in the volumes of a regular one on the surface's mean edge; 0: any */
} EqmFillOptions;

/* What is missing to fill, in words; NULL: nothing. Not collective. */
PETSC_INTERN const char *EqmFillMissing(void);
/* EqmSoupFill - replace a closed surface by the solid within: its vertices keep their numbers, its triangles are those
   of the solid's boundary, new vertices follow.

   Collective; rank 0 gathers the surface and fills it. Errors: EQM_ERR_USAGE (built without TetGen), EQM_ERR_MESH (not
   one closed surface; it crosses itself). */
PETSC_INTERN PetscErrorCode EqmSoupFill(const EqmFillOptions *options, EqmSoup *soup);

#endif
