/* Preparation of meshes as scanners and modelling programs deliver them: pieces, seams, non-manifold edges and
   vertices, holes. Steps behind one table (prepare.c): a new one is one file and one row. */
#ifndef EQM_PREPARE_H
#define EQM_PREPARE_H

#include <equimap/soup.h>

/* What to do. */
typedef struct {
  char steps[256];          /* "none"; "auto": all steps and EqmSoupRepair if the target does not take the mesh
                               as it is; or steps, separated by commas */
  PetscInt piece;           /* of `largest`: which piece to keep, 1 is the largest */
  PetscBool without_weld;   /* EqmPrepareShared: no `weld`, although it is among the steps */
  PetscReal hole_weight;    /* of `holes`: density of the cells that fill holes */
  PetscReal weld_tolerance; /* of `weld`: distance, as a share of the mesh's diameter */
  PetscReal handle_length;  /* of `handles`: loops up to this length, as a share of the mesh's diameter, are cut */
  PetscBool repair;         /* at the end EqmSoupRepair */
  PetscBool keeps_cells;    /* which then splits no cell */
  const char *target;       /* a target's name, or NULL: that of the mesh's topology */
} EqmPrepareOptions;

/* Result of a step. */
typedef struct {
  const char *step; /* its name */
  PetscInt64 count; /* of things changed, 0: nothing was to be done */
  char what[160];   /* in words */
} EqmPreparedStep;

enum { EQM_MAX_PREPARED_STEPS = 8 };

/* A prepared mesh, and the numberings back to the given one. */
typedef struct {
  EqmSoup soup;     /* vertices of the given mesh keep their numbers, added ones follow */
  PetscInt *parent; /* per cell of its slab: the cell of the given mesh that it comes from, -1: it was added */
  PetscInt *vertex; /* per vertex of the given mesh's slab: the vertex of `soup` that stands for it */
  PetscInt num_steps;
  EqmPreparedStep step[EQM_MAX_PREPARED_STEPS]; /* those that changed something */
  EqmRepair repair;                             /* counts of EqmSoupRepair, also where it changed nothing */
  PetscBool is_changed;                         /* the soup differs from the given mesh */
} EqmPreparation;

/* Defaults. Not collective. */
PETSC_INTERN void EqmPrepareOptionsInit(EqmPrepareOptions *options);
/* Read -prepare, -piece, -hole_weight, -weld_tolerance and -handle_length. Collective, between PetscOptionsBegin and
   PetscOptionsEnd. Errors: EQM_ERR_USAGE (values out of range, a step that does not exist). */
PETSC_INTERN PetscErrorCode EqmPrepareSetFromOptions(PetscOptionItems *PetscOptionsObject, EqmPrepareOptions *options);
/* Prepare a mesh, which stays as it is. Collective; the same on any number of ranks. `preparation` has steps only if
   something was changed; free it with EqmPreparationReset. Errors: EQM_ERR_USAGE (a piece that is not there). */
PETSC_INTERN PetscErrorCode EqmSoupPrepare(EqmSoup given, const EqmPrepareOptions *options,
                                           EqmPreparation *preparation);
/* A copy of its own of the mesh and the numberings, without the steps. Collective. */
PETSC_INTERN PetscErrorCode EqmPreparationCopy(EqmSoup given, const EqmPreparation *from, EqmPreparation *to);
/* Collective. */
PETSC_INTERN PetscErrorCode EqmPreparationReset(EqmPreparation *preparation);
/* The steps in one line: "weld: ..., holes: ...". Not collective. */
PETSC_INTERN PetscErrorCode EqmPreparationDescribe(const EqmPreparation *preparation, char *text, size_t length);

#endif
