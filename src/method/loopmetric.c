/* The Steklov operator (Dirichlet to Neumann) of the disk takes e^{ik theta} to |k| e^{ik theta}: it is the square root
   of -d^2/dtheta^2. With A and M the stiffness and lumped mass of linear elements on the loop, S = M (M^-1 A)^{1/2},
   and by the integral x^{-1/2} = 2/pi int e^u / (x + e^{2u}) du, which the trapezoidal rule takes to many digits with
   few nodes,

       S^-1 = sum over the nodes of 2/pi step e^u (A + e^{2u} M)^-1:

   a dozen cyclic tridiagonal systems, whatever the spacing of the vertices. A shift of M/2 makes A definite. Rank 0
   solves them for the whole loop. */
#include "method/loopmetric.h"

struct _p_EqmLoopMetric {
  EqmLoop loop;
  PetscInt count;              /* the loop's */
  PetscReal *stiffness, *mass; /* 1/gap to the next vertex; half of both gaps */
  PetscReal first, last;       /* range of the nodes u */
  PetscReal *rhs, *sum, *diagonal, *solution, *coupling;
};

static const PetscReal node_step = 1., node_margin = 4.5, shift = .5;

/* From the gaps between neighbours, on rank 0: the matrices, and the range of nodes that covers the spectrum. */
static PetscErrorCode Discretise(EqmLoopMetric metric, const PetscReal *gap)
{
  const PetscInt n = metric->count;
  PetscReal smallest = 2. * PETSC_PI;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    PetscCheck(gap[k] > 0., PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE, "the boundary is not in its order");
    metric->stiffness[k] = 1. / gap[k];
    metric->mass[k] += .5 * gap[k];
    metric->mass[(k + 1) % n] += .5 * gap[k];
    smallest = PetscMin(smallest, gap[k]);
  }
  metric->first = PetscLogReal(shift) - node_margin;
  metric->last = PetscLogReal(2. / smallest) + node_margin; /* no eigenvalue of M^-1 A is above (2/gap)^2 */
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLoopMetricCreate(EqmLoop loop, const PetscReal *x, EqmLoopMetric *out)
{
  EqmLoopMetric metric;
  PetscReal *point, *gap;

  PetscFunctionBegin;
  PetscCall(PetscNew(&metric));
  metric->loop = loop;
  metric->count = loop->count;
  PetscCall(PetscCalloc7(metric->count, &metric->stiffness, metric->count, &metric->mass, metric->count, &metric->rhs,
                         metric->count, &metric->sum, metric->count, &metric->diagonal, metric->count,
                         &metric->solution, metric->count, &metric->coupling));
  PetscCall(PetscMalloc2(2 * metric->count, &point, metric->count, &gap));
  PetscCall(EqmLoopGaps(loop, x, point, gap));
  PetscCall(Discretise(metric, gap));
  PetscCall(PetscFree2(point, gap));
  *out = metric;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLoopMetricDestroy(EqmLoopMetric *metric)
{
  PetscFunctionBegin;
  if (!*metric) PetscFunctionReturn(0);
  PetscCall(PetscFree7((*metric)->stiffness, (*metric)->mass, (*metric)->rhs, (*metric)->sum, (*metric)->diagonal,
                       (*metric)->solution, (*metric)->coupling));
  PetscCall(PetscFree(*metric));
  PetscFunctionReturn(0);
}

/* solution = (A + weight M)^-1 rhs: all vertices but the last are a tridiagonal chain, the last closes it. */
static void SolveLoop(EqmLoopMetric metric, PetscReal weight)
{
  const PetscInt n = metric->count, last = n - 1;
  const PetscReal *const s = metric->stiffness;
  PetscReal *const x = metric->solution, *const q = metric->coupling, *const d = metric->diagonal;
  PetscReal pivot = s[last] + s[last - 1] + weight * metric->mass[last], rest = metric->rhs[last];

  for (PetscInt k = 0; k < last; k++) {
    d[k] = s[k] + s[(k + last) % n] + weight * metric->mass[k];
    x[k] = metric->rhs[k];
    q[k] = 0.;
  }
  q[0] -= s[last]; /* the chain's ends touch the last vertex */
  q[last - 1] -= s[last - 1];
  for (PetscInt k = 1; k < last; k++) {
    const PetscReal factor = s[k - 1] / d[k - 1];
    d[k] -= factor * s[k - 1];
    x[k] += factor * x[k - 1];
    q[k] += factor * q[k - 1];
  }
  x[last - 1] /= d[last - 1];
  q[last - 1] /= d[last - 1];
  for (PetscInt k = last - 2; k >= 0; k--) {
    x[k] = (x[k] + s[k] * x[k + 1]) / d[k];
    q[k] = (q[k] + s[k] * q[k + 1]) / d[k];
  }
  rest += s[last] * x[0] + s[last - 1] * x[last - 1];
  pivot += s[last] * q[0] + s[last - 1] * q[last - 1];
  x[last] = rest / pivot;
  for (PetscInt k = 0; k < last; k++) x[k] -= q[k] * x[last];
}

PetscErrorCode EqmLoopMetricApply(EqmLoopMetric metric, const PetscReal *g, PetscReal *h)
{
  PetscFunctionBegin;
  PetscCall(EqmLoopGather(metric->loop, g, metric->rhs));
  for (PetscInt k = 0; k < metric->count; k++) metric->sum[k] = 0.;
  for (PetscReal u = metric->first; metric->count > 0 && u < metric->last; u += node_step) {
    SolveLoop(metric, PetscExpReal(2. * u) + shift);
    for (PetscInt k = 0; k < metric->count; k++)
      metric->sum[k] += 2. / PETSC_PI * node_step * PetscExpReal(u) * metric->solution[k];
  }
  PetscCall(EqmLoopScatter(metric->loop, metric->sum, h));
  PetscFunctionReturn(0);
}
