/* Weighted sums over cells. */
#include "energy/loops.h"
#include "mesh/mesh_private.h"

PetscErrorCode EqmWeightedSum(EqmMesh mesh, const PetscReal *x, PetscInt power, PetscReal *sum)
{
  PetscReal part[EQM_NUM_RANGES], local = 0.;

  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) {
    part[b] = 0.;
    for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < EqmRangeStart(mesh->num_owned_cells, b + 1); c++) {
      part[b] += mesh->weight[c] * (power == 1 ? x[c] : x[c] * x[c]);
    }
  }
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) local += part[b];
  PetscCall(MPIU_Allreduce(&local, sum, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRemoveWeightedMean(EqmMesh mesh, PetscReal *x)
{
  PetscReal mean;

  PetscFunctionBegin;
  PetscCall(EqmWeightedSum(mesh, x, 1, &mean));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) x[c] -= mean;
  PetscFunctionReturn(0);
}
