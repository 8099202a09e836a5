/* Residuals of a map and their sums. */
#include "method/lm.h"
#include "domain/domain_private.h"
#include "energy/loops.h"
#include <math.h>

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

static PetscErrorCode AllPositive(EqmMesh mesh, const PetscReal *x, PetscBool *positive)
{
  PetscReal smallest = 1., all;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    if (!(x[c] > 0.)) smallest = -1.;
  }
  PetscCall(MPIU_Allreduce(&smallest, &all, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  *positive = (PetscBool)(all > 0.);
  PetscFunctionReturn(0);
}

/* (E_D - A): the angle energy of places or, being quadratic in them, of displacements. */
PetscErrorCode EqmLmAngleEnergy(EqmMethod method, const PetscReal *x, PetscReal *energy)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  EqmPlace place = {.x = (PetscReal *)x};
  PetscReal dirichlet, area, local = 0.;

  PetscFunctionBegin;
  PetscCall(EqmLaplacianEnergy(mesh, lm->laplacian, 2, x, &dirichlet));
  PetscCall(EqmImageMeasure(method->problem->domain, &place, lm->bend));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) local += lm->bend[c];
  PetscCall(MPIU_Allreduce(&local, &area, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  *energy = dirichlet - area;
  PetscFunctionReturn(0);
}

/* Sphere: q = log(half det / a) keeps triangles from leaning over; `positive` false if one has. Collective. */
static PetscErrorCode EvaluateBarrier(EqmMethod method, EqmTrial *trial, PetscBool *positive)
{
  const EqmMesh mesh = method->problem->mesh;

  PetscFunctionBegin;
  PetscCall(EqmImageMeasureOf(method->problem->domain, EQM_MEASURE_HALF_DET, &trial->place, trial->half_det));
  PetscCall(AllPositive(mesh, trial->half_det, positive));
  if (!*positive) PetscFunctionReturn(0);
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++)
    trial->lean[c] = PetscLogReal(trial->half_det[c] / trial->image[c]);
  PetscCall(EqmLmWeightedSum(mesh, trial->lean, 2, &trial->barrier));
  PetscFunctionReturn(0);
}

/* What the trial is worth with the present weights. Not collective. */
void EqmLmWeigh(EqmMethod method, EqmTrial *trial)
{
  const EqmLm *const lm = method->data;

  trial->objective = trial->squares + lm->kappa * trial->barrier + lm->angle_weight * trial->angle +
                     method->problem->landmarks.weight * trial->pull;
}

/* Look at trial->place. Counts one evaluation. Collective. */
PetscErrorCode EqmLmEvaluate(EqmMethod method, EqmTrial *trial)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const PetscBool balanced = (PetscBool)(lm->epsilon > 0.);
  PetscBool fine;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(mesh->ledger, &work));
  work->evaluations++;
  trial->objective = INFINITY; /* PETSC_INFINITY is a finite number */
  PetscCall(EqmImageMeasure(method->problem->domain, &trial->place, trial->image));
  PetscCall(AllPositive(mesh, trial->image, &fine));
  if (fine && method->problem->domain->curved_image) PetscCall(EvaluateBarrier(method, trial, &fine));
  if (fine) PetscCall(EqmDomainBoundaryInOrder(method->problem->domain, &trial->place, &fine));
  if (!fine) PetscFunctionReturn(0);
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
  if (balanced) PetscCall(EqmLmAngleEnergy(method, trial->place.x, &trial->angle));
  if (method->problem->landmarks.num_total > 0)
    PetscCall(
        EqmLandmarksSquares(&method->problem->landmarks, method->problem->domain, trial->place.x, NULL, &trial->pull));
  EqmLmWeigh(method, trial);
  PetscFunctionReturn(0);
}
