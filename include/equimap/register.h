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

/* EqmLocatorCreate - prepare to find points in the image of a mesh.

   Collective. x - the images of the mesh's local vertices, ghosts up to date: 2 reals each for EQM_IMAGE_PLANE, else 3;
   copied. locator - to be freed with EqmLocatorDestroy. */
PETSC_EXTERN PetscErrorCode EqmLocatorCreate(EqmMesh mesh, EqmImageKind kind, const PetscReal *x, EqmLocator *locator);
/* EqmLocatorDestroy - free a locator. Not collective; NULL is fine. */
PETSC_EXTERN PetscErrorCode EqmLocatorDestroy(EqmLocator *locator);
/* EqmLocatorFind - find `num` points of this rank.

   Collective. points - coordinates as in EqmLocatorCreate. location - to be freed with EqmLocationDestroy. A point that
   lies in no cell is taken to the closest point of the image, and counted. Of several cells that hold a point the one
   with the lowest input number is taken, so that the answer does not depend on the number of ranks. */
PETSC_EXTERN PetscErrorCode EqmLocatorFind(EqmLocator locator, PetscInt num, const PetscReal *points,
                                           EqmLocation *location);
/* EqmLocationDestroy - free a location. Collective; NULL is fine. */
PETSC_EXTERN PetscErrorCode EqmLocationDestroy(EqmLocation *location);
/* EqmLocationInterpolate - values at the points from values at the vertices, linear in each cell.

   Collective. mesh - the one that the locator was made of; vertices - `width` reals per local vertex, ghosts up to
   date; points - `width` reals per point of this rank. */
PETSC_EXTERN PetscErrorCode EqmLocationInterpolate(EqmLocation location, EqmMesh mesh, PetscInt width,
                                                   const PetscReal *vertices, PetscReal *points);
/* EqmLocationSample - values at the points from values that are constant in each cell.

   Collective. mesh - the one that the locator was made of; cells - `width` reals per owned cell; points - `width` reals
   per point of this rank. */
PETSC_EXTERN PetscErrorCode EqmLocationSample(EqmLocation location, EqmMesh mesh, PetscInt width,
                                              const PetscReal *cells, PetscReal *points);

/* ---- registration */

/* A correspondence phi = g^-1 o h o f between A and B: maps f of A and g of B to one target, the disk, the sphere or
   the ball, and a map h of the target to itself. */
typedef struct _p_EqmRegistration *EqmRegistration;

/* EqmRegistrationCreate - a registration without meshes and with default settings.

   Collective on `comm`. ledger - counts the work and must outlive the registration. registration - to be freed with
   EqmRegistrationDestroy. */
PETSC_EXTERN PetscErrorCode EqmRegistrationCreate(MPI_Comm comm, EqmLedger ledger, EqmRegistration *registration);
/* EqmRegistrationDestroy - free a registration, with its map. Collective; NULL is fine. */
PETSC_EXTERN PetscErrorCode EqmRegistrationDestroy(EqmRegistration *registration);
/* EqmRegistrationSetFromOptions - take the settings from PETSc's options: those that `equimap register --help` lists.

   Collective. Call before EqmRegistrationRead. Errors: EQM_ERR_USAGE (a value that is none, options that exclude each
   other). */
PETSC_EXTERN PetscErrorCode EqmRegistrationSetFromOptions(EqmRegistration registration);
/* EqmRegistrationRead - read A and B: meshes, or results that hold a map.

   Collective. file_b - may be "target": the disk, sphere or ball itself. Both may be NULL with -restart: the meshes
   that the checkpoint has kept. Errors: EQM_ERR_IO, EQM_ERR_MESH (one cannot be mapped, or A and B are not of one
   kind), EQM_ERR_USAGE. */
PETSC_EXTERN PetscErrorCode EqmRegistrationRead(EqmRegistration registration, const char *file_a, const char *file_b);
/* EqmRegistrationViewInput - print what was read, and that a run can begin. Collective; rank 0 prints. */
PETSC_EXTERN PetscErrorCode EqmRegistrationViewInput(EqmRegistration registration);
/* EqmRegistrationSolve - map what is no result yet, bring landmarks together, compose, measure.

   Collective, after EqmRegistrationRead. That it has not converged is no error: EqmRegistrationGetStatus tells. Errors:
   EQM_ERR_MESH, EQM_ERR_USAGE (landmarks that are not there), EQM_ERR_IO, EQM_ERR_CHECKPOINT. */
PETSC_EXTERN PetscErrorCode EqmRegistrationSolve(EqmRegistration registration);
/* EqmRegistrationGetStatus - how it went, as a status and in words.

   Not collective. EQM_STATUS_STOPPED: on request, with a checkpoint, and there is no map yet. message - may be NULL;
   belongs to the registration. */
PETSC_EXTERN PetscErrorCode EqmRegistrationGetStatus(EqmRegistration registration, EqmStatus *status,
                                                     const char **message);
/* EqmRegistrationGetMap - the correspondence as a map of A.

   Not collective, after EqmRegistrationSolve. The images are points of B, three coordinates each (of the target, where
   that is B). map - belongs to the registration. */
PETSC_EXTERN PetscErrorCode EqmRegistrationGetMap(EqmRegistration registration, EqmMap *map);
/* EqmRegistrationWriteFrames - with -frames, the time series beside the result file, and the frames as meshes.

   Collective, after the map has been written to `files` (as of EqmMapWrite). Errors: EQM_ERR_IO. */
PETSC_EXTERN PetscErrorCode EqmRegistrationWriteFrames(EqmRegistration registration, const char *files);
/* EqmRegistrationView - print the figures. Collective, after EqmRegistrationSolve; rank 0 prints. */
PETSC_EXTERN PetscErrorCode EqmRegistrationView(EqmRegistration registration);
/* EqmRegistrationHelp - list the options of EqmRegistrationSetFromOptions, for -help. Collective. */
PETSC_EXTERN PetscErrorCode EqmRegistrationHelp(MPI_Comm comm);

#endif
