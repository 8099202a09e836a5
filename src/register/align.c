/* Without landmarks: the rotation of A's map under which A, carried to B, is most like a rigid motion of A. */
#include "register/sample.h"
#include "mesh/mesh_private.h"
#include "geometry/rotation.h"
#include <math.h>

enum { COARSE = 300, FINE = 1500, TRIALS = 300, ANGLES = 180, REFINED = 4, FEW_STEPS = 6, MOST_STEPS = 40 };
/* If the pose's residual, root mean square in radii, is below `good_enough` there is no search; the result of a search
   must be smaller by the factor `better_by`. */
static const PetscReal good_enough = 1e-3, better_by = .5;

/* The rotation by a vector of angles, times the one before: product = exp(angles) rotation. */
static void TurnBy(PetscInt dim, const PetscReal *angles, const PetscReal *rotation, PetscReal *product)
{
  PetscReal turn[9];

  if (dim == 2) {
    turn[0] = turn[3] = PetscCosReal(angles[0]);
    turn[2] = PetscSinReal(angles[0]);
    turn[1] = -turn[2];
  } else { /* from the unit quaternion of half the angle */
    const PetscReal angle = PetscSqrtReal(PetscSqr(angles[0]) + PetscSqr(angles[1]) + PetscSqr(angles[2]));
    const PetscReal s = angle > 0. ? PetscSinReal(.5 * angle) / angle : .5;
    const PetscReal q[4] = {PetscCosReal(.5 * angle), s * angles[0], s * angles[1], s * angles[2]};
    EqmRotationOfQuaternion(q, turn);
  }
  for (PetscInt i = 0; i < dim; i++) {
    for (PetscInt j = 0; j < dim; j++) {
      product[dim * i + j] = 0.;
      for (PetscInt k = 0; k < dim; k++) product[dim * i + j] += turn[dim * i + k] * rotation[dim * k + j];
    }
  }
}

/* x <- A^-1 x, A positive definite, n <= 3, by elimination. */
static void SolveSmall(PetscInt n, PetscReal a[3][3], PetscReal x[3])
{
  for (PetscInt k = 0; k < n; k++) {
    for (PetscInt i = k + 1; i < n; i++) {
      const PetscReal factor = a[i][k] / a[k][k];
      for (PetscInt j = k; j < n; j++) a[i][j] -= factor * a[k][j];
      x[i] -= factor * x[k];
    }
  }
  for (PetscInt k = n - 1; k >= 0; k--) {
    for (PetscInt j = k + 1; j < n; j++) x[k] -= a[k][j] * x[j];
    x[k] /= a[k][k];
  }
}

/* The Gauss-Newton step in the rotation's angles, derivatives by differences. */
static PetscErrorCode FindStep(const EqmSample *s, const PetscReal *rotation, const PetscReal *residual,
                               PetscReal delta, PetscReal step[3])
{
  const PetscInt n = s->dim == 2 ? 1 : 3, length = 3 * s->count, size = s->dim * s->dim;
  PetscReal *about, normal[3][3] = {{0.}}, sums[12] = {0.}, turned[6 * 9], squares[6];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(2 * n * length, &about));
  for (PetscInt k = 0; k < 2 * n; k++) { /* central differences in each angle */
    PetscReal angles[3] = {0., 0., 0.};
    angles[k / 2] = k % 2 ? -delta : delta;
    TurnBy(s->dim, angles, rotation, turned + size * k);
  }
  PetscCall(EqmSampleResiduals(s, 2 * n, turned, about, squares));
  for (PetscInt k = 0; k < length; k++) {
    PetscReal slope[3];
    for (PetscInt a = 0; a < n; a++)
      slope[a] = (about[2 * a * length + k] - about[(2 * a + 1) * length + k]) / (2. * delta);
    for (PetscInt a = 0; a < n; a++) {
      sums[9 + a] -= slope[a] * residual[k];
      for (PetscInt b = 0; b < n; b++) sums[3 * a + b] += slope[a] * slope[b];
    }
  }
  PetscCall(PetscFree(about));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sums, 12, MPIU_REAL, MPIU_SUM, s->r->comm));
  for (PetscInt a = 0; a < n; a++) {
    for (PetscInt b = 0; b < n; b++) normal[a][b] = sums[3 * a + b] + (a == b ? 1e-12 : 0.);
    step[a] = sums[9 + a];
  }
  SolveSmall(n, normal, step);
  PetscFunctionReturn(0);
}

/* The longest of the step, its half, its quarter, ... that reduces the sum of squares, evaluated together. `step` zero
   if none does. */
static PetscErrorCode ShortenStep(const EqmSample *s, PetscReal *rotation, PetscReal *residual, PetscReal *squares,
                                  PetscReal step[3])
{
  enum { HALVINGS = 6 };
  const PetscInt length = 3 * s->count, size = s->dim * s->dim;
  PetscReal *trial, turned[HALVINGS * 9], attained[HALVINGS], scale = 1.;
  PetscInt taken = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(HALVINGS * length, &trial));
  for (PetscInt k = 0; k < HALVINGS; k++, scale *= .5) {
    const PetscReal angles[3] = {scale * step[0], scale * step[1], scale * step[2]};
    TurnBy(s->dim, angles, rotation, turned + size * k);
  }
  PetscCall(EqmSampleResiduals(s, HALVINGS, turned, trial, attained));
  while (taken < HALVINGS && !(attained[taken] < *squares)) taken++;
  if (taken < HALVINGS) {
    *squares = attained[taken];
    PetscCall(PetscArraycpy(rotation, turned + size * taken, size));
    PetscCall(PetscArraycpy(residual, trial + length * taken, length));
  }
  scale = taken < HALVINGS ? PetscPowReal(.5, (PetscReal)taken) : 0.;
  for (PetscInt a = 0; a < 3; a++) step[a] *= scale;
  PetscCall(PetscFree(trial));
  PetscFunctionReturn(0);
}

/* Gauss-Newton with halving from `rotation` on. */
static PetscErrorCode Refine(const EqmSample *s, PetscInt most_steps, PetscReal *rotation, PetscReal *squares)
{
  PetscReal *residual, delta = 1e-2;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * s->count, &residual));
  PetscCall(EqmSampleResiduals(s, 1, rotation, residual, squares));
  for (PetscInt it = 0; it < most_steps; it++) {
    PetscReal step[3] = {0., 0., 0.}, longest;
    PetscCall(FindStep(s, rotation, residual, delta, step));
    PetscCall(ShortenStep(s, rotation, residual, squares, step));
    longest = PetscMax(PetscAbsReal(step[0]), PetscMax(PetscAbsReal(step[1]), PetscAbsReal(step[2])));
    if (longest > 0. && longest < 1e-14) break;
    if (longest == 0. && delta <= 1e-7) break;
    delta = PetscMax(1e-7, longest > 0. ? PetscMin(delta, .1 * longest) : .01 * delta);
  }
  PetscCall(PetscFree(residual));
  PetscFunctionReturn(0);
}

/* Trial number i: evenly spaced angles, or rotations along a super-Fibonacci spiral (Alexa 2022). */
static void TrialRotation(PetscInt dim, PetscInt i, PetscReal *rotation)
{
  if (dim == 2) {
    const PetscReal identity[4] = {1., 0., 0., 1.}, angle = 2. * PETSC_PI * i / ANGLES;
    TurnBy(2, &angle, identity, rotation);
  } else {
    const PetscReal t = (i + .5) / TRIALS, a = 2. * PETSC_PI * (i + .5) / PETSC_SQRT2,
                    b = 2. * PETSC_PI * (i + .5) / 1.533751168755204288118041;
    const PetscReal q[4] = {PetscSqrtReal(t) * PetscSinReal(a), PetscSqrtReal(t) * PetscCosReal(a),
                            PetscSqrtReal(1. - t) * PetscSinReal(b), PetscSqrtReal(1. - t) * PetscCosReal(b)};
    EqmRotationOfQuaternion(q, rotation);
  }
}

/* Try many rotations on a coarse sample, refine the best few there, and the best of these on the fine sample. */
static PetscErrorCode Search(EqmRegistration r, const EqmSample *fine, PetscReal *best, PetscReal *squares)
{
  const PetscInt trials = r->dim == 2 ? ANGLES : TRIALS, size = r->dim * r->dim;
  PetscReal *rotations, *residuals, *value, least = INFINITY;
  PetscInt *number;
  EqmSample coarse;

  PetscFunctionBegin;
  PetscCall(EqmSampleCreate(r, COARSE, &coarse));
  PetscCall(
      PetscMalloc4(size * trials, &rotations, 3 * coarse.count * trials, &residuals, trials, &value, trials, &number));
  for (PetscInt i = 0; i < trials; i++) {
    TrialRotation(r->dim, i, rotations + size * i);
    number[i] = i;
  }
  PetscCall(EqmSampleResiduals(&coarse, trials, rotations, residuals, value));
  PetscCall(PetscSortRealWithArrayInt(trials, value, number));
  for (PetscInt k = 0; k < PetscMin(REFINED, trials); k++) {
    PetscReal *const rotation = rotations + size * number[k], attained;
    PetscCall(Refine(&coarse, FEW_STEPS, rotation, &attained));
    if (attained >= least) continue;
    least = attained;
    PetscCall(PetscArraycpy(best, rotation, size));
  }
  PetscCall(PetscFree4(rotations, residuals, value, number));
  PetscCall(EqmSampleDestroy(&coarse));
  PetscCall(Refine(fine, MOST_STEPS, best, squares));
  PetscFunctionReturn(0);
}

/* 003 section 7: g = argmin sum vol(v) |g f(v) - v|^2, v about the centroid. */
static PetscErrorCode RotationOfPose(EqmRegistration r, const EqmSide *side, PetscReal *rotation)
{
  const EqmMesh mesh = side->mesh;
  PetscReal mean[3] = {0., 0., 0.}, correlation[9] = {0.};

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt k = 0; k < 3; k++) mean[k] += side->weight[v] * mesh->position[3 * v + k];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, mean, 3, MPIU_REAL, MPIU_SUM, r->comm));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt k = 0; k < 9; k++)
      correlation[k] += side->weight[v] * (mesh->position[3 * v + k / 3] - mean[k / 3]) * side->x[3 * v + k % 3];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, correlation, 9, MPIU_REAL, MPIU_SUM, r->comm));
  PetscCall(EqmBestRotation(3, correlation, rotation));
  PetscFunctionReturn(0);
}

/* h = g_B^-1 g_A. */
static PetscErrorCode Pose(EqmRegistration r, PetscReal *rotation)
{
  PetscReal a[9], b[9];

  PetscFunctionBegin;
  PetscCall(RotationOfPose(r, &r->a, a));
  PetscCall(RotationOfPose(r, &r->b, b));
  for (PetscInt i = 0; i < 3; i++) {
    for (PetscInt j = 0; j < 3; j++) {
      rotation[3 * i + j] = 0.;
      for (PetscInt k = 0; k < 3; k++) rotation[3 * i + j] += b[3 * k + i] * a[3 * k + j];
    }
  }
  PetscFunctionReturn(0);
}

/* The pose if its residual is small, else the better of pose and search. */
static PetscErrorCode Choose(EqmRegistration r, PetscReal *rotation)
{
  const PetscBool planar = (PetscBool)(r->dim == 2);
  PetscReal *residual, posed = INFINITY, searched = INFINITY, found[9];
  EqmSample s;

  PetscFunctionBegin;
  PetscCall(EqmSampleCreate(r, FINE, &s));
  PetscCall(PetscMalloc1(3 * s.count, &residual));
  if (!planar) PetscCall(Pose(r, rotation));
  if (!planar) PetscCall(EqmSampleResiduals(&s, 1, rotation, residual, &posed));
  if (PetscSqrtReal(posed) > good_enough || r->set.align == EQM_ALIGN_SHAPE) PetscCall(Search(r, &s, found, &searched));
  if (r->set.align == EQM_ALIGN_SHAPE || PetscSqrtReal(searched) < better_by * PetscSqrtReal(posed))
    PetscCall(PetscArraycpy(rotation, found, r->dim * r->dim));
  PetscCall(PetscFree(residual));
  PetscCall(EqmSampleDestroy(&s));
  PetscFunctionReturn(0);
}

/* Rotate A's map. Collective. */
PetscErrorCode EqmAlign(EqmRegistration r)
{
  PetscReal rotation[9];

  PetscFunctionBegin;
  if (r->set.align == EQM_ALIGN_NONE) PetscFunctionReturn(0);
  if (r->set.align == EQM_ALIGN_POSE)
    PetscCall(Pose(r, rotation));
  else
    PetscCall(Choose(r, rotation));
  EqmRotate(r->dim, rotation, r->a.mesh->num_local, r->a.x);
  PetscFunctionReturn(0);
}
