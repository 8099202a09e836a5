/* What a map is worth: the residual of its ratios and the added terms. */
#include "method/lm.h"
#include "domain/domain_private.h"
#include "energy/loops.h"
#include <math.h>

/* What the ranks add up of a trial: image cells that are not positive, of the boundary, w rho. */
enum { NOT_POSITIVE, BOUNDARY, RESIDUAL = BOUNDARY + EQM_BOUNDARY_SUMS, NUM_SUMS };

static inline PetscReal ResidualAt(const EqmLm *lm, EqmMesh mesh, const EqmTrial *trial, PetscInt c)
{
  PetscReal rho, first, second;

  lm->residual->at(PetscLogReal(trial->image[c] / mesh->weight[c]) - lm->level, &rho, &first, &second);
  return rho;
}

/* Residuals of all cells, NaN where the image is not positive, the mean not yet removed. */
static void FillResiduals(const EqmLm *lm, EqmMesh mesh, EqmTrial *trial, PetscReal sum[NUM_SUMS])
{
  PetscReal part[EQM_NUM_RANGES];
  PetscInt bad = 0;

#pragma omp parallel for schedule(static) reduction(+ : bad)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) {
    part[b] = 0.;
    for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < EqmRangeStart(mesh->num_owned_cells, b + 1); c++) {
      bad += !(trial->image[c] > 0.);
      trial->residual[c] = ResidualAt(lm, mesh, trial, c);
      part[b] += mesh->weight[c] * trial->residual[c];
    }
  }
#pragma omp parallel for schedule(static)
  for (PetscInt c = mesh->num_owned_cells; c < mesh->num_local_cells; c++)
    trial->residual[c] = ResidualAt(lm, mesh, trial, c);
  sum[NOT_POSITIVE] = (PetscReal)bad;
  sum[RESIDUAL] = 0.;
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) sum[RESIDUAL] += part[b];
}

/* Take the mean off; the sum of w rho^2. Collective. */
static PetscErrorCode SumSquares(EqmMesh mesh, PetscReal mean, EqmTrial *trial)
{
  PetscReal part[EQM_NUM_RANGES], local = 0.;

  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) {
    part[b] = 0.;
    for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < EqmRangeStart(mesh->num_owned_cells, b + 1); c++) {
      trial->residual[c] -= mean;
      part[b] += mesh->weight[c] * (trial->residual[c] * trial->residual[c]);
    }
  }
  for (PetscInt c = mesh->num_owned_cells; c < mesh->num_local_cells; c++) trial->residual[c] -= mean;
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) local += part[b];
  PetscCall(MPIU_Allreduce(&local, &trial->squares, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
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

/* All of a trial from its place, with two reductions beside the terms'. Counts one evaluation. Collective. */
PetscErrorCode EqmLmEvaluate(EqmMethod method, EqmTrial *trial)
{
  EqmLm *const lm = method->data;
  const EqmDomain domain = method->problem->domain;
  const EqmMesh mesh = method->problem->mesh;
  PetscReal sum[NUM_SUMS];
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(mesh->ledger, &work));
  work->evaluations++;
  trial->objective = INFINITY; /* PETSC_INFINITY is a finite number */
  PetscCall(EqmImageMeasure(domain, &trial->place, trial->image));
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
  FillResiduals(lm, mesh, trial, sum);
  EqmDomainSumBoundary(domain, &trial->place, sum + BOUNDARY);
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, NUM_SUMS, MPIU_REAL, MPIU_SUM, mesh->comm));
  const PetscBool valid = (PetscBool)(sum[NOT_POSITIVE] == 0. && EqmDomainIsInOrder(domain, sum + BOUNDARY));
  if (valid) PetscCall(SumSquares(mesh, lm->residual->without_mean ? sum[RESIDUAL] : 0., trial));
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  if (valid) PetscCall(EqmLmAddTerms(method, trial));
  PetscFunctionReturn(0);
}
