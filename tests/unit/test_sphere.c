/* The sphere: moves and frames, the two measures of image triangles and the energy against differences along geodesics,
   the formulas of Sutti and Yueh (sphere, "001") as they must read, unfolding. */
#include "support/testing.h"
#include "domain/domain_private.h"
#include "unfold/unfold.h"
#include "geometry/simplex.h"

/* A map to the sphere that is far from area-preserving and does not fold. */
typedef struct {
  TestMesh test;
  EqmSolver solver;
  EqmDomain domain;
  EqmPlace *place;
} Setting;

static PetscErrorCode Begin(const char *shape, PetscInt n, Setting *s)
{
  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 3, &s->test));
  PetscCall(TestSolve(s->test.mesh, "sphere", "-method fixed-point -max_it 0", &s->solver));
  CHECK(s->solver->iterate->totals.folds == 0, "the linear map of %s folds", shape);
  s->domain = s->solver->problem->domain;
  s->place = &s->solver->iterate->place;
  PetscFunctionReturn(0);
}

static PetscErrorCode End(Setting *s)
{
  PetscFunctionBegin;
  PetscCall(EqmSolverDestroy(&s->solver));
  PetscCall(TestMeshDestroy(&s->test));
  PetscFunctionReturn(0);
}

/* ---- moves and frames */

/* Places of length one, frames of length one and tangent, ghosts as their owners have them. */
static PetscErrorCode CheckPlace(EqmMesh mesh, const EqmPlace *place)
{
  PetscReal *x, *frame;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * mesh->num_local, &x, 3 * mesh->num_local, &frame));
  PetscCall(PetscArraycpy(x, place->x, 3 * mesh->num_local));
  PetscCall(PetscArraycpy(frame, place->frame, 3 * mesh->num_local));
  PetscCall(EqmMeshUpdateGhosts(mesh, 3, x));
  PetscCall(EqmMeshUpdateGhosts(mesh, 3, frame));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal *const p = place->x + 3 * v, *const b = place->frame + 3 * v;
    CHECK_CLOSE(EqmDot3(p, p), 1., 1e-15, 1.);
    CHECK_CLOSE(EqmDot3(b, b), 1., 1e-15, 1.);
    CHECK_CLOSE(EqmDot3(p, b), 0., 1e-15, 1.);
  }
  for (PetscInt k = 3 * mesh->num_owned; k < 3 * mesh->num_local; k++)
    CHECK(x[k] == place->x[k] && frame[k] == place->frame[k], "ghost %d is not where its owner has it", (int)k / 3);
  PetscCall(PetscFree2(x, frame));
  PetscFunctionReturn(0);
}

/* Rounding does not add up over many moves, long and short. */
static PetscErrorCode TestManyMoves(Setting *s)
{
  EqmPlace place;
  Vec step;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(s->domain, &place));
  PetscCall(EqmPlaceCopy(s->domain, s->place, &place));
  PetscCall(EqmDomainCreateVec(s->domain, &step));
  for (PetscInt k = 0; k < 300; k++) {
    PetscCall(TestRandomStep(s->domain, k, k % 3 ? .3 : 3., step));
    PetscCall(EqmDomainMove(s->domain, &place, 1., step, &place));
  }
  PetscCall(CheckPlace(s->domain->mesh, &place));
  PetscCall(VecSet(step, 0.));
  PetscCall(EqmDomainMove(s->domain, &place, 1., step, &place));
  PetscCall(CheckPlace(s->domain->mesh, &place));
  PetscCall(VecDestroy(&step));
  PetscCall(EqmPlaceDestroy(&place));
  PetscFunctionReturn(0);
}

static PetscReal Distance(PetscInt n, const PetscReal *x, const PetscReal *y)
{
  PetscReal largest = 0.;

  for (PetscInt k = 0; k < n; k++) largest = PetscMax(largest, PetscAbsReal(x[k] - y[k]));
  return largest;
}

/* Degrees of freedom (s1, s2) -> (-s2, s1): a quarter turn to the left. */
static PetscErrorCode QuarterTurn(Vec from, Vec to)
{
  const PetscScalar *s;
  PetscScalar *t;
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(from, &n));
  PetscCall(VecGetArrayRead(from, &s));
  PetscCall(VecGetArrayWrite(to, &t));
  for (PetscInt k = 0; k < n; k += 2) {
    t[k] = -s[k + 1];
    t[k + 1] = s[k];
  }
  PetscCall(VecRestoreArrayRead(from, &s));
  PetscCall(VecRestoreArrayWrite(to, &t));
  PetscFunctionReturn(0);
}

/* Parallel transport: what crosses the geodesic stays as it is, what points along it turns with it; the way back along
   the carried velocity leads to the old places and frames. */
static PetscErrorCode TestTransport(Setting *s, PetscReal size)
{
  const PetscInt n = 3 * s->domain->mesh->num_local, owned = 3 * s->domain->mesh->num_owned;
  PetscReal *before, *after, angle;
  EqmPlace there, back;
  Vec step, across;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &before, n, &after));
  PetscCall(EqmPlaceCreate(s->domain, &there));
  PetscCall(EqmPlaceCreate(s->domain, &back));
  PetscCall(EqmDomainCreateVec(s->domain, &step));
  PetscCall(VecDuplicate(step, &across));
  PetscCall(TestRandomStep(s->domain, 5, size, step));
  PetscCall(QuarterTurn(step, across));
  PetscCall(EqmDomainMove(s->domain, s->place, 1., step, &there));
  PetscCall(EqmDomainExpand(s->domain, s->place, across, before));
  PetscCall(EqmDomainExpand(s->domain, &there, across, after));
  CHECK_CLOSE(Distance(n, before, after), 0., 1e-14, size);
  PetscCall(EqmDomainExpand(s->domain, s->place, step, before));
  PetscCall(EqmDomainExpand(s->domain, &there, step, after));
  for (PetscInt k = 0; k < owned; k++) { /* the geodesic's velocity at its end */
    const PetscReal *const u = before + k - k % 3;
    angle = PetscSqrtReal(EqmDot3(u, u));
    CHECK_CLOSE(after[k], PetscCosReal(angle) * before[k] - angle * PetscSinReal(angle) * s->place->x[k], 1e-14, size);
  }
  PetscCall(EqmDomainMove(s->domain, &there, -1., step, &back));
  CHECK_CLOSE(Distance(n, back.x, s->place->x), 0., 3e-15, 1.);
  CHECK_CLOSE(Distance(n, back.frame, s->place->frame), 0., 3e-15, 1.);
  PetscCall(VecDestroy(&step));
  PetscCall(VecDestroy(&across));
  PetscCall(EqmPlaceDestroy(&there));
  PetscCall(EqmPlaceDestroy(&back));
  PetscCall(PetscFree2(before, after));
  PetscFunctionReturn(0);
}

/* ---- measures and energy */

/* Gradient of a sum of measures with slopes at random, by differences of fourth order along a geodesic; first and
   second derivative of every cell's measure. */
static PetscErrorCode TestMeasure(Setting *s, EqmMeasureKind kind)
{
  const EqmMesh mesh = s->domain->mesh;
  const PetscInt m = mesh->num_local_cells, n = 3 * mesh->num_local;
  const PetscReal h = 1e-3;
  PetscReal *velocity, *acceleration, *first, *second, *a, *slope, *ambient, largest = 0., sum = 0., product;
  EqmPlace to;
  Vec step, gradient;

  PetscFunctionBegin;
  PetscCall(PetscMalloc7(n, &velocity, n, &acceleration, m, &first, m, &second, 5 * m, &a, m, &slope, n, &ambient));
  PetscCall(EqmDomainCreateVec(s->domain, &step));
  PetscCall(VecDuplicate(step, &gradient));
  PetscCall(EqmPlaceCreate(s->domain, &to));
  PetscCall(TestRandomStep(s->domain, 7, .1, step)); /* a fair part of an edge's length */
  PetscCall(EqmDomainExpand(s->domain, s->place, step, velocity));
  PetscCall(EqmDomainCurvature(s->domain, s->place, velocity, acceleration));
  PetscCall(EqmImageDerivativesOf(s->domain, kind, s->place, velocity, acceleration, first, second));
  for (int k = 0; k < 5; k++) {
    PetscCall(EqmDomainMove(s->domain, s->place, (k - 2) * h, step, &to));
    PetscCall(EqmImageMeasureOf(s->domain, kind, &to, a + k * m));
  }
  for (PetscInt c = 0; c < m; c++) {
    const PetscReal rate = (8. * (a[3 * m + c] - a[m + c]) - (a[4 * m + c] - a[c])) / (12. * h);
    const PetscReal second_derivative =
        (16. * (a[3 * m + c] + a[m + c]) - (a[4 * m + c] + a[c]) - 30. * a[2 * m + c]) / (12. * h * h);
    CHECK_CLOSE(first[c], rate, 1e-10, 1.);
    CHECK_CLOSE(second[c], second_derivative, 1e-8, 1.);
    largest = PetscMax(largest, PetscAbsReal(second[c]));
    slope[c] = TestRandom(8, mesh->cell_input[c], 0);
    if (c < mesh->num_owned_cells) sum += slope[c] * first[c];
  }
  CHECK(TestMax(mesh->comm, largest) > 1e-3, "the second derivatives are too small to show anything");
  PetscCall(EqmImageGradientOf(s->domain, kind, s->place, slope, ambient));
  PetscCall(EqmDomainProject(s->domain, s->place, ambient, gradient));
  PetscCall(VecDot(gradient, step, &product));
  CHECK_CLOSE(product, TestSum(mesh->comm, sum), 1e-12, 1.);
  PetscCall(EqmPlaceDestroy(&to));
  PetscCall(VecDestroy(&step));
  PetscCall(VecDestroy(&gradient));
  PetscCall(PetscFree7(velocity, acceleration, first, second, a, slope, ambient));
  PetscFunctionReturn(0);
}

/* An octant, a triangle that is larger than a hemisphere's half, one turned over; the whole sphere. */
static PetscErrorCode TestSolidAngles(Setting *s)
{
  const EqmMesh mesh = s->domain->mesh;
  const PetscReal x[3] = {1., 0., 0.}, y[3] = {0., 1., 0.}, z[3] = {0., 0., 1.}, back[3] = {-.6, -.8, 0.};
  const PetscReal *const octant[] = {x, y, z}, *const turned[] = {y, x, z}, *const large[] = {y, back, z};
  const PetscReal wedge = PETSC_PI - PetscAtan2Real(.6, .8); /* between y and `back`, seen from z */
  PetscReal *a, sum = 0.;

  PetscFunctionBegin;
  CHECK_CLOSE(EqmMeasureValue(EQM_MEASURE_SOLID_ANGLE, octant), .5 * PETSC_PI, 1e-15, 1.);
  CHECK_CLOSE(EqmMeasureValue(EQM_MEASURE_SOLID_ANGLE, turned), -.5 * PETSC_PI, 1e-15, 1.);
  CHECK_CLOSE(EqmMeasureValue(EQM_MEASURE_SOLID_ANGLE, large), wedge, 1e-14, 1.);
  PetscCall(PetscMalloc1(mesh->num_local_cells, &a));
  PetscCall(EqmImageMeasureOf(s->domain, EQM_MEASURE_SOLID_ANGLE, s->place, a));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) sum += a[c];
  CHECK_CLOSE(TestSum(mesh->comm, sum), 4. * PETSC_PI, 1e-12, 1.);
  PetscCall(PetscFree(a));
  PetscFunctionReturn(0);
}

/* The normalised energy's gradient in the frames' degrees of freedom. */
static PetscErrorCode TestEnergy(Setting *s)
{
  const PetscReal h = 1e-3;
  PetscReal *a, value, at[4], product, norm, length;
  EqmPlace to;
  Vec gradient, step;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(s->domain->mesh->num_local_cells, &a));
  PetscCall(EqmPlaceCreate(s->domain, &to));
  PetscCall(EqmDomainCreateVec(s->domain, &gradient));
  PetscCall(VecDuplicate(gradient, &step));
  PetscCall(EqmAuthalicEnergy(s->domain, s->place, a, &value, gradient));
  PetscCall(VecNorm(gradient, NORM_2, &norm));
  CHECK(norm > 1e-2, "the gradient %g is too small to show anything", (double)norm);
  for (PetscInt seed = 0; seed < 3; seed++) {
    PetscCall(TestRandomStep(s->domain, seed, .1, step));
    if (seed == 2) PetscCall(VecAXPBY(step, .05 / norm, 0., gradient)); /* where the derivative is largest */
    for (int k = 0; k < 4; k++) {
      PetscCall(EqmDomainMove(s->domain, s->place, (k < 2 ? k - 2 : k - 1) * h, step, &to));
      PetscCall(EqmAuthalicEnergy(s->domain, &to, a, &at[k], NULL));
    }
    PetscCall(VecDot(gradient, step, &product));
    PetscCall(VecNorm(step, NORM_2, &length));
    CHECK_CLOSE((8. * (at[2] - at[1]) - (at[3] - at[0])) / (12. * h), product, 1e-8, norm * length);
  }
  PetscCall(VecDestroy(&gradient));
  PetscCall(VecDestroy(&step));
  PetscCall(EqmPlaceDestroy(&to));
  PetscCall(PetscFree(a));
  PetscFunctionReturn(0);
}

/* A rotation of the sphere changes no measure: its field is in the kernel of both gradients. */
static PetscErrorCode TestRotations(Setting *s)
{
  const EqmMesh mesh = s->domain->mesh;
  PetscReal *a, *velocity, *first, value, product, norm;
  Vec gradient, field;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(mesh->num_local_cells, &a, 3 * mesh->num_local, &velocity, mesh->num_local_cells, &first));
  PetscCall(EqmDomainCreateVec(s->domain, &gradient));
  PetscCall(VecDuplicate(gradient, &field));
  PetscCall(EqmAuthalicEnergy(s->domain, s->place, a, &value, gradient));
  for (PetscInt axis = 0; axis < 3; axis++) {
    const PetscReal e[3] = {axis == 0, axis == 1, axis == 2};
    for (PetscInt v = 0; v < mesh->num_local; v++) EqmCross(e, s->place->x + 3 * v, velocity + 3 * v);
    for (int kind = EQM_MEASURE_AREA3; kind <= EQM_MEASURE_SOLID_ANGLE; kind++) {
      PetscCall(EqmImageDerivativesOf(s->domain, (EqmMeasureKind)kind, s->place, velocity, NULL, first, NULL));
      for (PetscInt c = 0; c < mesh->num_local_cells; c++) CHECK_CLOSE(first[c], 0., 1e-15, 1.);
    }
    PetscCall(EqmDomainProject(s->domain, s->place, velocity, field));
    PetscCall(VecDot(gradient, field, &product));
    PetscCall(VecNorm(gradient, NORM_2, &norm));
    CHECK_CLOSE(product, 0., 1e-13, norm);
  }
  PetscCall(VecDestroy(&gradient));
  PetscCall(VecDestroy(&field));
  PetscCall(PetscFree3(a, velocity, first));
  PetscFunctionReturn(0);
}

/* ---- 001 as it must read */

static void RandomTriangle(PetscInt seed, PetscReal f[9])
{
  for (PetscInt k = 0; k < 9; k++) f[k] = TestRandom(seed, k / 3, k % 3);
}

/* 001 Appendix A: the derivatives of the area by corner i; in that by f_i^3 both terms have the same sign. */
static void TestAppendixA(PetscInt seed)
{
  PetscReal f[9], g[12], ij[3], ik[3], jk[3];

  RandomTriangle(seed, f);
  for (PetscInt k = 0; k < 3; k++) {
    ij[k] = f[k] - f[3 + k];
    ik[k] = f[k] - f[6 + k];
    jk[k] = f[3 + k] - f[6 + k];
  }
  const PetscReal a12 = ij[0] * ik[1] - ij[1] * ik[0], a13 = ij[0] * ik[2] - ij[2] * ik[0],
                  a23 = ij[1] * ik[2] - ij[2] * ik[1];
  const PetscReal area = .5 * PetscSqrtReal(a12 * a12 + a13 * a13 + a23 * a23); /* 001 (2.5) */
  const PetscReal *const corner[] = {f, f + 3, f + 6};
  EqmMeasureGradient(EQM_MEASURE_AREA3, corner, g);
  CHECK_CLOSE(EqmArea3(f, f + 3, f + 6), area, 1e-14, area);
  CHECK_CLOSE(g[0], (a12 * jk[1] + a13 * jk[2]) / (4. * area), 1e-13, 1.);
  CHECK_CLOSE(g[1], -(a12 * jk[0] - a23 * jk[2]) / (4. * area), 1e-13, 1.);
  CHECK_CLOSE(g[2], -(a13 * jk[0] + a23 * jk[1]) / (4. * area), 1e-13, 1.);
  const PetscReal printed = -(a13 * jk[0] - a23 * jk[1]) / (4. * area);
  CHECK(PetscAbsReal(g[2] - printed) > 1e-3, "the printed sign is as good");
}

/* 001 Appendix B: the Hessian of E_S = a^2/|t| of one triangle, |t| = 1: blocks over coordinates s and t. */
static void TestAppendixB(PetscInt seed)
{
  PetscReal f[9], d[9], g[12], along = 0., form = 0., h[3][3], x[3][3];

  RandomTriangle(seed, f);
  RandomTriangle(seed + 100, d);
  for (PetscInt l = 0; l < 3; l++) {
    for (PetscInt i = 0; i < 3; i++) {
      h[l][i] = f[3 * ((i + 1) % 3) + l] - f[3 * ((i + 2) % 3) + l]; /* h^l = (f_j - f_k, f_k - f_i, f_i - f_j) */
      x[l][i] = d[3 * i + l];
    }
  }
  for (PetscInt s = 0; s < 3; s++) {
    for (PetscInt t = 0; t < 3;
         t++) { /* x_s^T (h^s h^t^T - 2 h^t h^s^T) x_t; on the diagonal the other two's squares */
      if (s != t)
        form += EqmDot3(x[s], h[s]) * EqmDot3(h[t], x[t]) - 2. * EqmDot3(x[s], h[t]) * EqmDot3(h[s], x[t]);
      else
        for (PetscInt l = 0; l < 3; l++) form += l == s ? 0. : PetscSqr(EqmDot3(x[s], h[l]));
    }
  }
  form *= .5;
  const PetscReal *const corner[] = {f, f + 3, f + 6}, *const velocity[] = {d, d + 3, d + 6};
  EqmMeasureGradient(EQM_MEASURE_AREA3, corner, g);
  for (PetscInt k = 0; k < 9; k++) along += g[k] * d[k];
  const PetscReal second_derivative = EqmMeasureSecondDerivative(EQM_MEASURE_AREA3, corner, velocity);
  CHECK_CLOSE(2. * (along * along + EqmArea3(f, f + 3, f + 6) * second_derivative), form, 1e-12,
              1. + PetscAbsReal(form));
}

/* ---- unfolding */

/* Places of all vertices in input numbering, on every rank. */
static PetscErrorCode GatherPlaces(Setting *s, PetscReal *all)
{
  const EqmMesh mesh = s->domain->mesh;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(all, 3 * mesh->soup_vertices));
  for (PetscInt k = 0; k < 3 * mesh->num_owned; k++) all[3 * mesh->vertex_input[k / 3] + k % 3] = s->place->x[k];
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, all, 3 * mesh->soup_vertices, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

static PetscErrorCode ScatterPlaces(Setting *s, const PetscReal *all)
{
  const EqmMesh mesh = s->domain->mesh;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * mesh->num_owned; k++) s->place->x[k] = all[3 * mesh->vertex_input[k / 3] + k % 3];
  PetscCall(EqmMeshUpdateGhosts(mesh, 3, s->place->x));
  PetscCall(EqmPlaceMakeFrames(s->domain, s->place));
  PetscFunctionReturn(0);
}

/* Swap the first two vertices of a cell given by its input number. */
static PetscErrorCode SwapInCell(Setting *s, PetscInt cell, PetscReal *all)
{
  const EqmSoup soup = s->test.soup;
  PetscInt v[2] = {0, 0};

  PetscFunctionBegin;
  for (int a = 0; a < 2 && cell >= soup->cell_start && cell < soup->cell_end; a++)
    v[a] = soup->cells[3 * (cell - soup->cell_start) + a];
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, v, 2, MPIU_INT, MPI_SUM, soup->comm));
  for (PetscInt k = 0; k < 3; k++) {
    const PetscReal x = all[3 * v[0] + k];
    all[3 * v[0] + k] = all[3 * v[1] + k];
    all[3 * v[1] + k] = x;
  }
  PetscFunctionReturn(0);
}

/* `after` counts the folds of the map that is left, there are no more than before, and the place is in order. */
static PetscErrorCode Unfold(Setting *s, PetscInt64 *before, PetscInt64 *after)
{
  PetscReal *det;
  PetscInt64 left;

  PetscFunctionBegin;
  PetscCall(EqmSphereUnfold(s->solver->problem, s->solver->iterate, before, after));
  PetscCall(PetscMalloc1(s->domain->mesh->num_local_cells, &det));
  PetscCall(EqmImageFolds(s->domain, s->place, det, &left));
  PetscCall(PetscFree(det));
  CHECK(left == *after && *after <= *before, "%d folds left, %d said; %d before", (int)left, (int)*after, (int)*before);
  PetscCall(CheckPlace(s->domain->mesh, s->place));
  PetscFunctionReturn(0);
}

/* Some swapped vertices are put right without touching the far side; a hopeless map is left no worse; a good one as it
   is. */
static PetscErrorCode TestUnfold(Setting *s)
{
  const PetscInt n = s->domain->mesh->soup_vertices;
  PetscReal *good, *all;
  PetscInt64 before, after;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * n, &good, 3 * n, &all));
  PetscCall(GatherPlaces(s, good));
  PetscCall(Unfold(s, &before, &after));
  PetscCall(GatherPlaces(s, all));
  CHECK(before == 0 && Distance(3 * n, good, all) == 0., "a map without folds was changed");
  for (PetscInt k = 0; k < 3; k++) PetscCall(SwapInCell(s, (2 * k + 1) * s->test.soup->num_cells / 7, all));
  PetscCall(ScatterPlaces(s, all));
  PetscCall(Unfold(s, &before, &after));
  CHECK(before >= 6 && after == 0, "of %d folds %d are left", (int)before, (int)after);
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal x[3] = {TestRandom(1, v, 0), TestRandom(1, v, 1), TestRandom(1, v, 2)};
    for (PetscInt k = 0; k < 3; k++) all[3 * v + k] = x[k] / PetscSqrtReal(EqmDot3(x, x));
  }
  PetscCall(ScatterPlaces(s, all));
  PetscCall(Unfold(s, &before, &after));
  CHECK(before > s->test.soup->num_cells / 3, "%d folds are too few", (int)before);
  PetscCall(ScatterPlaces(s, good));
  PetscCall(PetscFree2(good, all));
  PetscFunctionReturn(0);
}

/* A map that is mirrored is turned over. */
static PetscErrorCode TestOrient(Setting *s)
{
  PetscReal *det;
  PetscInt64 folds;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(s->domain->mesh->num_local_cells, &det));
  for (PetscInt v = 0; v < s->domain->mesh->num_local; v++) s->place->x[3 * v + 1] *= -1.;
  PetscCall(EqmImageFolds(s->domain, s->place, det, &folds));
  CHECK(folds == s->domain->mesh->num_cells, "%d folds of the mirrored map", (int)folds);
  PetscCall(EqmSphereOrient(s->solver->problem, s->solver->iterate));
  PetscCall(EqmImageFolds(s->domain, s->place, det, &folds));
  CHECK(folds == 0, "%d folds of the map that was turned over", (int)folds);
  PetscCall(EqmPlaceMakeFrames(s->domain, s->place));
  PetscCall(PetscFree(det));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Setting s;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  for (PetscInt seed = 0; seed < 5; seed++) {
    TestAppendixA(seed);
    TestAppendixB(seed);
  }
  PetscCall(Begin("head", 400, &s));
  PetscCall(CheckPlace(s.domain->mesh, s.place));
  PetscCall(TestManyMoves(&s));
  PetscCall(TestTransport(&s, 1e-6));
  PetscCall(TestTransport(&s, 1.));
  PetscCall(TestMeasure(&s, EQM_MEASURE_AREA3));
  PetscCall(TestMeasure(&s, EQM_MEASURE_HALF_DET));
  PetscCall(TestMeasure(&s, EQM_MEASURE_SOLID_ANGLE));
  PetscCall(TestSolidAngles(&s));
  PetscCall(TestEnergy(&s));
  PetscCall(TestRotations(&s));
  PetscCall(TestUnfold(&s));
  PetscCall(TestOrient(&s));
  PetscCall(End(&s));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
