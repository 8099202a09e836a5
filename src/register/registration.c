/* The registration object: from two files to a correspondence. */
#include "register/registration.h"
#include "mesh/mesh_private.h"
#include "solver/inner.h"
#include "store/keptmesh.h"
#include <string.h>

PetscErrorCode EqmRegistrationCreate(MPI_Comm comm, EqmLedger ledger, EqmRegistration *out)
{
  EqmRegistration r;

  PetscFunctionBegin;
  PetscCall(PetscNew(&r));
  r->comm = comm;
  r->ledger = ledger;
  r->a.name = "A";
  r->b.name = "B";
  r->set = (EqmRegisterSettings){
      .start = EQM_LANDMARKS_ROTATION, .weight = 1e4, .tolerance = 1e-3, .reach = .5, .stages = 4};
  *out = r;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmRegistrationDestroy(EqmRegistration *registration)
{
  EqmRegistration r = *registration;

  PetscFunctionBegin;
  if (!r) PetscFunctionReturn(0);
  PetscCall(EqmLandmarkListReset(&r->landmarks));
  for (PetscInt k = 0; k < r->num_fields; k++) PetscCall(EqmFieldReset(&r->fields[k]));
  PetscCall(PetscFree(r->fields));
  PetscCall(PetscFree(r->goal));
  PetscCall(PetscFree(r->image));
  PetscCall(PetscFree(r->inverse_image));
  PetscCall(EqmLocationDestroy(&r->on_b));
  PetscCall(EqmLocationDestroy(&r->forward));
  PetscCall(EqmLocationDestroy(&r->inverse));
  if (r->found != r->map) PetscCall(EqmMapDestroy(&r->found));
  PetscCall(EqmMapDestroy(&r->map));
  PetscCall(EqmSideReset(&r->a));
  PetscCall(EqmSideReset(&r->b));
  PetscCall(PetscFree(*registration));
  PetscFunctionReturn(0);
}

/* Is B the target itself? If B is not named, the checkpoint has it. */
static PetscErrorCode FindWhetherTarget(EqmRegistration r, const char *file_b)
{
  char name[PETSC_MAX_PATH_LEN], entry[PETSC_MAX_PATH_LEN] = "";
  const char *restart;

  PetscFunctionBegin;
  PetscCall(EqmFirstRestart(r, name, &restart));
  if (!file_b && restart) PetscCall(EqmKeptMeshGetEntry(r->comm, restart, 1, entry, sizeof(entry)));
  PetscCall(PetscStrcmp(file_b ? file_b : entry, "target", &r->bare));
  PetscFunctionReturn(0);
}

/* The method must draw landmarks together. */
static PetscErrorCode CheckMethod(EqmRegistration r)
{
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(EqmSolverCreate(r->a.mesh, r->target, &solver));
  PetscCall(EqmSolverSetFromOptions(solver));
  PetscCall(EqmSolverRequireLandmarks(solver));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* Check the options against each other and the meshes before the run. */
static PetscErrorCode CheckTogether(EqmRegistration r)
{
  PetscFunctionBegin;
  if (r->bare && r->set.by == EQM_BY_MIDPOINTS)
    EqmFail(r->comm, EQM_ERR_USAGE, "-register_by midpoints moves B too, and the target does not move");
  if (r->set.align == EQM_ALIGN_POSE && r->dim == 2)
    EqmFail(r->comm, EQM_ERR_USAGE, "-align pose is for the sphere and the ball: a disk has no pose in space");
  if (r->kind == EQM_IMAGE_SPACE && (r->set.by == EQM_BY_MIDPOINTS || r->set.start == EQM_LANDMARKS_FLOW))
    EqmFail(r->comm, EQM_ERR_USAGE,
            "-register_by midpoints and -landmark_start flow are for surfaces: of a solid the "
            "best rotation comes first, and then A's map is drawn to the landmarks");
  if (r->landmarks.num) PetscCall(EqmCheckLandmarks(r));
  if (r->landmarks.num) PetscCall(CheckMethod(r));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationRead(EqmRegistration r, const char *file_a, const char *file_b)
{
  char usage[2 * PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(usage, sizeof(usage), "equimap register %s %s", file_a ? file_a : "", file_b ? file_b : ""));
  PetscCall(FindWhetherTarget(r, file_b));
  PetscCall(EqmSideRead(r, &r->a, file_a, r->set.density_a, r->set.map_a, usage));
  PetscCall(EqmRegistrationCheckStop(r, PETSC_FALSE));
  if (r->status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  if (!r->bare) PetscCall(EqmSideRead(r, &r->b, file_b, r->set.density_b, r->set.map_b, usage));
  if (r->set.has_landmarks)
    PetscCall(EqmLandmarkListRead(r->comm, r->set.landmarks, r->a.soup->num_vertices,
                                  r->bare ? -1 : r->b.soup->num_vertices, &r->landmarks));
  PetscCall(EqmPointsTakeUnit(r));
  PetscCall(EqmAddCurves(r));
  PetscCall(EqmReadFields(r));
  PetscCall(CheckTogether(r));
  PetscFunctionReturn(0);
}

/* The status of a map that did not converge or folds becomes the registration's, unless one is set already. */
static void MergeStatus(EqmRegistration r, const EqmSide *side)
{
  if (!side->map || r->status != EQM_STATUS_CONVERGED || side->map->status == EQM_STATUS_CONVERGED) return;
  r->status = side->map->status;
  (void)snprintf(r->message, sizeof(r->message), "map of %s: %.2000s", side->name, side->map->message);
}

/* The status of the whole registration. */
static PetscErrorCode Judge(EqmRegistration r)
{
  const EqmRegisterFigures *const f = &r->figures;
  const PetscInt64 folds = f->folds_a + f->folds_b;

  PetscFunctionBegin;
  if (!r->message[0]) PetscCall(PetscStrncpy(r->message, "the maps are composed", sizeof(r->message)));
  MergeStatus(r, &r->a);
  MergeStatus(r, &r->b);
  if (r->landmarks.num && f->landmark_max > r->set.tolerance) {
    r->status = EQM_STATUS_NOT_CONVERGED;
    PetscCall(PetscSNPrintf(r->message, sizeof(r->message),
                            "the landmarks are off by up to %.2g, more than -landmark_tol %.6g; try a larger "
                            "-landmark_weight, more -landmark_stages or another -landmark_reach",
                            (double)f->landmark_max, (double)r->set.tolerance));
  }
  if (f->folds_phi > 0) {
    r->status = EQM_STATUS_FOLDS;
    PetscCall(PetscSNPrintf(r->message, sizeof(r->message),
                            "%" PetscInt64_FMT " tetrahedra of A are flat or turned inside out on B", f->folds_phi));
  }
  if (folds > 0) {
    r->status = EQM_STATUS_FOLDS;
    PetscCall(PetscSNPrintf(r->message, sizeof(r->message),
                            "%" PetscInt64_FMT " cells of the maps that are composed are folded over", folds));
  }
  r->map->status = r->status;
  PetscCall(PetscStrncpy(r->map->message, r->message, sizeof(r->map->message)));
  PetscFunctionReturn(0);
}

/* Copy history and work of the last minimisation for A to the result. */
static PetscErrorCode CopyRun(EqmRegistration r, EqmMap to)
{
  const EqmMap from = r->a.map;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(r->ledger, &work));
  to->cost.work = *work;
  to->iterations = from->iterations;
  to->num_history = from->num_history;
  PetscCall(PetscMalloc1(from->num_history, &to->history));
  PetscCall(PetscArraycpy(to->history, from->history, from->num_history));
  to->energy_initial = from->num_history ? from->energy_initial : r->figures.energy;
  to->energy_final = r->figures.energy;
  to->num_boundary_vertices = r->a.mesh->num_boundary_vertices;
  to->distortion.folds = r->figures.folds_a + r->figures.folds_b + r->figures.folds_phi;
  PetscCall(PetscStrncpy(to->method, from->method, sizeof(to->method)));
  PetscCall(PetscStrncpy(to->command, "register", sizeof(to->command)));
  PetscFunctionReturn(0);
}

/* f and g. */
static PetscErrorCode MapBoth(EqmRegistration r)
{
  PetscFunctionBegin;
  PetscCall(EqmSideSolve(r, &r->a));
  PetscCall(EqmRegistrationCheckStop(r, PETSC_FALSE)); /* the next minimisation checks -wall_time itself */
  if (!r->bare) PetscCall(EqmSideSolve(r, &r->b));
  PetscFunctionReturn(0);
}

/* h: by landmarks, or a rotation. */
static PetscErrorCode MoveOntoEachOther(EqmRegistration r)
{
  PetscFunctionBegin;
  PetscCall(EqmRegistrationCheckStop(r, PETSC_FALSE));
  if (r->status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  if (r->landmarks.num) {
    PetscCall(EqmFindGoals(r));
    PetscCall(EqmRotateOntoLandmarks(r));
    PetscCall(EqmAdapt(r));
  } else if (!r->bare) {
    PetscCall(EqmAlign(r));
  }
  PetscFunctionReturn(0);
}

/* phi and its figures. */
static PetscErrorCode ComposeAndMeasure(EqmRegistration r)
{
  PetscFunctionBegin;
  PetscCall(EqmRegistrationCheckStop(r, PETSC_TRUE));
  if (r->status != EQM_STATUS_STOPPED) PetscCall(EqmCompose(r));
  PetscCall(EqmRegistrationCheckStop(r, PETSC_TRUE));
  if (r->status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  PetscCall(EqmMeasureCorrespondence(r));
  PetscCall(CopyRun(r, r->found));
  PetscCall(EqmIntakeTakeMap(&r->a.intake, r->a.mesh, r->found, &r->map));
  PetscCall(EqmRegistrationCheckStop(r, PETSC_TRUE));
  PetscFunctionReturn(0);
}

/* The summary of a run that is to be continued: the last minimisation for A. */
static PetscErrorCode SummariseStopped(EqmRegistration r)
{
  PetscFunctionBegin;
  if (!r->map) {
    PetscCall(EqmMapCreate(r->a.soup, r->dim, &r->map));
    if (r->a.map) r->figures.energy = r->a.map->distortion.energy;
    if (r->a.map) PetscCall(CopyRun(r, r->map));
    PetscCall(PetscStrncpy(r->map->command, "register", sizeof(r->map->command)));
  }
  r->map->status = r->status;
  PetscCall(PetscStrncpy(r->map->message, r->message, sizeof(r->map->message)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationSolve(EqmRegistration r)
{
  PetscFunctionBegin;
  if (r->status != EQM_STATUS_STOPPED) PetscCall(EqmKeepMeshes(r));
  PetscCall(EqmRegistrationCheckStop(r, PETSC_FALSE));
  if (r->status != EQM_STATUS_STOPPED) PetscCall(MapBoth(r));
  if (r->status != EQM_STATUS_STOPPED) PetscCall(MoveOntoEachOther(r));
  if (r->status != EQM_STATUS_STOPPED) PetscCall(ComposeAndMeasure(r));
  if (r->status == EQM_STATUS_STOPPED) {
    PetscCall(SummariseStopped(r));
    PetscFunctionReturn(0);
  }
  PetscCall(Judge(r));
  PetscCall(EqmRestoreUnit(r));
  PetscCall(EqmAddToResult(r));
  PetscCall(EqmTransferFields(r));
  PetscCall(EqmAddFrames(r));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationGetStatus(EqmRegistration r, EqmStatus *status, const char **message)
{
  PetscFunctionBegin;
  *status = r->status;
  if (message) *message = r->message;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationGetMap(EqmRegistration r, EqmMap *map)
{
  PetscFunctionBegin;
  *map = r->map;
  PetscFunctionReturn(0);
}
