/* The fixed-point iteration with landmarks and a held boundary, 000 (49). */
#include "method/fixedpoint.h"
#include "domain/domain_private.h"

typedef struct {
  signed char *group;
  PetscReal *share;   /* per local vertex: what each cell around it adds to its diagonal */
  PetscReal *columns; /* two, of owned vertices */
  PetscReal *z, *pull;
} Drawn;

/* T lambda D and T lambda P^T g, each landmark's with its weight: the paper's L_S is that of the target's measure T,
 * the program's of measure one. */
static PetscErrorCode AddLandmarks(EqmProblem problem, const EqmLandmarks *landmarks, Drawn *d)
{
  const EqmMesh mesh = problem->mesh;
  const PetscReal scale = problem->domain->target_measure * landmarks->lambda;
  const PetscInt n = mesh->num_owned;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < landmarks->num; i++) {
    const PetscInt v = landmarks->vertex[i];
    if (d->group[v] == EQM_GROUP_FIXED) continue;
    d->share[v] = scale * landmarks->share[v];
    for (PetscInt c = 0; c < 2; c++)
      d->columns[c * n + v] += scale * landmarks->weight[i] * landmarks->place[2 * i + c];
  }
  PetscFunctionReturn(0);
}

/* -L_IB b; the boundary stays where it is. */
static PetscErrorCode PullOfBoundary(EqmProblem problem, const PetscReal *x, const PetscReal *weights, Drawn *d)
{
  const EqmMesh mesh = problem->mesh;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    d->group[v] = mesh->on_boundary[v] ? EQM_GROUP_FIXED : 0;
    for (PetscInt c = 0; c < 2; c++) d->z[2 * v + c] = mesh->on_boundary[v] ? x[2 * v + c] : 0.;
  }
  PetscCall(EqmLaplacianApply(mesh, weights, 2, d->z, d->pull));
  for (PetscInt k = 0; k < 2 * mesh->num_owned; k++) {
    const PetscInt v = k / 2;
    d->columns[(k % 2) * mesh->num_owned + v] = d->group[v] == EQM_GROUP_FIXED ? 0. : -d->pull[k];
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFixedPointDraw(EqmProblem problem, const PetscReal *weights, EqmPlace *place)
{
  const EqmMesh mesh = problem->mesh;
  const PetscInt n = mesh->num_owned;
  Drawn d;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(mesh->num_local, &d.group, 2 * n, &d.columns, 2 * mesh->num_local, &d.z, 2 * n, &d.pull));
  PetscCall(PetscCalloc1(mesh->num_local, &d.share));
  PetscCall(PullOfBoundary(problem, place->x, weights, &d));
  PetscCall(AddLandmarks(problem, &problem->landmarks, &d));
  PetscCall(EqmGroupFactorWithShares(problem, weights, d.group, d.share));
  PetscCall(EqmGroupSolve(problem, 2, d.columns));
  for (PetscInt k = 0; k < 2 * n; k++) {
    if (d.group[k / 2] != EQM_GROUP_FIXED) place->x[k] = d.columns[(k % 2) * n + k / 2];
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, place->x));
  PetscCall(PetscFree(d.share));
  PetscCall(PetscFree4(d.group, d.columns, d.z, d.pull));
  PetscFunctionReturn(0);
}
