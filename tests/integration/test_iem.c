/* 003 Algorithm 1 written down once more, with dense matrices and nothing of the library but the mesh and the first
   map: lines 13 to 38, with (17) as it must be (a_k and c_k are swapped above it). The house's ncg takes the same
   steps. */
#include "support/testing.h"
#include "mesh/mesh_private.h"

enum { STEPS = 12 };

typedef struct {
  PetscInt n, cells, interior; /* interior vertices come first */
  PetscInt *place;             /* of a vertex in that order */
  const PetscInt *tet;
  PetscReal *weight;    /* volumes, which add up to one */
  PetscReal *f;         /* 3 per vertex, in the mesh's order */
  PetscReal *angle;     /* theta, phi per vertex; of the boundary */
  PetscReal *g, *h, *p; /* per vertex 3 numbers: by f^1, f^2, f^3 inside, by theta, phi on the boundary */
  PetscReal *factor[2]; /* Cholesky factors of L_II and L_BB, rows of the lower triangle */
} Iem;

static PetscReal Volume(const PetscReal *a, const PetscReal *b, const PetscReal *c, const PetscReal *d,
                        PetscReal by[12])
{
  PetscReal u[3], v[3], w[3], vw[3], wu[3], uv[3];

  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    w[k] = d[k] - a[k];
  }
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    vw[k] = (v[i] * w[j] - v[j] * w[i]) / 6.;
    wu[k] = (w[i] * u[j] - w[j] * u[i]) / 6.;
    uv[k] = (u[i] * v[j] - u[j] * v[i]) / 6.;
  }
  for (int k = 0; k < 3 && by; k++) {
    by[3 + k] = vw[k];
    by[6 + k] = wu[k];
    by[9 + k] = uv[k];
    by[k] = -vw[k] - wu[k] - uv[k];
  }
  return u[0] * vw[0] + u[1] * vw[1] + u[2] * vw[2];
}

static PetscReal CellVolume(const Iem *m, const PetscReal *x, PetscInt c, PetscReal by[12])
{
  const PetscInt *const v = m->tet + 4 * c;

  return Volume(x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3], by);
}

/* E_I = E_V / V(f) - V(f) with E_V = sum a^2 / w, V(e) = 1 (003 (2)). */
static PetscReal Energy(const Iem *m, const PetscReal *x)
{
  PetscReal stretch = 0., volume = 0.;

  for (PetscInt c = 0; c < m->cells; c++) {
    const PetscReal a = CellVolume(m, x, c, NULL);
    stretch += a * a / m->weight[c];
    volume += a;
  }
  return stretch / volume - volume;
}

/* (10): by f inside, by the angles on the boundary, with the chain rule of (7). */
static void Gradient(Iem *m)
{
  PetscReal stretch = 0., volume = 0., by[12];

  for (PetscInt c = 0; c < m->cells; c++) {
    const PetscReal a = CellVolume(m, m->f, c, NULL);
    stretch += a * a / m->weight[c];
    volume += a;
  }
  for (PetscInt k = 0; k < 3 * m->n; k++) m->g[k] = 0.;
  for (PetscInt c = 0; c < m->cells; c++) {
    const PetscReal a = CellVolume(m, m->f, c, by);
    const PetscReal slope = 2. * a / (m->weight[c] * volume) - stretch / (volume * volume) - 1.;
    for (int k = 0; k < 12; k++) m->g[3 * m->tet[4 * c + k / 3] + k % 3] += slope * by[k];
  }
  for (PetscInt v = 0; v < m->n; v++) {
    PetscReal *const g = m->g + 3 * v;
    const PetscReal ct = PetscCosReal(m->angle[2 * v]), st = PetscSinReal(m->angle[2 * v]);
    const PetscReal cp = PetscCosReal(m->angle[2 * v + 1]), sp = PetscSinReal(m->angle[2 * v + 1]);
    if (m->place[v] < m->interior) continue;
    const PetscReal by_theta = ct * cp * g[0] + ct * sp * g[1] - st * g[2], by_phi = -st * sp * g[0] + st * cp * g[1];
    g[0] = by_theta;
    g[1] = by_phi;
    g[2] = 0.;
  }
}

/* L_V at the present map, its block of interior (0) or boundary (1) vertices, factored. */
static PetscErrorCode FactorBlock(Iem *m, int block)
{
  const PetscInt first = block ? m->interior : 0, size = block ? m->n - m->interior : m->interior;
  PetscReal *const l = m->factor[block], by[12];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < size * size; k++) l[k] = 0.;
  for (PetscInt c = 0; c < m->cells; c++) {
    (void)CellVolume(m, m->f, c, by);
    for (int i = 0; i < 4; i++) {
      for (int j = 0; j < 4; j++) {
        const PetscInt row = m->place[m->tet[4 * c + i]] - first, column = m->place[m->tet[4 * c + j]] - first;
        if (row < 0 || column < 0 || row >= size || column >= size) continue;
        for (int k = 0; k < 3; k++) l[size * row + column] += 2. / 3. * by[3 * i + k] * by[3 * j + k] / m->weight[c];
      }
    }
  }
  for (PetscInt j = 0; j < size; j++) {
    for (PetscInt i = j; i < size; i++) {
      for (PetscInt k = 0; k < j; k++) l[size * i + j] -= l[size * i + k] * l[size * j + k];
      CHECK(i > j || l[size * j + j] > 0., "L_V is not definite at %d", (int)j);
      l[size * i + j] = i == j ? PetscSqrtReal(l[size * i + i]) : l[size * i + j] / l[size * j + j];
    }
  }
  PetscFunctionReturn(0);
}

/* Line 22: h = M^-1 g. */
static PetscErrorCode Precondition(Iem *m)
{
  PetscReal *b;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(m->n, &b));
  for (int block = 0; block < 2; block++) {
    const PetscInt first = block ? m->interior : 0, size = block ? m->n - m->interior : m->interior;
    const PetscReal *const l = m->factor[block];
    for (int k = 0; k < 3 - block; k++) {
      for (PetscInt v = 0; v < m->n; v++) {
        if (m->place[v] >= first && m->place[v] < first + size) b[m->place[v] - first] = m->g[3 * v + k];
      }
      for (PetscInt i = 0; i < size; i++) {
        for (PetscInt j = 0; j < i; j++) b[i] -= l[size * i + j] * b[j];
        b[i] /= l[size * i + i];
      }
      for (PetscInt i = size - 1; i >= 0; i--) {
        for (PetscInt j = i + 1; j < size; j++) b[i] -= l[size * j + i] * b[j];
        b[i] /= l[size * i + i];
      }
      for (PetscInt v = 0; v < m->n; v++) {
        if (m->place[v] >= first && m->place[v] < first + size) m->h[3 * v + k] = b[m->place[v] - first];
      }
    }
  }
  PetscCall(PetscFree(b));
  PetscFunctionReturn(0);
}

static PetscReal Product(const Iem *m, const PetscReal *x, const PetscReal *y)
{
  PetscReal sum = 0.;

  for (PetscInt k = 0; k < 3 * m->n; k++) sum += x[k] * y[k];
  return sum;
}

/* Lines 33 and 34, from f to x. */
static void Move(const Iem *m, PetscReal alpha, PetscReal *x, PetscReal *angle)
{
  for (PetscInt v = 0; v < m->n; v++) {
    if (m->place[v] < m->interior) {
      for (int k = 0; k < 3; k++) x[3 * v + k] = m->f[3 * v + k] + alpha * m->p[3 * v + k];
      continue;
    }
    const PetscReal theta = m->angle[2 * v] + alpha * m->p[3 * v], phi = m->angle[2 * v + 1] + alpha * m->p[3 * v + 1];
    x[3 * v] = PetscSinReal(theta) * PetscCosReal(phi);
    x[3 * v + 1] = PetscSinReal(theta) * PetscSinReal(phi);
    x[3 * v + 2] = PetscCosReal(theta);
    if (angle) {
      angle[2 * v] = theta;
      angle[2 * v + 1] = phi;
    }
  }
}

/* Lines 13 to 38; alpha_0 = 2 is meant for a solid of the ball's volume, which here has volume one. */
static PetscErrorCode Run(Iem *m, PetscReal energy[STEPS + 1], PetscReal length[STEPS])
{
  PetscReal lambda = 0., alpha = 2. * 4. / 3. * PETSC_PI, *x;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * m->n, &x));
  for (int block = 0; block < 2; block++) PetscCall(FactorBlock(m, block));
  energy[0] = Energy(m, m->f);
  for (PetscInt step = 0; step < STEPS; step++) {
    const PetscReal before = lambda;
    Gradient(m);
    PetscCall(Precondition(m));
    lambda = Product(m, m->g, m->h);
    for (PetscInt k = 0; k < 3 * m->n; k++) m->p[k] = -m->h[k] + (step ? lambda / before * m->p[k] : 0.);
    const PetscReal slope = Product(m, m->g, m->p);
    Move(m, alpha, x, NULL);
    alpha = -alpha * alpha * slope / (2. * (Energy(m, x) - energy[step] - alpha * slope));
    Move(m, alpha, m->f, m->angle);
    length[step] = alpha;
    energy[step + 1] = Energy(m, m->f);
  }
  PetscCall(PetscFree(x));
  PetscFunctionReturn(0);
}

/* From the mesh of one rank and a map of it. */
static PetscErrorCode Begin(EqmMesh mesh, const PetscReal *x, Iem *m)
{
  PetscInt boundary = 0;

  PetscFunctionBegin;
  *m = (Iem){.n = mesh->num_owned, .cells = mesh->num_owned_cells, .tet = mesh->cells, .weight = mesh->weight};
  PetscCall(PetscMalloc3(m->n, &m->place, 3 * m->n, &m->f, 2 * m->n, &m->angle));
  PetscCall(PetscCalloc3(3 * m->n, &m->g, 3 * m->n, &m->h, 3 * m->n, &m->p));
  for (PetscInt v = 0; v < m->n; v++) m->interior += !mesh->on_boundary[v];
  for (PetscInt v = 0, inside = 0; v < m->n; v++)
    m->place[v] = mesh->on_boundary[v] ? m->interior + boundary++ : inside++;
  PetscCall(PetscArraycpy(m->f, x, 3 * m->n));
  for (PetscInt v = 0; v < m->n; v++) {
    m->angle[2 * v] = PetscAcosReal(PetscMax(-1., PetscMin(1., x[3 * v + 2])));
    m->angle[2 * v + 1] = PetscAtan2Real(x[3 * v + 1], x[3 * v]);
  }
  PetscCall(PetscMalloc2(m->interior * m->interior, &m->factor[0], boundary * boundary, &m->factor[1]));
  PetscFunctionReturn(0);
}

static PetscErrorCode End(Iem *m)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(m->place, m->f, m->angle));
  PetscCall(PetscFree3(m->g, m->h, m->p));
  PetscCall(PetscFree2(m->factor[0], m->factor[1]));
  PetscFunctionReturn(0);
}

/* By the algorithm on each rank alone, then by the program alone and on all ranks. */
int main(int argc, char **argv)
{
  PetscReal energy[STEPS + 1], length[STEPS];
  char options[128];

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(PetscSNPrintf(options, sizeof(options),
                          "-method ncg -ncg_line_search printed -start_steps 15 -unfold none -energy_rtol 0 -max_it %d",
                          STEPS));
  for (int together = 0; together < 2; together++) {
    TestMesh test;
    EqmSolver solver;
    PetscCall(TestMeshCreate(together ? PETSC_COMM_WORLD : PETSC_COMM_SELF, "blob", 350, 2, &test));
    if (!together) {
      Iem m;
      PetscCall(TestSolve(test.mesh, "ball", "-method ncg -start_steps 15 -unfold none -max_it 0", &solver));
      PetscCall(Begin(test.mesh, solver->iterate->place.x, &m));
      PetscCall(Run(&m, energy, length));
      PetscCall(End(&m));
      PetscCall(EqmSolverDestroy(&solver));
      CHECK(energy[STEPS] < .9 * energy[0], "the algorithm descends from %g to %g only", (double)energy[0],
            (double)energy[STEPS]);
    }
    PetscCall(TestSolve(test.mesh, "ball", options, &solver));
    CHECK(solver->num_history == STEPS + 1, "%d rows", (int)solver->num_history);
    for (PetscInt k = 0; k <= STEPS; k++) {
      CHECK_CLOSE(solver->history[k].energy, energy[k], 1e-6, energy[k]);
      if (k > 0) CHECK_CLOSE(solver->history[k].step, length[k - 1], 1e-5, length[k - 1]);
    }
    PetscCall(EqmSolverDestroy(&solver));
    PetscCall(TestMeshDestroy(&test));
  }
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
