/* Landmark flows: they arrive, keep areas, and keep the circle. */
#include "support/testing.h"
#include "register/landmark_flow.h"

enum { LANDMARKS = 6, POINTS = 40 };

/* A point of the target at random, not too close to the circle. */
static void RandomPoint(PetscInt dim, PetscInt seed, PetscInt number, PetscReal *x)
{
  PetscReal squared = 0.;

  for (PetscInt k = 0; k < dim; k++) {
    x[k] = .6 * TestRandom(seed, number, k);
    squared += x[k] * x[k];
  }
  for (PetscInt k = 0; k < dim && dim == 3; k++) x[k] /= PetscSqrtReal(squared);
}

/* Two directions at right angles in the plane or the tangent plane of x. */
static void Tangents(PetscInt dim, const PetscReal *x, PetscReal u[3], PetscReal v[3])
{
  PetscReal length = 0.;

  u[0] = dim == 2 ? 1. : -x[1];
  u[1] = dim == 2 ? 0. : x[0];
  u[2] = 0.;
  for (PetscInt k = 0; k < 3; k++) length += u[k] * u[k];
  for (PetscInt k = 0; k < 3; k++) u[k] /= PetscSqrtReal(length);
  v[0] = dim == 2 ? 0. : -x[2] * u[1];
  v[1] = dim == 2 ? 1. : x[2] * u[0];
  v[2] = dim == 2 ? 0. : x[0] * u[1] - x[1] * u[0];
}

/* Area of the parallelogram that a small square around each point becomes, over what it was: by differences. */
static PetscErrorCode TestFlow(PetscInt dim)
{
  const PetscReal h = 1e-4;
  PetscReal from[3 * LANDMARKS], to[3 * LANDMARKS], x[4 * 3 * POINTS + 3 * LANDMARKS], left, moved = 0.;
  PetscReal *const end = x + 4 * dim * POINTS;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < LANDMARKS; i++) {
    PetscReal squared = 0.;
    RandomPoint(dim, 1, i, from + dim * i);
    for (PetscInt k = 0; k < dim; k++) {
      to[dim * i + k] = from[dim * i + k] + .15 * TestRandom(2, i, k);
      squared += PetscSqr(to[dim * i + k]);
    }
    for (PetscInt k = 0; k < dim && dim == 3; k++) to[dim * i + k] /= PetscSqrtReal(squared);
  }
  for (PetscInt p = 0; p < POINTS; p++) {
    PetscReal at[3] = {0.}, u[3], v[3];
    RandomPoint(dim, 3, p, at);
    Tangents(dim, at, u, v);
    for (PetscInt c = 0; c < 4; c++) {
      PetscReal squared = 0., *const y = x + dim * (4 * p + c);
      for (PetscInt k = 0; k < dim; k++) {
        y[k] = at[k] + h * (c % 2 ? 1. : -1.) * (c < 2 ? u[k] : v[k]);
        squared += y[k] * y[k];
      }
      for (PetscInt k = 0; k < dim && dim == 3; k++) y[k] /= PetscSqrtReal(squared);
    }
  }
  PetscCall(PetscArraycpy(end, from, dim * LANDMARKS));
  PetscCall(EqmLandmarkFlow(dim, .5, LANDMARKS, from, to, 4 * POINTS + LANDMARKS, x, &left));
  CHECK(left < 1e-10, "the landmarks are %g from their places", (double)left);
  for (PetscInt k = 0; k < dim * LANDMARKS; k++) CHECK_CLOSE(end[k], to[k], 1e-10, 1.);
  for (PetscInt p = 0; p < POINTS; p++) {
    const PetscReal *const y = x + 4 * dim * p;
    PetscReal u[3] = {0.}, v[3] = {0.}, n[3], area;
    for (PetscInt k = 0; k < dim; k++) {
      u[k] = (y[dim + k] - y[k]) / (2. * h);
      v[k] = (y[3 * dim + k] - y[2 * dim + k]) / (2. * h);
      moved = PetscMax(moved, PetscAbsReal(u[k]) + PetscAbsReal(v[k]));
    }
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    area = PetscSqrtReal(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    CHECK_CLOSE(area, 1., 5e-5, 1.); /* what the integration leaves */
  }
  CHECK(moved > 1.2, "nothing is stretched (%g): the test sees no flow", (double)moved);
  PetscFunctionReturn(0);
}

/* Points of the circle glide along it, and a landmark on it with them. */
static PetscErrorCode TestCircle(void)
{
  PetscReal from[4] = {1., 0., .2, .3}, to[4] = {0., 0., .4, .1}, x[2 * POINTS], left, farthest = 0.;

  PetscFunctionBegin;
  to[0] = PetscCosReal(.2);
  to[1] = PetscSinReal(.2);
  for (PetscInt p = 0; p < POINTS; p++) {
    x[2 * p] = PetscCosReal(2. * PETSC_PI * p / POINTS);
    x[2 * p + 1] = PetscSinReal(2. * PETSC_PI * p / POINTS);
  }
  PetscCall(EqmLandmarkFlow(2, .5, 2, from, to, POINTS, x, &left));
  CHECK(left < .01, "the landmarks are %g from their places", (double)left);
  for (PetscInt p = 0; p < POINTS; p++) {
    const PetscReal *const y = x + 2 * p, *const z = x + 2 * ((p + 1) % POINTS);
    CHECK_CLOSE(y[0] * y[0] + y[1] * y[1], 1., 1e-14, 1.);
    CHECK(y[0] * z[1] - y[1] * z[0] > 0., "the circle is out of order at point %d", (int)p);
    farthest = PetscMax(farthest, PetscAbsReal(y[0] - PetscCosReal(2. * PETSC_PI * p / POINTS)));
  }
  CHECK(farthest > .01, "the circle does not move");
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestFlow(2));
  PetscCall(TestFlow(3));
  PetscCall(TestCircle());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
