/* Scalar Laplacians with some vertices held or decoupled: one pattern, one symbolic factor for all of them. */
#include "method/method.h"

typedef struct {
  EqmMesh mesh;
  const PetscReal *weights;
  const signed char *group;
} GroupMatrix;

static void CellLaplacian(void *context, PetscInt cell, PetscReal *matrix)
{
  const GroupMatrix *const g = context;
  const PetscInt *const v = g->mesh->cells + 3 * cell;
  const PetscReal *const w = g->weights + 3 * cell;

  for (PetscInt a = 0; a < 3; a++) {
    const PetscBool fixed = (PetscBool)(g->group[v[a]] == EQM_GROUP_FIXED);
    for (PetscInt b = 0; b < 3; b++) {
      if (a == b)
        matrix[4 * a] = fixed ? 1. : w[(a + 1) % 3] + w[(a + 2) % 3];
      else
        matrix[3 * a + b] = fixed || g->group[v[a]] != g->group[v[b]] ? 0. : -w[3 - a - b];
    }
  }
}

/* One unknown per vertex; made at the first need. */
static PetscErrorCode MakeScalar(EqmSolver solver)
{
  const EqmMesh mesh = solver->mesh;
  EqmUnknowns unknowns = {.num_owned = mesh->num_owned, .first = mesh->vertex_start, .start = mesh->global};

  PetscFunctionBegin;
  if (solver->scalar) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(mesh->num_local, &solver->scalar_count));
  for (PetscInt v = 0; v < mesh->num_local; v++) solver->scalar_count[v] = 1;
  unknowns.count = solver->scalar_count;
  PetscCall(EqmLinearCreate(mesh, solver->ordering, &unknowns, PETSC_FALSE, &solver->scalar));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGroupFactor(EqmSolver solver, const PetscReal *weights, const signed char *group)
{
  GroupMatrix matrix = {solver->mesh, weights, group};
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(MakeScalar(solver));
  PetscCall(EqmLinearFactor(solver->scalar, CellLaplacian, &matrix, 1., &success));
  if (!success) {
    EqmFail(solver->comm, EQM_ERR_MESH,
            "a Laplacian of this mesh is not positive definite (very obtuse or degenerate triangles); remesh, or start "
            "with -start tutte");
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGroupSolve(EqmSolver solver, PetscInt num_rhs, PetscReal *columns)
{
  PetscFunctionBegin;
  PetscCall(EqmLinearSolve(solver->scalar, num_rhs, columns, columns));
  PetscFunctionReturn(0);
}

/* May coordinate c of a vertex of this kind move? */
static PetscBool CoordinateIsFree(EqmVertexKind kind, PetscInt c)
{
  return (PetscBool)(kind == EQM_VERTEX_FREE || (kind == EQM_VERTEX_SIDE_X && c == 0) ||
                     (kind == EQM_VERTEX_SIDE_Y && c == 1));
}

/* Right-hand side for coordinate c: what the held values put on the free ones. */
static PetscErrorCode HeldValues(EqmSolver solver, const PetscReal *weights, const signed char *group,
                                 const EqmPlace *from, PetscInt c, PetscReal *scratch, PetscReal *rhs)
{
  const EqmMesh mesh = solver->mesh;
  const PetscInt dim = solver->domain->dim;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_local; v++) scratch[v] = group[v] == EQM_GROUP_FIXED ? from->x[dim * v + c] : 0.;
  PetscCall(EqmLaplacianApply(mesh, weights, 1, scratch, rhs));
  for (PetscInt v = 0; v < mesh->num_owned; v++) rhs[v] = group[v] == EQM_GROUP_FIXED ? 0. : -rhs[v];
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHarmonicMap(EqmSolver solver, const PetscReal *weights, const EqmPlace *from, EqmPlace *to)
{
  const EqmMesh mesh = solver->mesh;
  const EqmDomain domain = solver->domain;
  const PetscInt dim = domain->dim, n = mesh->num_owned;
  signed char *group, *previous;
  PetscReal *scratch, *columns;

  PetscFunctionBegin;
  PetscCall(
      PetscMalloc4(mesh->num_local, &group, mesh->num_local, &previous, mesh->num_local, &scratch, dim * n, &columns));
  for (PetscInt c = 0; c < dim;) {
    PetscInt same = 0; /* coordinates in a row that have the same vertices free share a factor */
    for (; c + same < dim; same++) {
      PetscInt differs = 0, any;
      for (PetscInt v = 0; v < mesh->num_local; v++) {
        group[v] = CoordinateIsFree((EqmVertexKind)domain->kind[v], c + same) ? 0 : EQM_GROUP_FIXED;
        differs |= same > 0 && group[v] != previous[v];
      }
      PetscCall(MPIU_Allreduce(&differs, &any, 1, MPIU_INT, MPI_MAX, mesh->comm));
      if (any) break;
      PetscCall(PetscArraycpy(previous, group, mesh->num_local));
      PetscCall(HeldValues(solver, weights, group, from, c + same, scratch, columns + same * n));
    }
    PetscCall(EqmGroupFactor(solver, weights, previous));
    PetscCall(EqmGroupSolve(solver, same, columns));
    for (PetscInt v = 0; v < n; v++) {
      for (PetscInt k = 0; k < same; k++)
        to->x[dim * v + c + k] = previous[v] == EQM_GROUP_FIXED ? from->x[dim * v + c + k] : columns[k * n + v];
    }
    c += same;
  }
  PetscCall(PetscFree4(group, previous, scratch, columns));
  PetscCall(EqmMeshUpdateGhosts(mesh, dim, to->x));
  PetscFunctionReturn(0);
}
