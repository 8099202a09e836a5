/* Faces, edges and corners of the unit cube on a closed surface that is mapped to the sphere.

   Corner k is at (k & 1, k >> 1 & 1, k >> 2 & 1); face 2a + s is where coordinate a is s. Edges run from corners with
   an even sum of coordinates to odd ones, and consist of vertices of the face on their left: so each face gives up
   vertices for one edge at each of its corners, and none for two. */
#ifndef EQM_CUBE_FACES_H
#define EQM_CUBE_FACES_H

#include "mesh/mesh_private.h"

enum { EQM_CUBE_FACES = 6, EQM_CUBE_CORNERS = 8, EQM_CUBE_EDGES = 12 };

typedef struct {
  PetscInt from, to;    /* corners */
  PetscInt axis;        /* from and to differ in this coordinate */
  PetscInt left, right; /* faces */
} EqmCubeEdge;

typedef struct {
  EqmMesh mesh;
  const PetscReal *x; /* places on the sphere, three per local vertex */
  EqmCubeEdge edge[EQM_CUBE_EDGES];
  PetscInt corner_vertex[EQM_CUBE_CORNERS]; /* global numbers */
  PetscReal corner[3 * EQM_CUBE_CORNERS];   /* places of the corners' vertices on the sphere, on every rank */
  PetscReal *label;                         /* per local vertex: its face, or EQM_CUBE_FACES + its corner */
  PetscReal *on_edge;                       /* per local vertex: its edge, or -1 */
} EqmCubeFaces;

/* The four corners of a face, counter-clockwise as seen from outside. Not collective. */
PETSC_INTERN void EqmCubeFaceCorners(PetscInt face, PetscInt corners[4]);
/* Divide the surface. `turn` (3 x 3, by rows) brings places of the sphere into the cube's axes. Errors: EQM_ERR_MESH
   (the surface is too coarse for twelve edges). Collective. */
PETSC_INTERN PetscErrorCode EqmCubeFacesCreate(EqmMesh mesh, const PetscReal *x, const PetscReal turn[9],
                                               EqmCubeFaces *cube);
PETSC_INTERN PetscErrorCode EqmCubeFacesDestroy(EqmCubeFaces *cube);
/* Fill corners and labels: the part of EqmCubeFacesCreate that is geometry (cube_labels.c). Collective. */
PETSC_INTERN PetscErrorCode EqmCubeLabel(EqmCubeFaces *cube, const PetscReal turn[9]);
/* The faces that a local vertex is on, as bits. Not collective. */
PETSC_INTERN PetscInt EqmCubeFacesOf(const EqmCubeFaces *cube, PetscInt v);
/* End the run with EQM_ERR_MESH: the surface is too coarse. Collective. */
PETSC_INTERN PetscErrorCode EqmCubeTooCoarse(EqmMesh mesh, const char *why);

#endif
