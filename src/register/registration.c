/* The registration as an object: options, the way from two files to a correspondence, the figures for people. */
#include "register/registration.h"
#include <string.h>

static const char *const ways[] = {"direct", "midpoints", "EqmRegisterBy", "", NULL};
static const char *const alignments[] = {"auto", "shape", "pose", "none", "EqmAlignment", "", NULL};
static const char *const landmark_starts[] = {"flow", "rotation", "EqmLandmarkStart", "", NULL};
static const char *const landmark_points[] = {"auto", "surface", "target", "EqmLandmarkPoints", "", NULL};

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
  PetscCall(EqmMapDestroy(&r->map));
  PetscCall(EqmSideReset(&r->a));
  PetscCall(EqmSideReset(&r->b));
  PetscCall(PetscFree(*registration));
  PetscFunctionReturn(0);
}

static PetscErrorCode AskLandmarks(EqmRegisterSettings *set, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(
      PetscOptionsString("-landmarks",
                         "corresponding points, CSV with a header: per line a vertex of A and a vertex of B, or a "
                         "vertex of A and the coordinates of a point (vertices count from 0)",
                         NULL, "", set->landmarks, sizeof(set->landmarks), &set->has_landmarks));
  PetscCall(PetscOptionsEnum("-landmark_points",
                             "what points are: of B's surface (the closest point is taken) or of the unit disk or "
                             "sphere; auto: of the target where they all lie in it",
                             NULL, landmark_points, (PetscEnum)set->points, (PetscEnum *)&set->points, NULL));
  PetscCall(PetscOptionsEnum("-landmark_start",
                             "what goes before the minimisation: flow, a smooth area-preserving flow that brings the "
                             "landmarks to their places, or only the best rotation, as the papers have it",
                             NULL, landmark_starts, (PetscEnum)set->start, (PetscEnum *)&set->start, NULL));
  PetscCall(PetscOptionsReal("-landmark_reach", "how far a landmark's pull reaches in the flow, in radii", NULL,
                             set->reach, &set->reach, NULL));
  PetscCall(PetscOptionsReal("-landmark_weight",
                             "lambda, the weight of the squared distances beside the energy, at first", NULL,
                             set->weight, &set->weight, NULL));
  PetscCall(PetscOptionsInt("-landmark_stages",
                            "while the landmarks are not close enough, minimise anew with ten times the weight, up to "
                            "so many times in all",
                            NULL, set->stages, &set->stages, NULL));
  PetscCall(PetscOptionsReal("-landmark_tol", "how close the landmarks must come, in radii", NULL, set->tolerance,
                             &set->tolerance, NULL));
  PetscFunctionReturn(0);
}

static PetscErrorCode Ask(EqmRegisterSettings *set, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsString("-map_a", "the map of A, made before, where A itself holds none", NULL, "", set->map_a,
                               sizeof(set->map_a), NULL));
  PetscCall(PetscOptionsString("-map_b", "the map of B", NULL, "", set->map_b, sizeof(set->map_b), NULL));
  PetscCall(PetscOptionsString("-density_a",
                               "a positive weight per cell of A (CSV with a header, or /cell/density of an HDF5 file): "
                               "keep mass instead of area or volume",
                               NULL, "", set->density_a, sizeof(set->density_a), NULL));
  PetscCall(PetscOptionsString("-density_b", "the same of B", NULL, "", set->density_b, sizeof(set->density_b), NULL));
  PetscCall(
      PetscOptionsEnum("-align",
                       "without landmarks, the rotation between the maps: pose, such that A and B correspond as "
                       "they stand in space (003 section 7; not for disks); shape, such that A comes closest to B "
                       "after a rigid motion; auto, the pose unless the shape is far better; none, as they are",
                       NULL, alignments, (PetscEnum)set->align, (PetscEnum *)&set->align, NULL));
  PetscCall(AskLandmarks(set, PetscOptionsObject));
  PetscCall(PetscOptionsString("-transfer",
                               "fields to carry along, separated by commas: coordinates, a dataset of A's .h5 file "
                               "(/vertex/ratio), a .csv file with a header and a row per vertex or cell; with b: in "
                               "front, from B to A",
                               NULL, "", set->transfer, sizeof(set->transfer), NULL));
  PetscCall(PetscOptionsInt("-frames",
                            "write so many frames of the straight way from A to its points on B: a time series "
                            "OUT.morph.xmf for ParaView beside OUT.h5, and meshes OUT.frame000.obj, ...",
                            NULL, set->frames, &set->frames, NULL));
  PetscCall(PetscOptionsEnum("-register_by",
                             "direct: A's map goes to the landmarks of B; midpoints: both maps go half the way (001 "
                             "section 6.6)",
                             NULL, ways, (PetscEnum)set->by, (PetscEnum *)&set->by, NULL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationSetFromOptions(EqmRegistration r)
{
  EqmRegisterSettings *const set = &r->set;

  PetscFunctionBegin;
  PetscOptionsBegin(r->comm, NULL, "Registration", NULL);
  PetscCall(Ask(set, PetscOptionsObject));
  PetscOptionsEnd();
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-quiet", &set->quiet, NULL)); /* the solver lists it */
  if (!(set->weight > 0.) || !(set->tolerance > 0.) || !(set->reach > 0.))
    EqmFail(r->comm, EQM_ERR_USAGE, "-landmark_weight, -landmark_tol and -landmark_reach want numbers above 0");
  if (set->stages < 1)
    EqmFail(r->comm, EQM_ERR_USAGE, "-landmark_stages %" PetscInt_FMT ": give 1 or more", set->stages);
  if (set->frames < 0 || set->frames == 1 || set->frames > 1000)
    EqmFail(r->comm, EQM_ERR_USAGE, "-frames %" PetscInt_FMT ": give a number from 2 to 1000", set->frames);
  if (set->by == EQM_BY_MIDPOINTS && !set->has_landmarks)
    EqmFail(r->comm, EQM_ERR_USAGE, "-register_by midpoints wants -landmarks FILE");
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationHelp(MPI_Comm comm)
{
  EqmRegistration r;

  PetscFunctionBegin;
  PetscCall(EqmRegistrationCreate(comm, NULL, &r));
  PetscCall(EqmRegistrationSetFromOptions(r));
  PetscCall(EqmRegistrationDestroy(&r));
  PetscCall(EqmSolverHelp(comm, "disk"));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationRead(EqmRegistration r, const char *file_a, const char *file_b)
{
  PetscFunctionBegin;
  r->bare = (PetscBool)!strcmp(file_b, "target");
  PetscCall(EqmSideRead(r, &r->a, file_a, r->set.density_a, r->set.map_a));
  if (!r->bare) PetscCall(EqmSideRead(r, &r->b, file_b, r->set.density_b, r->set.map_b));
  if (r->set.has_landmarks)
    PetscCall(EqmLandmarkListRead(r->comm, r->set.landmarks, r->a.soup->num_vertices,
                                  r->bare ? -1 : r->b.soup->num_vertices, &r->landmarks));
  PetscCall(EqmReadFields(r));
  if (r->bare && r->set.by == EQM_BY_MIDPOINTS)
    EqmFail(r->comm, EQM_ERR_USAGE, "-register_by midpoints moves B too, and the target does not move");
  PetscFunctionReturn(0);
}

/* A map that did not converge, or that folds, is told about; what happened last counts most. */
static void TakeStatus(EqmRegistration r, const EqmSide *side)
{
  if (!side->map || r->status != EQM_STATUS_CONVERGED || side->map->status == EQM_STATUS_CONVERGED) return;
  r->status = side->map->status;
  (void)snprintf(r->message, sizeof(r->message), "map of %s: %.2000s", side->name, side->map->message);
}

/* How it went as a whole. */
static PetscErrorCode Judge(EqmRegistration r)
{
  const EqmRegisterFigures *const f = &r->figures;
  const PetscInt64 folds = f->folds_a + f->folds_b;

  PetscFunctionBegin;
  if (!r->message[0]) PetscCall(PetscStrncpy(r->message, "the maps are composed", sizeof(r->message)));
  TakeStatus(r, &r->a);
  TakeStatus(r, &r->b);
  if (r->landmarks.num && r->kind != EQM_IMAGE_SPACE && f->landmark_max > r->set.tolerance) {
    r->status = EQM_STATUS_NOT_CONVERGED;
    PetscCall(PetscSNPrintf(r->message, sizeof(r->message),
                            "the landmarks are off by up to %.2g, more than -landmark_tol %g; try a larger "
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

/* What the result says of the run: history and work of the last minimisation for A. */
static PetscErrorCode TakeRun(EqmRegistration r)
{
  const EqmMap from = r->a.map, to = r->map;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(r->ledger, &work));
  to->work = *work;
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

PetscErrorCode EqmRegistrationSolve(EqmRegistration r)
{
  PetscFunctionBegin;
  PetscCall(EqmSideSolve(r, &r->a));
  if (!r->bare && r->status != EQM_STATUS_STOPPED) PetscCall(EqmSideSolve(r, &r->b));
  if (r->landmarks.num && r->status != EQM_STATUS_STOPPED) {
    PetscCall(EqmFindGoals(r));
    PetscCall(EqmRotateOntoLandmarks(r));
    PetscCall(EqmAdapt(r));
  }
  if (r->status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  if (!r->landmarks.num && !r->bare) PetscCall(EqmAlign(r));
  PetscCall(EqmCompose(r));
  PetscCall(EqmMeasureCorrespondence(r));
  PetscCall(TakeRun(r));
  PetscCall(Judge(r));
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

PetscErrorCode EqmRegistrationViewInput(EqmRegistration r)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(r->comm, "%s, %" PetscInt_FMT " vertices, to ", r->a.soup->file, r->a.soup->num_vertices));
  if (r->bare)
    PetscCall(PetscPrintf(r->comm, "the target"));
  else
    PetscCall(PetscPrintf(r->comm, "%s, %" PetscInt_FMT " vertices", r->b.soup->file, r->b.soup->num_vertices));
  PetscCall(PetscPrintf(r->comm, ": equimap register can begin, by the %s\n", r->target));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationView(EqmRegistration r)
{
  const EqmRegisterFigures *const f = &r->figures;
  const EqmDistortion *const d = &r->map->distortion;

  PetscFunctionBegin;
  PetscCall(PetscPrintf(r->comm, "\n%s -> %s by the %s\n  %s: %s\n", r->a.soup->file,
                        r->bare ? "the target" : r->b.soup->file, r->target, EqmStatusName(r->status), r->message));
  PetscCall(PetscPrintf(r->comm, "  energy        %.6e of the map of A to the target, %" PetscInt64_FMT " folds\n",
                        (double)f->energy, r->map->distortion.folds));
  PetscCall(PetscPrintf(r->comm, "  ratio         sd %.3e   min %.4f   median %.6f   max %.4f, A to B in space\n",
                        (double)d->ratio.sd, (double)d->ratio.min, (double)d->ratio.p50, (double)d->ratio.max));
  if (r->landmarks.num)
    PetscCall(PetscPrintf(r->comm, "  landmarks     %" PetscInt_FMT ", error mean %.3e, max %.3e in the target\n",
                          r->landmarks.num, (double)f->landmark_mean, (double)f->landmark_max));
  if (r->set.frames)
    PetscCall(PetscPrintf(r->comm,
                          "  frames        %" PetscInt_FMT ", at most %" PetscInt64_FMT " folded cells in one\n",
                          r->set.frames, f->most_frame_folds));
  if (!r->bare) {
    PetscCall(PetscPrintf(r->comm, "  d(phi)        %.4e   after the best rigid motion %.4e (radii)\n",
                          (double)f->dissimilarity, (double)f->dissimilarity_rigid));
    PetscCall(PetscPrintf(r->comm,
                          "  outside       %" PetscInt64_FMT " vertices of A clamped, by %.2e at most; %" PetscInt64_FMT
                          " of B, by %.2e\n",
                          r->forward->num_clamped, (double)r->forward->most_distant, r->inverse->num_clamped,
                          (double)r->inverse->most_distant));
  }
  PetscFunctionReturn(0);
}
