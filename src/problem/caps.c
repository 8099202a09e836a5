/* Maps to the sphere in stereographic coordinates about a pole, and the fixed-point step of 001 Algorithm 2 on them. */
#include "problem/problem.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"
#include "measure/quantile.h"

const PetscReal EqmSmallestImage = 4e-15;

/* Stereographic projection from the pole `up` = +1 (north) or -1: three reals per vertex to two. */
static void ToPlane(PetscInt n, PetscReal up, const PetscReal *x, PetscReal *z)
{
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal height =
        PetscMax(1. - up * x[3 * v + 2], PETSC_MACHINE_EPSILON); /* a vertex at the pole stays finite */
    for (PetscInt k = 0; k < 2; k++) z[2 * v + k] = x[3 * v + k] / height;
  }
}

void EqmPlaneToSphere(PetscInt n, PetscReal up, const PetscReal *z, PetscReal *x)
{
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal squared = z[2 * v] * z[2 * v] + z[2 * v + 1] * z[2 * v + 1];
    for (PetscInt k = 0; k < 2; k++) x[3 * v + k] = 2. * z[2 * v + k] / (1. + squared);
    x[3 * v + 2] = up * (squared - 1.) / (squared + 1.);
  }
}

/* Divide by the median modulus: half of the vertices on each hemisphere. */
PetscErrorCode EqmDivideByMedian(EqmMesh mesh, PetscReal *z)
{
  PetscReal *modulus;
  EqmStatistics statistics;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_owned, &modulus));
  for (PetscInt v = 0; v < mesh->num_owned; v++)
    modulus[v] = PetscSqrtReal(z[2 * v] * z[2 * v] + z[2 * v + 1] * z[2 * v + 1]);
  PetscCall(EqmStatisticsOf(mesh->comm, mesh->num_owned, modulus, &statistics));
  PetscCall(PetscFree(modulus));
  for (PetscInt k = 0; k < 2 * mesh->num_local; k++) z[k] /= statistics.p50;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereOrient(EqmProblem problem, EqmIterate iterate)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal *det;
  PetscInt64 folds;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local_cells, &det));
  PetscCall(EqmImageFolds(problem->domain, &iterate->place, det, &folds));
  PetscCall(PetscFree(det));
  if (2 * folds <= mesh->num_cells) PetscFunctionReturn(0);
  for (PetscInt v = 0; v < mesh->num_local; v++) iterate->place.x[3 * v] *= -1.;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereSmallestImage(EqmProblem problem, const EqmPlace *place, PetscReal *smallest)
{
  PetscReal local = PETSC_MAX_REAL, *det;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(problem->mesh->num_local_cells, &det));
  PetscCall(EqmImageMeasureOf(problem->domain, EQM_MEASURE_HALF_DET, place, det));
  for (PetscInt c = 0; c < problem->mesh->num_owned_cells; c++) local = PetscMin(local, PetscAbsReal(det[c]));
  PetscCall(MPIU_Allreduce(&local, smallest, 1, MPIU_REAL, MPIU_MIN, problem->comm));
  PetscCall(PetscFree(det));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereCapStep(EqmProblem problem, EqmIterate iterate, PetscInt step, const PetscReal *weights)
{
  const EqmMesh mesh = problem->mesh;
  const PetscReal up = step % 2 ? 1. : -1., radius = 1.2;
  PetscReal *z;
  signed char *group;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(2 * mesh->num_local, &z, mesh->num_local, &group));
  ToPlane(mesh->num_local, up, iterate->place.x, z);
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    group[v] = z[2 * v] * z[2 * v] + z[2 * v + 1] * z[2 * v + 1] < radius * radius ? 0 : EQM_GROUP_FIXED;
  }
  PetscCall(EqmHeldSolve(problem, weights, group, 2, z));
  PetscCall(EqmDivideByMedian(mesh, z));
  EqmPlaneToSphere(mesh->num_local, up, z, iterate->place.x);
  PetscCall(PetscFree2(z, group));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereFixedPointStep(EqmProblem problem, EqmIterate iterate, PetscInt step, PetscReal *weights)
{
  PetscFunctionBegin;
  PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_STRETCH, &iterate->place, weights));
  PetscCall(EqmSphereCapStep(problem, iterate, step, weights));
  PetscFunctionReturn(0);
}
