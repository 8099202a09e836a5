/* Goals of landmarks in the target: from vertices of B, points of B's surface or points of the target.
 */
#include "register/registration.h"
#include "mesh/gather.h"
#include "mesh/mesh_private.h"

/* Do all points lie on the unit sphere (in the unit disk)? */
static PetscBool LieInTarget(const EqmRegistration r)
{
  const EqmLandmarkList *const list = &r->landmarks;

  if (list->width != r->dim || r->kind == EQM_IMAGE_SPACE) return PETSC_FALSE;
  for (PetscInt i = 0; i < list->num; i++) {
    PetscReal squared = 0.;
    for (PetscInt k = 0; k < r->dim; k++) squared += PetscSqr(list->other[r->dim * i + k]);
    const PetscReal length = PetscSqrtReal(squared);
    if (length > 1.01 || (r->kind == EQM_IMAGE_SPHERE && length < .99)) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Points of the target are projected onto the sphere, or into the disk. */
static void TakeTargetPoints(EqmRegistration r)
{
  const EqmLandmarkList *const list = &r->landmarks;

  for (PetscInt i = 0; i < list->num; i++) {
    PetscReal squared = 0., length;
    for (PetscInt k = 0; k < r->dim; k++) squared += PetscSqr(list->other[r->dim * i + k]);
    length = PetscSqrtReal(squared);
    for (PetscInt k = 0; k < r->dim; k++)
      r->goal[r->dim * i + k] =
          list->other[r->dim * i + k] / (r->kind == EQM_IMAGE_SPHERE || length > 1. ? length : 1.);
  }
}

/* The goal of a point in space is the image of the closest point of B. Rank 0 sends the queries. */
static PetscErrorCode TakeSurfacePoints(EqmRegistration r)
{
  const EqmLandmarkList *const list = &r->landmarks;
  const PetscInt num = r->b.mesh->rank == 0 ? list->num : 0;
  EqmLocator locator;
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(EqmLocatorCreate(r->b.mesh, EQM_IMAGE_SPACE, r->b.mesh->position, &locator));
  PetscCall(EqmLocatorFind(locator, num, list->other, &r->on_b));
  PetscCall(EqmLocatorDestroy(&locator));
  PetscCall(EqmLocationInterpolate(r->on_b, r->b.mesh, r->dim, r->b.x, r->goal));
  PetscCall(PetscMPIIntCast(r->dim * list->num, &count));
  PetscCallMPI(MPI_Bcast(r->goal, count, MPIU_REAL, 0, r->comm));
  PetscFunctionReturn(0);
}

/* Vertices of B among the landmarks. */
static PetscErrorCode VerticesOfB(EqmRegistration r, PetscInt **vertices)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(r->landmarks.num, vertices));
  for (PetscInt i = 0; i < r->landmarks.num; i++) (*vertices)[i] = (PetscInt)r->landmarks.other[i];
  PetscFunctionReturn(0);
}

/* Are the landmarks' points, if they are no vertices, points of the target? */
static PetscBool AreOfTarget(EqmRegistration r)
{
  return (PetscBool)(r->set.points == EQM_POINTS_TARGET ||
                     (r->set.points == EQM_POINTS_AUTO && (r->bare || LieInTarget(r))));
}

PetscErrorCode EqmPointsTakeUnit(EqmRegistration r)
{
  EqmLandmarkList *const list = &r->landmarks;

  PetscFunctionBegin;
  if (r->b.intake.unit == 0 || list->width != 3 || AreOfTarget(r)) PetscFunctionReturn(0);
  r->set.points = EQM_POINTS_SURFACE; /* said once, by the file's numbers */
  for (PetscInt k = 0; k < 3 * list->num; k++) list->other[k] = ldexp(list->other[k], (int)-r->b.intake.unit);
  PetscFunctionReturn(0);
}

/* Boundary vertices must correspond to boundary vertices, which no weight can change. */
static PetscErrorCode CheckBoundaries(EqmRegistration r, const PetscInt *inside_a, const PetscInt *vertices_b,
                                      const PetscInt *inside_b)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < r->landmarks.num; i++) {
    const PetscInt a = r->landmarks.vertex[i], b = vertices_b[i];
    if (inside_a[i] == inside_b[i]) continue;
    EqmFail(r->comm, EQM_ERR_USAGE,
            "landmark %" PetscInt_FMT ": vertex %" PetscInt_FMT " of A is %s the boundary, vertex %" PetscInt_FMT
            " of B is %s it: no map brings them together",
            i + 1, a, inside_a[i] ? "off" : "on", b, inside_b[i] ? "off" : "on");
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckPoints(EqmRegistration r)
{
  const EqmLandmarkList *const list = &r->landmarks;

  PetscFunctionBegin;
  if (r->set.by == EQM_BY_MIDPOINTS)
    EqmFail(r->comm, EQM_ERR_USAGE, "-register_by midpoints moves B too and wants vertices of B for landmarks");
  if (AreOfTarget(r) && !LieInTarget(r))
    EqmFail(r->comm, EQM_ERR_USAGE,
            "the landmarks' points do not lie %s: %" PetscInt_FMT
            " coordinates each, within 1 %%, are wanted; with -landmark_points surface they are points of B",
            r->kind == EQM_IMAGE_SPHERE ? "on the unit sphere" : "in the unit disk", r->dim);
  if (!AreOfTarget(r) && list->width != 3)
    EqmFail(r->comm, EQM_ERR_USAGE, "points of B have three coordinates; the landmarks have %" PetscInt_FMT,
            list->width);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCheckLandmarks(EqmRegistration r)
{
  const EqmLandmarkList *const list = &r->landmarks;
  PetscInt *vertices, *inside_a, *inside_b;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(list->num, &inside_a, list->num, &inside_b));
  PetscCall(EqmSideCheckVertices(&r->a, list->num, list->vertex, inside_a));
  if (list->width == 1) {
    if (r->bare) EqmFail(r->comm, EQM_ERR_USAGE, "the target has no vertices: give landmarks as points of it");
    PetscCall(VerticesOfB(r, &vertices));
    PetscCall(EqmSideCheckVertices(&r->b, list->num, vertices, inside_b));
    if (r->kind != EQM_IMAGE_SPHERE) PetscCall(CheckBoundaries(r, inside_a, vertices, inside_b));
    PetscCall(PetscFree(vertices));
  } else {
    PetscCall(CheckPoints(r));
  }
  PetscCall(PetscFree2(inside_a, inside_b));
  PetscFunctionReturn(0);
}

/* Fill r->goal. Collective. */
PetscErrorCode EqmFindGoals(EqmRegistration r)
{
  const EqmLandmarkList *const list = &r->landmarks;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(r->dim * list->num, &r->goal));
  if (list->width == 1) {
    PetscInt *vertices;
    PetscCall(VerticesOfB(r, &vertices));
    PetscCall(EqmMeshGatherVertices(r->b.mesh, list->num, vertices, r->dim, r->b.x, r->goal, NULL));
    PetscCall(PetscFree(vertices));
  } else if (AreOfTarget(r)) {
    if (!r->set.quiet && !r->bare)
      PetscCall(PetscPrintf(r->comm, "landmarks: their points are points of the unit %s\n", r->target));
    TakeTargetPoints(r);
  } else {
    PetscCall(TakeSurfacePoints(r));
  }
  PetscFunctionReturn(0);
}

/* Interpolate `values` per vertex of B, `width` each, at the landmarks of B. */
static PetscErrorCode GatherOnB(EqmRegistration r, PetscInt width, const PetscReal *values, PetscReal *gathered)
{
  PetscInt *vertices;
  PetscMPIInt count;

  PetscFunctionBegin;
  if (r->on_b) {
    PetscCall(EqmLocationInterpolate(r->on_b, r->b.mesh, width, values, gathered));
    PetscCall(PetscMPIIntCast(width * r->landmarks.num, &count));
    PetscCallMPI(MPI_Bcast(gathered, count, MPIU_REAL, 0, r->comm));
    PetscFunctionReturn(0);
  }
  PetscCall(VerticesOfB(r, &vertices));
  PetscCall(EqmMeshGatherVertices(r->b.mesh, r->landmarks.num, vertices, width, values, gathered, NULL));
  PetscCall(PetscFree(vertices));
  PetscFunctionReturn(0);
}

static void MeanAndMax(PetscInt num, PetscInt dim, const PetscReal *p, const PetscReal *q, PetscReal unit,
                       PetscReal *mean, PetscReal *most)
{
  *mean = *most = 0.;
  for (PetscInt i = 0; i < num; i++) {
    PetscReal squared = 0., distance;
    for (PetscInt k = 0; k < dim; k++) squared += PetscSqr(p[dim * i + k] - q[dim * i + k]);
    distance = PetscSqrtReal(squared) / unit;
    *mean += distance / num;
    *most = PetscMax(*most, distance);
  }
}

/* Fill the figures of landmarks, in the target and, where they have a place on B, in space. Collective. */
PetscErrorCode EqmLandmarkErrors(EqmRegistration r)
{
  const PetscInt num = r->landmarks.num;
  const PetscBool on_b = (PetscBool)(!r->bare && (r->landmarks.width == 1 || r->on_b));
  EqmRegisterFigures *const f = &r->figures;
  PetscReal *p, *q;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * num, &p, 3 * num, &q));
  PetscCall(EqmMeshGatherVertices(r->a.mesh, num, r->landmarks.vertex, r->dim, r->a.x, p, NULL));
  PetscCall(PetscArraycpy(q, r->goal, r->dim * num));
  if (on_b) PetscCall(GatherOnB(r, r->dim, r->b.x, q)); /* B may have moved */
  PetscCall(PetscArraycpy(r->goal, q, r->dim * num));
  MeanAndMax(num, r->dim, p, q, 1., &f->landmark_mean, &f->landmark_max);
  f->landmarks_in_space = on_b;
  if (on_b) {
    PetscCall(EqmMeshGatherVertices(r->a.mesh, num, r->landmarks.vertex, 3, r->image, p, NULL));
    PetscCall(GatherOnB(r, 3, r->b.mesh->position, q));
    MeanAndMax(num, 3, p, q, EqmSideRadius(r, &r->b), &f->landmark_space_mean, &f->landmark_space_max);
  }
  PetscCall(PetscFree2(p, q));
  PetscFunctionReturn(0);
}
