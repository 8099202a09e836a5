/* The linear conformal map by a dipole (Angenent, Haker, Tannenbaum and Kikinis 1999): L z = b, with b zero but at the
   corners of one triangle. Conjugate gradients with the metric of conformal maps, (L + M)^-1, as preconditioner: a
   dozen iterations suffice, as the eigenvalues of the preconditioned matrix lie between those of the sphere's lowest
   modes and one; and the one factor is that of the minimisation's metric. */
#include "start/start.h"
#include "mesh/mesh_private.h"
#include "problem/metric.h"

enum { WIDTH = 2, MOST_STEPS = 200 };

typedef struct {
  EqmProblem problem;
  const PetscReal *weights;
  PetscReal *residual, *image, *columns; /* WIDTH per owned vertex */
  PetscReal *direction;                  /* WIDTH per local vertex */
} Cg;

/* Inner products of the two coordinates. */
static PetscErrorCode Dot(const Cg *cg, const PetscReal *x, const PetscReal *y, PetscReal product[WIDTH])
{
  PetscReal sum[WIDTH] = {0., 0.};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < WIDTH * cg->problem->mesh->num_owned; k++) sum[k % WIDTH] += x[k] * y[k];
  PetscCall(MPIU_Allreduce(sum, product, WIDTH, MPIU_REAL, MPIU_SUM, cg->problem->comm));
  PetscFunctionReturn(0);
}

/* image <- (L + M)^-1 residual. */
static PetscErrorCode Precondition(Cg *cg)
{
  const PetscInt n = cg->problem->mesh->num_owned;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < WIDTH * n; k++) cg->columns[(k % WIDTH) * n + k / WIDTH] = cg->residual[k];
  PetscCall(EqmGroupSolve(cg->problem, WIDTH, cg->columns));
  for (PetscInt k = 0; k < WIDTH * n; k++) cg->image[k] = cg->columns[(k % WIDTH) * n + k / WIDTH];
  PetscFunctionReturn(0);
}

/* From z = 0 for the right-hand side in `residual`. L is singular, but the right-hand side has the sum zero. */
static PetscErrorCode Iterate(Cg *cg, PetscReal *z)
{
  const EqmMesh mesh = cg->problem->mesh;
  const PetscInt n = WIDTH * mesh->num_owned;
  const PetscReal tolerance = 1e-10;
  PetscReal rho[WIDTH], old[WIDTH] = {1., 1.}, first[WIDTH], curvature[WIDTH];

  PetscFunctionBegin;
  for (PetscInt step = 0; step < MOST_STEPS; step++) {
    PetscCall(Precondition(cg));
    PetscCall(Dot(cg, cg->residual, cg->image, rho));
    for (PetscInt c = 0; c < WIDTH && step == 0; c++) first[c] = rho[c];
    if (rho[0] <= PetscSqr(tolerance) * first[0] && rho[1] <= PetscSqr(tolerance) * first[1]) PetscFunctionReturn(0);
    for (PetscInt k = 0; k < n; k++)
      cg->direction[k] = cg->image[k] + (step > 0 ? rho[k % WIDTH] / old[k % WIDTH] * cg->direction[k] : 0.);
    PetscCall(EqmMeshUpdateGhosts(mesh, WIDTH, cg->direction));
    PetscCall(EqmLaplacianApply(mesh, cg->weights, WIDTH, cg->direction, cg->image));
    PetscCall(Dot(cg, cg->direction, cg->image, curvature));
    for (PetscInt k = 0; k < n; k++) {
      const PetscReal alpha = curvature[k % WIDTH] > 0. ? rho[k % WIDTH] / curvature[k % WIDTH] : 0.;
      z[k] += alpha * cg->direction[k];
      cg->residual[k] -= alpha * cg->image[k];
    }
    for (PetscInt c = 0; c < WIDTH; c++) old[c] = rho[c] > 0. ? rho[c] : 1.;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDipoleSolve(EqmProblem problem, const EqmPlace *place, const PetscInt corner[3],
                              const PetscReal charge[6], PetscReal *z)
{
  const EqmMesh mesh = problem->mesh;
  Cg cg = {.problem = problem};
  EqmMetric metric;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetAngleWeights(problem, &cg.weights));
  PetscCall(EqmMetricCreate(problem, &metric));
  PetscCall(EqmMetricRefresh(metric, place));
  PetscCall(EqmMetricDestroy(&metric));
  PetscCall(PetscMalloc4(WIDTH * mesh->num_owned, &cg.residual, WIDTH * mesh->num_owned, &cg.image,
                         WIDTH * mesh->num_owned, &cg.columns, WIDTH * mesh->num_local, &cg.direction));
  PetscCall(PetscArrayzero(cg.residual, WIDTH * mesh->num_owned));
  PetscCall(PetscArrayzero(z, WIDTH * mesh->num_local));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt a = 0; a < 3; a++) {
      if (mesh->global[v] != corner[a]) continue;
      for (PetscInt c = 0; c < WIDTH; c++) cg.residual[WIDTH * v + c] = charge[WIDTH * a + c];
    }
  }
  PetscCall(Iterate(&cg, z));
  PetscCall(EqmMeshUpdateGhosts(mesh, WIDTH, z));
  PetscCall(PetscFree4(cg.residual, cg.image, cg.columns, cg.direction));
  PetscFunctionReturn(0);
}
