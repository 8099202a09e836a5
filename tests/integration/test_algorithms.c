/* The papers' algorithms in a second, plain implementation, against the library's methods: the fixed point of 000
   (14) with dense matrices, 000 Algorithm 1 with its step (18), 002 Algorithm 1. */
#include "support/testing.h"
#include "domain/domain_private.h"

/* ---- dense linear algebra for small meshes */

/* Solve A x = b for several columns by elimination with pivots; both are used up, the solution is in b. */
static void SolveDense(PetscInt n, PetscInt columns, PetscReal *a, PetscReal *b)
{
  for (PetscInt k = 0; k < n; k++) {
    PetscInt pivot = k;
    for (PetscInt i = k + 1; i < n; i++) {
      if (PetscAbsReal(a[i * n + k]) > PetscAbsReal(a[pivot * n + k])) pivot = i;
    }
    for (PetscInt j = 0; j < n + columns && pivot != k; j++) {
      PetscReal *const row = j < n ? a + j : b + j - n;
      const PetscInt width = j < n ? n : columns;
      const PetscReal t = row[k * width];
      row[k * width] = row[pivot * width];
      row[pivot * width] = t;
    }
    for (PetscInt i = 0; i < n; i++) {
      const PetscReal factor = i == k ? 0. : a[i * n + k] / a[k * n + k];
      for (PetscInt j = k; j < n; j++) a[i * n + j] -= factor * a[k * n + j];
      for (PetscInt j = 0; j < columns; j++) b[i * columns + j] -= factor * b[k * columns + j];
    }
  }
  for (PetscInt k = 0; k < n * columns; k++) b[k] /= a[k / columns * n + k / columns];
}

/* L_S of a map by 000 (2c), (2d) from angles and areas, all vertices, on one rank. */
static void DenseStretchLaplacian(EqmMesh mesh, const PetscReal *x, PetscReal *matrix)
{
  const PetscInt n = mesh->num_vertices;

  for (PetscInt k = 0; k < n * n; k++) matrix[k] = 0.;
  for (PetscInt q = 0; q < 3 * mesh->num_cells; q++) { /* the angle at corner k, opposite to the edge ij */
    const PetscInt c = q / 3, *const v = mesh->cells + 3 * c, k = v[q % 3], i = v[(q + 1) % 3], j = v[(q + 2) % 3];
    const PetscReal u[2] = {x[2 * i] - x[2 * k], x[2 * i + 1] - x[2 * k + 1]},
                    w[2] = {x[2 * j] - x[2 * k], x[2 * j + 1] - x[2 * k + 1]};
    const PetscReal twice = u[0] * w[1] - u[1] * w[0], angle = PetscAtan2Real(twice, u[0] * w[0] + u[1] * w[1]);
    const PetscReal weight = PetscCosReal(angle) / PetscSinReal(angle) * .5 * twice / (2. * mesh->weight[c]);
    matrix[i * n + j] -= weight;
    matrix[j * n + i] -= weight;
    matrix[i * n + i] += weight;
    matrix[j * n + j] += weight;
  }
}

/* New values of the vertices with `chosen` from those of the others: -L_cc^-1 L_co z_o. */
static PetscErrorCode DenseGroupSolve(PetscInt n, const PetscReal *matrix, const PetscBool *chosen, const PetscReal *z,
                                      PetscReal *result)
{
  PetscInt *list, count = 0;
  PetscReal *a, *b;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &list, n * n, &a, 2 * n, &b));
  for (PetscInt v = 0; v < n; v++) {
    if (chosen[v]) list[count++] = v;
  }
  for (PetscInt i = 0; i < count; i++) {
    for (PetscInt j = 0; j < count; j++) a[i * count + j] = matrix[list[i] * n + list[j]];
    b[2 * i] = b[2 * i + 1] = 0.;
    for (PetscInt v = 0; v < n; v++) {
      for (PetscInt c = 0; c < 2 && !chosen[v]; c++) b[2 * i + c] -= matrix[list[i] * n + v] * z[2 * v + c];
    }
  }
  SolveDense(count, 2, a, b);
  for (PetscInt i = 0; i < count; i++) PetscCall(PetscArraycpy(result + 2 * list[i], b + 2 * i, 2));
  PetscCall(PetscFree3(list, a, b));
  PetscFunctionReturn(0);
}

/* One pass of 000 (14), corrected: the row norms of (14e) are of both coordinates and over the boundary's vertices, and
   the interior follows the new boundary. */
static PetscErrorCode DenseFixedPointStep(EqmMesh mesh, PetscReal *x)
{
  const PetscInt n = mesh->num_vertices;
  PetscReal *matrix, *inverted, mean[2] = {0., 0.};
  PetscBool *inside;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n * n, &matrix, 2 * n, &inverted, n, &inside));
  DenseStretchLaplacian(mesh, x, matrix);
  for (PetscInt v = 0; v < n; v++) {
    inside[v] = (PetscBool)!mesh->on_boundary[v];
    for (PetscInt c = 0; c < 2; c++)
      inverted[2 * v + c] = x[2 * v + c] / (x[2 * v] * x[2 * v] + x[2 * v + 1] * x[2 * v + 1]);
  }
  PetscCall(DenseGroupSolve(n, matrix, mesh->on_boundary, inverted, x));
  for (PetscInt k = 0; k < 2 * n; k++)
    mean[k % 2] += mesh->on_boundary[k / 2] ? x[k] / mesh->num_boundary_vertices : 0.;
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal p[2] = {x[2 * v] - mean[0], x[2 * v + 1] - mean[1]},
                    length = PetscSqrtReal(p[0] * p[0] + p[1] * p[1]);
    for (PetscInt c = 0; c < 2 && mesh->on_boundary[v]; c++) x[2 * v + c] = p[c] / length;
  }
  PetscCall(DenseGroupSolve(n, matrix, inside, x, x));
  PetscCall(PetscFree3(matrix, inverted, inside));
  PetscFunctionReturn(0);
}

/* Three steps of the library and of the dense form from the same start; on one rank. */
static PetscErrorCode TestFixedPoint(const char *shape)
{
  TestMesh test;
  EqmSolver start, solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_SELF, shape, 120, 2, &test));
  PetscCall(TestSolve(test.mesh, "disk", "-method fixed-point -start harmonic -max_it 0", &start));
  PetscCall(TestSolve(test.mesh, "disk", "-method fixed-point -start harmonic -max_it 3 -energy_rtol 0", &solver));
  for (PetscInt k = 0; k < 3; k++) PetscCall(DenseFixedPointStep(test.mesh, start->iterate->place.x));
  for (PetscInt k = 0; k < 2 * test.mesh->num_vertices; k++)
    CHECK_CLOSE(solver->iterate->place.x[k], start->iterate->place.x[k], 1e-9, 1.);
  PetscCall(EqmSolverDestroy(&start));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* 002 Algorithm 1: after a step, L_S of the old map times the new map vanishes in every coordinate that is free. */
static PetscErrorCode TestSquareFixedPoint(void)
{
  TestMesh test;
  EqmSolver before, after;
  PetscReal *weights, *residual, scale = 0.;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "patch", 400, 2, &test));
  const EqmMesh mesh = test.mesh;
  PetscCall(TestSolve(mesh, "square", "-method fixed-point -start harmonic -max_it 1 -energy_rtol 0", &before));
  PetscCall(TestSolve(mesh, "square", "-method fixed-point -start harmonic -max_it 2 -energy_rtol 0", &after));
  PetscCall(PetscMalloc2(3 * mesh->num_local_cells, &weights, 2 * mesh->num_owned, &residual));
  PetscCall(EqmLaplacianWeights(before->problem->domain, EQM_LAPLACIAN_STRETCH, &before->iterate->place, weights));
  PetscCall(EqmLaplacianApply(mesh, weights, 2, after->iterate->place.x, residual));
  for (PetscInt k = 0; k < 2 * mesh->num_owned; k++) scale = PetscMax(scale, PetscAbsReal(residual[k]));
  scale = TestMax(mesh->comm, scale); /* the forces that hold the sides in place */
  for (PetscInt k = 0; k < 2 * mesh->num_owned; k++) {
    const EqmVertexMotion *const kind = EqmDomainMotion(before->problem->domain, k / 2);
    const PetscBool free = (PetscBool)(kind == &EqmMotionFree || kind == (k % 2 ? &EqmMotionSideY : &EqmMotionSideX));
    if (free)
      CHECK_CLOSE(residual[k], 0., 1e-11, scale);
    else
      CHECK(after->iterate->place.x[k] == before->iterate->place.x[k], "a side's vertex has left it");
  }
  PetscCall(PetscFree2(weights, residual));
  PetscCall(EqmSolverDestroy(&before));
  PetscCall(EqmSolverDestroy(&after));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* ---- 000 Algorithm 1 */

enum { NCG_STEPS = 40 };

typedef struct {
  EqmSolver solver;
  PetscReal *weights, *columns, *a, *local, *applied;
  signed char *group;
  Vec g, h, p, product;
  /* per iteration: energy before the step; g.p; |g|^2 in M^-1; |p|^2 in M and in M^-1 */
  PetscReal energy[NCG_STEPS + 1], slope[NCG_STEPS], g_squared[NCG_STEPS], p_squared[NCG_STEPS], p_printed[NCG_STEPS];
  PetscReal alpha[NCG_STEPS];
} Ncg;

/* y = M^-1 x or y = M x, M = blkdiag(I2 x L_II, L_BB): columns by coordinate, angles in the first. */
static PetscErrorCode ApplyM(Ncg *ncg, PetscBool inverse, Vec x, Vec y)
{
  const EqmMesh mesh = ncg->solver->mesh;
  const EqmDomain domain = ncg->solver->problem->domain;
  const PetscInt n = mesh->num_owned;
  const PetscScalar *from;
  PetscScalar *to;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(x, &from));
  for (PetscInt k = 0; k < 2 * n; k++)
    ncg->columns[k] =
        k / n < domain->dof_count[k % n] ? from[domain->dof_start[k % n] - domain->dof_first + k / n] : 0.;
  PetscCall(VecRestoreArrayRead(x, &from));
  if (inverse) {
    PetscCall(EqmGroupSolve(ncg->solver->problem, 2, ncg->columns));
  } else {
    for (signed char group = 0; group < 2; group++) { /* interior and boundary do not see each other */
      for (PetscInt k = 0; k < 2 * n; k++)
        ncg->local[k] = ncg->group[k / 2] == group ? ncg->columns[k % 2 * n + k / 2] : 0.;
      PetscCall(EqmMeshUpdateGhosts(mesh, 2, ncg->local));
      PetscCall(EqmLaplacianApply(mesh, ncg->weights, 2, ncg->local, ncg->applied));
      for (PetscInt k = 0; k < 2 * n; k++) {
        if (ncg->group[k / 2] == group) ncg->columns[k % 2 * n + k / 2] = ncg->applied[k];
      }
    }
  }
  PetscCall(VecGetArrayWrite(y, &to));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt k = 0; k < domain->dof_count[v]; k++)
      to[domain->dof_start[v] - domain->dof_first + k] = ncg->columns[k * n + v];
  }
  PetscCall(VecRestoreArrayWrite(y, &to));
  PetscFunctionReturn(0);
}

static PetscErrorCode NcgBegin(EqmMesh mesh, Ncg *ncg)
{
  PetscFunctionBegin;
  PetscCall(TestSolve(mesh, "disk", "-method ncg -max_it 0", &ncg->solver));
  PetscCall(PetscMalloc6(3 * mesh->num_local_cells, &ncg->weights, 2 * mesh->num_owned, &ncg->columns,
                         mesh->num_local_cells, &ncg->a, 2 * mesh->num_local, &ncg->local, 2 * mesh->num_owned,
                         &ncg->applied, mesh->num_local, &ncg->group));
  PetscCall(EqmDomainCreateVec(ncg->solver->problem->domain, &ncg->g));
  PetscCall(VecDuplicate(ncg->g, &ncg->h));
  PetscCall(VecDuplicate(ncg->g, &ncg->p));
  PetscCall(VecDuplicate(ncg->g, &ncg->product));
  for (PetscInt v = 0; v < mesh->num_local; v++) ncg->group[v] = mesh->on_boundary[v] ? 1 : 0;
  PetscCall(EqmLaplacianWeights(ncg->solver->problem->domain, EQM_LAPLACIAN_STRETCH, &ncg->solver->iterate->place,
                                ncg->weights));
  PetscCall(EqmGroupFactor(ncg->solver->problem, ncg->weights, ncg->group, NULL));
  PetscFunctionReturn(0);
}

static PetscErrorCode NcgEnd(Ncg *ncg)
{
  PetscFunctionBegin;
  PetscCall(PetscFree6(ncg->weights, ncg->columns, ncg->a, ncg->local, ncg->applied, ncg->group));
  PetscCall(VecDestroy(&ncg->g));
  PetscCall(VecDestroy(&ncg->h));
  PetscCall(VecDestroy(&ncg->p));
  PetscCall(VecDestroy(&ncg->product));
  PetscCall(EqmSolverDestroy(&ncg->solver));
  PetscFunctionReturn(0);
}

/* (18) from the present map, whose energy and gradient are known: the parabola through the previous step length. */
static PetscErrorCode ParabolaStep(Ncg *ncg, PetscReal energy, PetscReal slope, PetscReal previous, PetscReal *alpha)
{
  PetscReal trial;
  EqmPlace to;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(ncg->solver->problem->domain, &to));
  PetscCall(EqmDomainMove(ncg->solver->problem->domain, &ncg->solver->iterate->place, previous, ncg->p, &to));
  PetscCall(EqmAuthalicEnergy(ncg->solver->problem->domain, &to, ncg->a, &trial, NULL));
  *alpha = -previous * previous * slope / (2. * (trial - energy - previous * slope));
  PetscCall(EqmPlaceDestroy(&to));
  PetscFunctionReturn(0);
}

/* Lines 10-23, as printed. alpha_0 = 2 is meant for a surface of area pi; with area one that is 2 pi. */
static PetscErrorCode NcgRun(Ncg *ncg)
{
  const EqmDomain domain = ncg->solver->problem->domain;
  EqmPlace *const place = &ncg->solver->iterate->place;
  PetscReal alpha = 2. * PETSC_PI, lambda, product;

  PetscFunctionBegin;
  PetscCall(EqmAuthalicEnergy(domain, place, ncg->a, &ncg->energy[0], ncg->g));
  PetscCall(ApplyM(ncg, PETSC_TRUE, ncg->g, ncg->h));
  PetscCall(VecCopy(ncg->h, ncg->p));
  PetscCall(VecScale(ncg->p, -1.));
  for (PetscInt k = 0; k < NCG_STEPS; k++) {
    PetscCall(VecDot(ncg->g, ncg->p, &ncg->slope[k]));
    PetscCall(VecDot(ncg->g, ncg->h, &lambda));
    ncg->g_squared[k] = lambda;
    PetscCall(ApplyM(ncg, PETSC_FALSE, ncg->p, ncg->product));
    PetscCall(VecDot(ncg->p, ncg->product, &ncg->p_squared[k]));
    PetscCall(ApplyM(ncg, PETSC_TRUE, ncg->p, ncg->product));
    PetscCall(VecDot(ncg->p, ncg->product, &ncg->p_printed[k]));
    PetscCall(ParabolaStep(ncg, ncg->energy[k], ncg->slope[k], alpha, &alpha));
    ncg->alpha[k] = alpha;
    PetscCall(EqmDomainMove(domain, place, alpha, ncg->p, place));
    PetscCall(EqmAuthalicEnergy(domain, place, ncg->a, &ncg->energy[k + 1], ncg->g));
    PetscCall(ApplyM(ncg, PETSC_TRUE, ncg->g, ncg->h));
    PetscCall(VecDot(ncg->h, ncg->g, &product));
    PetscCall(VecAXPBY(ncg->p, -1., product / lambda, ncg->h));
  }
  PetscFunctionReturn(0);
}

/* (18) alone does not see to the Wolfe condition (22b) that Theorem 2 takes for granted: after a long step the next one
   is so short that the slope stays. */
static PetscErrorCode CheckWolfe(Ncg *ncg)
{
  const EqmDomain domain = ncg->solver->problem->domain;
  EqmPlace *const place = &ncg->solver->iterate->place;
  PetscReal energy, slope, slope_after, alpha;

  PetscFunctionBegin;
  PetscCall(EqmAuthalicEnergy(domain, place, ncg->a, &energy, ncg->g));
  PetscCall(ApplyM(ncg, PETSC_TRUE, ncg->g, ncg->p));
  PetscCall(VecScale(ncg->p, -1.));
  PetscCall(VecDot(ncg->g, ncg->p, &slope));
  PetscCall(ParabolaStep(ncg, energy, slope, 1e4, &alpha));
  PetscCall(EqmDomainMove(domain, place, alpha, ncg->p, place));
  PetscCall(EqmAuthalicEnergy(domain, place, ncg->a, &energy, ncg->g));
  PetscCall(VecDot(ncg->g, ncg->p, &slope_after));
  CHECK(PetscAbsReal(slope_after) > .5 * PetscAbsReal(slope), "the slope has fallen from %g to %g", (double)slope,
        (double)slope_after);
  PetscFunctionReturn(0);
}

/* What the convergence proof says, and what it would need. */
static PetscErrorCode CheckProof(const Ncg *ncg)
{
  PetscReal smallest = PETSC_MAX_REAL, sum = 0.;
  PetscInt gradient_grows = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < NCG_STEPS; k++) {
    const PetscReal cosine = -ncg->slope[k] / PetscSqrtReal(ncg->g_squared[k] * ncg->p_squared[k]);
    const PetscReal decrease = ncg->energy[k] - ncg->energy[k + 1], gain = cosine * cosine * ncg->g_squared[k];
    CHECK(cosine <= 1. + 1e-12, "(27b): the cosine of an angle is %g", (double)cosine);
    if (k == 0) CHECK_CLOSE(cosine, 1., 1e-10, 1.);
    smallest = PetscMin(smallest, decrease / gain);
    sum += gain;
    gradient_grows += k > 0 && ncg->g_squared[k] > ncg->g_squared[k - 1];
  }
  /* (27b) as printed, with |p| in M^-1: no cosine */
  CHECK(PetscAbsReal(-ncg->slope[0] / PetscSqrtReal(ncg->g_squared[0] * ncg->p_printed[0]) - 1.) > .1,
        "the printed (27b) gives a cosine");
  /* (31) with the largest c that (30) allows: an inequality, and not an equation */
  CHECK(smallest > 0., "(18) does not decrease the energy here: choose another mesh");
  CHECK(sum < .99 * (ncg->energy[0] - ncg->energy[NCG_STEPS]) / smallest, "(31) is an equation");
  CHECK(gradient_grows > 0, "(43): the gradient's norm falls monotonically");
  PetscFunctionReturn(0);
}

/* The house's ncg, told to do as printed, takes the same steps, and its history has ||g|| in M^-1. */
static PetscErrorCode CheckHouse(EqmMesh mesh, const Ncg *ncg)
{
  char options[128];
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), "-method ncg -ncg_line_search printed -max_it %d -energy_rtol 0",
                          NCG_STEPS));
  PetscCall(TestSolve(mesh, "disk", options, &solver));
  CHECK(solver->num_history == NCG_STEPS + 1, "%d rows", (int)solver->num_history);
  for (PetscInt k = 0; k <= NCG_STEPS; k++) {
    CHECK_CLOSE(solver->history[k].energy, ncg->energy[k], 1e-6, ncg->energy[k]);
    if (k > 0) CHECK_CLOSE(solver->history[k].step, ncg->alpha[k - 1], 1e-5, ncg->alpha[k - 1]);
    if (k < NCG_STEPS)
      CHECK_CLOSE(PetscSqr(solver->history[k].preconditioned_norm), ncg->g_squared[k], 1e-5, ncg->g_squared[k]);
    if (k > 0) {
      const PetscReal decrease = (ncg->energy[k] - ncg->energy[k - 1]) / (ncg->alpha[k - 1] * ncg->slope[k - 1]);
      CHECK_CLOSE(solver->history[k].wolfe_decrease, decrease, 1e-4, 1.);
    }
  }
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* With the strong Wolfe search every step meets (22), here with c2 = .01, which the steps of (18) do not all meet. */
static PetscErrorCode TestWolfe(EqmMesh mesh)
{
  static const char *const searches[2] = {"wolfe", "printed"};
  PetscInt misses[2] = {0, 0};

  PetscFunctionBegin;
  for (int k = 0; k < 2; k++) {
    char options[128];
    EqmSolver solver;
    PetscCall(PetscSNPrintf(options, sizeof(options),
                            "-method ncg -ncg_line_search %s -ncg_c2 .01 -max_it 30 -energy_rtol 0", searches[k]));
    PetscCall(TestSolve(mesh, "disk", options, &solver));
    CHECK(solver->history[0].wolfe_slope == -1., "the first map was made by a step");
    for (PetscInt i = 1; i < solver->num_history; i++) {
      const EqmHistoryRow *const row = &solver->history[i];
      misses[k] += row->wolfe_decrease < 1e-4 || row->wolfe_slope > .01;
    }
    CHECK(solver->iterate->totals.energy < .5 * solver->history[0].energy, "%s: energy %g of %g", searches[k],
          (double)solver->iterate->totals.energy, (double)solver->history[0].energy);
    PetscCall(EqmSolverDestroy(&solver));
  }
  CHECK(misses[0] == 0 && misses[1] > 0, "(22) is missed in %d and %d steps", (int)misses[0], (int)misses[1]);
  PetscFunctionReturn(0);
}

static PetscErrorCode TestNcg(void)
{
  TestMesh test;
  Ncg ncg;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 500, 2, &test));
  PetscCall(NcgBegin(test.mesh, &ncg));
  PetscCall(NcgRun(&ncg));
  PetscCall(CheckProof(&ncg));
  PetscCall(CheckHouse(test.mesh, &ncg));
  PetscCall(TestWolfe(test.mesh));
  PetscCall(CheckWolfe(&ncg));
  PetscCall(NcgEnd(&ncg));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestFixedPoint("hills"));
  PetscCall(TestFixedPoint("cap"));
  PetscCall(TestSquareFixedPoint());
  PetscCall(TestNcg());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
