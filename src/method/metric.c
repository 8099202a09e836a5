/* A Laplacian, of most objectives the stretch Laplacian, as a metric for gradients. In the plane M = blkdiag(L_II,
   L_BB) (000 section 3.2), degree of freedom by degree of freedom, angles and slides with the first coordinate. On the
   sphere the gradient is a field in space: each coordinate is solved with the Laplacian and a mass, and the result
   projected back (docs/methods.md, Published methods). */
#include "method/method.h"

struct _p_EqmMetric {
  PetscReal *weights, *mass, *columns, *ambient;
  signed char *group;
  EqmPlace at; /* the map that the present factor belongs to */
};

PetscErrorCode EqmMetricCreate(EqmSolver solver, EqmMetric *out)
{
  const EqmMesh mesh = solver->mesh;
  const PetscInt dim = solver->domain->dim;
  EqmMetric metric;

  PetscFunctionBegin;
  PetscCall(PetscNew(&metric));
  PetscCall(PetscMalloc5(3 * mesh->num_local_cells, &metric->weights, mesh->num_local_cells, &metric->mass,
                         dim * mesh->num_owned, &metric->columns, dim * mesh->num_local, &metric->ambient,
                         mesh->num_local, &metric->group));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    metric->group[v] = solver->domain->kind[v] == EQM_VERTEX_FIXED ? EQM_GROUP_FIXED : mesh->on_boundary[v] ? 1 : 0;
  }
  PetscCall(EqmPlaceCreate(solver->domain, &metric->at));
  *out = metric;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricDestroy(EqmMetric *metric)
{
  PetscFunctionBegin;
  if (!*metric) PetscFunctionReturn(0);
  PetscCall(EqmPlaceDestroy(&(*metric)->at));
  PetscCall(PetscFree5((*metric)->weights, (*metric)->mass, (*metric)->columns, (*metric)->ambient, (*metric)->group));
  PetscCall(PetscFree(*metric));
  PetscFunctionReturn(0);
}

/* Factor what belongs to the present map. */
static PetscErrorCode Factor(EqmSolver solver, EqmMetric metric)
{
  PetscBool with_mass;

  PetscFunctionBegin;
  PetscCall(solver->problem->objective->metric(solver, metric->weights, metric->mass, &with_mass));
  PetscCall(EqmGroupFactor(solver, metric->weights, metric->group, with_mass ? metric->mass : NULL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricRefresh(EqmSolver solver, EqmMetric metric)
{
  PetscFunctionBegin;
  PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &metric->at));
  PetscCall(Factor(solver, metric));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricState(EqmSolver solver, EqmMetric metric, EqmState state)
{
  const EqmPlace present = solver->place;

  PetscFunctionBegin;
  PetscCall(EqmStatePlace(state, solver->domain, "metric_of", &metric->at));
  if (!EqmStateIsLoading(state)) PetscFunctionReturn(0);
  solver->place = metric->at; /* for as long as it takes to factor again what was factored there */
  PetscCall(Factor(solver, metric));
  solver->place = present;
  PetscFunctionReturn(0);
}

/* One column per coordinate in space. */
static PetscErrorCode ApplyInSpace(EqmSolver solver, EqmMetric metric, Vec g, Vec h)
{
  const PetscInt n = solver->mesh->num_owned, dim = solver->domain->dim;

  PetscFunctionBegin;
  PetscCall(EqmDomainExpand(solver->domain, &solver->place, g, metric->ambient));
  for (PetscInt k = 0; k < dim * n; k++) metric->columns[(k % dim) * n + k / dim] = metric->ambient[k];
  PetscCall(EqmGroupSolve(solver, dim, metric->columns));
  for (PetscInt k = 0; k < dim * n; k++) metric->ambient[k] = metric->columns[(k % dim) * n + k / dim];
  PetscCall(EqmDomainProject(solver->domain, &solver->place, metric->ambient, h));
  PetscFunctionReturn(0);
}

/* One column per degree of freedom of a vertex. */
static PetscErrorCode ApplyByDof(EqmSolver solver, EqmMetric metric, Vec g, Vec h)
{
  const EqmDomain domain = solver->domain;
  const PetscInt n = solver->mesh->num_owned;
  const PetscScalar *from;
  PetscScalar *to;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(g, &from));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt k = 0; k < 2; k++) {
      metric->columns[k * n + v] = k < domain->dof_count[v] ? from[domain->dof_start[v] - domain->dof_first + k] : 0.;
    }
  }
  PetscCall(VecRestoreArrayRead(g, &from));
  PetscCall(EqmGroupSolve(solver, 2, metric->columns));
  PetscCall(VecGetArrayWrite(h, &to));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt k = 0; k < domain->dof_count[v]; k++)
      to[domain->dof_start[v] - domain->dof_first + k] = metric->columns[k * n + v];
  }
  PetscCall(VecRestoreArrayWrite(h, &to));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricApply(EqmSolver solver, EqmMetric metric, Vec g, Vec h)
{
  PetscFunctionBegin;
  if (solver->domain->curved_image)
    PetscCall(ApplyInSpace(solver, metric, g, h));
  else
    PetscCall(ApplyByDof(solver, metric, g, h));
  PetscFunctionReturn(0);
}
