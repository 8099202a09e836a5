/* The Gauss map: each vertex goes to its normal (004 Definition 5.1). Hollows fold; a few steps of heat flow on the
   sphere smooth that away. */
#include "start/start.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"
#include "unfold/unfold.h"

/* Time step of the smoothing for a surface of area one; the sphere's slowest modes decay at rate 8 pi. */
#define TIME_STEP .01

/* Sum of the normals of the triangles around each vertex, weighted by their areas; where they cancel, the direction
   from the mesh's centroid. */
static PetscErrorCode SumNormals(EqmMesh mesh, PetscReal *x)
{
  PetscReal sum[3] = {0., 0., 0.}, middle[3];

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(x, 3 * mesh->num_local));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    const PetscReal *const p = mesh->position + 3 * v[0], *const q = mesh->position + 3 * v[1],
                           *const r = mesh->position + 3 * v[2];
    const PetscReal pq[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, pr[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
    PetscReal normal[3];
    EqmCross(pq, pr, normal);
    for (PetscInt k = 0; k < 9; k++) x[3 * v[k / 3] + k % 3] += normal[k % 3];
  }
  for (PetscInt k = 0; k < 3 * mesh->num_owned; k++) sum[k % 3] += mesh->position[k];
  PetscCall(MPIU_Allreduce(sum, middle, 3, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    PetscReal *const normal = x + 3 * v;
    for (PetscInt k = 0; k < 3 && EqmDot3(normal, normal) == 0.; k++)
      normal[k] = mesh->position[3 * v + k] - middle[k] / mesh->num_vertices;
  }
  PetscFunctionReturn(0);
}

/* Implicit Euler for df/dt = -M^-1 L f in every coordinate, then back onto the sphere: (M/dt + L) f' = (M/dt) f. */
static PetscErrorCode Smooth(EqmProblem problem, EqmIterate iterate, const PetscReal *mass, PetscReal *columns)
{
  const PetscInt n = problem->mesh->num_owned;
  PetscReal *const x = iterate->place.x, center[3];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * n; k++) columns[(k % 3) * n + k / 3] = mass[k / 3] / TIME_STEP * x[k];
  PetscCall(EqmGroupSolve(problem, 3, columns));
  for (PetscInt k = 0; k < 3 * n; k++) x[k] = columns[(k % 3) * n + k / 3];
  PetscCall(EqmPlaceMassCenter(problem->domain, mass, &iterate->place, center));
  PetscCall(EqmPlaceOntoSphere(problem->domain, center, &iterate->place));
  PetscFunctionReturn(0);
}

/* Factor M/dt + L. */
static PetscErrorCode FactorFlow(EqmProblem problem)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal *weights, *mass;
  signed char *group;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * mesh->num_local_cells, &weights, mesh->num_local_cells, &mass));
  PetscCall(PetscCalloc1(mesh->num_local, &group));
  PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_COTANGENT, NULL, weights));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) mass[c] = mesh->weight[c] / TIME_STEP;
  PetscCall(EqmGroupFactor(problem, weights, group, mass));
  PetscCall(PetscFree(group));
  PetscCall(PetscFree2(weights, mass));
  PetscFunctionReturn(0);
}

/* Keep the map of the fewest folds. */
static PetscErrorCode SmoothUntilUnfolded(EqmProblem problem, EqmIterate iterate, PetscInt most_steps)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal *mass, *columns, *scratch;
  PetscInt64 fewest, folds;
  EqmPlace best;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(mesh->num_owned, &mass, 3 * mesh->num_owned, &columns, mesh->num_local_cells, &scratch));
  PetscCall(EqmPlaceCreate(problem->domain, &best));
  PetscCall(EqmMeshVertexWeights(mesh, mass));
  PetscCall(EqmImageFolds(problem->domain, &iterate->place, scratch, &fewest));
  PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &best));
  if (fewest > 0) PetscCall(FactorFlow(problem));
  for (PetscInt k = 0; k < most_steps && fewest > 0; k++) {
    PetscCall(Smooth(problem, iterate, mass, columns));
    PetscCall(EqmImageFolds(problem->domain, &iterate->place, scratch, &folds));
    if (folds >= fewest) continue;
    fewest = folds;
    PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &best));
  }
  PetscCall(EqmPlaceCopy(problem->domain, &best, &iterate->place));
  PetscCall(EqmPlaceDestroy(&best));
  PetscCall(PetscFree3(mass, columns, scratch));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereGauss(EqmProblem problem, EqmIterate iterate, PetscInt steps)
{
  const PetscReal origin[3] = {0., 0., 0.};

  PetscFunctionBegin;
  PetscCall(SumNormals(problem->mesh, iterate->place.x));
  PetscCall(
      EqmPlaceOntoSphere(problem->domain, origin, &iterate->place)); /* of degree one, however many triangles fold */
  if (steps > 0) PetscCall(SmoothUntilUnfolded(problem, iterate, steps));
  PetscFunctionReturn(0);
}

/* The steps are those of the smoothing, at most. */
static PetscErrorCode Run(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  PetscFunctionBegin;
  PetscCall(EqmSphereGauss(problem, iterate, options->steps));
  if (options->steps == 0) PetscFunctionReturn(0);
  PetscCall(EqmSphereUnfoldFirstMap(problem, iterate));
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartSphereNormals = {EQM_STARTS_SPHERE, "normals",
                                            "vertex normals (004 Definition 5.1): folds wherever the surface is hollow",
                                            0, Run};
const EqmStartType EqmStartSphereGauss = {EQM_STARTS_SPHERE, "gauss",
                                          "normals, smoothed by heat flow for as long as they fold, and unfolding", 20,
                                          Run};
