/* First maps to the sphere. */
#include "method/method.h"
#include "geometry/simplex.h"
#include "measure/quantile.h"

/* Points of the plane (two reals per vertex) and of the sphere, seen from the pole `up` = +1 (north) or -1. */
static void ToPlane(PetscInt n, PetscReal up, const PetscReal *x, PetscReal *z)
{
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal height =
        PetscMax(1. - up * x[3 * v + 2], PETSC_MACHINE_EPSILON); /* a vertex at the pole stays finite */
    for (PetscInt k = 0; k < 2; k++) z[2 * v + k] = x[3 * v + k] / height;
  }
}

static void ToSphere(PetscInt n, PetscReal up, const PetscReal *z, PetscReal *x)
{
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal squared = z[2 * v] * z[2 * v] + z[2 * v + 1] * z[2 * v + 1];
    for (PetscInt k = 0; k < 2; k++) x[3 * v + k] = 2. * z[2 * v + k] / (1. + squared);
    x[3 * v + 2] = up * (squared - 1.) / (squared + 1.);
  }
}

/* Divide by the median modulus: half of the vertices on each hemisphere. */
static PetscErrorCode DivideByMedian(EqmMesh mesh, PetscReal *z)
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

PetscErrorCode EqmSphereOrient(EqmSolver solver)
{
  const EqmMesh mesh = solver->mesh;
  PetscReal *det;
  PetscInt64 folds;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local_cells, &det));
  PetscCall(EqmImageFolds(solver->domain, &solver->place, det, &folds));
  PetscCall(PetscFree(det));
  if (2 * folds <= mesh->num_cells) PetscFunctionReturn(0);
  for (PetscInt v = 0; v < mesh->num_local; v++) solver->place.x[3 * v] *= -1.;
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
static PetscErrorCode SolvePinned(EqmSolver solver, const PetscInt corner[3], const PetscReal pinned[6], PetscReal *z)
{
  const EqmMesh mesh = solver->mesh;
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
  PetscCall(EqmAngleWeights(solver, &weights));
  PetscCall(EqmHeldSolve(solver, weights, group, 2, z));
  PetscCall(PetscFree(group));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereLinear(EqmSolver solver, PetscBool dipole)
{
  const EqmMesh mesh = solver->mesh;
  PetscInt corner[3];
  PetscReal position[9], pinned[6], *z;

  PetscFunctionBegin;
  PetscCall(MostRegularTriangle(mesh, corner, position));
  PinnedPlaces(position, pinned);
  PetscCall(PetscMalloc1(2 * mesh->num_local, &z));
  if (dipole)
    PetscCall(EqmDipoleSolve(solver, corner, pinned, z));
  else
    PetscCall(SolvePinned(solver, corner, pinned, z));
  PetscCall(Center(mesh, z));
  PetscCall(DivideByMedian(mesh, z));
  ToSphere(mesh->num_local, 1., z, solver->place.x);
  PetscCall(EqmSphereOrient(solver));
  PetscCall(PetscFree(z));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereCapStep(EqmSolver solver, PetscInt step, const PetscReal *weights)
{
  const EqmMesh mesh = solver->mesh;
  const PetscReal up = step % 2 ? 1. : -1., radius = 1.2;
  PetscReal *z;
  signed char *group;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(2 * mesh->num_local, &z, mesh->num_local, &group));
  ToPlane(mesh->num_local, up, solver->place.x, z);
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    group[v] = z[2 * v] * z[2 * v] + z[2 * v + 1] * z[2 * v + 1] < radius * radius ? 0 : EQM_GROUP_FIXED;
  }
  PetscCall(EqmHeldSolve(solver, weights, group, 2, z));
  PetscCall(DivideByMedian(mesh, z));
  ToSphere(mesh->num_local, up, z, solver->place.x);
  PetscCall(PetscFree2(z, group));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereFixedPointStep(EqmSolver solver, PetscInt step, PetscReal *weights)
{
  PetscFunctionBegin;
  PetscCall(EqmLaplacianWeights(solver->domain, EQM_LAPLACIAN_STRETCH, &solver->place, weights));
  PetscCall(EqmSphereCapStep(solver, step, weights));
  PetscFunctionReturn(0);
}
