/* The smallest eigenvalues of the Hessian of 001 Appendix B: that of the stretch energy E_S in space, three coordinates
   per vertex, with the mesh's area scaled to that of the sphere. Table 4 has its smallest eigenvalue.

   E_S of a cell is a^2/w, its Hessian 2/w (da da^T + a Hess a): the first part is semidefinite, so that the eigenvalues
   lie above minus the largest sum of the others' norms over the cells around a vertex. A first pass from there finds
   the smallest; those of a map near a minimum crowd at zero, and a second one from just below it tells them apart. */
#include "solver/solver_private.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"
#include "solver/lanczos.h"

typedef struct {
  EqmProblem problem;
  const PetscReal *x;
  EqmLinear linear; /* H - shift */
  PetscReal shift;
  PetscReal *share; /* per local vertex: one over the cells around it, for owned ones */
} Stretch;

/* The 9 x 9 matrix of Appendix B; row 3a + s belongs to corner a and coordinate s. */
void EqmStretchHessian(const PetscReal *const p[3], PetscReal area, PetscReal matrix[81])
{
  PetscReal h[3][3]; /* coordinate, corner */

  for (PetscInt s = 0; s < 3; s++) {
    for (PetscInt a = 0; a < 3; a++) h[s][a] = p[(a + 1) % 3][s] - p[(a + 2) % 3][s];
  }
  for (PetscInt row = 0; row < 9; row++) {
    const PetscInt a = row / 3, s = row % 3;
    for (PetscInt column = 0; column < 9; column++) {
      const PetscInt b = column / 3, t = column % 3;
      PetscReal sum = s == t ? 0. : h[s][a] * h[t][b] - 2. * h[t][a] * h[s][b];
      for (PetscInt u = 0; u < 3 && s == t; u++) sum += u == s ? 0. : h[u][a] * h[u][b];
      matrix[9 * row + column] = sum / (2. * area);
    }
  }
}

static void CellHessian(const Stretch *stretch, PetscInt cell, PetscReal matrix[81])
{
  const EqmMesh mesh = stretch->problem->mesh;
  const PetscInt *const v = mesh->cells + 3 * cell;
  const PetscReal *const p[3] = {stretch->x + 3 * v[0], stretch->x + 3 * v[1], stretch->x + 3 * v[2]};

  EqmStretchHessian(p, mesh->weight[cell] * stretch->problem->domain->target_measure, matrix);
}

static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const Stretch *const stretch = context;

  CellHessian(stretch, cell, matrix);
  for (PetscInt row = 0; row < 9; row++)
    matrix[10 * row] -= stretch->shift * stretch->share[stretch->problem->mesh->cells[3 * cell + row / 3]];
}

/* 2/w a Hess a of a cell, Frobenius norm: the Hessian less 2/w da da^T. */
static PetscReal IndefiniteNorm(const Stretch *stretch, PetscInt cell)
{
  const EqmMesh mesh = stretch->problem->mesh;
  const PetscInt *const v = mesh->cells + 3 * cell;
  const PetscReal *const x = stretch->x, *const p[3] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2]};
  const PetscReal scale = 2. / (mesh->weight[cell] * stretch->problem->domain->target_measure);
  PetscReal matrix[81], gradient[9], squares = 0.;

  CellHessian(stretch, cell, matrix);
  EqmMeasureGradient(EQM_MEASURE_AREA3, p, gradient);
  for (PetscInt k = 0; k < 81; k++) squares += PetscSqr(matrix[k] - scale * gradient[k / 9] * gradient[k % 9]);
  return PetscSqrtReal(squares);
}

static PetscErrorCode FirstShift(Stretch *stretch)
{
  const EqmMesh mesh = stretch->problem->mesh;
  PetscReal *norm, largest = 0.;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(mesh->num_local, &norm));
  PetscCall(PetscArrayzero(stretch->share, mesh->num_local));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscReal bound = IndefiniteNorm(stretch, c);
    for (PetscInt a = 0; a < 3; a++) {
      norm[mesh->cells[3 * c + a]] += bound;
      stretch->share[mesh->cells[3 * c + a]] += 1.;
    }
  }
  for (PetscInt v = 0; v < mesh->num_owned; v++) largest = PetscMax(largest, norm[v]);
  for (PetscInt v = 0; v < mesh->num_local; v++) stretch->share[v] = 1. / stretch->share[v];
  PetscCall(PetscFree(norm));
  PetscCall(MPIU_Allreduce(&largest, &stretch->shift, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  stretch->shift *= -1.001;
  PetscFunctionReturn(0);
}

static PetscErrorCode ApplyInverse(void *context, Vec x, Vec y)
{
  Stretch *const stretch = context;
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecCopy(x, y));
  PetscCall(VecGetArray(y, &array));
  PetscCall(EqmLinearSolve(stretch->linear, 1, array, array));
  PetscCall(VecRestoreArray(y, &array));
  PetscFunctionReturn(0);
}

/* With the present shift. `success`: H less the shift has a factor. */
static PetscErrorCode Pass(Stretch *stretch, Vec like, PetscInt wanted, PetscReal *values, PetscInt *found,
                           PetscBool *success)
{
  PetscFunctionBegin;
  PetscCall(EqmLinearFactor(stretch->linear, CellMatrix, stretch, 1., success));
  if (!*success) PetscFunctionReturn(0);
  PetscCall(EqmLanczos(stretch->problem->comm, ApplyInverse, stretch, like, stretch->shift, wanted, values, found));
  PetscFunctionReturn(0);
}

static PetscErrorCode TwoPasses(Stretch *stretch, Vec like, PetscInt wanted, PetscReal *values, PetscInt *found)
{
  const MPI_Comm comm = stretch->problem->comm;
  const PetscReal bound = -stretch->shift;
  PetscReal smallest;
  PetscInt one;
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(Pass(stretch, like, 1, &smallest, &one, &success));
  PetscCheck(success, comm, PETSC_ERR_NOT_CONVERGED,
             "the Hessian is too near to singular for its eigenvalues to be computed");
  if (one == 0) PetscFunctionReturn(0);
  stretch->shift = smallest - PetscMax(.1 * PetscAbsReal(smallest), 1e-6 * bound);
  PetscCall(Pass(stretch, like, wanted, values, found, &success));
  if (success) PetscFunctionReturn(0);
  stretch->shift = -bound; /* the first pass was not so close */
  PetscCall(Pass(stretch, like, wanted, values, found, &success));
  PetscFunctionReturn(0);
}

static PetscErrorCode Eigenvalues(Stretch *stretch, PetscInt wanted, PetscReal *values, PetscInt *found)
{
  const EqmMesh mesh = stretch->problem->mesh;
  const PetscInt n = mesh->num_local;
  EqmUnknowns unknowns = {.num_owned = 3 * mesh->num_owned, .first = 3 * mesh->vertex_start};
  unsigned char *count;
  PetscInt *start;
  Vec like;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &start, n, &count, n, &stretch->share));
  for (PetscInt v = 0; v < n; v++) {
    start[v] = 3 * mesh->global[v];
    count[v] = 3;
  }
  unknowns.start = start;
  unknowns.count = count;
  PetscCall(VecCreateMPI(mesh->comm, unknowns.num_owned, PETSC_DETERMINE, &like));
  PetscCall(FirstShift(stretch));
  PetscCall(EqmLinearCreate(mesh, stretch->problem->ordering, &unknowns, EQM_MATRIX_COUPLED, &stretch->linear));
  PetscCall(TwoPasses(stretch, like, wanted, values, found));
  PetscCall(EqmLinearDestroy(&stretch->linear));
  PetscCall(VecDestroy(&like));
  PetscCall(PetscFree3(start, count, stretch->share));
  PetscFunctionReturn(0);
}

/* EqmSolverStretchHessianEigenvalues - the algebraically smallest eigenvalues of the Hessian of 001 Appendix B at the
   present map to the sphere.

   Collective, after EqmSolverSolve. wanted, values, found, options, errors: as of EqmSolverHessianEigenvalues; and
   EQM_ERR_USAGE for other targets. Counts two coupled factorisations and their solves. */
PetscErrorCode EqmSolverStretchHessianEigenvalues(EqmSolver solver, PetscInt wanted, PetscReal *values, PetscInt *found)
{
  Stretch stretch = {.problem = solver->problem, .x = solver->iterate->place.x};

  PetscFunctionBegin;
  if (!solver->problem->domain->curved_image)
    EqmFail(solver->comm, EQM_ERR_USAGE, "the Hessian of 001 Appendix B is that of maps to the sphere");
  PetscCall(EqmLanczosCheck(solver->comm, 3 * solver->mesh->num_owned, wanted, found));
  PetscCall(Eigenvalues(&stretch, wanted, values, found));
  PetscFunctionReturn(0);
}
