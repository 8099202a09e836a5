/* The smallest eigenvalues of the Hessian of the normalised authalic energy at a map (001 section 6.1, Table 4).

   With E(a) = sum a^2/(w A) - A and s = dE/da, the Riemannian Hessian in the frames' degrees of freedom is

       H = (2/A) J^T W^-1 J + sum s (Hess a + the geodesics' curvature term) + U C U^T,

   J = da, W the weights, and U the gradients of A and of sum (r - 1) a at frozen r: the coupling by the total area.
   E(a) is convex, so that only the sum over s can be negative: the eigenvalues lie above minus the largest sum, over
   the cells around a vertex, of these cells' norms. H less a shift below that bound is definite; its inverse, a factor
   and two extra columns (Woodbury), turns H's smallest eigenvalues into the largest, which Lanczos finds at once. */
#include "solver/solver_private.h"
#include "domain/domain_private.h"
#include "energy/curvature.h"
#include "solver/lanczos.h"

typedef struct {
  EqmProblem problem;
  EqmIterate iterate;
  EqmLinear linear;            /* H - shift without U C U^T, factored */
  PetscReal shift;             /* below all eigenvalues */
  PetscReal *slope;            /* s per local cell */
  PetscReal *share;            /* per local vertex: one over the cells around it, for owned ones */
  Vec column[2], solved[2];    /* U, and factor^-1 U */
  PetscReal capacitance[2][2]; /* (C^-1 + U^T solved)^-1 */
} Hessian;

static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const Hessian *const h = context;
  const EqmMesh mesh = h->problem->mesh;
  const PetscReal scale = 2. / (mesh->weight[cell] * h->iterate->totals.total);
  EqmCellDerivatives d;

  EqmCellDifferentiate(h->problem->domain, &h->iterate->place, cell, &d);
  for (PetscInt i = 0; i < d.frame.count; i++) {
    for (PetscInt j = 0; j < d.frame.count; j++)
      matrix[d.frame.count * i + j] = scale * d.first[i] * d.first[j] + h->slope[cell] * d.second[i][j];
    matrix[d.frame.count * i + i] -= h->shift * h->share[mesh->cells[mesh->cell_size * cell + d.frame.corner[i]]];
  }
}

/* Slopes, the shift, and how many cells each vertex has. */
static PetscErrorCode Prepare(Hessian *h)
{
  const EqmMesh mesh = h->problem->mesh;
  const EqmImageTotals *const totals = &h->iterate->totals;
  PetscReal *norm, largest[2] = {0., 0.};

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(mesh->num_local, &norm));
  PetscCall(PetscArrayzero(h->share, mesh->num_local));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal squares = 0., diagonal = 0.;
    EqmCellDerivatives d;
    EqmCellDifferentiate(h->problem->domain, &h->iterate->place, c, &d);
    h->slope[c] = 2. * (h->iterate->image[c] / (mesh->weight[c] * totals->total) - 1.) - totals->energy / totals->total;
    for (PetscInt i = 0; i < d.frame.count; i++) {
      for (PetscInt j = 0; j < d.frame.count; j++) squares += PetscSqr(h->slope[c] * d.second[i][j]);
      diagonal = PetscMax(diagonal, 2. * d.first[i] * d.first[i] / (mesh->weight[c] * totals->total));
    }
    largest[1] = PetscMax(largest[1], diagonal);
    for (PetscInt a = 0; a < mesh->cell_size; a++) {
      norm[mesh->cells[mesh->cell_size * c + a]] += PetscSqrtReal(squares);
      h->share[mesh->cells[mesh->cell_size * c + a]] += 1.;
    }
  }
  for (PetscInt v = 0; v < mesh->num_owned; v++) largest[0] = PetscMax(largest[0], norm[v]);
  for (PetscInt v = 0; v < mesh->num_local; v++) h->share[v] = 1. / h->share[v];
  PetscCall(PetscFree(norm));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, largest, 2, MPIU_REAL, MPIU_MAX, mesh->comm));
  h->shift = -PetscMax(1.001 * largest[0], 1e-9 * largest[1]); /* second term: rotations must not make it singular */
  PetscFunctionReturn(0);
}

/* x <- factor^-1 x. */
static PetscErrorCode SolveFactored(Hessian *h, Vec x)
{
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecGetArray(x, &array));
  PetscCall(EqmLinearSolve(h->linear, 1, array, array));
  PetscCall(VecRestoreArray(x, &array));
  PetscFunctionReturn(0);
}

/* U = (g, p), g = sum da, p = sum (r - 1) da, C = (2/A) (E/A - 1, -1; -1, 0); and (C^-1 + U^T solved)^-1. */
static PetscErrorCode Couple(Hessian *h)
{
  const EqmProblem problem = h->problem;
  const EqmIterate iterate = h->iterate;
  const EqmMesh mesh = problem->mesh;
  const PetscReal total = iterate->totals.total, energy = iterate->totals.energy;
  PetscReal *slope, *ambient, m[2][2];

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_local_cells, &slope, problem->domain->dim * mesh->num_owned, &ambient));
  for (int k = 0; k < 2; k++) {
    for (PetscInt c = 0; c < mesh->num_local_cells; c++)
      slope[c] = k == 0 ? 1. : iterate->image[c] / (mesh->weight[c] * total) - 1.;
    PetscCall(EqmImageGradient(problem->domain, &iterate->place, slope, ambient));
    PetscCall(EqmDomainProject(problem->domain, &iterate->place, ambient, h->column[k]));
    PetscCall(VecCopy(h->column[k], h->solved[k]));
    PetscCall(SolveFactored(h, h->solved[k]));
  }
  PetscCall(PetscFree2(slope, ambient));
  for (int i = 0; i < 2; i++) {
    for (int j = 0; j < 2; j++) PetscCall(VecDot(h->column[i], h->solved[j], &m[i][j]));
  }
  m[0][1] -= .5 * total; /* C^-1 = (A/2) (0, -1; -1, 1 - E/A) */
  m[1][0] -= .5 * total;
  m[1][1] += .5 * (total - energy);
  const PetscReal determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
  h->capacitance[0][0] = m[1][1] / determinant;
  h->capacitance[1][1] = m[0][0] / determinant;
  h->capacitance[0][1] = -m[0][1] / determinant;
  h->capacitance[1][0] = -m[1][0] / determinant;
  PetscFunctionReturn(0);
}

/* y = (H - shift)^-1 x. */
static PetscErrorCode ApplyInverse(void *context, Vec x, Vec y)
{
  Hessian *const h = context;
  PetscReal along[2];

  PetscFunctionBegin;
  for (int k = 0; k < 2; k++) PetscCall(VecDot(h->solved[k], x, &along[k]));
  PetscCall(VecCopy(x, y));
  PetscCall(SolveFactored(h, y));
  for (int k = 0; k < 2; k++)
    PetscCall(VecAXPY(y, -(h->capacitance[k][0] * along[0] + h->capacitance[k][1] * along[1]), h->solved[k]));
  PetscFunctionReturn(0);
}

static PetscErrorCode Eigenvalues(Hessian *h, PetscInt wanted, PetscReal *values, PetscInt *found)
{
  const EqmDomain domain = h->problem->domain;
  const EqmUnknowns unknowns = EqmDomainUnknowns(domain);
  const EqmMesh mesh = h->problem->mesh;
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_local_cells, &h->slope, mesh->num_local, &h->share));
  for (int k = 0; k < 2; k++) {
    PetscCall(EqmDomainCreateVec(domain, &h->column[k]));
    PetscCall(VecDuplicate(h->column[k], &h->solved[k]));
  }
  PetscCall(Prepare(h));
  PetscCall(EqmLinearCreate(mesh, h->problem->ordering, &unknowns, EQM_MATRIX_COUPLED, &h->linear));
  PetscCall(EqmLinearFactor(h->linear, CellMatrix, h, 1., &success));
  PetscCheck(success, mesh->comm, PETSC_ERR_NOT_CONVERGED,
             "the Hessian is too near to singular for its eigenvalues to be computed");
  PetscCall(Couple(h));
  PetscCall(EqmLanczos(h->problem->comm, ApplyInverse, h, h->column[0], h->shift, wanted, values, found));
  PetscCall(EqmLinearDestroy(&h->linear));
  for (int k = 0; k < 2; k++) {
    PetscCall(VecDestroy(&h->column[k]));
    PetscCall(VecDestroy(&h->solved[k]));
  }
  PetscCall(PetscFree2(h->slope, h->share));
  PetscFunctionReturn(0);
}
/* EqmSolverHessianEigenvalues - the algebraically smallest eigenvalues of the Hessian of the normalised authalic energy
   at the present map.

   Collective, after EqmSolverSolve. The Hessian is the Riemannian one in orthonormal coordinates of the tangent spaces:
   second derivatives along geodesics. On the sphere three eigenvalues belong to rotations and vanish where the gradient
   does; on the disk one. wanted - how many, at most the number of degrees of freedom; values - `wanted` numbers,
   ascending; found - how many converged. Options: -hessian_eps_* (SLEPc). Counts a coupled factorisation and its
   solves. Errors: EQM_ERR_USAGE (built without SLEPc, or too many wanted). */
PetscErrorCode EqmSolverHessianEigenvalues(EqmSolver solver, PetscInt wanted, PetscReal *values, PetscInt *found)
{
  Hessian h = {.problem = solver->problem, .iterate = solver->iterate};

  PetscFunctionBegin;
  PetscCall(EqmLanczosCheck(solver->problem->comm, solver->problem->domain->num_dofs, wanted, found));
  PetscCall(Eigenvalues(&h, wanted, values, found));
  PetscFunctionReturn(0);
}
