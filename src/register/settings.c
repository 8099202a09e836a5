/* The options of a registration. */
#include "register/registration.h"

static const char *const ways[] = {"direct", "midpoints", "EqmRegisterBy", "", NULL};
static const char *const alignments[] = {"auto", "shape", "pose", "none", "EqmAlignment", "", NULL};
static const char *const landmark_starts[] = {"flow", "rotation", "EqmLandmarkStart", "", NULL};
static const char *const boundaries[] = {"auto", "held", "free", "EqmRegisterBoundary", "", NULL};
static const char *const landmark_points[] = {"auto", "surface", "target", "EqmLandmarkPoints", "", NULL};

static PetscErrorCode ReadLandmarkOptions(EqmRegisterSettings *set, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(
      PetscOptionsString("-landmarks",
                         "corresponding points, CSV with a header: per line a vertex of A and a vertex of B, or a "
                         "vertex of A and the coordinates of a point (vertices count from 0)",
                         NULL, "", set->landmarks, sizeof(set->landmarks), &set->has_landmarks));
  PetscCall(PetscOptionsString("-curves_a",
                               "feature curves of A, CSV with a header: per line the curve's number and a vertex, in "
                               "their order along the curve; with -curves_b",
                               NULL, "", set->curves_a, sizeof(set->curves_a), NULL));
  PetscCall(
      PetscOptionsString("-curves_b",
                         "the curves of B that those of A should go to: the same numbers, from the same end, with "
                         "as many vertices as they like",
                         NULL, "", set->curves_b, sizeof(set->curves_b), NULL));
  PetscCall(PetscOptionsEnum("-landmark_points",
                             "what points are: of B's surface (the closest point is taken) or of the unit disk or "
                             "sphere; auto: of the target where they all lie in it",
                             NULL, landmark_points, (PetscEnum)set->points, (PetscEnum *)&set->points, NULL));
  PetscCall(PetscOptionsEnum("-landmark_start",
                             "what goes before the minimisation: flow, a smooth area-preserving flow that brings the "
                             "landmarks to their places, or only the best rotation, as the papers have it",
                             NULL, landmark_starts, (PetscEnum)set->start, (PetscEnum *)&set->start, NULL));
  PetscCall(
      PetscOptionsEnum("-register_boundary",
                       "disk: while landmarks are drawn the boundary is held where the best rotation puts it (000 "
                       "section 6), or free to slide; auto: held with -method fixed-point and ncg",
                       NULL, boundaries, (PetscEnum)set->boundary, (PetscEnum *)&set->boundary, NULL));
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

static PetscErrorCode ReadOptions(EqmRegisterSettings *set, PetscOptionItems *PetscOptionsObject)
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
  PetscCall(PetscOptionsBool("-repair", "mend first in both meshes what is safe to mend (see equimap check)", NULL,
                             set->repair, &set->repair, NULL));
  PetscCall(ReadLandmarkOptions(set, PetscOptionsObject));
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
  PetscCall(ReadOptions(set, PetscOptionsObject));
  PetscOptionsEnd();
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-quiet", &set->quiet,
                                NULL)); /* the solver lists this option and the following ones */
  PetscCall(EqmStagesBegin(r));
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
