/* Polygons into triangles. */
#ifndef EQM_FORMAT_POLYGON_H
#define EQM_FORMAT_POLYGON_H

#include <equimap/base.h>

enum { EQM_MAX_POLYGON = 1024 }; /* corners; cutting takes time that grows with their square */

PETSC_INTERN void EqmPolygonTriangulate(PetscInt num_corners, const PetscReal *corners, PetscInt *triangles);
/* The corners of the polygon that `num` triangles make up, in order: 3 * num numbers, at most EQM_MAX_POLYGON - 2
   triangles; `cycle` has room for num + 2. PETSC_FALSE: they make up none. Not collective. */
PETSC_INTERN PetscBool EqmPolygonOfTriangles(PetscInt num, const PetscInt *triangles, PetscInt *cycle);

#endif
