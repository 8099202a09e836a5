/* What a map is worth: the residual of its ratios and the added terms. */
#include "method/lm.h"
#include "domain/domain_private.h"
#include "energy/loops.h"
#include <math.h>

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

/* The objective from the squares and the terms at a map. Collective. */
PetscErrorCode EqmLmAddTerms(EqmMethod method, EqmTrial *trial)
{
  PetscReal terms = 0.;

  PetscFunctionBegin;
  PetscCall(EqmTermsAdd(method->problem, &trial->place, trial->image, &terms, NULL));
  trial->objective = trial->squares + ((EqmLm *)method->data)->term_scale * terms;
  PetscFunctionReturn(0);
}

/* All of a trial from its place. Counts one evaluation. Collective. */
PetscErrorCode EqmLmEvaluate(EqmMethod method, EqmTrial *trial)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  PetscBool valid;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(mesh->ledger, &work));
  work->evaluations++;
  trial->objective = INFINITY; /* PETSC_INFINITY is a finite number */
  PetscCall(EqmImageMeasure(method->problem->domain, &trial->place, trial->image));
  PetscCall(AllPositive(mesh, trial->image, &valid));
  if (valid) PetscCall(EqmDomainBoundaryInOrder(method->problem->domain, &trial->place, &valid));
  if (!valid) PetscFunctionReturn(0);
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal first, second;
    lm->residual->at(PetscLogReal(trial->image[c] / mesh->weight[c]) - lm->level, &trial->residual[c], &first, &second);
  }
  if (lm->residual->without_mean) PetscCall(EqmRemoveWeightedMean(mesh, trial->residual));
  PetscCall(EqmWeightedSum(mesh, trial->residual, 2, &trial->squares));
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscCall(EqmLmAddTerms(method, trial));
  PetscFunctionReturn(0);
}
