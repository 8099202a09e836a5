/* Maps by the cascade: derivatives, relaxation, multigrid, and no fold on shapes good and bad. */
#include "support/testing.h"
#include "domain/domain_private.h"
#include "hierarchy/balance.h"
#include "hierarchy/cascade.h"
#include "hierarchy/levelsystem.h"
#include "hierarchy/prolongation.h"
#include "hierarchy/relax.h"
#include <omp.h>

/* A surface, its levels and a map of the finest. */
typedef struct {
  TestMesh mesh;
  EqmDomain domain;
  EqmHierarchy hierarchy;
  EqmCascadeTarget target;
  EqmCascadeResult result;
  PetscReal *x;
} Case;

static PetscErrorCode CaseCreate(EqmSoup soup, EqmCascadeTarget target, Case *test)
{
  EqmHierarchyOptions options;
  EqmCascadeOptions cascade;
  PetscBool *corner;
  EqmPlace place;

  PetscFunctionBegin;
  test->target = target;
  PetscCall(TestMeshFromSoup(soup, &test->mesh));
  if (target == EQM_TARGET_DISK) PetscCall(EqmDomainCreateDisk(test->mesh.mesh, &test->domain));
  if (target == EQM_TARGET_SQUARE) PetscCall(EqmDomainCreateSquare(test->mesh.mesh, NULL, &test->domain));
  if (target == EQM_TARGET_SPHERE) PetscCall(EqmDomainCreateSphere(test->mesh.mesh, &test->domain));
  PetscCall(PetscMalloc1(test->mesh.mesh->num_local, &corner));
  for (PetscInt v = 0; v < test->mesh.mesh->num_local; v++)
    corner[v] = (PetscBool)(EqmDomainMotion(test->domain, v) == &EqmMotionCorner);
  PetscCall(EqmHierarchyOptionsDefault(&options));
  PetscCall(EqmCascadeOptionsDefault(&cascade));
  options.corner = corner;
  PetscCall(EqmHierarchyCreate(test->mesh.mesh, &options, &test->hierarchy));
  PetscCall(EqmPlaceCreate(test->domain, &place));
  PetscCall(EqmDomainPlaceBoundary(test->domain, &place));
  PetscCall(PetscMalloc1(test->domain->dim * test->hierarchy->level[0].num_vertices, &test->x));
  PetscCall(EqmHierarchyGather(test->hierarchy, test->domain->dim, place.x, test->x));
  PetscCall(EqmCascade(test->hierarchy, target, &cascade, test->x, &test->result));
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(PetscFree(corner));
  PetscFunctionReturn(0);
}

static PetscErrorCode CaseDestroy(Case *test)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(test->x));
  PetscCall(EqmHierarchyDestroy(&test->hierarchy));
  PetscCall(EqmDomainDestroy(&test->domain));
  PetscCall(TestMeshDestroy(&test->mesh));
  PetscFunctionReturn(0);
}

static PetscErrorCode CaseGenerate(MPI_Comm comm, const char *shape, PetscInt n, EqmCascadeTarget target, Case *test)
{
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(comm, shape, n, 1, &soup));
  PetscCall(CaseCreate(soup, target, test));
  PetscFunctionReturn(0);
}

/* The map of the finest level, as the folder's inner functions want it; on the first rank. */
static PetscErrorCode CaseMap(const Case *test, PetscReal epsilon, EqmLevelMap *map)
{
  EqmLevelValue value;

  PetscFunctionBegin;
  PetscCall(EqmLevelMapCreate(&test->hierarchy->level[0], test->target, map));
  PetscCall(PetscArraycpy(map->x, test->x, map->dim * map->level->num_vertices));
  PetscCall(EqmLevelMapSetMotions(map, test->target));
  map->epsilon = epsilon;
  PetscCall(EqmLevelMapEvaluate(map, map->x, &value));
  PetscFunctionReturn(0);
}

/* One cell's part of the objective, A as it is. */
static PetscReal CellObjective(const EqmLevelMap *map, PetscInt cell)
{
  const PetscInt *const v = map->level->cells + 3 * cell, dim = map->dim;
  const PetscReal *const p[3] = {map->x + dim * v[0], map->x + dim * v[1], map->x + dim * v[2]};
  const PetscReal w = map->level->weight[cell];
  EqmLevelResidual residual[2];
  PetscReal half[3], value = 0., angle = dim == 2 ? -EqmLevelArea(dim, p[0], p[1], p[2]) : -4. * PETSC_PI * w;

  const PetscInt count = EqmLevelResiduals(dim, p[0], p[1], p[2], 1. / (map->total * w), residual);
  CHECK(count > 0, "cell %d is folded", (int)cell);
  for (PetscInt m = 0; m < count; m++) value += w * PetscSqr(residual[m].rho);
  EqmHalfCotangents(map->level, cell, half);
  for (PetscInt a = 0; a < 3; a++) {
    for (PetscInt k = 0; k < dim; k++) angle += .5 * half[a] * PetscSqr(p[(a + 1) % 3][k] - p[(a + 2) % 3][k]);
  }
  return value + EqmAngleFactor(map) * angle;
}

/* The right-hand side of every cell is half of minus the objective's slope. */
static PetscErrorCode TestSlopes(const char *shape, EqmCascadeTarget target)
{
  const PetscReal h = 1e-6;
  Case test;
  EqmLevelMap map;
  EqmCellSystem s;

  PetscFunctionBegin;
  PetscCall(CaseGenerate(PETSC_COMM_SELF, shape, 200, target, &test));
  PetscCall(CaseMap(&test, .1, &map));
  for (PetscInt c = 0; c < map.level->num_cells; c++) {
    PetscReal largest = 0.;
    EqmBalanceCell(&map, c, 0., 0., &s);
    for (PetscInt k = 0; k < s.count[0] + s.count[1] + s.count[2]; k++)
      largest = PetscMax(largest, PetscAbsReal(s.right[k]));
    for (PetscInt a = 0, n = 0; a < 3; a++) {
      PetscReal *const x = map.x + map.dim * map.level->cells[3 * c + a], before[3], value[2];
      PetscCall(PetscArraycpy(before, x, map.dim));
      for (PetscInt k = 0; k < s.count[a]; k++, n++) {
        for (PetscInt side = 0; side < 2; side++) {
          for (PetscInt e = 0; e < map.dim; e++) x[e] = before[e] + (side ? h : -h) * s.frame[a][map.dim * k + e];
          EqmRetract((EqmMotion)map.motion[map.level->cells[3 * c + a]], x);
          value[side] = CellObjective(&map, c);
          PetscCall(PetscArraycpy(x, before, map.dim));
        }
        CHECK_CLOSE(-2. * s.right[n], (value[1] - value[0]) / (2. * h), 1e-4, 2. * largest);
      }
    }
  }
  PetscCall(EqmLevelMapDestroy(&map));
  PetscCall(CaseDestroy(&test));
  PetscFunctionReturn(0);
}

/* The slope of the whole objective, A as it is. */
static PetscErrorCode SlopeNorm(const EqmLevelMap *map, PetscReal *norm)
{
  PetscReal *sum;
  EqmCellSystem s;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(2 * map->level->num_vertices, &sum));
  for (PetscInt c = 0; c < map->level->num_cells; c++) {
    EqmBalanceCell(map, c, 0., 0., &s);
    for (PetscInt a = 0, n = 0; a < 3; a++) {
      for (PetscInt k = 0; k < s.count[a]; k++) sum[2 * map->level->cells[3 * c + a] + k] += s.right[n++];
    }
  }
  *norm = 0.;
  for (PetscInt k = 0; k < 2 * map->level->num_vertices; k++) *norm += sum[k] * sum[k];
  *norm = PetscSqrtReal(*norm);
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(0);
}

/* Sweeps lead to where the slope vanishes, and never through a fold. */
static PetscErrorCode TestRelaxation(const char *shape, EqmCascadeTarget target)
{
  Case test;
  EqmLevelMap map;
  EqmLevelStars stars;
  EqmLevelValue value;
  PetscReal before, after;

  PetscFunctionBegin;
  PetscCall(CaseGenerate(PETSC_COMM_SELF, shape, 100, target, &test));
  PetscCall(CaseMap(&test, .3, &map)); /* another weight than the map was made with */
  PetscCall(EqmLevelStarsCreate(map.level, &stars));
  PetscCall(SlopeNorm(&map, &before));
  PetscCall(EqmRelaxLevel(&map, &stars, 300));
  PetscCall(SlopeNorm(&map, &after));
  CHECK(after < 1e-3 * before, "the slope falls from %g to %g only", (double)before, (double)after);
  PetscCall(EqmLevelMapEvaluate(&map, map.x, &value));
  CHECK(value.folds == 0, "folds");
  PetscCall(EqmLevelStarsDestroy(&stars));
  PetscCall(EqmLevelMapDestroy(&map));
  PetscCall(CaseDestroy(&test));
  PetscFunctionReturn(0);
}

/* Two levels with systems of their own and the prolongation between them. */
typedef struct {
  EqmLevelMap fine, coarse;
  EqmLevelSystem system; /* of the finer */
  EqmProlongation prolongation;
} TwoLevels;

static PetscErrorCode SystemOf(const EqmLevelMap *map, EqmLevelSystem *system)
{
  unsigned char *count;
  PetscReal frame[6];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(map->level->num_vertices, &count));
  for (PetscInt v = 0; v < map->level->num_vertices; v++)
    count[v] = (unsigned char)EqmMotionFrame((EqmMotion)map->motion[v], map->x + map->dim * v, frame);
  PetscCall(EqmLevelSystemCreate(map->level, count, system));
  PetscCall(PetscFree(count));
  PetscFunctionReturn(0);
}

static PetscErrorCode TwoLevelsCreate(const Case *test, TwoLevels *two)
{
  PetscFunctionBegin;
  PetscCall(CaseMap(test, .1, &two->fine));
  PetscCall(EqmLevelMapCreate(&test->hierarchy->level[1], test->target, &two->coarse));
  PetscCall(EqmLevelMapRestrict(&two->fine, &two->coarse));
  PetscCall(SystemOf(&two->fine, &two->system));
  PetscCall(EqmProlongationCreate(&two->fine, &two->coarse, &two->prolongation));
  PetscFunctionReturn(0);
}

static PetscErrorCode TwoLevelsDestroy(TwoLevels *two)
{
  PetscFunctionBegin;
  PetscCall(EqmProlongationDestroy(&two->prolongation));
  PetscCall(EqmLevelSystemDestroy(&two->system));
  PetscCall(EqmLevelMapDestroy(&two->fine));
  PetscCall(EqmLevelMapDestroy(&two->coarse));
  PetscFunctionReturn(0);
}

/* A rotation (about `axis` on the sphere) in the directions of each vertex. */
static void Rotation(const EqmLevelMap *map, const PetscReal axis[3], PetscReal *motion)
{
  PetscReal frame[6], turn[3];

  for (PetscInt v = 0; v < map->level->num_vertices; v++) {
    const PetscReal *const x = map->x + map->dim * v;
    const PetscInt count = EqmMotionFrame((EqmMotion)map->motion[v], x, frame);
    if (map->dim == 3)
      EqmCross(axis, x, turn);
    else {
      turn[0] = -x[1];
      turn[1] = x[0];
    }
    for (PetscInt k = 0; k < 2; k++) {
      motion[2 * v + k] = 0.;
      for (PetscInt c = 0; c < map->dim && k < count; c++) motion[2 * v + k] += frame[map->dim * k + c] * turn[c];
    }
  }
}

/* Rotations are prolonged exactly, but for a vertex here and there that no coarse triangle is around. */
static PetscErrorCode TestProlongation(const char *shape, EqmCascadeTarget target)
{
  const PetscReal axis[3] = {.36, .48, .8};
  Case test;
  TwoLevels two;
  PetscReal *coarse, *fine, *prolonged;
  PetscInt n, differ = 0;

  PetscFunctionBegin;
  PetscCall(CaseGenerate(PETSC_COMM_SELF, shape, 1500, target, &test));
  PetscCall(TwoLevelsCreate(&test, &two));
  n = 2 * two.fine.level->num_vertices;
  PetscCall(PetscMalloc2(2 * two.coarse.level->num_vertices, &coarse, n, &fine));
  PetscCall(PetscCalloc1(n, &prolonged));
  Rotation(&two.fine, axis, fine);
  Rotation(&two.coarse, axis, coarse);
  EqmProlongationAdd(&two.prolongation, coarse, prolonged);
  for (PetscInt k = 0; k < n; k++) differ += PetscAbsReal(prolonged[k] - fine[k]) > 1e-5;
  CHECK(differ <= .02 * n, "%d of %d differ", (int)differ, (int)n);
  PetscCall(PetscFree2(coarse, fine));
  PetscCall(PetscFree(prolonged));
  PetscCall(TwoLevelsDestroy(&two));
  PetscCall(CaseDestroy(&test));
  PetscFunctionReturn(0);
}

static PetscErrorCode FillSystem(TwoLevels *two)
{
  EqmCellSystem s;
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(EqmLevelSystemClear(&two->system));
  for (PetscInt c = 0; c < two->fine.level->num_cells; c++) {
    EqmBalanceCell(&two->fine, c, .01, .1, &s);
    EqmLevelSystemAdd(&two->system, c, s.matrix, s.right);
  }
  PetscCall(EqmLevelSystemEnd(&two->system, 1e-10, &success));
  CHECK(success, "a block of the diagonal is not definite");
  PetscFunctionReturn(0);
}

/* How far off the system that EqmBalanceAssemble makes is from the sum of EqmBalanceCell, over the largest number. */
static PetscReal Difference(PetscInt n, const PetscReal *one, const PetscReal *other)
{
  PetscReal largest = 0., difference = 0.;

  for (PetscInt k = 0; k < n; k++) {
    largest = PetscMax(largest, PetscAbsReal(other[k]));
    difference = PetscMax(difference, PetscAbsReal(one[k] - other[k]));
  }
  return difference / largest;
}

static PetscErrorCode TestAssembly(const char *shape, EqmCascadeTarget target)
{
  Case test;
  TwoLevels two;
  EqmLevelSystem assembled;
  PetscBool success;
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(CaseGenerate(PETSC_COMM_SELF, shape, 800, target, &test));
  PetscCall(TwoLevelsCreate(&test, &two));
  PetscCall(FillSystem(&two));
  PetscCall(SystemOf(&two.fine, &assembled));
  PetscCall(EqmBalanceAssemble(&two.fine, .01, PetscSqr(.1 / .3), &assembled, &success));
  CHECK(success, "a block of the diagonal is not definite");
  n = assembled.matrix.num_rows;
  CHECK_CLOSE(Difference(2 * n, assembled.right, two.system.right), 0., 1e-12, 1.);
  CHECK_CLOSE(Difference(4 * assembled.matrix.start[n], assembled.matrix.entry[0].e, two.system.matrix.entry[0].e), 0.,
              1e-12, 1.);
  PetscCall(EqmLevelSystemDestroy(&assembled));
  PetscCall(TwoLevelsDestroy(&two));
  PetscCall(CaseDestroy(&test));
  PetscFunctionReturn(0);
}

/* The coarser matrix is P^T A P: x^T (P^T A P) y = (P x)^T A (P y) for any x and y; P^T is the transpose of P. */
static PetscErrorCode TestGalerkin(const char *shape, EqmCascadeTarget target)
{
  Case test;
  TwoLevels two;
  EqmBlockMatrix coarse;
  PetscReal *x[2], *fine[2], *product, *restricted, sides[4] = {0., 0., 0., 0.};
  PetscInt n, m;
  PetscRandom random;

  PetscFunctionBegin;
  PetscCall(CaseGenerate(PETSC_COMM_SELF, shape, 800, target, &test));
  PetscCall(TwoLevelsCreate(&test, &two));
  PetscCall(FillSystem(&two));
  PetscCall(EqmProlongationGalerkinPattern(&two.prolongation, &two.system.matrix, &coarse));
  PetscCall(EqmProlongationGalerkinFill(&two.prolongation, &two.system.matrix, &coarse));
  n = 2 * two.prolongation.num_fine;
  m = 2 * two.prolongation.num_coarse;
  PetscCall(PetscRandomCreate(PETSC_COMM_SELF, &random));
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(PetscMalloc1(m, &x[k]));
    PetscCall(PetscCalloc1(n, &fine[k]));
    for (PetscInt i = 0; i < m; i++) PetscCall(PetscRandomGetValueReal(random, &x[k][i]));
    EqmProlongationAdd(&two.prolongation, x[k], fine[k]);
  }
  PetscCall(PetscMalloc2(n, &product, m, &restricted));
  EqmBlockMatrixMultiply(&two.system.matrix, fine[1], product);
  for (PetscInt i = 0; i < n; i++) sides[0] += fine[0][i] * product[i];
  EqmProlongationRestrict(&two.prolongation, product, restricted);
  for (PetscInt i = 0; i < m; i++) sides[1] += x[0][i] * restricted[i];
  EqmBlockMatrixMultiply(&coarse, x[1], restricted);
  for (PetscInt i = 0; i < m; i++) sides[2] += x[0][i] * restricted[i];
  EqmBlockMatrixMultiply(&coarse, x[0], restricted);
  for (PetscInt i = 0; i < m; i++) sides[3] += x[1][i] * restricted[i];
  for (PetscInt k = 1; k < 4; k++)
    CHECK(PetscAbsReal(sides[k] - sides[0]) < 1e-10 * PetscAbsReal(sides[0]), "side %d: %g, not %g", (int)k,
          (double)sides[k], (double)sides[0]);
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(PetscFree(x[k]));
    PetscCall(PetscFree(fine[k]));
  }
  PetscCall(PetscFree2(product, restricted));
  PetscCall(PetscRandomDestroy(&random));
  PetscCall(EqmBlockMatrixReset(&coarse));
  PetscCall(TwoLevelsDestroy(&two));
  PetscCall(CaseDestroy(&test));
  PetscFunctionReturn(0);
}

/* Multigrid and Cholesky solve the same system. */
static PetscErrorCode TestMultigrid(const char *shape, EqmCascadeTarget target)
{
  Case test;
  TwoLevels two;
  PetscInt iterations, n;
  PetscBool success;
  PetscReal norm = 0., difference = 0., *direct;

  PetscFunctionBegin;
  PetscCall(CaseGenerate(PETSC_COMM_SELF, shape, 1500, target, &test));
  PetscCall(TwoLevelsCreate(&test, &two));
  PetscCall(FillSystem(&two));
  PetscCall(EqmLevelSystemFactorSolve(&two.system, &success));
  CHECK(success, "no factor");
  n = 2 * two.fine.level->num_vertices;
  PetscCall(PetscMalloc1(n, &direct));
  PetscCall(PetscArraycpy(direct, two.system.solution, n));
  PetscCall(EqmLevelSystemMultigridSolve(&two.system, 1, &two.prolongation, 1e-6, &iterations, &success));
  CHECK(success && iterations < 50, "%d iterations", (int)iterations);
  for (PetscInt k = 0; k < n; k++) {
    norm += PetscSqr(direct[k]);
    difference += PetscSqr(direct[k] - two.system.solution[k]);
  }
  CHECK(difference < 1e-6 * norm, "%g of %g differ", (double)difference, (double)norm);
  PetscCall(PetscFree(direct));
  PetscCall(TwoLevelsDestroy(&two));
  PetscCall(CaseDestroy(&test));
  PetscFunctionReturn(0);
}

/* No folds by the energies' own count, on the mesh as it is dealt out, and no more than this energy. */
static PetscErrorCode CheckMap(const Case *test, PetscReal most_energy)
{
  const EqmMesh mesh = test->mesh.mesh;
  PetscInt64 folds;
  PetscReal *scratch;
  PetscBool in_order;
  EqmPlace place;

  PetscFunctionBegin;
  CHECK(test->result.folds == 0, "%d folds", (int)test->result.folds);
  CHECK(test->result.energy < most_energy, "energy %g", (double)test->result.energy);
  PetscCall(EqmPlaceCreate(test->domain, &place));
  PetscCall(EqmHierarchyScatter(test->hierarchy, test->domain->dim, test->x, place.x));
  PetscCall(EqmMeshUpdateGhosts(mesh, test->domain->dim, place.x));
  PetscCall(EqmPlaceMakeFrames(test->domain, &place));
  PetscCall(PetscMalloc1(mesh->num_local_cells, &scratch));
  PetscCall(EqmImageFolds(test->domain, &place, scratch, &folds));
  CHECK(folds == 0, "%d folds", (int)folds);
  PetscCall(EqmDomainBoundaryInOrder(test->domain, &place, &in_order));
  CHECK(in_order, "the boundary is out of order");
  PetscCall(PetscFree(scratch));
  PetscCall(EqmPlaceDestroy(&place));
  PetscFunctionReturn(0);
}

/* On one rank and on all: no folds, and the same map. */
static PetscErrorCode TestShape(const char *shape, PetscInt n, EqmCascadeTarget target, PetscReal most_energy)
{
  Case alone, together;

  PetscFunctionBegin;
  PetscCall(CaseGenerate(PETSC_COMM_SELF, shape, n, target, &alone));
  PetscCall(CaseGenerate(PETSC_COMM_WORLD, shape, n, target, &together));
  PetscCall(CheckMap(&together, most_energy));
  for (PetscInt k = 0; k < together.domain->dim * together.hierarchy->level[0].num_vertices; k++)
    CHECK_CLOSE(together.x[k], alone.x[k], 1e-6, 1.);
  PetscCall(CaseDestroy(&alone));
  PetscCall(CaseDestroy(&together));
  PetscFunctionReturn(0);
}

/* A tube with hemispheres at its ends: `around` vertices on a ring, rings `step` apart. */
static PetscErrorCode Capsule(PetscReal length, PetscReal radius, PetscInt around, PetscInt rings, EqmSoup *soup)
{
  const PetscInt n = around * rings + 2;
  PetscReal *point;
  PetscInt *cell, m = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * n, &point, 6 * n, &cell));
  for (PetscInt r = 0; r < rings; r++) {
    const PetscReal z = length * (r + .5) / rings, end = PetscMin(z, length - z);
    const PetscReal wide = end < radius ? PetscSqrtReal(radius * radius - PetscSqr(radius - end)) : radius;
    for (PetscInt k = 0; k < around; k++) {
      const PetscReal angle = 2. * PETSC_PI * (k + .5 * (r % 2)) / around;
      const PetscReal place[3] = {wide * PetscCosReal(angle), wide * PetscSinReal(angle), z};
      PetscCall(PetscArraycpy(point + 3 * (around * r + k), place, 3));
    }
  }
  for (PetscInt k = 0; k < 6; k++) point[3 * (n - 2) + k] = k == 5 ? length : 0.;
  for (PetscInt r = 0; r <= rings; r++) {
    for (PetscInt k = 0; k < around; k++) {
      const PetscInt next = (k + 1) % around, shift = (r - 1) % 2;
      const PetscInt a = around * (r - 1) + k, b = around * (r - 1) + next, c = around * r + k, d = around * r + next;
      const PetscInt lower = r > 0 ? (shift ? a : b) : n - 2;
      const PetscInt pair[2][3] = {{a, b, shift ? d : c}, {lower, d, c}};
      if (r == rings) {
        const PetscInt top[3] = {a, b, n - 1};
        PetscCall(PetscArraycpy(cell + 3 * m++, top, 3));
        continue;
      }
      if (r > 0) PetscCall(PetscArraycpy(cell + 3 * m++, pair[0], 3));
      if (r > 0 && shift) { /* the diagonal from a to d */
        const PetscInt other[3] = {a, d, c};
        PetscCall(PetscArraycpy(cell + 3 * m++, other, 3));
      } else {
        PetscCall(PetscArraycpy(cell + 3 * m++, pair[1], 3));
      }
    }
  }
  PetscCall(TestSoupFromArrays(PETSC_COMM_WORLD, n, point, 3, m, cell, soup));
  PetscCall(PetscFree2(point, cell));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestCapsule(void)
{
  EqmSoup soup;
  Case test;

  PetscFunctionBegin;
  PetscCall(Capsule(20., .1, 12, 400, &soup));
  PetscCall(CaseCreate(soup, EQM_TARGET_SPHERE, &test));
  PetscCall(CheckMap(&test, 1000.)); /* far from equal areas, but a map */
  PetscCall(CaseDestroy(&test));
  PetscFunctionReturn(0);
}

/* Every tenth triangle of a good surface gets a vertex all but on one of its edges: needles of quality 1e-6. */
static PetscErrorCode TestNeedles(const char *shape, EqmCascadeTarget target, PetscReal most_energy)
{
  const PetscReal share[3] = {1e-6, .3, .7 - 1e-6};
  EqmSoup soup, needles;
  Case test;
  PetscReal *point;
  PetscInt *cell, n, m;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_SELF, shape, 1500, 1, &soup));
  n = soup->num_vertices;
  m = soup->num_cells;
  PetscCall(PetscMalloc2(3 * (n + m), &point, 9 * m, &cell));
  PetscCall(PetscArraycpy(point, soup->vertices, 3 * n));
  PetscCall(PetscArraycpy(cell, soup->cells, 3 * m));
  for (PetscInt c = 0; c < soup->num_cells; c += 10, n++) {
    const PetscInt v[3] = {cell[3 * c], cell[3 * c + 1], cell[3 * c + 2]};
    for (PetscInt k = 0; k < 3; k++) {
      point[3 * n + k] = 0.;
      for (PetscInt a = 0; a < 3; a++) point[3 * n + k] += share[a] * point[3 * v[a] + k];
    }
    cell[3 * c + 2] = n;
    for (PetscInt a = 1; a < 3; a++, m++) {
      cell[3 * m] = v[a];
      cell[3 * m + 1] = v[(a + 1) % 3];
      cell[3 * m + 2] = n;
    }
  }
  PetscCall(TestSoupFromArrays(PETSC_COMM_WORLD, n, point, 3, m, cell, &needles));
  PetscCall(CaseCreate(needles, target, &test));
  PetscCall(CheckMap(&test, most_energy));
  PetscCall(CaseDestroy(&test));
  PetscCall(PetscFree2(point, cell));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

/* Several pieces on each of the finer levels, and cells and vertices between them: the same bits for any number of
   threads. */
static PetscErrorCode TestThreads(const char *shape, EqmCascadeTarget target)
{
  const int threads = omp_get_max_threads();
  Case one, three;
  PetscBool same;

  PetscFunctionBegin;
  omp_set_num_threads(1);
  PetscCall(CaseGenerate(PETSC_COMM_WORLD, shape, 20000, target, &one));
  omp_set_num_threads(3);
  PetscCall(CaseGenerate(PETSC_COMM_WORLD, shape, 20000, target, &three));
  omp_set_num_threads(threads);
  CHECK(one.hierarchy->level[0].num_vertices > 2 * EQM_VERTICES_OF_PIECE, "one piece");
  PetscCall(PetscArraycmp(one.x, three.x, one.domain->dim * one.hierarchy->level[0].num_vertices, &same));
  CHECK(same, "three threads' map differs from that of one");
  CHECK(one.result.folds == 0 && one.result.energy < .1, "energy %g, %d folds", (double)one.result.energy,
        (int)one.result.folds);
  PetscCall(CaseDestroy(&one));
  PetscCall(CaseDestroy(&three));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscMPIInt size;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestSlopes("hills", EQM_TARGET_DISK));
  PetscCall(TestSlopes("patch", EQM_TARGET_SQUARE));
  PetscCall(TestSlopes("head", EQM_TARGET_SPHERE));
  PetscCall(TestRelaxation("hills", EQM_TARGET_DISK));
  PetscCall(TestRelaxation("patch", EQM_TARGET_SQUARE));
  PetscCall(TestRelaxation("head", EQM_TARGET_SPHERE));
  PetscCall(TestProlongation("hills", EQM_TARGET_DISK));
  PetscCall(TestProlongation("head", EQM_TARGET_SPHERE));
  PetscCall(TestAssembly("hills", EQM_TARGET_DISK));
  PetscCall(TestAssembly("hills", EQM_TARGET_SQUARE));
  PetscCall(TestAssembly("head", EQM_TARGET_SPHERE));
  PetscCall(TestGalerkin("hills", EQM_TARGET_DISK));
  PetscCall(TestMultigrid("hills", EQM_TARGET_DISK));
  PetscCall(TestGalerkin("head", EQM_TARGET_SPHERE));
  PetscCall(TestMultigrid("head", EQM_TARGET_SPHERE));
  PetscCall(TestShape("cap", 1000, EQM_TARGET_DISK, .02));
  PetscCall(TestShape("hills", 3000, EQM_TARGET_DISK, .05));
  PetscCall(TestShape("patch", 1000, EQM_TARGET_SQUARE, .01));
  PetscCall(TestShape("hills", 3000, EQM_TARGET_SQUARE, .02));
  PetscCall(TestShape("head", 2000, EQM_TARGET_SPHERE, .01));
  PetscCall(TestShape("starfish", 3000, EQM_TARGET_SPHERE, 1.));
  PetscCall(TestCapsule());
  PetscCall(TestNeedles("hills", EQM_TARGET_DISK, .1));
  PetscCall(TestNeedles("head", EQM_TARGET_SPHERE, 1000.));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  if (size == 1) PetscCall(TestThreads("hills", EQM_TARGET_DISK)); /* the hierarchy is on one rank */
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
