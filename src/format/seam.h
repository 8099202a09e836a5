/* The seams of a texture: where corners of one vertex have different texture coordinates. */
#ifndef EQM_FORMAT_SEAM_H
#define EQM_FORMAT_SEAM_H

#include <equimap/soup.h>

/* A surface cut along the seams of its texture: one vertex for each different pair of a vertex of the surface and a
   point of the texture. */
typedef struct {
  PetscInt num;       /* vertices of the cut surface; the first ones are those of the surface */
  PetscInt *corner;   /* 3 * num_cells: corners of the triangles among the vertices of the cut surface */
  PetscInt *original; /* num: the vertex of the surface */
  PetscReal *point;   /* 2 * num: the texture point; zero for vertices of no triangle */
} EqmSeams;

PETSC_INTERN PetscErrorCode EqmSeamsFind(PetscInt num_vertices, PetscInt num_cells, const PetscInt *cells,
                                         const PetscReal *texture, EqmSeams *seams);
PETSC_INTERN PetscErrorCode EqmSeamsReset(EqmSeams *seams);

/* The same where a surface lies in slabs on the ranks. Vertices have the numbers of the surface, what they have of
   further points follows. */
typedef struct {
  PetscReal *point;    /* 2 per vertex of the slab: its first point, zero for vertices of no triangle */
  PetscInt64 num_more; /* further points of all ranks */
  PetscInt more_end;   /* those of this rank and lower ones */
  PetscReal *more;     /* 2 per further point of this rank */
  PetscInt *corner;    /* 3 per cell of the slab: numbers of the corners' points */
} EqmSeamSlabs;

/* EqmSeamsFindSlabs - cut a surface along the seams of its texture. texture - 6 per cell of the slab, two per corner.
   Collective; EqmSeamSlabsReset must follow. */
PETSC_INTERN PetscErrorCode EqmSeamsFindSlabs(EqmSoup soup, const PetscReal *texture, EqmSeamSlabs *seams);
PETSC_INTERN PetscErrorCode EqmSeamSlabsReset(EqmSeamSlabs *seams);

#endif
