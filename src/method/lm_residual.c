/* Residuals of a map and their sums. */
#include "method/lm.h"
#include "energy/loops.h"

/* sum over owned cells of w x^k, k = 1 or 2. */
PetscErrorCode EqmLmWeightedSum(EqmMesh mesh, const PetscReal *x, PetscInt power, PetscReal *sum)
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

/* Subtract the weighted mean: the total area is free. */
PetscErrorCode EqmLmRemoveMean(EqmMesh mesh, PetscReal *x)
{
  PetscReal mean;

  PetscFunctionBegin;
  PetscCall(EqmLmWeightedSum(mesh, x, 1, &mean));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) x[c] -= mean;
  PetscFunctionReturn(0);
}

/* (E_D - A): the angle energy of places or, being quadratic in them, of displacements. */
PetscErrorCode EqmLmAngleEnergy(EqmSolver solver, const PetscReal *x, PetscReal *energy)
{
  EqmLm *const lm = solver->data;
  const EqmMesh mesh = solver->mesh;
  EqmPlace place = {.x = (PetscReal *)x};
  PetscReal dirichlet, area, local = 0.;

  PetscFunctionBegin;
  PetscCall(EqmLaplacianEnergy(mesh, lm->laplacian, 2, x, &dirichlet));
  PetscCall(EqmImageMeasure(solver->domain, &place, lm->bend));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) local += lm->bend[c];
  PetscCall(MPIU_Allreduce(&local, &area, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  *energy = dirichlet - area;
  PetscFunctionReturn(0);
}

/* Look at trial->place. Counts one evaluation. Collective. */
PetscErrorCode EqmLmEvaluate(EqmSolver solver, EqmTrial *trial)
{
  EqmLm *const lm = solver->data;
  const EqmMesh mesh = solver->mesh;
  const PetscBool balanced = (PetscBool)(lm->epsilon > 0.);
  PetscReal smallest = 1., ok;
  PetscBool in_order;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(mesh->ledger, &work));
  work->evaluations++;
  trial->objective = PETSC_INFINITY;
  PetscCall(EqmImageMeasure(solver->domain, &trial->place, trial->image));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    if (!(trial->image[c] > 0.)) smallest = -1.;
  }
  PetscCall(MPIU_Allreduce(&smallest, &ok, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  if (ok < 0.) PetscFunctionReturn(0);
  PetscCall(EqmDomainBoundaryInOrder(solver->domain, &trial->place, &in_order));
  if (!in_order) PetscFunctionReturn(0);
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal first, second;
    EqmLmResidual(balanced, PetscLogReal(trial->image[c] / mesh->weight[c]) - lm->level, &trial->residual[c], &first,
                  &second);
  }
  if (!balanced) PetscCall(EqmLmRemoveMean(mesh, trial->residual));
  PetscCall(EqmLmWeightedSum(mesh, trial->residual, 2, &trial->squares));
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  trial->objective = trial->squares;
  if (balanced) {
    PetscReal angle;
    PetscCall(EqmLmAngleEnergy(solver, trial->place.x, &angle));
    trial->objective += lm->angle_weight * angle;
  }
  PetscFunctionReturn(0);
}
