/* Mobius maps of the sphere: conformal maps are unique up to these (004 section 2.1). */
#include <equimap/domain.h>
#include "domain/domain_private.h"
#include "geometry/simplex.h"

/* Longest shift of one step of centring: longer ones move nearly all vertices to one side. */
#define LONGEST_SHIFT .5

PetscErrorCode EqmPlaceShift(EqmDomain domain, const PetscReal c[3], EqmPlace *place)
{
  const PetscReal keep = 1. - EqmDot3(c, c);

  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) {
    PetscReal *const x = place->x + 3 * v;
    const PetscReal y[3] = {x[0] + c[0], x[1] + c[1], x[2] + c[2]}, scale = keep / EqmDot3(y, y);
    PetscReal length = 0.;
    for (PetscInt k = 0; k < 3; k++) {
      x[k] = scale * y[k] + c[k];
      length += x[k] * x[k];
    }
    length = PetscSqrtReal(length); /* one up to rounding, which must not accumulate */
    for (PetscInt k = 0; k < 3; k++) x[k] /= length;
  }
  PetscCall(EqmPlaceMakeFrames(domain, place));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPlaceMassCenter(EqmDomain domain, const PetscReal *mass, const EqmPlace *place, PetscReal center[3])
{
  PetscReal sum[3] = {0., 0., 0.};

  PetscFunctionBegin;
  for (PetscInt v = 0; v < domain->mesh->num_owned; v++) {
    for (PetscInt k = 0; k < 3; k++) sum[k] += mass[v] * place->x[3 * v + k];
  }
  PetscCall(MPIU_Allreduce(sum, center, 3, MPIU_REAL, MPIU_SUM, domain->mesh->comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPlaceOntoSphere(EqmDomain domain, const PetscReal center[3], EqmPlace *place)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < domain->mesh->num_owned; v++) {
    PetscReal *const x = place->x + 3 * v, length;
    for (PetscInt k = 0; k < 3; k++) x[k] -= center[k];
    length = PetscSqrtReal(EqmDot3(x, x));
    for (PetscInt k = 0; k < 3; k++) x[k] = length > 0. ? x[k] / length : (k == 2 ? 1. : 0.);
  }
  PetscCall(EqmMeshUpdateGhosts(domain->mesh, 3, place->x));
  PetscCall(EqmPlaceMakeFrames(domain, place));
  PetscFunctionReturn(0);
}

/* Newton's step for the shift that centres: -[2 (I - sum m x x^T)]^-1 center, no longer than LONGEST_SHIFT. */
static PetscErrorCode CenteringShift(EqmDomain domain, const PetscReal *mass, const EqmPlace *place,
                                     const PetscReal center[3], PetscReal shift[3])
{
  PetscReal local[9] = {0.}, moment[9], row[9], cofactor[9], determinant, length;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < domain->mesh->num_owned; v++) {
    const PetscReal *const x = place->x + 3 * v;
    for (PetscInt k = 0; k < 9; k++) local[k] += mass[v] * x[k / 3] * x[k % 3];
  }
  PetscCall(MPIU_Allreduce(local, moment, 9, MPIU_REAL, MPIU_SUM, domain->mesh->comm));
  for (PetscInt k = 0; k < 9; k++) row[k] = 2. * ((k % 4 == 0 ? 1. : 0.) - moment[k]);
  for (PetscInt k = 0; k < 3; k++) EqmCross(row + 3 * ((k + 1) % 3), row + 3 * ((k + 2) % 3), cofactor + 3 * k);
  determinant = EqmDot3(row, cofactor);
  for (PetscInt k = 0; k < 3; k++) { /* the matrix is symmetric: so are its cofactors */
    shift[k] = determinant > 0. ? -EqmDot3(cofactor + 3 * k, center) / determinant : -center[k];
  }
  length = PetscSqrtReal(EqmDot3(shift, shift));
  for (PetscInt k = 0; k < 3 && length > LONGEST_SHIFT; k++) shift[k] *= LONGEST_SHIFT / length;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPlaceCenter(EqmDomain domain, const PetscReal *mass, EqmPlace *place, PetscReal *offset)
{
  enum { MOST_STEPS = 100, MOST_CUTS = 20 };
  const PetscReal tolerance = 1e-14;
  PetscReal center[3], shift[3];
  EqmPlace trial;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(domain, &trial));
  PetscCall(EqmPlaceMassCenter(domain, mass, place, center));
  *offset = PetscSqrtReal(EqmDot3(center, center));
  for (PetscInt step = 0; step < MOST_STEPS && (*offset) > tolerance; step++) {
    PetscReal distance = PETSC_MAX_REAL;
    PetscCall(CenteringShift(domain, mass, place, center, shift));
    for (PetscInt cut = 0; cut < MOST_CUTS && !(distance < *offset); cut++) {
      PetscCall(EqmPlaceCopy(domain, place, &trial));
      PetscCall(EqmPlaceShift(domain, shift, &trial));
      PetscCall(EqmPlaceMassCenter(domain, mass, &trial, center));
      distance = PetscSqrtReal(EqmDot3(center, center));
      for (PetscInt k = 0; k < 3; k++) shift[k] *= .5;
    }
    if (!(distance < *offset)) break;
    PetscCall(EqmPlaceCopy(domain, &trial, place));
    *offset = distance;
  }
  PetscCall(EqmPlaceDestroy(&trial));
  PetscFunctionReturn(0);
}
