/* Gauss-Seidel relaxation over the stars of vertices: one small Gauss-Newton system each, no fold ever. */
#include "hierarchy/relax.h"
#include <stdlib.h>

/* Value and, unless `gradient` is NULL, gradient and Gauss-Newton matrix (rows of the upper triangle) in ambient
   coordinates. `dim` is a constant wherever this is called. */
static inline PetscReal StarValue(const PetscInt dim, const EqmStarImage *star, const PetscReal *x, PetscReal *gradient,
                                  PetscReal *matrix)
{
  PetscReal value = 0.;

  for (PetscInt k = 0; k < dim && gradient; k++) gradient[k] = 0.;
  for (PetscInt k = 0; k < dim * (dim + 1) / 2 && gradient; k++) matrix[k] = 0.;
  for (PetscInt j = 0; j < star->num_cells; j++) {
    const PetscReal *const p = star->ring[j], *const q = star->ring[j + 1 == star->size ? 0 : j + 1];
    EqmLevelResidual residual[2];
    const PetscInt count = EqmLevelResiduals(dim, x, p, q, 1. / (star->total * star->weight[j]), residual);
    if (count < 0) return PETSC_INFINITY;
    if (star->area_varies) value -= star->balance * EqmLevelArea(dim, x, p, q);
    for (PetscInt m = 0; m < count; m++) {
      const PetscReal rho = residual[m].rho, slope = residual[m].slope;
      PetscReal g[3], along, squared;
      value += star->weight[j] * rho * rho;
      if (!gradient) continue;
      EqmLevelGradient(dim, residual[m].of_area, x, p, q, g);
      along = 2. * star->weight[j] * slope * rho - (star->area_varies && m == 0 ? star->balance : 0.);
      squared = 2. * star->weight[j] * slope * slope;
      for (PetscInt k = 0, e = 0; k < dim; k++) {
        gradient[k] += along * g[k];
        for (PetscInt l = k; l < dim; l++) matrix[e++] += squared * g[k] * g[l];
      }
    }
  }
  for (PetscInt j = 0; j < star->size && star->cotangent; j++) {
    const PetscReal c = star->balance * star->cotangent[j];
    for (PetscInt k = 0, e = 0; k < dim; e += dim - k, k++) {
      const PetscReal d = x[k] - star->ring[j][k];
      value += .5 * c * d * d;
      if (!gradient) continue;
      gradient[k] += c * d;
      matrix[e] += c;
    }
  }
  return value;
}

PetscReal EqmStarImageValue(const EqmStarImage *star, const PetscReal *x)
{
  return star->dim == 2 ? StarValue(2, star, x, NULL, NULL) : StarValue(3, star, x, NULL, NULL);
}

/* The step, in ambient coordinates, from gradient and matrix; false where there is none. */
static inline PetscBool StarStep(const PetscInt dim, EqmMotion motion, const PetscReal *x, const PetscReal *gradient,
                                 const PetscReal *matrix, PetscReal *step)
{
  PetscReal frame[6], g[2] = {0., 0.}, h[2][2] = {{0., 0.}, {0., 0.}}, s[2] = {0., 0.};
  const PetscInt count = EqmMotionFrame(motion, x, frame);

  for (PetscInt a = 0; a < count; a++) {
    for (PetscInt k = 0; k < dim; k++) {
      g[a] += frame[dim * a + k] * gradient[k];
      for (PetscInt l = 0; l < dim; l++) {
        const PetscInt low = PetscMin(k, l), high = PetscMax(k, l);
        const PetscReal entry = frame[dim * a + k] * matrix[low * dim - low * (low - 1) / 2 + high - low];
        for (PetscInt b = a; b < count; b++) h[a][b] += entry * frame[dim * b + l];
      }
    }
  }
  if (count == 0) return PETSC_FALSE;
  if (count == 1) {
    if (!(h[0][0] > 0.)) return PETSC_FALSE;
    s[0] = -g[0] / h[0][0];
  } else {
    const PetscReal small = 1e-9 * (h[0][0] + h[1][1]), p = h[0][0] + small, q = h[1][1] + small;
    const PetscReal det = p * q - h[0][1] * h[0][1];
    if (!(det > 0.)) return PETSC_FALSE;
    s[0] = (h[0][1] * g[1] - q * g[0]) / det;
    s[1] = (h[0][1] * g[0] - p * g[1]) / det;
  }
  for (PetscInt k = 0; k < dim; k++) step[k] = s[0] * frame[k] + (count == 2 ? s[1] * frame[dim + k] : 0.);
  return PETSC_TRUE;
}

/* Boundary vertices keep their order: no further than half of the way to either neighbour. */
static void ShortenOnBoundary(const EqmStarImage *star, const PetscReal *x, PetscReal step[2])
{
  const PetscReal *const next = star->ring[0], *const last = star->ring[star->size - 1];
  const PetscReal most = .5 * PetscMin(hypot(next[0] - x[0], next[1] - x[1]), hypot(last[0] - x[0], last[1] - x[1]));
  const PetscReal length = hypot(step[0], step[1]);

  if (length <= most) return;
  for (PetscInt k = 0; k < 2; k++) step[k] *= most / length;
}

static inline void StarRelax(const PetscInt dim, const EqmStarImage *star, EqmMotion motion, PetscInt steps,
                             PetscReal *x)
{
  enum { MOST_HALVINGS = 12 };

  for (PetscInt n = 0; n < steps; n++) {
    PetscReal gradient[3], matrix[6], step[3], trial[3], t = 1.;
    const PetscReal value = StarValue(dim, star, x, gradient, matrix);
    PetscInt h;
    if (!(value < PETSC_INFINITY) || !StarStep(dim, motion, x, gradient, matrix, step)) return;
    if (star->size > star->num_cells) ShortenOnBoundary(star, x, step);
    for (h = 0; h < MOST_HALVINGS; h++, t *= .5) {
      for (PetscInt k = 0; k < dim; k++) trial[k] = x[k] + t * step[k];
      EqmRetract(motion, trial);
      if (StarValue(dim, star, trial, NULL, NULL) < value) break;
    }
    if (h == MOST_HALVINGS) return;
    for (PetscInt k = 0; k < dim; k++) x[k] = trial[k];
  }
}

void EqmStarImageRelax(const EqmStarImage *star, EqmMotion motion, PetscInt steps, PetscReal *x)
{
  if (star->dim == 2)
    StarRelax(2, star, motion, steps, x);
  else
    StarRelax(3, star, motion, steps, x);
}

static void RelaxVertex(EqmLevelMap *map, const EqmLevelStars *stars, PetscInt v, EqmStarImage *star)
{
  const PetscInt at = stars->start[v], dim = map->dim;
  const PetscBool inside = (PetscBool)(map->level->part[v] == EQM_INSIDE);

  star->size = stars->start[v + 1] - at;
  star->num_cells = inside ? star->size : star->size - 1;
  star->area_varies = (PetscBool)!inside;
  star->weight = stars->weight + at;
  star->cotangent = map->epsilon > 0. ? stars->cotangent + at : NULL;
  for (PetscInt k = 0; k < star->size; k++) {
    const PetscReal *const p = map->x + dim * stars->ring[at + k];
    for (PetscInt c = 0; c < dim; c++) star->ring[k][c] = p[c];
  }
  EqmStarImageRelax(star, (EqmMotion)map->motion[v], 1, map->x + dim * v);
}

void EqmRelaxVertices(EqmLevelMap *map, const EqmLevelStars *stars, PetscInt num, const PetscInt *vertex,
                      PetscBool backwards, PetscReal (*ring)[3])
{
  EqmStarImage star = {.dim = map->dim, .total = map->total, .balance = EqmAngleFactor(map), .ring = ring};

  for (PetscInt k = 0; k < num; k++) RelaxVertex(map, stars, vertex[backwards ? num - 1 - k : k], &star);
}

/* Those of a piece. */
static void RelaxPiece(EqmLevelMap *map, const EqmLevelStars *stars, PetscInt piece, PetscBool backwards,
                       PetscReal (*ring)[3])
{
  const EqmLevelPieces *const pieces = &stars->vertices;
  const PetscInt begin = pieces->start[piece];

  EqmRelaxVertices(map, stars, pieces->start[piece + 1] - begin, pieces->item + begin, backwards, ring);
}

PetscErrorCode EqmRelaxLevel(EqmLevelMap *map, const EqmLevelStars *stars, PetscInt sweeps)
{
  const PetscInt count = stars->vertices.count;
  int bad = 0;

  PetscFunctionBegin;
#pragma omp parallel if (count > 1)
  {
    PetscReal(*const ring)[3] = malloc((size_t)stars->most * sizeof(*ring));
    if (!ring) {
#pragma omp atomic write
      bad = 1;
    }
    for (PetscInt s = 0; s < sweeps; s++) {
      const PetscBool backwards = (PetscBool)(s % 2);
#pragma omp for schedule(dynamic)
      for (PetscInt k = 0; k < count; k++) {
        if (ring) RelaxPiece(map, stars, k, backwards, ring);
      }
#pragma omp single
      if (ring) RelaxPiece(map, stars, count, backwards, ring);
    }
    free(ring);
  }
  PetscCheck(!bad, PETSC_COMM_SELF, PETSC_ERR_MEM, "too little memory for a sweep");
  PetscFunctionReturn(0);
}
