/* Correspondences between two meshes through their maps to one target: point location, transfer, registration.
   Sources: 000 section 6, 001 section 6.6, 003 section 7. */
#ifndef EQUIMAP_REGISTER_H
#define EQUIMAP_REGISTER_H

#include <equimap/solver.h>

/* Where the image of a mesh lies, and what is meant by a point of a cell. */
typedef enum {
  EQM_IMAGE_PLANE,  /* triangles in the plane, two coordinates a point */
  EQM_IMAGE_SPHERE, /* triangles inscribed in the unit sphere: a point of the sphere belongs to the triangle that it
                       projects to, seen from the centre */
  EQM_IMAGE_SPACE   /* tetrahedra, or triangles of a surface in space */
} EqmImageKind;

/* ---- point location */

/* Finds the cells of an image that points lie in. Each rank keeps a tree of boxes over its own cells. */
typedef struct _p_EqmLocator *EqmLocator;

/* Where points were found. Points outside the image are clamped to the closest one of it. */
typedef struct _p_EqmLocation *EqmLocation;
struct _p_EqmLocation {
  MPI_Comm comm;
  PetscInt num;           /* points of this rank */
  PetscInt cell_size;     /* corners of a cell */
  PetscInt *cell;         /* input number of the cell, per point */
  PetscReal *barycentric; /* cell_size per point, not negative, sum one */
  PetscReal *distance;    /* from the point to where it was found: 0 inside the image */
  PetscInt64 num_clamped; /* points of all ranks that lie outside */
  PetscReal most_distant; /* the largest distance of all ranks */
  PetscSF cells;          /* roots: the cells that each rank owns; leaves: the points */
};

/* A locator for the image of `mesh` whose vertices are at `x` (2 coordinates per local vertex in the plane, else 3;
   ghosts up to date), which is copied. Collective. */
PETSC_EXTERN PetscErrorCode EqmLocatorCreate(EqmMesh mesh, EqmImageKind kind, const PetscReal *x, EqmLocator *locator);
PETSC_EXTERN PetscErrorCode EqmLocatorDestroy(EqmLocator *locator);
/* Find `num` points of this rank, with coordinates as in EqmLocatorCreate. Of several cells that hold a point the one
   with the lowest input number is taken, so that the answer does not depend on the number of ranks. Collective. */
PETSC_EXTERN PetscErrorCode EqmLocatorFind(EqmLocator locator, PetscInt num, const PetscReal *points,
                                           EqmLocation *location);
PETSC_EXTERN PetscErrorCode EqmLocationDestroy(EqmLocation *location);
/* Values at the points from values at the vertices of the mesh that the locator was made of, linear in each cell:
   `width` per local vertex, ghosts up to date, to `width` per point. Collective. */
PETSC_EXTERN PetscErrorCode EqmLocationInterpolate(EqmLocation location, EqmMesh mesh, PetscInt width,
                                                   const PetscReal *vertices, PetscReal *points);
/* The same from values that are constant in each cell, `width` per owned cell. Collective. */
PETSC_EXTERN PetscErrorCode EqmLocationSample(EqmLocation location, EqmMesh mesh, PetscInt width,
                                              const PetscReal *cells, PetscReal *points);

/* ---- registration */

/* A correspondence phi = g^-1 o h o f between A and B: maps f of A and g of B to one target, the disk, the sphere or
   the ball, and a map h of the target to itself. */
typedef struct _p_EqmRegistration *EqmRegistration;

PETSC_EXTERN PetscErrorCode EqmRegistrationCreate(MPI_Comm comm, EqmLedger ledger, EqmRegistration *registration);
PETSC_EXTERN PetscErrorCode EqmRegistrationDestroy(EqmRegistration *registration);
/* Read the options that --help of `equimap register` lists. Errors: EQM_ERR_USAGE. Collective. */
PETSC_EXTERN PetscErrorCode EqmRegistrationSetFromOptions(EqmRegistration registration);
/* Read A and B: meshes, or results that hold a map. `file_b` may be "target": the disk, sphere or ball itself. Errors:
   EQM_ERR_IO, EQM_ERR_MESH (cannot be mapped, or A and B are not of one kind), EQM_ERR_USAGE. Collective. */
PETSC_EXTERN PetscErrorCode EqmRegistrationRead(EqmRegistration registration, const char *file_a, const char *file_b);
/* Say on the screen what was read, and that a run can begin. Collective. */
PETSC_EXTERN PetscErrorCode EqmRegistrationViewInput(EqmRegistration registration);
/* Map what is no result yet, move landmarks together, compose, measure. The map's status tells how it went.
   Collective. */
PETSC_EXTERN PetscErrorCode EqmRegistrationSolve(EqmRegistration registration);
/* How it went. EQM_STATUS_STOPPED: on request, with a checkpoint, and there is no map yet. Not collective. */
PETSC_EXTERN PetscErrorCode EqmRegistrationGetStatus(EqmRegistration registration, EqmStatus *status,
                                                     const char **message);
/* phi as a map of A: /map/coordinates are the points of B, three coordinates each (with B the target: of the target).
   Referenced, not to be destroyed. Not collective. */
PETSC_EXTERN PetscErrorCode EqmRegistrationGetMap(EqmRegistration registration, EqmMap *map);
/* With -frames, after the map has been written to `files` (as of EqmMapWrite): the time series beside the result file
   and the frames as meshes. Errors: EQM_ERR_IO. Collective. */
PETSC_EXTERN PetscErrorCode EqmRegistrationWriteFrames(EqmRegistration registration, const char *files);
/* Print the figures. Collective. */
PETSC_EXTERN PetscErrorCode EqmRegistrationView(EqmRegistration registration);
/* Print (on rank 0) the options that EqmRegistrationSetFromOptions knows. Collective. */
PETSC_EXTERN PetscErrorCode EqmRegistrationHelp(MPI_Comm comm);

#endif
