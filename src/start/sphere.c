/* First maps to the sphere. */
#include "start/start.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"
#include "problem/objective.h"
#include "unfold/unfold.h"

/* Subtract the vertex mean. */
static PetscErrorCode Center(EqmMesh mesh, PetscReal *z)
{
  PetscReal sum[2] = {0., 0.};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2 * mesh->num_owned; k++) sum[k % 2] += z[k];
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt k = 0; k < 2 * mesh->num_local; k++) z[k] -= sum[k % 2] / mesh->num_vertices;
  PetscFunctionReturn(0);
}

/* The triangle whose edges differ least in length, ties by the input number; its corners' global numbers and places. */
static PetscErrorCode MostRegularTriangle(EqmMesh mesh, PetscInt corner[3], PetscReal position[9])
{
  PetscReal best = PETSC_MAX_REAL, least;
  PetscInt cell = -1, number, lowest;
  PetscMPIInt mine, owner;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    PetscReal edge[3], mean = 0., spread = 0.;
    for (PetscInt a = 0; a < 3; a++) {
      const PetscReal *const p = mesh->position + 3 * mesh->cells[3 * c + a], *const q =
                                                                                  mesh->position +
                                                                                  3 * mesh->cells[3 * c + (a + 1) % 3];
      edge[a] = PetscSqrtReal(PetscSqr(p[0] - q[0]) + PetscSqr(p[1] - q[1]) + PetscSqr(p[2] - q[2]));
      mean += edge[a] / 3.;
    }
    for (PetscInt a = 0; a < 3; a++) spread += PetscSqr(edge[a] - mean);
    if (spread < best || (spread == best && mesh->cell_input[c] < mesh->cell_input[cell])) {
      best = spread;
      cell = c;
    }
  }
  PetscCall(MPIU_Allreduce(&best, &least, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  number = cell >= 0 && best == least ? mesh->cell_input[cell] : PETSC_MAX_INT;
  PetscCall(MPIU_Allreduce(&number, &lowest, 1, MPIU_INT, MPI_MIN, mesh->comm));
  mine = number == lowest ? mesh->rank : mesh->size;
  PetscCallMPI(MPI_Allreduce(&mine, &owner, 1, MPI_INT, MPI_MIN, mesh->comm));
  for (PetscInt a = 0; a < 3 && mesh->rank == owner; a++) {
    const PetscInt v = mesh->cells[3 * cell + a];
    corner[a] = mesh->global[v];
    for (PetscInt k = 0; k < 3; k++) position[3 * a + k] = mesh->position[3 * v + k];
  }
  PetscCallMPI(MPI_Bcast(corner, 3, MPIU_INT, owner, mesh->comm));
  PetscCallMPI(MPI_Bcast(position, 9, MPIU_REAL, owner, mesh->comm));
  PetscFunctionReturn(0);
}

/* Where the pinned triangle's corners go: the linear function of Laplacian linearisation, in units of the triangle. */
static void PinnedPlaces(const PetscReal position[9], PetscReal pinned[6])
{
  const PetscReal *const a = position, *const b = position + 3, *const c = position + 6;
  PetscReal ab[3], ac[3], height[3], length, depth, foot;

  for (PetscInt k = 0; k < 3; k++) {
    ab[k] = b[k] - a[k];
    ac[k] = c[k] - a[k];
  }
  foot = EqmDot3(ac, ab) / EqmDot3(ab, ab);
  for (PetscInt k = 0; k < 3; k++) height[k] = ac[k] - foot * ab[k];
  length = PetscSqrtReal(EqmDot3(ab, ab));
  depth = PetscSqrtReal(EqmDot3(height, height));
  pinned[0] = -1. / length;
  pinned[1] = (1. - foot) / depth;
  pinned[2] = 1. / length;
  pinned[3] = foot / depth;
  pinned[4] = 0.;
  pinned[5] = -1. / depth;
}

/* The places of the triangle's corners held, the others harmonic. */
static PetscErrorCode SolvePinned(EqmProblem problem, const PetscInt corner[3], const PetscReal pinned[6], PetscReal *z)
{
  const EqmMesh mesh = problem->mesh;
  const PetscReal *weights;
  signed char *group;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local, &group));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    group[v] = 0;
    z[2 * v] = z[2 * v + 1] = 0.;
    for (PetscInt a = 0; a < 3; a++) {
      if (mesh->global[v] != corner[a]) continue;
      group[v] = EQM_GROUP_FIXED;
      z[2 * v] = pinned[2 * a];
      z[2 * v + 1] = pinned[2 * a + 1];
    }
  }
  PetscCall(EqmProblemGetAngleWeights(problem, &weights));
  PetscCall(EqmHeldSolve(problem, weights, group, 2, z));
  PetscCall(PetscFree(group));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereLinear(EqmProblem problem, EqmIterate iterate, PetscBool dipole)
{
  const EqmMesh mesh = problem->mesh;
  PetscInt corner[3];
  PetscReal position[9], pinned[6], *z;

  PetscFunctionBegin;
  PetscCall(MostRegularTriangle(mesh, corner, position));
  PinnedPlaces(position, pinned);
  PetscCall(PetscMalloc1(2 * mesh->num_local, &z));
  if (dipole)
    PetscCall(EqmDipoleSolve(problem, &iterate->place, corner, pinned, z));
  else
    PetscCall(SolvePinned(problem, corner, pinned, z));
  PetscCall(Center(mesh, z));
  PetscCall(EqmDivideByMedian(mesh, z));
  EqmPlaneToSphere(mesh->num_local, 1., z, iterate->place.x);
  PetscCall(EqmSphereOrient(problem, iterate));
  PetscCall(PetscFree(z));
  PetscFunctionReturn(0);
}

/* ---- the linear map, and starts that continue from it */

static PetscErrorCode RunLinear(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * problem->mesh->num_local_cells, &weights));
  PetscCall(EqmSphereLinear(problem, iterate, PETSC_FALSE));
  for (PetscInt k = 0; k < options->steps; k++) PetscCall(EqmSphereFixedPointStep(problem, iterate, k, weights));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}

/* Fixed-point steps until the energy rises; the map before the rise, unfolded. */
static PetscErrorCode RunDescending(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  PetscReal *weights, before;
  EqmPlace last;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * problem->mesh->num_local_cells, &weights));
  PetscCall(EqmPlaceCreate(problem->domain, &last));
  PetscCall(EqmSphereLinear(problem, iterate, PETSC_FALSE));
  PetscCall(EqmIterateUpdate(problem, iterate));
  for (PetscInt k = 0; k < options->steps; k++) {
    before = iterate->totals.energy;
    PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &last));
    PetscCall(EqmSphereFixedPointStep(problem, iterate, k, weights));
    PetscCall(EqmIterateUpdate(problem, iterate));
    if (iterate->totals.energy < before) continue;
    PetscCall(EqmPlaceCopy(problem->domain, &last, &iterate->place));
    break;
  }
  PetscCall(EqmSphereUnfoldFirstMap(problem, iterate));
  PetscCall(EqmPlaceDestroy(&last));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunConformal(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  (void)options;
  PetscFunctionBegin;
  PetscCall(EqmSphereLinear(problem, iterate, problem->objective->fixed_metric));
  PetscCall(EqmIterateCenter(problem, iterate));
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartSphereLinearType = {EQM_STARTS_SPHERE, "linear",
                                               "Laplacian linearisation: one triangle pinned, the rest conformal", 0,
                                               RunLinear};
const EqmStartType EqmStartSphereFixedPoint = {EQM_STARTS_SPHERE, "fixed-point",
                                               "linear, then fixed-point steps (001 Algorithm 2)", 10, RunLinear};
const EqmStartType EqmStartSphereDescending = {
    EQM_STARTS_SPHERE, "descending",
    "linear, then fixed-point steps for as long as the energy falls, -start_steps at most (001 section 6.3)", 100,
    RunDescending};
const EqmStartType EqmStartSphereConformal = {EQM_STARTS_SPHERE, "conformal",
                                              "linear, then the Mobius map that brings its mass centre to the sphere's",
                                              0, RunConformal};
