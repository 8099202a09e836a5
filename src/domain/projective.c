#include "domain/projective.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"
#include "geometry/rotation.h"

/* Homogeneous coordinates (u, v) of a point of the sphere, by the one of two formulas that does not cancel. */
static void ToProjective(const PetscReal x[3], double complex w[2])
{
  const double complex z = x[0] + I * x[1];

  w[0] = x[2] <= 0. ? z : 1. + x[2];
  w[1] = x[2] <= 0. ? 1. - x[2] : conj(z);
}

static PetscReal Squared(double complex z)
{
  return PetscSqr(creal(z)) + PetscSqr(cimag(z));
}

void EqmMoebiusApply(const EqmMoebius *map, const PetscReal x[3], PetscReal y[3])
{
  double complex w[2];

  ToProjective(x, w);
  const double complex u = map->m[0] * w[0] + map->m[1] * w[1], v = map->m[2] * w[0] + map->m[3] * w[1],
                       across = u * conj(v);
  const PetscReal up = Squared(u), down = Squared(v);
  y[0] = 2. * creal(across) / (up + down);
  y[1] = 2. * cimag(across) / (up + down);
  y[2] = (up - down) / (up + down);
}

EqmMoebius EqmMoebiusProduct(const EqmMoebius *a, const EqmMoebius *b)
{
  EqmMoebius product;

  for (int k = 0; k < 4; k++) product.m[k] = a->m[k - k % 2] * b->m[k % 2] + a->m[k - k % 2 + 1] * b->m[2 + k % 2];
  return product;
}

static double complex Det(const double complex a[2], const double complex b[2])
{
  return a[0] * b[1] - a[1] * b[0];
}

/* The map that takes the points to 0, 1 and infinity. */
static EqmMoebius ToStandard(const PetscReal p[9])
{
  double complex a[2], b[2], c[2];

  ToProjective(p, a);
  ToProjective(p + 3, b);
  ToProjective(p + 6, c);
  const double complex s = Det(b, c), t = Det(b, a); /* u = s det(w, a), v = t det(w, c) */
  return (EqmMoebius){{s * a[1], -s * a[0], t * c[1], -t * c[0]}};
}

EqmMoebius EqmMoebiusThrough(const PetscReal p[9], const PetscReal q[9])
{
  const EqmMoebius there = ToStandard(p), back = ToStandard(q);
  const EqmMoebius inverse = {{back.m[3], -back.m[1], -back.m[2], back.m[0]}};

  return EqmMoebiusProduct(&inverse, &there);
}

/* exp A for A = 1/2 (dilation + i rotation) . s with Pauli's matrices s, the second of them conjugate as our v is: A^2
   is a multiple of the identity. */
EqmMoebius EqmMoebiusExponential(const PetscReal rotation[3], const PetscReal dilation[3])
{
  double complex a[3], square = 0., even = 1., odd = 1.;

  for (int k = 0; k < 3; k++) {
    a[k] = .5 * (dilation[k] + I * rotation[k]);
    square += a[k] * a[k];
  }
  if (Squared(square) > 0.) {
    const double complex root = csqrt(square);
    even = ccosh(root);
    odd = csinh(root) / root;
  }
  return (EqmMoebius){{even + odd * a[2], odd * (a[0] + I * a[1]), odd * (a[0] - I * a[1]), even - odd * a[2]}};
}

PetscErrorCode EqmPlaceTransform(EqmDomain domain, const EqmMoebius *map, EqmPlace *place)
{
  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) EqmMoebiusApply(map, place->x + 3 * v, place->x + 3 * v);
  PetscCall(EqmPlaceMakeFrames(domain, place));
  PetscFunctionReturn(0);
}

/* The rotation that brings the points x as close to q as a rotation can. */
static PetscErrorCode BestRotation(PetscInt count, const PetscReal *x, const PetscReal *q, EqmMoebius *map)
{
  static const PetscReal axes[9] = {1., 0., 0., 0., 1., 0., 0., 0., 1.};
  PetscReal correlation[9] = {0.}, rotation[9], turned[9];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 9 * count; k++) correlation[k % 9] += q[3 * (k / 9) + k % 9 / 3] * x[3 * (k / 9) + k % 3];
  PetscCall(EqmBestRotation(3, correlation, rotation));
  for (int k = 0; k < 9; k++) turned[k] = rotation[3 * (k % 3) + k / 3];
  *map = EqmMoebiusThrough(axes, turned);
  PetscFunctionReturn(0);
}

static PetscReal Distance2(PetscInt count, const EqmMoebius *map, const PetscReal *x, const PetscReal *q)
{
  PetscReal sum = 0.;

  for (PetscInt i = 0; i < count; i++) {
    PetscReal y[3];
    EqmMoebiusApply(map, x + 3 * i, y);
    for (int k = 0; k < 3; k++) sum += PetscSqr(y[k] - q[3 * i + k]);
  }
  return sum;
}

/* Normal equations of the six fields' least-squares fit to q - y: matrix (lower and upper) and right-hand side. */
static void NormalEquations(PetscInt count, const EqmMoebius *map, const PetscReal *x, const PetscReal *q,
                            PetscReal h[6][6], PetscReal b[6])
{
  for (int i = 0; i < 36; i++) h[i / 6][i % 6] = 0.;
  for (int i = 0; i < 6; i++) b[i] = 0.;
  for (PetscInt p = 0; p < count; p++) {
    PetscReal y[3], field[6][3];
    EqmMoebiusApply(map, x + 3 * p, y);
    for (int k = 0; k < 3; k++) {
      const PetscReal axis[3] = {k == 0, k == 1, k == 2};
      EqmCross(axis, y, field[k]);
      for (int c = 0; c < 3; c++) field[3 + k][c] = axis[c] - y[k] * y[c];
    }
    for (int i = 0; i < 6; i++) {
      for (int c = 0; c < 3; c++) b[i] += field[i][c] * (q[3 * p + c] - y[c]);
      for (int j = 0; j < 6; j++) h[i][j] += EqmDot3(field[i], field[j]);
    }
  }
}

/* Solve the positive definite system (H + damping I) s = b by elimination. */
static void SolveDamped(PetscReal h[6][6], PetscReal damping, PetscReal b[6])
{
  for (int i = 0; i < 6; i++) h[i][i] += damping;
  for (int i = 0; i < 6; i++) {
    for (int r = i + 1; r < 6; r++) {
      const PetscReal factor = h[r][i] / h[i][i];
      for (int c = i; c < 6; c++) h[r][c] -= factor * h[i][c];
      b[r] -= factor * b[i];
    }
  }
  for (int i = 5; i >= 0; i--) {
    for (int c = i + 1; c < 6; c++) b[i] -= h[i][c] * b[c];
    b[i] /= h[i][i];
  }
}

/* Levenberg-Marquardt in the group, from the best rotation. */
PetscErrorCode EqmMoebiusAlign(PetscInt count, const PetscReal *x, const PetscReal *q, PetscBool rigid, EqmMoebius *map,
                               PetscReal *distance)
{
  enum { MOST_STEPS = 200 };
  PetscReal now, damping = 1e-2;

  PetscFunctionBegin;
  PetscCall(BestRotation(count, x, q, map));
  now = Distance2(count, map, x, q);
  for (PetscInt step = 0; step < MOST_STEPS && !rigid && count >= 3 && damping < 1e8; step++) {
    PetscReal h[6][6], move[6];
    NormalEquations(count, map, x, q, h, move);
    SolveDamped(h, damping, move);
    const EqmMoebius change = EqmMoebiusExponential(move, move + 3), trial = EqmMoebiusProduct(&change, map);
    const PetscReal then = Distance2(count, &trial, x, q);
    const PetscBool small = (PetscBool)(EqmDot3(move, move) + EqmDot3(move + 3, move + 3) < 1e-24);
    if (then < now) {
      *map = trial;
      now = then;
      damping = PetscMax(.1 * damping, 1e-14);
    } else {
      damping *= 10.;
    }
    if (small) break;
  }
  *distance = PetscSqrtReal(now / PetscMax(1, count));
  PetscFunctionReturn(0);
}
