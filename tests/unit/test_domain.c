/* Domains: vertices stay where they belong, frames, geodesics, the order of the boundary, corners. */
#include "support/testing.h"
#include "domain/domain_private.h"

/* Velocity and acceleration of geodesics against differences of places; Project undoes Expand. */
static PetscErrorCode TestGeodesics(EqmDomain domain, const EqmPlace *place)
{
  const PetscInt n = 2 * domain->mesh->num_local;
  const PetscReal h = 1e-3;
  PetscReal *velocity, *acceleration;
  EqmPlace ahead, behind;
  Vec step, back;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &velocity, n, &acceleration));
  PetscCall(EqmDomainCreateVec(domain, &step));
  PetscCall(VecDuplicate(step, &back));
  PetscCall(EqmPlaceCreate(domain, &ahead));
  PetscCall(EqmPlaceCreate(domain, &behind));
  PetscCall(TestRandomStep(domain, 1, 1., step));
  PetscCall(EqmDomainExpand(domain, place, step, velocity));
  PetscCall(EqmDomainCurvature(domain, place, velocity, acceleration));
  PetscCall(EqmDomainMove(domain, place, h, step, &ahead));
  PetscCall(EqmDomainMove(domain, place, -h, step, &behind));
  for (PetscInt k = 0; k < n; k++) {
    CHECK_CLOSE((ahead.x[k] - behind.x[k]) / (2. * h), velocity[k], 1e-6, 1.);
    CHECK_CLOSE((ahead.x[k] - 2. * place->x[k] + behind.x[k]) / (h * h), acceleration[k], 1e-6, 1.);
  }
  PetscCall(EqmDomainProject(domain, place, velocity, back));
  PetscCall(VecAXPY(back, -1., step));
  PetscCall(VecNorm(back, NORM_INFINITY, velocity));
  CHECK_CLOSE(velocity[0], 0., 1e-14, 1.);
  PetscCall(EqmPlaceDestroy(&ahead));
  PetscCall(EqmPlaceDestroy(&behind));
  PetscCall(VecDestroy(&step));
  PetscCall(VecDestroy(&back));
  PetscCall(PetscFree2(velocity, acceleration));
  PetscFunctionReturn(0);
}

/* Frames are orthonormal and as long as the vertex has degrees of freedom; these are numbered without gaps. */
static PetscErrorCode TestFrames(EqmDomain domain, const EqmPlace *place)
{
  const EqmMesh mesh = domain->mesh;
  PetscInt next = domain->dof_first;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    PetscReal frame[9];
    const PetscInt count = EqmDomainFrame(domain, place, v, frame);
    CHECK(count == domain->dof_count[v], "%d columns for %d degrees of freedom", (int)count, (int)domain->dof_count[v]);
    CHECK(v >= mesh->num_owned || domain->dof_start[v] == next, "vertex %d starts at %d", (int)v,
          (int)domain->dof_start[v]);
    if (v < mesh->num_owned) next += count;
    for (PetscInt i = 0; i < count; i++) {
      for (PetscInt j = 0; j < count; j++) {
        CHECK_CLOSE(frame[2 * i] * frame[2 * j] + frame[2 * i + 1] * frame[2 * j + 1], i == j ? 1. : 0., 1e-14, 1.);
      }
      if (EqmDomainMotion(domain, v) == &EqmMotionCircle) { /* tangent, the angle growing */
        CHECK_CLOSE(frame[0] * place->x[2 * v] + frame[1] * place->x[2 * v + 1], 0., 1e-14, 1.);
        CHECK(place->x[2 * v] * frame[1] - place->x[2 * v + 1] * frame[0] > 0., "vertex %d runs backwards", (int)v);
      }
    }
  }
  CHECK(next - domain->dof_first == domain->num_dofs, "%d degrees of freedom, not %d", (int)(next - domain->dof_first),
        (int)domain->num_dofs);
  PetscFunctionReturn(0);
}

/* After a thousand moves the circle's vertices are on the circle, to the last digit or two, and the sides' on their
   sides, exactly; ghosts are where their owners are. */
static PetscErrorCode TestStaysOnBoundary(EqmDomain domain, const EqmPlace *start)
{
  const EqmMesh mesh = domain->mesh;
  EqmPlace place, check;
  Vec step;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(domain, &place));
  PetscCall(EqmPlaceCreate(domain, &check));
  PetscCall(EqmDomainCreateVec(domain, &step));
  PetscCall(EqmPlaceCopy(domain, start, &place));
  for (PetscInt k = 0; k < 1000; k++) {
    PetscCall(TestRandomStep(domain, k, .5, step));
    PetscCall(EqmDomainMove(domain, &place, .7, step, &place)); /* in place */
  }
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal *const x = place.x + 2 * v, *const s = start->x + 2 * v;
    const EqmVertexMotion *const kind = EqmDomainMotion(domain, v);
    if (kind == &EqmMotionCircle) CHECK_CLOSE(x[0] * x[0] + x[1] * x[1], 1., 1e-15, 1.);
    if (kind == &EqmMotionSideX || kind == &EqmMotionCorner)
      CHECK(x[1] == s[1], "%.17g left its side %.17g", (double)x[1], (double)s[1]);
    if (kind == &EqmMotionSideY || kind == &EqmMotionCorner)
      CHECK(x[0] == s[0], "%.17g left its side %.17g", (double)x[0], (double)s[0]);
    if (kind == &EqmMotionFree) CHECK(x[0] != s[0] && x[1] != s[1], "vertex %d has not moved", (int)v);
    if (v < mesh->num_owned) PetscCall(PetscArraycpy(check.x + 2 * v, x, 2));
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, check.x));
  for (PetscInt k = 0; k < 2 * mesh->num_local; k++) CHECK(check.x[k] == place.x[k], "a ghost is out of date");
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(EqmPlaceDestroy(&check));
  PetscCall(VecDestroy(&step));
  PetscFunctionReturn(0);
}

static PetscErrorCode ExpectOrder(EqmDomain domain, const EqmPlace *place, PetscBool wanted, const char *what)
{
  PetscBool in_order;

  PetscFunctionBegin;
  PetscCall(EqmDomainBoundaryInOrder(domain, place, &in_order));
  CHECK(in_order == wanted, "%s: in order: %d", what, (int)in_order);
  PetscFunctionReturn(0);
}

/* The place that a boundary vertex of the disk takes when angles are mapped by t -> turns * t + shift. */
static PetscErrorCode Wind(EqmDomain domain, PetscReal turns, PetscReal shift, EqmPlace *place)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) {
    if (EqmDomainMotion(domain, v) != &EqmMotionCircle) continue;
    const PetscReal angle = 2. * PETSC_PI * turns * domain->arc_length[v] + shift;
    place->x[2 * v] = PetscCosReal(angle);
    place->x[2 * v + 1] = PetscSinReal(angle);
  }
  PetscFunctionReturn(0);
}

/* 000 (10) requires ordered angles and Algorithm 1 does not keep them: every disorder must be found. */
static PetscErrorCode TestOrderOnCircle(EqmDomain domain, const EqmPlace *start)
{
  EqmPlace place;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(domain, &place));
  PetscCall(EqmPlaceCopy(domain, start, &place));
  PetscCall(ExpectOrder(domain, &place, PETSC_TRUE, "by arc length"));
  PetscCall(Wind(domain, 1., 3., &place));
  PetscCall(ExpectOrder(domain, &place, PETSC_TRUE, "turned, past the angle 0"));
  PetscCall(Wind(domain, 2., 0., &place));
  PetscCall(ExpectOrder(domain, &place, PETSC_FALSE, "wound twice"));
  PetscCall(Wind(domain, -1., 0., &place));
  PetscCall(ExpectOrder(domain, &place, PETSC_FALSE, "backwards"));
  PetscCall(Wind(domain, .5, 0., &place));
  PetscCall(ExpectOrder(domain, &place, PETSC_FALSE, "half way round and back"));
  PetscCall(Wind(domain, 0., 1., &place));
  PetscCall(ExpectOrder(domain, &place, PETSC_FALSE, "all in one point"));
  PetscCall(EqmPlaceDestroy(&place));
  PetscFunctionReturn(0);
}

/* One vertex moved past its neighbour, and back before it. */
static PetscErrorCode TestOvertaking(EqmDomain domain, const EqmPlace *start)
{
  const EqmMesh mesh = domain->mesh;
  PetscReal gap = PETSC_MAX_REAL;
  PetscInt vertex = PETSC_MAX_INT, chosen = PETSC_MAX_INT;
  EqmPlace place;
  Vec step;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < mesh->num_boundary_facets;
       e++) { /* the mover with the lowest input number, and its way ahead */
    const PetscInt i = mesh->boundary_facets[2 * e], j = mesh->boundary_facets[2 * e + 1];
    if (i >= mesh->num_owned || domain->dof_count[i] == 0 || mesh->vertex_input[i] >= vertex) continue;
    vertex = mesh->vertex_input[i];
    gap = PetscSqrtReal(PetscSqr(start->x[2 * i] - start->x[2 * j]) +
                        PetscSqr(start->x[2 * i + 1] - start->x[2 * j + 1]));
  }
  PetscCall(MPIU_Allreduce(&vertex, &chosen, 1, MPIU_INT, MPI_MIN, mesh->comm));
  PetscCall(EqmPlaceCreate(domain, &place));
  PetscCall(EqmDomainCreateVec(domain, &step));
  for (PetscInt sign = -1; sign <= 1; sign += 2) {
    PetscCall(VecZeroEntries(step));
    for (PetscInt v = 0; v < mesh->num_owned && vertex == chosen; v++) {
      if (mesh->vertex_input[v] == chosen)
        PetscCall(VecSetValue(step, domain->dof_start[v], sign * gap, INSERT_VALUES));
    }
    PetscCall(VecAssemblyBegin(step));
    PetscCall(VecAssemblyEnd(step));
    PetscCall(EqmDomainMove(domain, start, .3, step, &place));
    PetscCall(ExpectOrder(domain, &place, PETSC_TRUE, "a third of the way to the neighbour"));
    PetscCall(EqmDomainMove(domain, start, 4., step, &place));
    PetscCall(ExpectOrder(domain, &place, PETSC_FALSE, "far past the neighbour"));
  }
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(VecDestroy(&step));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestDisk(const char *shape)
{
  TestMesh test;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, 300, 1, &test));
  PetscCall(TestStart(test.mesh, "disk", &solver));
  const EqmDomain domain = solver->problem->domain;
  CHECK_CLOSE(TestSum(PETSC_COMM_WORLD, domain->num_dofs),
              2. * test.mesh->num_vertices - test.mesh->num_boundary_vertices, 0., 1.);
  PetscCall(TestGeodesics(domain, &solver->iterate->place));
  PetscCall(TestFrames(domain, &solver->iterate->place));
  PetscCall(TestStaysOnBoundary(domain, &solver->iterate->place));
  PetscCall(TestOrderOnCircle(domain, &solver->iterate->place));
  PetscCall(TestOvertaking(domain, &solver->iterate->place));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Input numbers of the boundary vertices in the order of the loop, the same on every rank. */
static PetscErrorCode Loop(EqmMesh mesh, PetscInt **loop)
{
  PetscInt *place;
  PetscReal *arc;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_local, &place, mesh->num_local, &arc));
  PetscCall(PetscCalloc1(mesh->num_boundary_vertices, loop));
  PetscCall(EqmMeshBoundaryLoop(mesh, place, arc));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    if (place[v] >= 0) (*loop)[place[v]] = mesh->vertex_input[v];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, *loop, mesh->num_boundary_vertices, MPIU_INT, MPI_SUM, mesh->comm));
  PetscCall(PetscFree2(place, arc));
  PetscFunctionReturn(0);
}

/* The four corners that the user names stand at (0,0), (1,0), (1,1), (0,1), and each side holds the vertices between.
 */
static PetscErrorCode TestCorners(EqmMesh mesh, const PetscInt *loop, const PetscInt at[4])
{
  static const PetscReal wanted[4][2] = {{0., 0.}, {1., 0.}, {1., 1.}, {0., 1.}};
  const PetscInt n = mesh->num_boundary_vertices, corners[4] = {loop[at[0]], loop[at[1]], loop[at[2]], loop[at[3]]};
  EqmDomain domain;
  EqmPlace place;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreateSquare(mesh, corners, &domain));
  PetscCall(EqmPlaceCreate(domain, &place));
  PetscCall(EqmDomainPlaceBoundary(domain, &place));
  PetscCall(ExpectOrder(domain, &place, PETSC_TRUE, "at the start"));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscReal *const x = place.x + 2 * v;
    PetscInt k = 0, side = 0;
    if (!mesh->on_boundary[v]) continue;
    while (loop[k] != mesh->vertex_input[v]) k++;
    for (PetscInt s = 0; s < 4; s++) {
      if ((k - at[s] + n) % n < (at[(s + 1) % 4] - at[s] + n) % n) side = s;
    }
    if (k == at[side]) {
      CHECK(x[0] == wanted[side][0] && x[1] == wanted[side][1], "corner %d at (%g, %g)", (int)side, (double)x[0],
            (double)x[1]);
      CHECK(EqmDomainMotion(domain, v) == &EqmMotionCorner, "corner %d can move", (int)side);
    } else {
      CHECK(x[(side + 1) % 2] == wanted[side][(side + 1) % 2], "(%g, %g) is not on side %d", (double)x[0], (double)x[1],
            (int)side);
      CHECK(EqmDomainMotion(domain, v) == (side % 2 ? &EqmMotionSideY : &EqmMotionSideX), "side %d, kind %s", (int)side,
            EqmDomainMotion(domain, v)->name);
      CHECK(x[side % 2] > 0. && x[side % 2] < 1., "(%g, %g) is past a corner", (double)x[0], (double)x[1]);
    }
  }
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(EqmDomainDestroy(&domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestWrongCorners(EqmMesh mesh, const PetscInt *loop)
{
  const PetscInt reversed[4] = {loop[3], loop[2], loop[1], loop[0]}, twice[4] = {loop[0], loop[1], loop[1], loop[5]};
  const PetscInt crossed[4] = {loop[0], loop[5], loop[2], loop[8]},
                 absent[4] = {loop[0], loop[1], loop[2], mesh->num_vertices};
  PetscInt inside[4] = {loop[0], loop[1], loop[2], 0}, count = 0;
  EqmDomain domain;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < mesh->num_boundary_vertices; k++) count += loop[k] == inside[3];
  for (; count; inside[3]++) { /* the first vertex that is not on the boundary */
    count = 0;
    for (PetscInt k = 0; k < mesh->num_boundary_vertices; k++) count += loop[k] == inside[3] + 1;
  }
  CHECK_FAILS(EQM_ERR_USAGE, EqmDomainCreateSquare(mesh, reversed, &domain));
  CHECK_FAILS(EQM_ERR_USAGE, EqmDomainCreateSquare(mesh, twice, &domain));
  CHECK_FAILS(EQM_ERR_USAGE, EqmDomainCreateSquare(mesh, crossed, &domain));
  CHECK_FAILS(EQM_ERR_USAGE, EqmDomainCreateSquare(mesh, absent, &domain));
  CHECK_FAILS(EQM_ERR_USAGE, EqmDomainCreateSquare(mesh, inside, &domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestSquare(const char *shape)
{
  TestMesh test;
  EqmSolver solver;
  PetscInt *loop;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, 300, 1, &test));
  const PetscInt n = test.mesh->num_boundary_vertices;
  const PetscInt even[4] = {0, n / 4, n / 2, 3 * n / 4}, turned[4] = {n - 2, 3, n / 2, n / 2 + 1},
                 close[4] = {4, 5, 6, 7};
  PetscCall(TestStart(test.mesh, "square", &solver));
  CHECK_CLOSE(TestSum(PETSC_COMM_WORLD, solver->problem->domain->num_dofs), 2. * test.mesh->num_vertices - n - 4, 0.,
              1.);
  PetscCall(TestGeodesics(solver->problem->domain, &solver->iterate->place));
  PetscCall(TestFrames(solver->problem->domain, &solver->iterate->place));
  PetscCall(TestStaysOnBoundary(solver->problem->domain, &solver->iterate->place));
  PetscCall(ExpectOrder(solver->problem->domain, &solver->iterate->place, PETSC_TRUE, "by arc length"));
  PetscCall(TestOvertaking(solver->problem->domain, &solver->iterate->place));
  PetscCall(Loop(test.mesh, &loop));
  PetscCall(TestCorners(test.mesh, loop, even));
  PetscCall(TestCorners(test.mesh, loop, turned));
  PetscCall(TestCorners(test.mesh, loop, close));
  PetscCall(TestWrongCorners(test.mesh, loop));
  PetscCall(PetscFree(loop));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestDisk("cap"));
  PetscCall(TestDisk("hills"));
  PetscCall(TestSquare("patch"));
  PetscCall(TestSquare("hills"));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
