/* The mesh that a run is given: which file, read, prepared and repaired if asked, refused if it cannot be mapped, kept
   beside the checkpoint. */
#ifndef EQM_INTAKE_H
#define EQM_INTAKE_H

#include <equimap/map.h>
#include <equimap/mesh.h>
#include "prepare/prepare.h"

/* How a run reads a mesh. */
typedef struct {
  const char *target; /* what it is to be mapped to; NULL: what its topology asks for */
  const char *part;   /* "A" or "B", which stands before every report, of a run that has two; else NULL */
  const char *usage;  /* the command line that the advice to mend the mesh repeats: "equimap disk scan.ply" */
  char mesh[PETSC_MAX_PATH_LEN]; /* the file; EqmIntakeChoose fills it in */
  char copy[PETSC_MAX_PATH_LEN]; /* the copy of it beside the checkpoint, where that is needed */
  PetscBool is_copy;             /* `mesh` is that copy */
  const char *checkpoint;        /* leave a copy for the checkpoint of that name; NULL: none */
  PetscBool resumed;             /* the run goes on from a checkpoint */
  const char *density;           /* a file with a weight per cell, or NULL */
  PetscReal noise;               /* that vertices move along their normals; 0: none */
  PetscInt seed;                 /* of the noise */
  EqmPrepareOptions prepare;     /* what is done to the mesh first; with empty steps the run cannot prepare */
  PetscBool repair;              /* repair what can be repaired without a choice */
  PetscBool quiet;               /* print neither what was done nor warnings */
} EqmIntakeOptions;

/* The mesh that a run works on. */
typedef struct {
  EqmSoup given;    /* as the file has it, with noise if asked */
  EqmSoup mapped;   /* prepared and repaired, or `given` itself where nothing was changed */
  PetscInt *parent; /* per cell of the slab of `mapped` the cell of `given` it comes from, -1: it was added; NULL where
                       they are the same */
  EqmRepair repair; /* what was repaired */
  EqmPreparation preparation; /* what was done: steps, and the way back */
  EqmTopology topology;       /* of `mapped` */
  const char *target;         /* what it can be mapped to */
} EqmIntake;

/* ---- choose.c */
PETSC_INTERN PetscErrorCode EqmIntakeChoose(MPI_Comm comm, const char *named, const char *restart,
                                            EqmIntakeOptions *options);
/* ---- intake.c */
PETSC_INTERN PetscErrorCode EqmIntakeRead(MPI_Comm comm, const EqmIntakeOptions *options, EqmLedger ledger,
                                          EqmIntake *intake);
PETSC_INTERN PetscErrorCode EqmIntakeTakeMap(const EqmIntake *intake, EqmMesh mesh, EqmMap found, EqmMap *map);
/* ---- given.c */
/* What has become of a cell of the file; of its parts the highest counts. */
typedef enum { EQM_CELL_LEFT_OUT, EQM_CELL_MAPPED, EQM_CELL_TURNED, EQM_CELL_CUT } EqmCellFate;
PETSC_INTERN PetscErrorCode EqmIntakeMarkCells(const EqmIntake *intake, PetscInt *mark);
PETSC_INTERN PetscErrorCode EqmIntakeMeasureGiven(const EqmIntake *intake, EqmLedger ledger, EqmMap found, EqmMap map);
/* ---- intake.c */
PETSC_INTERN PetscErrorCode EqmIntakeDestroy(EqmIntake *intake);
PETSC_INTERN PetscErrorCode EqmPrintRepair(MPI_Comm comm, const char *part, const EqmRepair *repair);
PETSC_INTERN PetscErrorCode EqmPrintPreparation(MPI_Comm comm, const char *part, const EqmPreparation *preparation);

#endif
