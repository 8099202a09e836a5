/* The double covering of a surface, and the Riemann map by way of it. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "store/map_private.h"

/* Half-edges of the soup's slab whose partner is missing, over all ranks. The whole mesh is small. */
static PetscErrorCode CountOpenEdges(EqmSoup soup, PetscInt *num_open)
{
  EqmSerialMesh all;
  PetscInt64 *key, *partner;
  PetscInt num = 0;

  PetscFunctionBegin;
  *num_open = 0;
  PetscCall(EqmSoupGather(soup, &all));
  PetscCall(PetscMalloc2(3 * all.num_cells, &key, 3 * all.num_cells, &partner));
  for (PetscInt c = 0; c < all.num_cells; c++) {
    for (PetscInt k = 0; k < 3; k++, num++) {
      const PetscInt i = all.cells[3 * c + k], j = all.cells[3 * c + (k + 1) % 3];
      key[num] = (PetscInt64)i * all.num_vertices + j;
      partner[num] = (PetscInt64)j * all.num_vertices + i;
    }
  }
  PetscCall(PetscSortInt64(num, key));
  PetscCall(PetscSortInt64(num, partner));
  for (PetscInt e = 0; e < num; e++) *num_open += key[e] != partner[e] || (e > 0 && key[e] == key[e - 1]);
  PetscCall(PetscFree2(key, partner));
  PetscCall(EqmSerialMeshReset(&all));
  PetscFunctionReturn(0);
}

/* A closed, oriented surface of Euler characteristic 2, twice as large, the same on any number of ranks. */
static PetscErrorCode TestCovering(void)
{
  PetscInt64 checksum;
  TestMesh test, alone;
  EqmDouble covering;
  EqmLedger ledger;
  EqmMesh mesh;
  PetscInt num_open;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "hills", 300, 3, &test));
  PetscCall(EqmDoubleCreate(test.mesh, &covering));
  CHECK(covering->soup->num_vertices == 2 * test.mesh->num_vertices - test.mesh->num_boundary_vertices, "%d vertices",
        (int)covering->soup->num_vertices);
  CHECK(covering->soup->num_cells == 2 * test.mesh->num_cells, "%d triangles", (int)covering->soup->num_cells);
  /* a closed surface has three edges to two triangles */
  CHECK(2 * covering->soup->num_vertices - covering->soup->num_cells == 4, "Euler characteristic %g",
        .5 * (2. * covering->soup->num_vertices - covering->soup->num_cells));
  PetscCall(CountOpenEdges(covering->soup, &num_open));
  CHECK(num_open == 0, "%d edges without a partner that runs the other way", (int)num_open);
  PetscCall(EqmLedgerCreate(PETSC_COMM_WORLD, &ledger));
  PetscCall(EqmMeshCreate(covering->soup, ledger, &mesh));
  CHECK(mesh->num_boundary_vertices == 0, "%d boundary vertices", (int)mesh->num_boundary_vertices);
  CHECK_CLOSE(mesh->measure, 2. * test.mesh->measure, 1e-12, test.mesh->measure);
  checksum = covering->soup->checksum;
  PetscCall(EqmMeshDestroy(&mesh));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscCall(EqmDoubleDestroy(&covering));
  PetscCall(TestMeshDestroy(&test));
  PetscCall(TestMeshCreate(PETSC_COMM_SELF, "hills", 300, 3, &alone));
  PetscCall(EqmDoubleCreate(alone.mesh, &covering));
  CHECK(covering->soup->checksum == checksum, "another covering on one rank");
  PetscCall(EqmDoubleDestroy(&covering));
  PetscCall(TestMeshDestroy(&alone));
  PetscFunctionReturn(0);
}

/* What is put on the two halves: the original comes back, and boundary vertices have one value. */
static PetscErrorCode TestHalves(void)
{
  TestMesh test;
  EqmDouble covering;
  PetscReal *original, *twin, *back, *slab, sum = 0., wanted = 0.;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "hills", 300, 3, &test));
  PetscCall(EqmDoubleCreate(test.mesh, &covering));
  const PetscInt n = test.mesh->num_owned, rows = covering->soup->vertex_end - covering->soup->vertex_start;
  PetscCall(PetscMalloc4(n, &original, n, &twin, n, &back, rows, &slab));
  for (PetscInt v = 0; v < n; v++) {
    original[v] = 1. + test.mesh->vertex_input[v];
    twin[v] = -1e4 * original[v];
    wanted += original[v] + (test.mesh->on_boundary[v] ? 0. : twin[v]);
  }
  PetscCall(EqmDoubleFromHalves(covering, 1, original, twin, slab));
  for (PetscInt i = 0; i < rows; i++) sum += slab[i];
  sum = TestSum(PETSC_COMM_WORLD, sum);
  CHECK_CLOSE(sum, TestSum(PETSC_COMM_WORLD, wanted), 1e-12, PetscAbsReal(sum));
  PetscCall(EqmDoubleToOriginal(covering, 1, slab, back));
  for (PetscInt v = 0; v < n; v++) CHECK(back[v] == original[v], "vertex %d: %g", (int)v, (double)back[v]);
  PetscCall(PetscFree4(original, twin, back, slab));
  PetscCall(EqmDoubleDestroy(&covering));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestRefusals(void)
{
  TestMesh solid, closed;
  EqmDouble covering;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "ball", 100, 0, &solid));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "sphere", 100, 0, &closed));
  CHECK_FAILS(EQM_ERR_USAGE, EqmDoubleCreate(solid.mesh, &covering));
  CHECK_FAILS(EQM_ERR_USAGE, EqmDoubleCreate(closed.mesh, &covering));
  PetscCall(TestMeshDestroy(&solid));
  PetscCall(TestMeshDestroy(&closed));
  PetscFunctionReturn(0);
}

/* The map of a cap, `flat` or not, and of a hilly disk by the covering, and how far it is from the one by the
   boundary's angles after a rotation. */
static PetscErrorCode Compare(PetscInt n, PetscBool flat, EqmDistortion *distortion, PetscReal *difference)
{
  TestMesh test;
  EqmSolver solver, other;
  EqmMap map;
  PetscBool in_order;

  PetscFunctionBegin;
  PetscCall(TestCapCreate(n, flat, &test));
  PetscCall(TestSolve(test.mesh, "conformal", "-method qiem -qiem_phase1 none -qiem_phase2 a -flow_step 4", &solver));
  PetscCall(EqmSolverGetMap(solver, test.soup, &map));
  *distortion = map->distortion;
  CHECK(map->status == EQM_STATUS_CONVERGED, "%s", map->message);
  CHECK(map->cost.work.factorizations > 1, "%d factorisations", (int)map->cost.work.factorizations);
  CHECK(map->num_history == map->iterations + 1, "%d rows", (int)map->num_history);
  PetscCall(EqmMapDestroy(&map));
  for (PetscInt v = 0; v < test.mesh->num_local; v++) {
    const PetscReal *const z = solver->iterate->place.x + 2 * v, length = PetscSqrtReal(z[0] * z[0] + z[1] * z[1]);
    CHECK(test.mesh->on_boundary[v] ? PetscAbsReal(length - 1.) < 1e-15 : length < 1., "radius 1 + %g",
          (double)(length - 1.));
  }
  PetscCall(EqmDomainBoundaryInOrder(solver->problem->domain, &solver->iterate->place, &in_order));
  CHECK(in_order, "the boundary is not in order");
  PetscCall(TestSolve(test.mesh, "conformal", "-gradient_tol 1e-8", &other));
  *difference = TestRmsAfterRotation(test.mesh, solver->iterate->place.x, other->iterate->place.x);
  PetscCall(EqmSolverDestroy(&other));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestMaps(void)
{
  EqmDistortion flat, cap, fine;
  PetscReal difference[3];

  PetscFunctionBegin;
  PetscCall(Compare(300, PETSC_TRUE, &flat, &difference[0]));
  PetscCall(Compare(300, PETSC_FALSE, &cap, &difference[1]));
  PetscCall(Compare(1200, PETSC_FALSE, &fine, &difference[2]));
  CHECK(flat.angle_error.mean < .3 && flat.folds == 0, "angles of a flat disk changed by %g degrees",
        (double)flat.angle_error.mean);
  CHECK(difference[0] < 5e-3 && difference[1] < 7e-3, "maps differ by %g and %g", (double)difference[0],
        (double)difference[1]);
  CHECK(difference[2] < difference[1] / 3., "maps differ by %g and %g with half the mesh width: not of second order",
        (double)difference[1], (double)difference[2]);
  CHECK(fine.angle_error.mean < cap.angle_error.mean / 1.8 && fine.folds == 0, "angle errors %g and %g degrees",
        (double)cap.angle_error.mean, (double)fine.angle_error.mean);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestCovering());
  PetscCall(TestHalves());
  PetscCall(TestRefusals());
  PetscCall(TestMaps());
  PetscCall(EqmFinalize());
  return 0;
}
