/* The fields of a registration, private to this folder. */
#ifndef EQM_REGISTRATION_H
#define EQM_REGISTRATION_H

#include <equimap/register.h>
#include "register/field.h"
#include "format/landmark_list.h"
#include "register/origin.h"
#include "base/stop.h"
#include "store/map_private.h"

typedef enum { EQM_BY_DIRECT, EQM_BY_MIDPOINTS } EqmRegisterBy;
typedef enum { EQM_LANDMARKS_FLOW, EQM_LANDMARKS_ROTATION } EqmLandmarkStart;
typedef enum { EQM_ALIGN_AUTO, EQM_ALIGN_SHAPE, EQM_ALIGN_POSE, EQM_ALIGN_NONE } EqmAlignment;
typedef enum { EQM_BOUNDARY_AUTO, EQM_BOUNDARY_HELD, EQM_BOUNDARY_FREE } EqmRegisterBoundary;
typedef enum { EQM_POINTS_AUTO, EQM_POINTS_SURFACE, EQM_POINTS_TARGET } EqmLandmarkPoints;

typedef struct {
  char landmarks[PETSC_MAX_PATH_LEN], curves_a[PETSC_MAX_PATH_LEN], curves_b[PETSC_MAX_PATH_LEN],
      map_a[PETSC_MAX_PATH_LEN], map_b[PETSC_MAX_PATH_LEN], density_a[PETSC_MAX_PATH_LEN],
      density_b[PETSC_MAX_PATH_LEN], transfer[PETSC_MAX_PATH_LEN], checkpoint[PETSC_MAX_PATH_LEN],
      restart[PETSC_MAX_PATH_LEN];
  PetscBool has_landmarks, repair, quiet;
  EqmRegisterBy by;
  EqmLandmarkStart start;
  EqmRegisterBoundary boundary;
  EqmLandmarkPoints points;
  EqmAlignment align;
  PetscReal weight, tolerance, reach, wall_time;
  PetscInt stages, frames;
} EqmRegisterSettings;

/* -ratio_tol of the maps of surfaces unless the user has another. Maps that are composed need not be better than their
   composition; and the farther a map is polished, the more rounding decides which of many equally good ones it becomes
   (docs/methods.md, Uniqueness). */
#define EQM_REGISTER_RATIO_TOL 3e-3
/* -lm_inner of these maps: quasi-Newton steps amplify small differences, damped steps do not. */
#define EQM_REGISTER_INNER 0

/* One of the two meshes with its map to the target. */
typedef struct {
  const char *name; /* "A" or "B" */
  EqmIntake intake;
  EqmSoup soup; /* as the file has it: intake.given */
  EqmMesh mesh; /* of intake.mapped, which differs where something was repaired */
  EqmOrigin origin;
  EqmMap map;        /* f or g as computed or read, of intake.mapped */
  EqmMap read;       /* as read, of the file's mesh: `map` itself where nothing was repaired; NULL: none was read */
  PetscReal *x;      /* places in the target per local vertex, moved by rotations and h */
  PetscReal *weight; /* per owned vertex: its share of the measure, sum one */
} EqmSide;

/* What is measured of a correspondence. Lengths of the target in its own units (radius 1), lengths in space in radii of
   the disk, sphere or ball that has B's measure. */
typedef struct {
  PetscReal landmark_mean, landmark_max; /* |h(f(p)) - g(q)| */
  PetscBool landmarks_in_space;
  PetscReal landmark_space_mean, landmark_space_max; /* |phi(p) - q| */
  PetscReal start_left;                              /* largest distance of landmarks after the flow */
  PetscReal dissimilarity, dissimilarity_rigid;      /* d(phi) of 003 section 7; after the best rigid motion */
  PetscReal energy_b;                                /* of g, where it was moved of h o g */
  PetscReal energy;                                  /* E of h o f */
  PetscReal own_energy;        /* E_A of h itself, from the target to the target (000 section 6) */
  PetscInt64 folds_a, folds_b; /* of h o f and, where it was moved, of g */
  PetscInt64 folds_phi;        /* solids: of phi itself, A's cells with their vertices on B */
  PetscInt64 most_frame_folds; /* of a frame of the morph */
} EqmRegisterFigures;

struct _p_EqmRegistration {
  MPI_Comm comm;
  EqmLedger ledger;
  EqmRegisterSettings set;
  char target[16];
  EqmImageKind kind;
  PetscInt dim;   /* coordinates in the target */
  PetscBool bare; /* B is the target itself */
  EqmSide a, b;
  EqmLandmarkList landmarks;
  PetscInt num_fields;
  EqmCarriedField *fields; /* of -transfer */
  PetscReal *goal;         /* dim per landmark: g(q), in the end h1(g(q)) where B has moved */
  EqmLocation on_b;        /* locations of landmarks that are points of B's surface, on rank 0; else NULL */
  EqmLocation forward, inverse;
  PetscReal *image, *inverse_image; /* phi per owned vertex of A, phi^-1 per owned vertex of B: three coordinates */
  EqmMap map;
  EqmMap found;            /* the same of A's repaired mesh; NULL where nothing was repaired */
  PetscInt stage;          /* minimisations so far: each has a checkpoint of its own */
  PetscBool stop_reported; /* the solver has printed that the run was stopped */
  PetscBool unsaved;       /* the last checkpoint could not be written */
  EqmStopFile stop_file;
  char kept[PETSC_MAX_PATH_LEN]; /* the entry of checkpoints about the run's copies of its meshes */
  EqmStatus status;              /* EQM_STATUS_STOPPED: to be continued, and nothing further is done */
  char message[EQM_MESSAGE_MAX];
  EqmRegisterFigures figures;
};

/* ---- side.c */
/* Read a mesh, or the copy of it where the run goes on and the file is gone or not named (NULL), with its density if
   `density_file` is not empty, and its map if the file holds one or `map_file` names one. `usage`: how the run was
   called. Collective. */
PETSC_INTERN PetscErrorCode EqmSideRead(EqmRegistration r, EqmSide *side, const char *file, const char *density_file,
                                        const char *map_file, const char *usage);
PETSC_INTERN PetscErrorCode EqmSideSolve(EqmRegistration r, EqmSide *side);
PETSC_INTERN PetscErrorCode EqmSideReset(EqmSide *side);
/* Landmarks must be vertices of some cell. `inside`, of `num`, tells of each whether it is off the boundary. Errors:
   EQM_ERR_USAGE. Collective. */
PETSC_INTERN PetscErrorCode EqmSideCheckVertices(const EqmSide *side, PetscInt num, const PetscInt *vertices,
                                                 PetscInt *inside);
/* Radius of the disk, sphere or ball that has the side's measure. Not collective. */
PETSC_INTERN PetscReal EqmSideRadius(const EqmRegistration r, const EqmSide *side);
/* ---- unit.c */
/* B, read, into the unit of A: both lie in one space. Errors: EQM_ERR_MESH. Collective. */
PETSC_INTERN PetscErrorCode EqmTakeUnitOfA(EqmRegistration r);
/* Lengths of the result in the unit of the files again; the distributed meshes keep theirs. Collective. */
PETSC_INTERN PetscErrorCode EqmRestoreUnit(EqmRegistration r);
/* ---- stages.c */
/* Watch for requests to stop, and read -checkpoint and -restart. Collective. */
PETSC_INTERN PetscErrorCode EqmStagesBegin(EqmRegistration r);
/* The first checkpoint of the run that is continued; NULL: a new run. */
PETSC_INTERN PetscErrorCode EqmFirstRestart(EqmRegistration r, char name[PETSC_MAX_PATH_LEN], const char **restart);
/* Copies of the meshes, with maps that were read, beside the checkpoints. Collective. */
PETSC_INTERN PetscErrorCode EqmKeepMeshes(EqmRegistration r);
/* Run a solver, whose options are set, as the next stage; sets r->status if it was stopped to be continued. Collective.
 */
PETSC_INTERN PetscErrorCode EqmRegistrationMinimise(EqmRegistration r, EqmSolver solver);
/* Between two steps of the registration: has a stop been requested, or, with `clock`, is -wall_time over? Then
   r->status becomes EQM_STATUS_STOPPED and the remaining steps are skipped. Only with -checkpoint. Collective. */
PETSC_INTERN PetscErrorCode EqmRegistrationCheckStop(EqmRegistration r, PetscBool clock);
/* ---- curves.c */
/* Curves of -curves_a and -curves_b become landmarks, points of B. Errors: EQM_ERR_USAGE, EQM_ERR_IO. Collective. */
PETSC_INTERN PetscErrorCode EqmAddCurves(EqmRegistration r);
/* ---- goals.c */
/* Landmarks that are points of B into the unit of its mesh (unit.c). Not collective. */
PETSC_INTERN PetscErrorCode EqmPointsTakeUnit(EqmRegistration r);
/* Check landmarks before the maps are computed. Errors: EQM_ERR_USAGE. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckLandmarks(EqmRegistration r);
PETSC_INTERN PetscErrorCode EqmFindGoals(EqmRegistration r);
PETSC_INTERN PetscErrorCode EqmLandmarkErrors(EqmRegistration r);
/* ---- adapt.c */
PETSC_INTERN PetscErrorCode EqmRotateOntoLandmarks(EqmRegistration r);
PETSC_INTERN PetscErrorCode EqmAdapt(EqmRegistration r);
/* ---- own_energy.c: fill figures.own_energy; `before`: A's places before h. Collective. */
PETSC_INTERN PetscErrorCode EqmMeasureOwnEnergy(EqmRegistration r, const PetscReal *before);
/* ---- align.c */
PETSC_INTERN PetscErrorCode EqmAlign(EqmRegistration r);
/* ---- compose.c */
PETSC_INTERN PetscErrorCode EqmCompose(EqmRegistration r);
PETSC_INTERN PetscErrorCode EqmMeasureCorrespondence(EqmRegistration r);
/* ---- transfer.c */
PETSC_INTERN PetscErrorCode EqmReadFields(EqmRegistration r);
PETSC_INTERN PetscErrorCode EqmTransferFields(EqmRegistration r);
/* ---- frames.c */
PETSC_INTERN PetscErrorCode EqmAddFrames(EqmRegistration r);
/* ---- output.c */
PETSC_INTERN PetscErrorCode EqmAddToResult(EqmRegistration r);

#endif
