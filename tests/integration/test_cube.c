/* Maps of solids to the cube: sliding in faces and along edges, the derivative there, the cube as a map of itself, the
   same map on any number of ranks, faces that are whole and meet as those of a cube do. */
#include "support/runs.h"
#include "geometry/simplex.h"

/* The mesh "cube" on [0, 1]^3: it is its own map. */
static PetscErrorCode CreateCube(PetscInt n, TestMesh *test)
{
  EqmSoup soup;
  PetscReal low[3], high[3];

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "cube", n, 0, &soup));
  for (PetscInt k = 0; k < 3; k++) low[k] = high[k] = soup->vertex_end > soup->vertex_start ? soup->vertices[k] : 0.;
  for (PetscInt k = 0; k < 3 * (soup->vertex_end - soup->vertex_start); k++) {
    low[k % 3] = PetscMin(low[k % 3], soup->vertices[k]);
    high[k % 3] = PetscMax(high[k % 3], soup->vertices[k]);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, low, 3, MPIU_REAL, MPIU_MIN, PETSC_COMM_WORLD));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, high, 3, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD));
  for (PetscInt k = 0; k < 3 * (soup->vertex_end - soup->vertex_start); k++)
    soup->vertices[k] = (soup->vertices[k] - low[k % 3]) / (high[k % 3] - low[k % 3]);
  PetscCall(TestMeshFromSoup(soup, test));
  PetscFunctionReturn(0);
}

/* Free coordinates follow the step, the others stay to the last bit; the gradient is the energy's. */
static PetscErrorCode TestSliding(EqmMesh mesh)
{
  const PetscReal h = 1e-6;
  EqmDomain domain;
  EqmPlace place, ahead, behind;
  PetscReal *a, energy[2], slope;
  PetscInt moved = 0;
  Vec step, gradient;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreateCube(mesh, mesh->position, &domain));
  PetscCall(EqmPlaceCreate(domain, &place));
  PetscCall(EqmPlaceCreate(domain, &ahead));
  PetscCall(EqmPlaceCreate(domain, &behind));
  PetscCall(PetscMalloc1(mesh->num_local_cells, &a));
  PetscCall(EqmDomainCreateVec(domain, &step));
  PetscCall(VecDuplicate(step, &gradient));
  PetscCall(PetscArraycpy(place.x, mesh->position, 3 * mesh->num_local));
  PetscCall(TestRandomStep(domain, 3, 1., step));
  PetscCall(EqmDomainMove(domain, &place, .01, step, &place));
  for (PetscInt k = 0; k < 3 * mesh->num_local; k++) {
    const PetscReal at = mesh->position[k];
    const PetscBool held = (PetscBool)(mesh->on_boundary[k / 3] && (at == 0. || at == 1.));
    CHECK((place.x[k] == at) == held, "coordinate %d of a vertex: %g, held at %g", (int)k % 3, (double)place.x[k],
          (double)at);
    moved += !held && k < 3 * mesh->num_owned;
  }
  CHECK(moved == domain->num_dofs, "%d coordinates moved, %d degrees of freedom", (int)moved, (int)domain->num_dofs);
  PetscCall(TestRandomStep(domain, 4, 1., step));
  PetscCall(EqmAuthalicEnergy(domain, &place, a, &energy[0], gradient));
  PetscCall(VecDot(gradient, step, &slope));
  PetscCall(EqmDomainMove(domain, &place, h, step, &ahead));
  PetscCall(EqmDomainMove(domain, &place, -h, step, &behind));
  PetscCall(EqmAuthalicEnergy(domain, &ahead, a, &energy[1], NULL));
  PetscCall(EqmAuthalicEnergy(domain, &behind, a, &energy[0], NULL));
  CHECK_CLOSE((energy[1] - energy[0]) / (2. * h), slope, 1e-6, PetscAbsReal(slope));
  PetscCall(VecDestroy(&step));
  PetscCall(VecDestroy(&gradient));
  PetscCall(PetscFree(a));
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(EqmPlaceDestroy(&ahead));
  PetscCall(EqmPlaceDestroy(&behind));
  PetscCall(EqmDomainDestroy(&domain));
  PetscFunctionReturn(0);
}

/* From a map of the cube to itself whose faces, edges and inside are shaken, back to E = 0. */
static PetscErrorCode TestItself(EqmMesh mesh)
{
  PetscReal *x;
  EqmSolver solver;
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * mesh->num_local, &x));
  for (PetscInt k = 0; k < 3 * mesh->num_owned; k++) {
    const PetscReal at = mesh->position[k];
    const PetscBool held = (PetscBool)(mesh->on_boundary[k / 3] && (at == 0. || at == 1.));
    x[k] = at + (held ? 0. : .02 * TestRandom(5, mesh->vertex_input[k / 3], k % 3));
  }
  PetscCall(TestOptionsBegin("-quiet -max_it 400", &options));
  PetscCall(EqmSolverCreate(mesh, "cube", &solver));
  PetscCall(EqmSolverSetFromOptions(solver));
  PetscCall(EqmSolverSetFirstMap(solver, 3, x));
  PetscCall(EqmSolverSolve(solver));
  PetscCall(TestOptionsEnd(&options));
  CHECK(solver->history[0].energy > 1e-3, "the start's energy is %g", (double)solver->history[0].energy);
  CHECK(solver->iterate->totals.energy < 1e-8, "the cube to itself: energy %g", (double)solver->iterate->totals.energy);
  CHECK(solver->iterate->totals.folds == 0, "folds");
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(PetscFree(x));
  PetscFunctionReturn(0);
}

/* A box of three different edges, turned in space: stretched to the cube, it keeps every share of the volume. */
static PetscErrorCode TestBox(void)
{
  const PetscReal c = PetscCosReal(.5), s = PetscSinReal(.5);
  TestMesh test;
  EqmSoup soup;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "cube", 300, 0, &soup));
  for (PetscInt v = 0; v < soup->vertex_end - soup->vertex_start; v++) {
    PetscReal *const p = soup->vertices + 3 * v;
    const PetscReal x = 3. * p[0], y = p[1], z = 2. * p[2];
    p[0] = c * x - s * y;
    p[1] = c * (s * x + c * y) - s * z;
    p[2] = s * (s * x + c * y) + c * z;
  }
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(TestSolve(test.mesh, "cube", "-max_it 2", &solver));
  CHECK(solver->iterate->totals.energy < 1e-16, "a box: energy %g", (double)solver->iterate->totals.energy);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Six whole faces: the areas of the boundary triangles in each add up to one, none is folded, and the volume is one. */
static PetscErrorCode TestFaces(const char *shape, PetscInt n, PetscReal most)
{
  PetscReal area[6] = {0.};
  TestMesh test;
  EqmSolver solver;
  PetscInt64 folds;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 1, &test));
  PetscCall(TestSolve(test.mesh, "cube", "-max_it 60", &solver));
  const EqmPlace *const place = &solver->iterate->place;
  for (PetscInt f = 0; f < test.mesh->num_boundary_facets; f++) {
    const PetscInt *const v = test.mesh->boundary_facets + 3 * f;
    PetscInt lowest = v[0], sides = ~0;
    for (PetscInt a = 0; a < 3; a++) {
      if (test.mesh->global[v[a]] < test.mesh->global[lowest]) lowest = v[a];
      sides &= EqmCubeSides(place->x + 3 * v[a]);
    }
    if (lowest >= test.mesh->num_owned) continue;
    for (PetscInt side = 0; side < 6; side++) {
      if (sides >> side & 1) area[side] += EqmArea3(place->x + 3 * v[0], place->x + 3 * v[1], place->x + 3 * v[2]);
    }
  }
  for (PetscInt side = 0; side < 6; side++) CHECK_CLOSE(TestSum(PETSC_COMM_WORLD, area[side]), 1., 1e-12, 1.);
  PetscCall(EqmImageBoundaryFolds(solver->problem->domain, place, &folds));
  CHECK(folds == 0 && solver->iterate->totals.folds == 0, "%s: %d folds, %d on the boundary", shape,
        (int)solver->iterate->totals.folds, (int)folds);
  CHECK_CLOSE(solver->iterate->totals.total, 1., 1e-12, 1.);
  CHECK(solver->iterate->totals.energy < most, "%s: energy %g", shape, (double)solver->iterate->totals.energy);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  TestMesh test;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(CreateCube(300, &test));
  PetscCall(TestSliding(test.mesh));
  PetscCall(TestItself(test.mesh));
  PetscCall(TestMeshDestroy(&test));
  PetscCall(TestBox());
  PetscCall(TestFaces("figure", 1000, 5e-2));
  PetscCall(TestFaces("blob", 1000, 5e-2));
  PetscCall(TestFaces("ball", 1000, 5e-3));
  PetscCall(TestSameOnRanks("ball", 700, "cube", "-max_it 10", 1e-7, .5));
  PetscCall(PetscFinalize());
  return 0;
}
