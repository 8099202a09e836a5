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

#endif
