/* Polygons into triangles. */
#ifndef EQM_FORMAT_POLYGON_H
#define EQM_FORMAT_POLYGON_H

#include <equimap/base.h>

enum { EQM_MAX_POLYGON = 1024 }; /* corners; cutting takes time that grows with their square */

PETSC_INTERN void EqmPolygonTriangulate(PetscInt num_corners, const PetscReal *corners, PetscInt *triangles);

#endif
