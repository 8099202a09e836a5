/* The landmark term of an objective: value, gradient, and the shares of its diagonal that cells contribute. */
#include "problem/landmarks.h"
#include "domain/domain_private.h"

PetscErrorCode EqmLandmarksReset(EqmLandmarks *landmarks)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(landmarks->input_vertex));
  PetscCall(PetscFree(landmarks->target));
  PetscCall(PetscFree(landmarks->given_weight));
  PetscCall(PetscFree(landmarks->vertex));
  PetscCall(PetscFree(landmarks->place));
  PetscCall(PetscFree(landmarks->weight));
  PetscCall(PetscFree(landmarks->share));
  landmarks->num = landmarks->num_total = 0;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLandmarksGive(EqmLandmarks *landmarks, PetscInt num, PetscInt dim, const PetscInt *vertices,
                                const PetscReal *places, const PetscReal *weights)
{
  PetscFunctionBegin;
  PetscCall(EqmLandmarksReset(landmarks));
  landmarks->num_total = num;
  landmarks->dim = dim;
  PetscCall(PetscMalloc1(num, &landmarks->input_vertex));
  PetscCall(PetscMalloc1(dim * num, &landmarks->target));
  PetscCall(PetscMalloc1(num, &landmarks->given_weight));
  PetscCall(PetscArraycpy(landmarks->input_vertex, vertices, num));
  PetscCall(PetscArraycpy(landmarks->target, places, dim * num));
  for (PetscInt i = 0; i < num; i++) landmarks->given_weight[i] = weights ? weights[i] : 1.;
  PetscFunctionReturn(0);
}

/* The matrix is a sum over cells: each cell of a landmark brings its share of the landmark's diagonal block. */
static PetscErrorCode MakeShares(EqmLandmarks *landmarks, EqmMesh mesh)
{
  PetscInt *cells_around;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(mesh->num_local, &landmarks->share));
  PetscCall(PetscCalloc1(mesh->num_local, &cells_around));
  for (PetscInt k = 0; k < mesh->cell_size * mesh->num_local_cells; k++) cells_around[mesh->cells[k]]++;
  for (PetscInt i = 0; i < landmarks->num; i++) {
    const PetscInt v = landmarks->vertex[i];
    landmarks->share[v] += landmarks->weight[i] / cells_around[v];
  }
  PetscCall(PetscFree(cells_around));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLandmarksSetUp(EqmLandmarks *landmarks, EqmDomain domain)
{
  const EqmMesh mesh = domain->mesh;
  const PetscInt dim = landmarks->dim;
  PetscInt *local;

  PetscFunctionBegin;
  if (landmarks->num_total == 0) PetscFunctionReturn(0);
  PetscCheck(dim == domain->dim, mesh->comm, PETSC_ERR_ARG_INCOMP, "landmarks have the target's coordinates");
  PetscCall(PetscMalloc1(landmarks->num_total, &landmarks->vertex));
  PetscCall(PetscMalloc1(dim * landmarks->num_total, &landmarks->place));
  PetscCall(PetscMalloc1(landmarks->num_total, &landmarks->weight));
  PetscCall(PetscMalloc1(landmarks->num_total, &local));
  PetscCall(EqmMeshFindVertices(mesh, landmarks->num_total, landmarks->input_vertex, local));
  for (PetscInt i = 0; i < landmarks->num_total; i++) {
    if (local[i] < 0) continue;
    landmarks->vertex[landmarks->num] = local[i];
    landmarks->weight[landmarks->num] = landmarks->given_weight[i];
    for (PetscInt c = 0; c < dim; c++) landmarks->place[dim * landmarks->num + c] = landmarks->target[dim * i + c];
    landmarks->num++;
  }
  PetscCall(PetscFree(local));
  PetscCall(MakeShares(landmarks, mesh));
  PetscFunctionReturn(0);
}

/* |x + velocity - q|^2 of landmark i of this rank. */
static PetscReal Squared(const EqmLandmarks *landmarks, PetscInt dim, PetscInt i, const PetscReal *x,
                         const PetscReal *velocity)
{
  PetscReal sum = 0.;

  for (PetscInt c = 0; c < dim; c++) {
    const PetscInt at = dim * landmarks->vertex[i] + c;
    sum += PetscSqr(x[at] + (velocity ? velocity[at] : 0.) - landmarks->place[dim * i + c]);
  }
  return sum;
}

PetscErrorCode EqmLandmarksSquares(const EqmLandmarks *landmarks, EqmDomain domain, const PetscReal *x,
                                   const PetscReal *velocity, PetscReal *squares)
{
  PetscReal local = 0.;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < landmarks->num; i++)
    local += landmarks->weight[i] * Squared(landmarks, domain->dim, i, x, velocity);
  PetscCall(MPIU_Allreduce(&local, squares, 1, MPIU_REAL, MPIU_SUM, domain->mesh->comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLandmarksLargest(const EqmLandmarks *landmarks, EqmDomain domain, const PetscReal *x,
                                   PetscReal *largest)
{
  PetscReal local = 0.;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < landmarks->num; i++) local = PetscMax(local, Squared(landmarks, domain->dim, i, x, NULL));
  PetscCall(MPIU_Allreduce(&local, largest, 1, MPIU_REAL, MPIU_MAX, domain->mesh->comm));
  *largest = PetscSqrtReal(*largest);
  PetscFunctionReturn(0);
}

void EqmLandmarksAddGradient(const EqmLandmarks *landmarks, EqmDomain domain, const PetscReal *x, PetscReal factor,
                             PetscReal *gradient)
{
  const PetscInt dim = domain->dim;

  for (PetscInt i = 0; i < landmarks->num; i++) {
    for (PetscInt c = 0; c < dim; c++) {
      const PetscInt at = dim * landmarks->vertex[i] + c;
      gradient[at] += factor * landmarks->weight[i] * (x[at] - landmarks->place[dim * i + c]);
    }
  }
}
