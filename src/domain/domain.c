/* Domains: how each kind of vertex moves. The planar ones are put together in disk.c and square.c. */
#include "domain/domain_private.h"
#include "geometry/simplex.h"

/* The frame of one vertex; returns its number of degrees of freedom. Not collective. */
PetscInt EqmDomainFrame(EqmDomain domain, const EqmPlace *place, PetscInt v, PetscReal frame[9])
{
  const PetscReal *const x = place->x + domain->dim * v;

  switch ((EqmVertexKind)domain->kind[v]) {
  case EQM_VERTEX_FREE:
    for (PetscInt k = 0; k < domain->dim * domain->dim; k++) frame[k] = k % (domain->dim + 1) ? 0. : 1.;
    return domain->dim;
  case EQM_VERTEX_CIRCLE: /* the direction in which the angle grows (000 (6)) */
    frame[0] = -x[1];
    frame[1] = x[0];
    return 1;
  case EQM_VERTEX_SIDE_X:
    frame[0] = 1.;
    frame[1] = 0.;
    return 1;
  case EQM_VERTEX_SIDE_Y:
    frame[0] = 0.;
    frame[1] = 1.;
    return 1;
  case EQM_VERTEX_SPHERE:
    for (PetscInt k = 0; k < 3; k++) frame[k] = place->frame[3 * v + k];
    EqmCross(x, frame, frame + 3);
    return 2;
  case EQM_VERTEX_ANGLES: /* no orthonormal frame, but what turns gradients into those by the angles (003 (7)) */
    EqmFromAngles(place->frame + 3 * v, NULL, frame, frame + 3);
    return 2;
  case EQM_VERTEX_FIXED:
    break;
  }
  return 0;
}

/* Number the degrees of freedom once `kind` is known: each rank's in the order of its vertices. Collective. */
PetscErrorCode EqmDomainNumber(EqmDomain domain)
{
  const unsigned char dof_count[] = {[EQM_VERTEX_FREE] = (unsigned char)domain->dim,
                                     [EQM_VERTEX_CIRCLE] = 1,
                                     [EQM_VERTEX_SIDE_X] = 1,
                                     [EQM_VERTEX_SIDE_Y] = 1,
                                     [EQM_VERTEX_SPHERE] = 2,
                                     [EQM_VERTEX_ANGLES] = 2,
                                     [EQM_VERTEX_FIXED] = 0};
  const EqmMesh mesh = domain->mesh;
  PetscInt count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_local, &domain->dof_start, mesh->num_local, &domain->dof_count));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    domain->dof_count[v] = dof_count[domain->kind[v]];
    if (v < mesh->num_owned) {
      domain->dof_start[v] = count;
      count += domain->dof_count[v];
    }
  }
  domain->num_dofs = count;
  domain->dof_first = 0;
  PetscCallMPI(MPI_Exscan(&count, &domain->dof_first, 1, MPIU_INT, MPI_SUM, mesh->comm));
  if (mesh->rank == 0) domain->dof_first = 0;
  for (PetscInt v = 0; v < mesh->num_owned; v++) domain->dof_start[v] += domain->dof_first;
  PetscCall(
      PetscSFBcastBegin(mesh->halo, MPIU_INT, domain->dof_start, domain->dof_start + mesh->num_owned, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(mesh->halo, MPIU_INT, domain->dof_start, domain->dof_start + mesh->num_owned, MPI_REPLACE));
  PetscFunctionReturn(0);
}

/* A domain without vertices' kinds yet, with the arc length of the boundary. Collective. */
PetscErrorCode EqmDomainCreatePlanar(EqmMesh mesh, const char *name, EqmDomain *out, PetscInt **loop_place)
{
  EqmDomain domain;

  PetscFunctionBegin;
  PetscCall(PetscNew(&domain));
  domain->mesh = mesh;
  domain->name = name;
  domain->dim = 2;
  PetscCall(PetscCalloc1(mesh->num_local, &domain->kind));
  PetscCall(PetscMalloc1(mesh->num_local, &domain->arc_length));
  PetscCall(PetscMalloc1(mesh->num_local, loop_place));
  PetscCall(EqmMeshBoundaryLoop(mesh, *loop_place, domain->arc_length));
  *out = domain;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmDomainDestroy(EqmDomain *domain)
{
  PetscFunctionBegin;
  if (!*domain) PetscFunctionReturn(0);
  PetscCall(PetscFree((*domain)->kind));
  PetscCall(PetscFree((*domain)->arc_length));
  PetscCall(PetscFree2((*domain)->dof_start, (*domain)->dof_count));
  PetscCall(PetscFree(*domain));
  PetscFunctionReturn(0);
}

/* All places zero. Not collective. */
PetscErrorCode EqmPlaceCreate(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc1(domain->dim * domain->mesh->num_local, &place->x));
  place->frame = NULL;
  if (domain->kind_of_boundary == EQM_VERTEX_SPHERE)
    PetscCall(PetscCalloc1(3 * domain->mesh->num_local, &place->frame));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmPlaceDestroy(EqmPlace *place)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(place->x));
  PetscCall(PetscFree(place->frame));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmPlaceCopy(EqmDomain domain, const EqmPlace *from, EqmPlace *to)
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(to->x, from->x, domain->dim * domain->mesh->num_local));
  if (from->frame) PetscCall(PetscArraycpy(to->frame, from->frame, 3 * domain->mesh->num_local));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCreateVec(EqmDomain domain, Vec *v)
{
  PetscFunctionBegin;
  PetscCall(VecCreateMPI(domain->mesh->comm, domain->num_dofs, PETSC_DECIDE, v));
  PetscFunctionReturn(0);
}

/* Turn a place on the circle by an angle. Rounding must not add up: the length is set to one. */
static void MoveOnCircle(const PetscReal *x, PetscReal angle, PetscReal *y)
{
  const PetscReal c = PetscCosReal(angle), d = PetscSinReal(angle);
  const PetscReal turned[2] = {c * x[0] - d * x[1], d * x[0] + c * x[1]};
  const PetscReal length = PetscSqrtReal(turned[0] * turned[0] + turned[1] * turned[1]);

  y[0] = turned[0] / length;
  y[1] = turned[1] / length;
}

/* Follow the great circle of velocity (s1, s2) in the frame (b, x cross b), and carry b along: what of it points along
   the motion turns with the motion, the rest stays (parallel transport). */
static void MoveOnSphere(const PetscReal *x, const PetscReal *b, PetscReal s1, PetscReal s2, PetscReal *y,
                         PetscReal *carried)
{
  const PetscReal angle = PetscSqrtReal(s1 * s1 + s2 * s2), c = PetscCosReal(angle), d = PetscSinReal(angle);
  const PetscReal u1 = angle > 0. ? s1 / angle : 1., u2 = angle > 0. ? s2 / angle : 0.;
  PetscReal b2[3], new_x[3], new_b[3], length, along;

  EqmCross(x, b, b2);
  for (PetscInt k = 0; k < 3; k++) {
    const PetscReal ahead = u1 * b[k] + u2 * b2[k];
    new_x[k] = c * x[k] + d * ahead;
    new_b[k] = b[k] + u1 * ((c - 1.) * ahead - d * x[k]);
  }
  length = PetscSqrtReal(EqmDot3(new_x, new_x));
  for (PetscInt k = 0; k < 3; k++) y[k] = new_x[k] / length;
  along = EqmDot3(new_b, y);
  for (PetscInt k = 0; k < 3; k++) new_b[k] -= along * y[k];
  length = PetscSqrtReal(EqmDot3(new_b, new_b));
  for (PetscInt k = 0; k < 3; k++) carried[k] = new_b[k] / length;
}

PetscErrorCode EqmDomainMove(EqmDomain domain, const EqmPlace *from, PetscReal t, Vec step, EqmPlace *to)
{
  const EqmMesh mesh = domain->mesh;
  const PetscScalar *s;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(step, &s));
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscScalar *const move = s + domain->dof_start[v] - domain->dof_first;
    const PetscReal *const x = from->x + domain->dim * v;
    PetscReal *const y = to->x + domain->dim * v;
    if (domain->kind[v] == EQM_VERTEX_CIRCLE) {
      MoveOnCircle(x, t * move[0], y);
    } else if (domain->kind[v] == EQM_VERTEX_SPHERE) {
      MoveOnSphere(x, from->frame + 3 * v, t * move[0], t * move[1], y, to->frame + 3 * v);
    } else if (domain->kind[v] == EQM_VERTEX_ANGLES) {
      for (PetscInt k = 0; k < 2; k++) to->frame[3 * v + k] = from->frame[3 * v + k] + t * move[k];
      EqmFromAngles(to->frame + 3 * v, y, NULL, NULL);
    } else {
      PetscReal frame[9];
      const PetscInt count = EqmDomainFrame(domain, from, v, frame);
      for (PetscInt c = 0; c < domain->dim; c++) {
        PetscReal moved = x[c];
        for (PetscInt k = 0; k < count; k++) moved += t * move[k] * frame[domain->dim * k + c];
        y[c] = moved;
      }
    }
  }
  PetscCall(VecRestoreArrayRead(step, &s));
  PetscCall(EqmMeshUpdateGhosts(mesh, domain->dim, to->x));
  if (to->frame) PetscCall(EqmMeshUpdateGhosts(mesh, 3, to->frame));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPlaceMakeFrames(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  if (!place->frame) PetscFunctionReturn(0);
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) {
    const PetscReal *const x = place->x + 3 * v;
    PetscReal axis[3] = {0., 0., 0.}, b[3], length;
    PetscInt smallest = 0;
    if (domain->kind[v] == EQM_VERTEX_ANGLES) EqmToAngles(x, place->frame + 3 * v);
    if (domain->kind[v] != EQM_VERTEX_SPHERE) continue;
    for (PetscInt k = 1; k < 3; k++) smallest = PetscAbsReal(x[k]) < PetscAbsReal(x[smallest]) ? k : smallest;
    axis[smallest] = 1.; /* the axis farthest from x */
    EqmCross(x, axis, b);
    length = PetscSqrtReal(EqmDot3(b, b));
    for (PetscInt k = 0; k < 3; k++) place->frame[3 * v + k] = b[k] / length;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainProject(EqmDomain domain, const EqmPlace *place, const PetscReal *ambient, Vec dofs)
{
  PetscScalar *g;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(dofs, &g));
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < domain->mesh->num_owned; v++) {
    PetscReal frame[9];
    const PetscInt count = EqmDomainFrame(domain, place, v, frame);
    for (PetscInt k = 0; k < count; k++) {
      PetscReal sum = 0.;
      for (PetscInt c = 0; c < domain->dim; c++) sum += frame[domain->dim * k + c] * ambient[domain->dim * v + c];
      g[domain->dof_start[v] - domain->dof_first + k] = sum;
    }
  }
  PetscCall(VecRestoreArrayWrite(dofs, &g));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainExpand(EqmDomain domain, const EqmPlace *place, Vec dofs, PetscReal *ambient)
{
  const PetscScalar *g;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(dofs, &g));
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < domain->mesh->num_owned; v++) {
    PetscReal frame[9];
    const PetscInt count = EqmDomainFrame(domain, place, v, frame);
    for (PetscInt c = 0; c < domain->dim; c++) {
      PetscReal sum = 0.;
      for (PetscInt k = 0; k < count; k++)
        sum += frame[domain->dim * k + c] * g[domain->dof_start[v] - domain->dof_first + k];
      ambient[domain->dim * v + c] = sum;
    }
  }
  PetscCall(VecRestoreArrayRead(dofs, &g));
  PetscCall(EqmMeshUpdateGhosts(domain->mesh, domain->dim, ambient));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCurvature(EqmDomain domain, const EqmPlace *place, const PetscReal *velocity,
                                  PetscReal *acceleration)
{
  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) {
    const PetscReal *const u = velocity + domain->dim * v;
    const PetscBool curved = (PetscBool)(domain->kind[v] == EQM_VERTEX_CIRCLE || domain->kind[v] == EQM_VERTEX_SPHERE);
    PetscReal squared = 0.;
    for (PetscInt c = 0; c < domain->dim && curved; c++) squared += u[c] * u[c];
    for (PetscInt c = 0; c < domain->dim; c++)
      acceleration[domain->dim * v + c] = -squared * place->x[domain->dim * v + c];
  }
  PetscFunctionReturn(0);
}

/* Progress from p to q along the boundary: an angle on the circle, a signed length on a side of the square. */
static PetscReal Advance(EqmDomain domain, PetscInt i, PetscInt j, const PetscReal *p, const PetscReal *q)
{
  if (domain->kind[i] == EQM_VERTEX_CIRCLE) return PetscAtan2Real(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]);
  return EqmSquareAdvance(p, q);
}

PetscErrorCode EqmDomainBoundaryInOrder(EqmDomain domain, const EqmPlace *place, PetscBool *in_order)
{
  const EqmMesh mesh = domain->mesh;
  PetscReal local[2] = {0., 1.}; /* length gone round, all steps forward */

  PetscFunctionBegin;
  *in_order = PETSC_TRUE;
  if (domain->kind_of_boundary == EQM_VERTEX_SPHERE) PetscFunctionReturn(0);
  for (PetscInt e = 0; e < mesh->num_boundary_facets; e++) {
    const PetscInt i = mesh->boundary_facets[2 * e], j = mesh->boundary_facets[2 * e + 1];
    if (i >= mesh->num_owned) continue;
    const PetscReal advance = Advance(domain, i, j, place->x + 2 * i, place->x + 2 * j);
    local[0] += advance;
    if (!(advance > 0.)) local[1] = 0.;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &local[0], 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &local[1], 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  *in_order = (PetscBool)(local[1] > 0. && PetscAbsReal(local[0] - domain->boundary_length) < .5);
  PetscFunctionReturn(0);
}
