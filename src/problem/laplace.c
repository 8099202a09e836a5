/* Scalar Laplacians with some vertices held or decoupled: one pattern, one symbolic factor for all of them. */
#include "problem/problem.h"
#include "domain/domain_private.h"

typedef struct {
  EqmMesh mesh;
  const PetscReal *weights;
  const signed char *group;
  const PetscReal *mass;  /* per cell, added to the diagonals of its corners in equal parts; NULL: none */
  const PetscReal *share; /* per vertex, added to its diagonal by each cell; NULL: none */
} GroupMatrix;

static void CellLaplacian(void *context, PetscInt cell, PetscReal *matrix)
{
  const GroupMatrix *const g = context;
  const PetscInt n = g->mesh->cell_size, edges = EqmCellNumEdges(n), *const v = g->mesh->cells + n * cell;

  for (PetscInt k = 0; k < n * n; k++) matrix[k] = 0.;
  for (PetscInt a = 0; a < n && g->mass; a++) matrix[(n + 1) * a] = g->mass[cell] / (PetscReal)n;
  for (PetscInt a = 0; a < n && g->share; a++) matrix[(n + 1) * a] += g->share[v[a]];
  for (PetscInt e = 0; e < edges; e++) {
    const PetscReal w = g->weights[edges * cell + e];
    PetscInt a, b;
    EqmCellEdge(n, e, &a, &b);
    matrix[(n + 1) * a] += w;
    matrix[(n + 1) * b] += w;
    if (g->group[v[a]] == g->group[v[b]]) matrix[n * a + b] = matrix[n * b + a] = -w;
  }
  for (PetscInt a = 0; a < n; a++) {
    if (g->group[v[a]] != EQM_GROUP_FIXED) continue;
    for (PetscInt b = 0; b < n; b++) matrix[n * a + b] = matrix[n * b + a] = a == b ? 1. : 0.;
  }
}

/* One unknown per vertex; created on first use. */
static PetscErrorCode MakeScalar(EqmProblem problem)
{
  const EqmMesh mesh = problem->mesh;
  EqmUnknowns unknowns = {.num_owned = mesh->num_owned, .first = mesh->vertex_start, .start = mesh->global};

  PetscFunctionBegin;
  if (problem->scalar) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(mesh->num_local, &problem->scalar_count));
  for (PetscInt v = 0; v < mesh->num_local; v++) problem->scalar_count[v] = 1;
  unknowns.count = problem->scalar_count;
  PetscCall(EqmLinearCreate(mesh, problem->ordering, &unknowns, EQM_MATRIX_SCALAR, &problem->scalar));
  PetscCall(EqmLinearDescribe(problem->scalar, problem->linear_solver, sizeof(problem->linear_solver)));
  PetscFunctionReturn(0);
}

static PetscErrorCode Factor(EqmProblem problem, GroupMatrix *matrix)
{
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(MakeScalar(problem));
  problem->holds_fixed_metric = PETSC_FALSE;
  PetscCall(EqmLinearFactor(problem->scalar, CellLaplacian, matrix, 1., &success));
  if (!success) {
    EqmFail(problem->comm, EQM_ERR_MESH,
            "a Laplacian of this mesh is not positive definite (very obtuse or degenerate cells); remesh, or "
            "take another start");
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGroupFactor(EqmProblem problem, const PetscReal *weights, const signed char *group,
                              const PetscReal *mass)
{
  GroupMatrix matrix = {problem->mesh, weights, group, mass, NULL};

  PetscFunctionBegin;
  PetscCall(Factor(problem, &matrix));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGroupFactorWithShares(EqmProblem problem, const PetscReal *weights, const signed char *group,
                                        const PetscReal *share)
{
  GroupMatrix matrix = {problem->mesh, weights, group, NULL, share};

  PetscFunctionBegin;
  PetscCall(Factor(problem, &matrix));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGroupSolve(EqmProblem problem, PetscInt num_rhs, PetscReal *columns)
{
  PetscFunctionBegin;
  PetscCall(EqmLinearSolve(problem->scalar, num_rhs, columns, columns));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGroupApply(EqmProblem problem, PetscInt num_rhs, PetscReal *columns)
{
  PetscFunctionBegin;
  PetscCall(EqmLinearApply(problem->scalar, num_rhs, columns, columns));
  PetscFunctionReturn(0);
}

/* Add to z, where it is not held, the solution of L d = -L z with what is factored. */
static PetscErrorCode AddCorrection(EqmProblem problem, const PetscReal *weights, const signed char *group,
                                    PetscInt width, PetscReal *z)
{
  const EqmMesh mesh = problem->mesh;
  const PetscInt n = mesh->num_owned;
  PetscReal *residual, *columns;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(width * n, &residual, width * n, &columns));
  PetscCall(EqmLaplacianApply(mesh, weights, width, z, residual));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt k = 0; k < width; k++)
      columns[k * n + v] = group[v] == EQM_GROUP_FIXED ? 0. : -residual[width * v + k];
  }
  PetscCall(EqmGroupSolve(problem, width, columns));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt k = 0; k < width && group[v] != EQM_GROUP_FIXED; k++) z[width * v + k] += columns[k * n + v];
  }
  PetscCall(PetscFree2(residual, columns));
  PetscCall(EqmMeshUpdateGhosts(mesh, width, z));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHeldExtend(EqmProblem problem, const PetscReal *weights, const signed char *group, PetscInt width,
                             PetscReal *z)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < problem->mesh->num_local; v++) {
    for (PetscInt k = 0; k < width && group[v] != EQM_GROUP_FIXED; k++) z[width * v + k] = 0.;
  }
  PetscCall(AddCorrection(problem, weights, group, width, z));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHeldImprove(EqmProblem problem, const PetscReal *weights, const signed char *group, PetscInt width,
                              PetscReal tolerance, PetscReal *z)
{
  PetscFunctionBegin;
  PetscCall(MakeScalar(problem));
  PetscCall(EqmLinearSetInexact(problem->scalar, tolerance));
  PetscCall(EqmGroupFactor(problem, weights, group, NULL));
  PetscCall(AddCorrection(problem, weights, group, width, z));
  PetscCall(EqmLinearSetExact(problem->scalar));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHeldSolve(EqmProblem problem, const PetscReal *weights, const signed char *group, PetscInt width,
                            PetscReal *z)
{
  PetscFunctionBegin;
  PetscCall(EqmGroupFactor(problem, weights, group, NULL));
  PetscCall(EqmHeldExtend(problem, weights, group, width, z));
  PetscFunctionReturn(0);
}

/* Coordinates c .. c + width - 1 of the places, solved with the vertices held that `group` says. */
static PetscErrorCode SolveCoordinates(EqmProblem problem, const PetscReal *weights, const signed char *group,
                                       PetscInt c, PetscInt width, EqmPlace *place)
{
  const PetscInt dim = problem->domain->dim, n = problem->mesh->num_local;
  PetscReal *z;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(width * n, &z));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt k = 0; k < width; k++) z[width * v + k] = place->x[dim * v + c + k];
  }
  PetscCall(EqmHeldSolve(problem, weights, group, width, z));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt k = 0; k < width; k++) place->x[dim * v + c + k] = z[width * v + k];
  }
  PetscCall(PetscFree(z));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHarmonicMap(EqmProblem problem, const PetscReal *weights, const EqmPlace *from, EqmPlace *to)
{
  const EqmMesh mesh = problem->mesh;
  const EqmDomain domain = problem->domain;
  signed char *group;
  PetscInt differs = 0, any;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(domain->dim * mesh->num_local, &group));
  PetscCall(EqmPlaceCopy(domain, from, to));
  for (PetscInt c = 0; c < domain->dim; c++) {
    for (PetscInt v = 0; v < mesh->num_local; v++) {
      group[c * mesh->num_local + v] = EqmDomainMotion(domain, v)->is_free[c] ? 0 : EQM_GROUP_FIXED;
      differs |= group[c * mesh->num_local + v] != group[v];
    }
  }
  PetscCall(MPIU_Allreduce(&differs, &any, 1, MPIU_INT, MPI_MAX, mesh->comm));
  if (any) { /* coordinates with the same vertices free share a factor */
    for (PetscInt c = 0; c < domain->dim; c++)
      PetscCall(SolveCoordinates(problem, weights, group + c * mesh->num_local, c, 1, to));
  } else {
    PetscCall(SolveCoordinates(problem, weights, group, 0, domain->dim, to));
  }
  PetscCall(PetscFree(group));
  PetscFunctionReturn(0);
}
