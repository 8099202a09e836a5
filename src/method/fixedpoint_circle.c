/* The fixed-point iteration with a boundary that moves along the circle, 000 (14). */
#include "method/fixedpoint.h"
#include "domain/domain_private.h"

/* New columns for one group of vertices: -L_gg^-1 L_gh z_h, where `z` (per local vertex, two coordinates) is zero on
   the group. */
static PetscErrorCode SolveGroup(EqmMethod method, EqmIterate iterate, signed char group, const PetscReal *z)
{
  EqmFixedPoint *const fp = method->data;
  const PetscInt n = method->problem->mesh->num_owned;
  PetscReal *rhs;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(2 * n, &rhs));
  PetscCall(EqmLaplacianApply(method->problem->mesh, fp->weights, 2, z, rhs));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt c = 0; c < 2; c++) fp->columns[c * n + v] = fp->group[v] == group ? -rhs[2 * v + c] : 0.;
  }
  PetscCall(PetscFree(rhs));
  PetscCall(EqmGroupSolve(method->problem, 2, fp->columns));
  PetscFunctionReturn(0);
}

/* 000 (14b): where the boundary would follow the interior, inverted in the circle, centred (14d): two columns on the
   owned boundary vertices. A vertex at the centre is everywhere far out: it draws nowhere. One so near to it that
   rounding decides on the direction would draw all of the boundary far to one side, and centring it again leave that
   rounding. */
static PetscErrorCode FollowInterior(EqmMethod method, EqmIterate iterate)
{
  EqmFixedPoint *const fp = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const PetscInt n = mesh->num_owned;
  PetscReal sum[2] = {0., 0.};

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal *const x = iterate->place.x + 2 * v, squared = x[0] * x[0] + x[1] * x[1];
    const PetscBool draws = (PetscBool)(fp->group[v] == 0 && squared > PETSC_MACHINE_EPSILON);
    for (PetscInt c = 0; c < 2; c++) fp->inverted[2 * v + c] = draws ? x[c] / squared : 0.;
  }
  PetscCall(SolveGroup(method, iterate, 1, fp->inverted));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt c = 0; c < 2 && fp->group[v] == 1; c++) sum[c] += fp->columns[c * n + v];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt k = 0; k < 2 * n; k++) {
    if (fp->group[k % n] == 1) fp->columns[k] -= sum[k / n] / mesh->num_boundary_vertices;
  }
  PetscFunctionReturn(0);
}

/* The boundary put on the circle (14e) after a share of the way from where it is to where it would follow; a vertex
   that is drawn nowhere stays. */
static PetscErrorCode PutOnCircle(EqmMethod method, EqmIterate iterate, PetscReal share, EqmPlace *to)
{
  const EqmFixedPoint *const fp = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const PetscInt n = mesh->num_owned;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal *const x = iterate->place.x + 2 * v, b[2] = {fp->columns[v], fp->columns[n + v]};
    const PetscReal length = PetscSqrtReal(b[0] * b[0] + b[1] * b[1]);
    if (fp->group[v] != 1) continue;
    if (length > PETSC_MACHINE_EPSILON) {
      const PetscReal angle = share * PetscAtan2Real(x[0] * b[1] - x[1] * b[0], x[0] * b[0] + x[1] * b[1]);
      const PetscReal c = PetscCosReal(angle), s = PetscSinReal(angle);
      to->x[2 * v] = share == 1. ? b[0] / length : c * x[0] - s * x[1];
      to->x[2 * v + 1] = share == 1. ? b[1] / length : s * x[0] + c * x[1];
    } else {
      for (PetscInt c = 0; c < 2; c++) to->x[2 * v + c] = x[c];
    }
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, to->x));
  PetscFunctionReturn(0);
}

/* 000 (14b), (14d), (14e) do not keep the boundary in order (10): where they break it, it goes only so far as the order
   holds, half the way, a quarter, ... and at last not at all. */
static PetscErrorCode MoveBoundary(EqmMethod method, EqmIterate iterate)
{
  enum { MOST_HALVINGS = 10 };
  EqmFixedPoint *const fp = method->data;
  const EqmDomain domain = method->problem->domain;
  PetscBool in_order = PETSC_FALSE;
  PetscReal share = 1.;

  PetscFunctionBegin;
  PetscCall(FollowInterior(method, iterate));
  PetscCall(EqmPlaceCopy(domain, &iterate->place, &fp->to));
  for (PetscInt k = 0; k < MOST_HALVINGS && !in_order; k++, share *= .5) {
    PetscCall(PutOnCircle(method, iterate, share, &fp->to));
    PetscCall(EqmDomainBoundaryInOrder(domain, &fp->to, &in_order));
    iterate->step_length = share;
  }
  if (in_order)
    PetscCall(EqmPlaceCopy(domain, &fp->to, &iterate->place));
  else
    iterate->step_length = 0.;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFixedPointStepOnDisk(EqmMethod method, EqmIterate iterate)
{
  EqmFixedPoint *const fp = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const PetscInt n = mesh->num_owned;

  PetscFunctionBegin;
  PetscCall(EqmGroupFactor(method->problem, fp->weights, fp->group, NULL));
  PetscCall(MoveBoundary(method, iterate));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    for (PetscInt c = 0; c < 2; c++) fp->inverted[2 * v + c] = fp->group[v] == 1 ? iterate->place.x[2 * v + c] : 0.;
  }
  PetscCall(SolveGroup(method, iterate, 0, fp->inverted));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt c = 0; c < 2 && fp->group[v] == 0; c++) iterate->place.x[2 * v + c] = fp->columns[c * n + v];
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, iterate->place.x));
  PetscFunctionReturn(0);
}
