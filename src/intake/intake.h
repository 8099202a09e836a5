/* The mesh that a run is given: which file, read, prepared and repaired if set, refused if it cannot be mapped, copied
   beside the checkpoint. */
#ifndef EQM_INTAKE_H
#define EQM_INTAKE_H

#include <equimap/map.h>
#include <equimap/mesh.h>
#include "prepare/components.h"

/* How a run reads a mesh. */
typedef struct {
  const char *target;            /* the target; NULL: that of the topology */
  const char *part;              /* "A" or "B", the prefix of every report in a run with two meshes; else NULL */
  const char *usage;             /* the command line that the advice on repairs repeats: "equimap disk scan.ply" */
  char mesh[PETSC_MAX_PATH_LEN]; /* the file; EqmIntakeChoose fills it in */
  char copy[PETSC_MAX_PATH_LEN]; /* the copy of it beside the checkpoint, where that is needed */
  PetscBool is_copy;             /* `mesh` is that copy */
  const char *checkpoint;        /* write a copy for the checkpoint of that name; NULL: none */
  PetscBool resumed;             /* the run continues from a checkpoint */
  const char *density;           /* a file with a weight per cell, or NULL */
  PetscReal noise;               /* displacement of vertices along their normals; 0: none */
  PetscInt seed;                 /* of the noise */
  EqmPrepareOptions prepare;     /* preparation of the mesh; with empty steps the command has none */
  PetscBool repair;              /* repair what can be repaired without a choice */
  PetscBool any_size;            /* bring meshes of any size into range: the command restores the unit of the file */
  PetscBool quiet;               /* print neither what was done nor warnings */
} EqmIntakeOptions;

/* The mesh that a run works on. */
typedef struct {
  EqmSoup given;    /* as the file has it, with noise if set */
  EqmSoup mapped;   /* prepared and repaired, or `given` itself where nothing was changed */
  PetscInt *parent; /* per cell of the slab of `mapped` the cell of `given` it comes from, -1: it was added; NULL where
                       they are the same */
  EqmRepair repair; /* counts of the repair */
  EqmPreparation preparation;      /* steps of the preparation, and the map back */
  PetscInt unit;                   /* both are divided by 2^unit: EqmMapRestoreUnit before maps of them are written */
  EqmTopology topology;            /* of `mapped` */
  const char *target;              /* what it can be mapped to */
  const EqmComponents *components; /* of a piece that EqmIntakePiece has taken: out of these; else NULL */
  PetscInt piece;                  /* its number among them, from 0 */
  EqmPreparation begun;            /* what the steps that all pieces have in common have made of it */
} EqmIntake;

/* ---- choose.c */
PETSC_INTERN PetscErrorCode EqmIntakeChoose(MPI_Comm comm, const char *named, const char *restart,
                                            EqmIntakeOptions *options);
/* ---- intake.c */
PETSC_INTERN PetscErrorCode EqmIntakeRead(MPI_Comm comm, const EqmIntakeOptions *options, EqmLedger ledger,
                                          EqmIntake *intake);
PETSC_INTERN PetscErrorCode EqmIntakeWithoutSplits(const EqmIntakeOptions *options, const EqmIntake *intake,
                                                   EqmIntake *whole, PetscBool *can);
/* EqmIntakeReadGiven - only read the mesh, with density and noise: of a mesh whose pieces are mapped one by one.
   EqmIntakeCut - prepare that mesh as far as all of its pieces have in common, and cut it into them.
   EqmIntakePiece - one of them, prepared: a mesh of its own, whose vertices are the ones that it needs. `number` counts
   from 0, the largest.

   Collective. components - to be freed with EqmComponentsReset after the pieces; piece - to be freed with
   EqmIntakeDestroy. can - it can be mapped; else `reason` says why not, in numbers of the whole. */
PETSC_INTERN PetscErrorCode EqmIntakeReadGiven(MPI_Comm comm, const EqmIntakeOptions *options, EqmLedger ledger,
                                               EqmIntake *intake);
PETSC_INTERN PetscErrorCode EqmIntakeCut(const EqmIntakeOptions *options, const EqmIntake *intake,
                                         EqmComponents *components);
PETSC_INTERN PetscErrorCode EqmIntakePiece(const EqmIntakeOptions *options, const EqmComponents *components,
                                           PetscInt number, EqmIntake *piece, PetscBool *can, char *reason,
                                           size_t length);
PETSC_INTERN PetscErrorCode EqmIntakeTakeMap(const EqmIntake *intake, EqmMesh mesh, EqmMap found, EqmMap *map);
/* ---- given.c */
/* The fate of a cell of the file; the highest of its parts. */
typedef enum { EQM_CELL_LEFT_OUT, EQM_CELL_MAPPED, EQM_CELL_TURNED, EQM_CELL_CUT } EqmCellFate;
PETSC_INTERN PetscErrorCode EqmIntakeMarkCells(const EqmIntake *intake, PetscInt *mark);
PETSC_INTERN PetscErrorCode EqmIntakeMeasureCells(EqmSoup given, EqmLedger ledger, const PetscInt *mark,
                                                  const PetscReal *coordinates, EqmMap map);
PETSC_INTERN PetscErrorCode EqmIntakeMeasureGiven(const EqmIntake *intake, EqmLedger ledger, EqmMap found, EqmMap map);
/* ---- intake.c */
PETSC_INTERN PetscErrorCode EqmIntakeDestroy(EqmIntake *intake);
/* ---- told.c */
PETSC_INTERN PetscErrorCode EqmPrintRepair(MPI_Comm comm, const char *part, const EqmRepair *repair);
PETSC_INTERN PetscErrorCode EqmPrintPreparation(MPI_Comm comm, const char *part, const EqmPreparation *preparation);

#endif
