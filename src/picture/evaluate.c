/* What a page shows of a result beyond what is stored. */
#include "picture/picture.h"
#include "geometry/simplex.h"
#include "measure/quantile.h"
#include "measure/weighted.h"
#include <math.h>
#include <string.h>

PetscBool EqmResultIsConformal(const EqmResult *result)
{
  return (PetscBool)(!strcmp(result->command, "conformal") && result->quasi_conformal != NULL);
}

PetscBool EqmResultHasGradient(const EqmResult *result)
{
  PetscInt count = 0;

  for (PetscInt k = 0; k < result->num_history && result->gradient; k++) count += result->gradient[k] > 0.;
  return (PetscBool)(count > 1);
}

void EqmResultCurve(const EqmResult *result, EqmCurve curve, double *values)
{
  const PetscReal *const energy = result->energy;
  PetscReal smallest = PETSC_MAX_REAL;

  for (PetscInt k = 0; k < result->num_history; k++) smallest = PetscMin(smallest, energy[k]);
  for (PetscInt k = 0; k < result->num_history; k++) {
    if (curve == EQM_CURVE_GRADIENT)
      values[k] = result->gradient && result->gradient[k] > 0. ? result->gradient[k] : NAN;
    else if (curve == EQM_CURVE_EXCESS)
      values[k] = energy[k] > smallest ? energy[k] - smallest : NAN;
    else
      values[k] = energy[k];
  }
}

const char *EqmCurveName(EqmCurve curve)
{
  if (curve == EQM_CURVE_GRADIENT) return "norm of the gradient";
  return curve == EQM_CURVE_EXCESS ? "energy above its smallest value" : "energy E";
}

/* Weights of cells: their measure times the density, which multiplies `weight` already. */
static void MultiplyByMeasure(EqmResult *result)
{
  for (PetscInt c = 0; c < result->num_cells; c++) {
    const PetscInt *const v = result->cells + result->cell_size * c;
    const PetscReal *const p = result->vertices + 3 * v[0], *const q = result->vertices + 3 * v[1],
                           *const r = result->vertices + 3 * v[2];
    const PetscReal measure =
        result->cell_size == 3 ? EqmArea3(p, q, r) : PetscAbsReal(EqmVolume(p, q, r, result->vertices + 3 * v[3]));
    result->weight[c] *= measure;
  }
}

/* Ratios of maps to the sphere are of areas without signs. Give folded triangles, which are those that look inward, or
   outward where most look inward, a negative ratio, as those in the plane have. */
static void SignRatios(EqmResult *result)
{
  PetscInt outward = 0;

  if (result->cell_size == 4 || result->dim == 2 || result->target) return;
  for (int pass = 0; pass < 2; pass++) {
    for (PetscInt c = 0; c < result->num_cells; c++) {
      const PetscInt *const v = result->cells + 3 * c;
      const PetscBool out =
          (PetscBool)(EqmHalfDet(result->images + 3 * v[0], result->images + 3 * v[1], result->images + 3 * v[2]) > 0.);
      if (pass == 0)
        outward += out ? 1 : -1;
      else if (out != (PetscBool)(outward > 0))
        result->ratio[c] = -PetscAbsReal(result->ratio[c]);
    }
  }
}

/* How bad a cell is: folded cells, of negative ratio, come first, then those that are distorted most. */
static double BadnessOf(const EqmResult *result, PetscInt c)
{
  const double r = result->ratio[c];

  if (!(r > 0.)) return 1e300;
  return EqmResultIsConformal(result) ? result->quasi_conformal[c] : fabs(log(r));
}

/* The worst cells, by insertion into a short list. */
static void FindMarks(EqmResult *result)
{
  double badness[EQM_NUM_MARKS];

  result->num_marks = 0;
  for (PetscInt c = 0; c < result->num_cells; c++) {
    const double bad = BadnessOf(result, c);
    PetscInt k = result->num_marks;
    if (k == EQM_NUM_MARKS && !(bad > badness[k - 1])) continue;
    if (k < EQM_NUM_MARKS) result->num_marks++;
    for (k = result->num_marks - 1; k > 0 && bad > badness[k - 1]; k--) {
      badness[k] = badness[k - 1];
      result->mark[k] = result->mark[k - 1];
    }
    badness[k] = bad;
    result->mark[k] = c;
  }
}

static PetscErrorCode ComputeDistances(EqmResult *result)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(result->num_vertices, &result->distance));
  for (PetscInt v = 0; v < result->num_vertices; v++) {
    const PetscReal *const p = result->vertices + 3 * v, *const q = result->images + 3 * v;
    result->distance[v] = PetscSqrtReal(PetscSqr(q[0] - p[0]) + PetscSqr(q[1] - p[1]) + PetscSqr(q[2] - p[2]));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmResultEvaluate(EqmResult *result)
{
  const PetscInt n = result->num_cells;
  PetscReal *sample;

  PetscFunctionBegin;
  MultiplyByMeasure(result);
  PetscCall(PetscMalloc1(n, &sample));
  PetscCall(PetscArraycpy(sample, result->ratio, n));
  PetscCall(EqmStatisticsOf(PETSC_COMM_SELF, n, sample, &result->ratio_statistics));
  PetscCall(PetscFree(sample));
  PetscCall(EqmWeightedRatioOf(PETSC_COMM_SELF, n, result->ratio, result->weight, &result->weighted));
  SignRatios(result);
  FindMarks(result);
  if (result->target && result->other_file[0]) PetscCall(ComputeDistances(result));
  PetscFunctionReturn(0);
}
