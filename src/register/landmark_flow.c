/* Flows of stream functions (docs/methods.md, Registration). A velocity v = n x grad psi, n the normal of the plane or
   the sphere, has no divergence: its flow keeps areas. Of all stream functions with the wanted velocities at the
   landmarks the one of least norm is taken, in the space of a smooth kernel k; it is a combination of the kernel's
   derivatives at the landmarks. In the disk k carries the factors 1 - |x|^2, so that psi is constant along the circle
   and the flow keeps the disk. */
#include "register/landmark_flow.h"
#include "geometry/simplex.h"
#include <petscmat.h>

enum { LEAST_STEPS = 12, CORRECTIONS = 4 };
static const PetscReal step_length = .02; /* of a landmark, per step of the integration */

typedef struct {
  PetscBool disk;
  PetscReal reach;
  PetscInt num;
  PetscReal *landmark; /* 3 each: positions at the beginning of the step */
  PetscReal *momentum; /* 3 each: psi = sum momentum_j . grad_y k(x, y_j) */
} Flow;

/* grad_x grad_y^T k(x, y), k = b(x) b(y) kappa(|x - y|); kappa the Matern kernel of order 7/2, b = 1 - |x|^2 in the
   disk and 1 on the sphere. */
static void MixedDerivative(const Flow *flow, const PetscReal x[3], const PetscReal y[3], PetscReal m[3][3])
{
  const PetscReal d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]}, square = flow->reach * flow->reach;
  const PetscReal z = PetscSqrtReal(EqmDot3(d, d)) / flow->reach, e = PetscExpReal(-z);
  const PetscReal value = (1. + z * (1. + z * (.4 + z / 15.))) * e;
  const PetscReal slope = -(1. + z * (1. + z / 3.)) * e / (5. * square); /* kappa' / r */
  const PetscReal second_slope = (1. + z) * e / (15. * square * square); /* slope' / r */
  const PetscReal bx = flow->disk ? 1. - EqmDot3(x, x) : 1., by = flow->disk ? 1. - EqmDot3(y, y) : 1.;
  const PetscReal of_b = flow->disk ? -2. : 0.; /* grad b = of_b x */

  for (PetscInt i = 0; i < 3; i++) {
    for (PetscInt j = 0; j < 3; j++) {
      m[i][j] = bx * by * ((i == j ? -slope : 0.) - second_slope * d[i] * d[j]) + of_b * of_b * x[i] * y[j] * value +
                of_b * slope * (bx * d[i] * y[j] - by * x[i] * d[j]);
    }
  }
}

/* n x g at a point. */
static void Turn(const Flow *flow, const PetscReal x[3], const PetscReal g[3], PetscReal turned[3])
{
  const PetscReal up[3] = {0., 0., 1.};

  EqmCross(flow->disk ? up : x, g, turned);
}

static void Velocity(const Flow *flow, const PetscReal x[3], PetscReal v[3])
{
  PetscReal gradient[3] = {0., 0., 0.};

  for (PetscInt j = 0; j < flow->num; j++) {
    PetscReal m[3][3];
    MixedDerivative(flow, x, flow->landmark + 3 * j, m);
    for (PetscInt i = 0; i < 3; i++) gradient[i] += EqmDot3(m[i], flow->momentum + 3 * j);
  }
  Turn(flow, x, gradient, v);
}

/* Project back to the sphere, or to the closed disk in the plane. */
static void Settle(const Flow *flow, PetscBool on_circle, PetscReal x[3])
{
  const PetscReal length = PetscSqrtReal(EqmDot3(x, x));

  if (flow->disk && !on_circle && length <= 1.) return;
  for (PetscInt k = 0; k < 3; k++) x[k] /= length;
}

/* One step of the classical Runge-Kutta method. */
static void Advance(const Flow *flow, PetscReal dt, PetscReal x[3])
{
  static const PetscReal stage[4] = {0., .5, .5, 1.}, weight[4] = {1. / 6., 1. / 3., 1. / 3., 1. / 6.};
  const PetscBool on_circle = (PetscBool)(PetscAbsReal(EqmDot3(x, x) - 1.) < 1e-12);
  PetscReal v[3] = {0., 0., 0.}, sum[3] = {0., 0., 0.};

  for (PetscInt s = 0; s < 4; s++) {
    const PetscReal t = stage[s] * dt, at[3] = {x[0] + t * v[0], x[1] + t * v[1], x[2] + t * v[2]};
    Velocity(flow, at, v);
    for (PetscInt k = 0; k < 3; k++) sum[k] += weight[s] * v[k];
  }
  for (PetscInt k = 0; k < 3; k++) x[k] += dt * sum[k];
  Settle(flow, on_circle, x);
}

/* Two directions in which a landmark can move. */
static void Frame(const Flow *flow, const PetscReal x[3], PetscReal frame[2][3])
{
  PetscReal axis[3] = {0., 0., 0.}, length;
  PetscInt smallest = 0;

  if (flow->disk) {
    for (PetscInt a = 0; a < 2; a++) {
      for (PetscInt k = 0; k < 3; k++) frame[a][k] = k == a;
    }
    return;
  }
  for (PetscInt k = 1; k < 3; k++) smallest = PetscAbsReal(x[k]) < PetscAbsReal(x[smallest]) ? k : smallest;
  axis[smallest] = 1.;
  EqmCross(x, axis, frame[0]);
  length = PetscSqrtReal(EqmDot3(frame[0], frame[0]));
  for (PetscInt k = 0; k < 3; k++) frame[0][k] /= length;
  EqmCross(x, frame[0], frame[1]);
}

/* The velocity at x of the straight line or great circle that arrives at q after unit time; returns its length. */
static PetscReal Towards(const Flow *flow, const PetscReal x[3], const PetscReal q[3], PetscReal v[3])
{
  PetscReal normal[3], angle, sine;

  if (flow->disk) {
    for (PetscInt k = 0; k < 3; k++) v[k] = q[k] - x[k];
    return PetscSqrtReal(EqmDot3(v, v));
  }
  EqmCross(x, q, normal);
  sine = PetscSqrtReal(EqmDot3(normal, normal));
  angle = PetscAtan2Real(sine, EqmDot3(x, q));
  EqmCross(normal, x, v);
  for (PetscInt k = 0; k < 3; k++) v[k] *= sine > 0. ? angle / sine : 0.;
  return angle;
}

/* b <- gram^-1 b, gram positive definite but for landmarks on the circle, which can only move along it. */
static PetscErrorCode SolveDense(PetscInt n, PetscReal *gram, PetscReal *b)
{
  PetscReal trace = 0.;
  Mat matrix;
  Vec right, left;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) trace += gram[(size_t)n * k + k];
  for (PetscInt k = 0; k < n; k++) gram[(size_t)n * k + k] += 1e-10 * trace / n;
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, n, n, gram, &matrix));
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, b, &right));
  PetscCall(VecDuplicate(right, &left));
  PetscCall(MatSetOption(matrix, MAT_SPD, PETSC_TRUE));
  PetscCall(MatCholeskyFactor(matrix, NULL, NULL));
  PetscCall(MatSolve(matrix, right, left));
  PetscCall(VecCopy(left, right));
  PetscCall(VecDestroy(&left));
  PetscCall(VecDestroy(&right));
  PetscCall(MatDestroy(&matrix));
  PetscFunctionReturn(0);
}

/* The momenta whose field has the velocities that lead to `to` in the time that remains. */
static PetscErrorCode FindMomenta(Flow *flow, const PetscReal *to, PetscReal remaining)
{
  const PetscInt n = 2 * flow->num;
  PetscReal *gram, *b;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2((size_t)n * n, &gram, n, &b));
  for (PetscInt i = 0; i < flow->num; i++) {
    const PetscReal *const x = flow->landmark + 3 * i;
    PetscReal frame[2][3], v[3], turned[3];
    (void)Towards(flow, x, to + 3 * i, v);
    Turn(flow, x, v, turned); /* n x (n x g) = -g: the gradient that belongs to v is -n x v */
    Frame(flow, x, frame);
    for (PetscInt a = 0; a < 2; a++) b[2 * i + a] = -EqmDot3(frame[a], turned) / remaining;
    for (PetscInt j = 0; j < flow->num; j++) {
      PetscReal m[3][3], other[2][3];
      MixedDerivative(flow, x, flow->landmark + 3 * j, m);
      Frame(flow, flow->landmark + 3 * j, other);
      for (PetscInt k = 0; k < 4; k++) {
        PetscReal sum = 0.;
        for (PetscInt c = 0; c < 3; c++) sum += frame[k / 2][c] * EqmDot3(m[c], other[k % 2]);
        gram[(size_t)n * (2 * j + k % 2) + 2 * i + k / 2] = sum;
      }
    }
  }
  PetscCall(SolveDense(n, gram, b));
  for (PetscInt i = 0; i < flow->num; i++) {
    PetscReal frame[2][3];
    Frame(flow, flow->landmark + 3 * i, frame);
    for (PetscInt k = 0; k < 3; k++) flow->momentum[3 * i + k] = b[2 * i] * frame[0][k] + b[2 * i + 1] * frame[1][k];
  }
  PetscCall(PetscFree2(gram, b));
  PetscFunctionReturn(0);
}

/* One step for all points and the landmarks, whose positions at its beginning are the kernel's centres throughout. */
static PetscErrorCode Step(Flow *flow, const PetscReal *to, PetscReal remaining, PetscReal dt, PetscInt dim,
                           PetscInt count, PetscReal *x)
{
  PetscReal *moved;

  PetscFunctionBegin;
  PetscCall(FindMomenta(flow, to, remaining));
#pragma omp parallel for schedule(static)
  for (PetscInt p = 0; p < count; p++) {
    PetscReal y[3] = {x[dim * p], x[dim * p + 1], dim == 3 ? x[dim * p + 2] : 0.};
    Advance(flow, dt, y);
    for (PetscInt k = 0; k < dim; k++) x[dim * p + k] = y[k];
  }
  PetscCall(PetscMalloc1(3 * flow->num, &moved));
  PetscCall(PetscArraycpy(moved, flow->landmark, 3 * flow->num));
  for (PetscInt i = 0; i < flow->num; i++) Advance(flow, dt, moved + 3 * i);
  PetscCall(PetscFree(flow->landmark));
  flow->landmark = moved;
  PetscFunctionReturn(0);
}

static PetscReal Farthest(const Flow *flow, const PetscReal *to)
{
  PetscReal largest = 0., v[3];

  for (PetscInt i = 0; i < flow->num; i++)
    largest = PetscMax(largest, Towards(flow, flow->landmark + 3 * i, to + 3 * i, v));
  return largest;
}

PetscErrorCode EqmLandmarkFlow(PetscInt dim, PetscReal reach, PetscInt num, const PetscReal *from, const PetscReal *to,
                               PetscInt count, PetscReal *x, PetscReal *left)
{
  Flow flow = {.disk = (PetscBool)(dim == 2), .reach = reach, .num = num};
  PetscReal *goal;
  PetscInt steps;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * num, &flow.landmark));
  PetscCall(PetscMalloc1(3 * num, &flow.momentum));
  PetscCall(PetscCalloc1(3 * num, &goal));
  for (PetscInt i = 0; i < num; i++) {
    for (PetscInt k = 0; k < dim; k++) {
      flow.landmark[3 * i + k] = from[dim * i + k];
      goal[3 * i + k] = to[dim * i + k];
    }
  }
  steps = PetscMax(LEAST_STEPS, (PetscInt)PetscCeilReal(Farthest(&flow, goal) / step_length));
  for (PetscInt s = 0; s < steps; s++)
    PetscCall(Step(&flow, goal, 1. - (PetscReal)s / steps, 1. / steps, dim, count, x));
  for (PetscInt s = 0; s < CORRECTIONS && Farthest(&flow, goal) > 1e-13; s++)
    PetscCall(Step(&flow, goal, 1., 1., dim, count, x));
  *left = Farthest(&flow, goal);
  PetscCall(PetscFree(goal));
  PetscCall(PetscFree(flow.landmark));
  PetscCall(PetscFree(flow.momentum));
  PetscFunctionReturn(0);
}
