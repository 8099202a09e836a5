/* A mesh made anew through its map: a regular mesh of the target, or another mesh that lies in it, carried back to the
   surface or solid, with the fields. */
#ifndef EQM_RESAMPLE_H
#define EQM_RESAMPLE_H

#include <equimap/register.h>
#include "measure/recognise.h"
#include "register/field.h"

/* A mesh with its map to a unit target. */
typedef struct {
  EqmSoup given;  /* of the file */
  EqmSoup mapped; /* the prepared mesh that the map belongs to, or `given` itself */
  PetscInt
      *parent;  /* per cell of the slab of `mapped` the cell of `given`, -1: it was added; NULL where they are one */
  EqmMesh mesh; /* of `mapped` */
  const char *target; /* as of EqmDomainShapeTarget */
  PetscInt dim;
  EqmImageKind kind;
  PetscReal *x; /* images of its local vertices, in the unit target, no cell turned over for the most part */
  PetscInt64 folds;
} EqmResampleSource;

/* ---- source.c */
/* Read a result, or (`map_file` not NULL) a mesh and a map of it that any program made. Collective. Errors: those of
   EqmSoupRead and EqmMapRead; EQM_ERR_MESH (it cannot be resampled), EQM_ERR_USAGE (it fills no known target). */
PETSC_INTERN PetscErrorCode EqmResampleSourceRead(MPI_Comm comm, const char *file, const char *map_file,
                                                  EqmLedger ledger, EqmResampleSource *source);
PETSC_INTERN PetscErrorCode EqmResampleSourceReset(EqmResampleSource *source);
/* The places in the unit target of the vertices of another mesh: a result of a map to the same target, a mesh file with
   texture coordinates, or one that lies in the target itself. `soup` is that mesh; `place` dim reals per vertex of its
   slab, PetscMalloc'ed. Collective. Errors: as above; EQM_ERR_USAGE (another target). */
PETSC_INTERN PetscErrorCode EqmResamplePlaces(const EqmResampleSource *source, const char *file, EqmLedger ledger,
                                              EqmSoup *soup, PetscReal **place);

/* ---- resample.c */
/* What was found. */
typedef struct {
  PetscReal measure, measure_before; /* area or volume of the new mesh and of the old one */
  PetscInt64 clamped;                /* vertices outside the image, taken to its closest point */
  PetscReal farthest;                /* of them */
} EqmResampleFigures;

/* Carry the vertices of `soup`, which lie at `place` in the target, back to the source: its coordinates become points
   of the surface or solid, its fields become those of the source, and "target", the places. Fields of cells become
   fields of vertices: the value of the cell that the vertex lies in, not a number in cells that were added. `more` -
   fields to be read beside those of the mesh, as for EqmFieldRead, with commas, or "". Collective. */
PETSC_INTERN PetscErrorCode EqmResample(const EqmResampleSource *source, const char *more, EqmSoup soup,
                                        const PetscReal *place, EqmResampleFigures *figures);

/* ---- image.c */
/* Is it the name of an image? Not collective. */
PETSC_INTERN PetscBool EqmIsGeometryImage(const char *file);
/* Can it be written? Errors: EQM_ERR_USAGE (built without the library). Collective. */
PETSC_INTERN PetscErrorCode EqmGeometryImageCheck(MPI_Comm comm, const char *file);
/* Write `quantity` ("position", "normal", or a field of the soup) of a regular n x n mesh of the square as an image:
   .png, 16 bits per channel, from the least to the largest value, which its text chunks tell; .tif, the numbers
   themselves in 32 bits. The first row is the square's upper side. Collective; rank 0 gathers and writes. Errors:
   EQM_ERR_USAGE (no such field, more than four numbers), EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmGeometryImageWrite(EqmSoup soup, PetscInt n, const char *quantity, const char *file);

#endif
