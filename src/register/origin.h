/* The origin of the vertices and cells of a repaired mesh in the mesh of the file, whose numbering the results have.
 */
#ifndef EQM_ORIGIN_H
#define EQM_ORIGIN_H

#include <equimap/register.h>
#include "intake/intake.h"

/* Of the mesh that is made of intake->mapped. Every cell is a part of one of the file's cells. */
typedef struct _p_EqmOrigin *EqmOrigin;
struct _p_EqmOrigin {
  const EqmIntake *intake; /* referenced */
  EqmMesh mesh;            /* referenced */
  PetscInt *parent;        /* per local cell: the file's cell; NULL, as all below, where nothing was repaired */
  PetscReal *share;        /* per local cell, cell_size^2: per corner its barycentric coordinates in the parent */
  PetscInt *source;        /* per owned vertex, cell_size: vertices of the file's mesh of which it is a combination */
  PetscReal *part;         /* and the coefficients: 1 for itself, except of new vertices */
};

PETSC_INTERN PetscErrorCode EqmOriginCreate(const EqmIntake *intake, EqmMesh mesh, EqmOrigin *origin);
PETSC_INTERN PetscErrorCode EqmOriginDestroy(EqmOrigin *origin);

/* `width` reals per vertex: from the file's slab to local vertices, ghosts included, linear in the file's cells; and
   from owned vertices to the slab, where vertices of no cell keep what they hold. Collective. */
PETSC_INTERN PetscErrorCode EqmVerticesFromOrigin(EqmOrigin origin, PetscInt width, const PetscReal *slab,
                                                  PetscReal *local);
PETSC_INTERN PetscErrorCode EqmVerticesToOrigin(EqmOrigin origin, PetscInt width, const PetscReal *owned,
                                                PetscReal *slab);
/* The same per owned cell. Of the parts of a cell the first gives its value; cells that were removed keep what they
   hold. Collective. */
PETSC_INTERN PetscErrorCode EqmCellsFromOrigin(EqmOrigin origin, PetscInt width, const PetscReal *slab,
                                               PetscReal *owned);
PETSC_INTERN PetscErrorCode EqmCellsToOrigin(EqmOrigin origin, PetscInt width, const PetscReal *owned, PetscReal *slab);
/* Cells of the file and barycentric coordinates in them, as in EqmLocation, of points that were found in the mesh.
   Collective. */
PETSC_INTERN PetscErrorCode EqmLocationInOrigin(EqmOrigin origin, EqmLocation location, PetscInt *cell,
                                                PetscReal *barycentric);

#endif
