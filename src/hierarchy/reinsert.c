/* Vertices come back to a map: the star's polygon is star-shaped as seen from the vertex that the other went onto, so
   that close to it there is always a place without folds. */
#include "hierarchy/reinsert.h"
#include <float.h>

enum { MOST_APPROACHES = 90 };

/* Mean value coordinates (Floater 2003) of the centre in its ring, the star's angles scaled to a full turn. */
static void MeanValueCoordinates(const EqmHierarchyLevel *level, const EqmCollapse *record, PetscReal *lambda)
{
  const PetscInt size = record->size, *const ring = level->ring + record->start;
  const PetscReal *const center = level->position + 3 * record->vertex, most_angle = 3.;
  PetscReal angle[EQM_MOST_RECORD], turn = 0., sum = 0.;

  for (PetscInt k = 0; k < size; k++) {
    const PetscReal *const p = level->position + 3 * ring[k], *const q = level->position + 3 * ring[(k + 1) % size];
    PetscReal u[3], v[3], n[3];
    for (PetscInt c = 0; c < 3; c++) {
      u[c] = p[c] - center[c];
      v[c] = q[c] - center[c];
    }
    EqmCross(u, v, n);
    angle[k] = PetscAtan2Real(PetscSqrtReal(EqmDot3(n, n)), EqmDot3(u, v));
    lambda[k] = 1. / (PetscSqrtReal(EqmDot3(u, u)) + DBL_MIN);
    turn += angle[k];
  }
  for (PetscInt k = 0; k < size; k++) angle[k] = PetscMin(turn > 0. ? angle[k] * 2. * PETSC_PI / turn : 1., most_angle);
  for (PetscInt k = 0; k < size; k++) {
    lambda[k] *= PetscTanReal(.5 * angle[k]) + PetscTanReal(.5 * angle[(k + size - 1) % size]);
    sum += lambda[k];
  }
  for (PetscInt k = 0; k < size; k++) lambda[k] /= sum;
}

/* From u into the wedge between its two edges in the ring, ever closer to u. */
static PetscBool CloseIn(const EqmStarImage *star, EqmMotion motion, PetscInt onto, PetscReal *x)
{
  const PetscReal *const u = star->ring[onto], *const p = star->ring[(onto + 1) % star->size],
                         *const q = star->ring[(onto + star->size - 1) % star->size];
  PetscReal direction[3] = {0., 0., 0.}, d[2][3] = {{0., 0., 0.}, {0., 0., 0.}}, length[2] = {0., 0.}, t, along = 0.,
            size = 0.;
  const PetscInt dim = star->dim;

  for (PetscInt k = 0; k < dim; k++) {
    d[0][k] = p[k] - u[k];
    d[1][k] = q[k] - u[k];
  }
  for (PetscInt s = 0; s < 2; s++) length[s] = PetscSqrtReal(EqmDot3(d[s], d[s]));
  for (PetscInt k = 0; k < dim; k++) direction[k] = d[0][k] / length[0] + d[1][k] / length[1];
  for (PetscInt k = 0; k < dim && dim == 3; k++) along += direction[k] * u[k];
  for (PetscInt k = 0; k < dim && dim == 3; k++) direction[k] -= along * u[k];
  for (PetscInt k = 0; k < dim; k++) size += direction[k] * direction[k];
  if (size < 1e-6) { /* a straight angle: across it */
    const PetscReal edge[3] = {d[0][0] / length[0], d[0][1] / length[0], d[0][2] / length[0]};
    if (dim == 3)
      EqmCross(u, edge, direction);
    else {
      direction[0] = -edge[1];
      direction[1] = edge[0];
    }
  } else if (EqmLevelOrientation(dim, u, p, q) < 0.) { /* the wedge is wider than that */
    for (PetscInt k = 0; k < dim; k++) direction[k] *= -1.;
  }
  t = PetscMin(length[0], length[1]);
  for (PetscInt n = 0; n < MOST_APPROACHES; n++, t *= .6) {
    for (PetscInt k = 0; k < dim; k++) x[k] = u[k] + t * direction[k];
    EqmRetract(motion, x);
    if (EqmStarImageValue(star, x) < PETSC_INFINITY) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Between its two neighbours on the boundary: first as on the surface, then ever closer to the one that it went onto.
 */
static PetscBool PlaceOnBoundary(const EqmHierarchyLevel *level, const EqmCollapse *record, const EqmStarImage *star,
                                 EqmMotion motion, PetscReal *x, PetscInt *hard)
{
  const PetscInt *const ring = level->ring + record->start, last = record->size - 1;
  const PetscReal *const v = level->position + 3 * record->vertex, *const p = level->position + 3 * ring[0],
                         *const q = level->position + 3 * ring[last];
  const PetscReal to_p = PetscSqrtReal(PetscSqr(p[0] - v[0]) + PetscSqr(p[1] - v[1]) + PetscSqr(p[2] - v[2]));
  const PetscReal to_q = PetscSqrtReal(PetscSqr(q[0] - v[0]) + PetscSqr(q[1] - v[1]) + PetscSqr(q[2] - v[2]));
  const PetscReal share = to_p + to_q > 0. ? to_p / (to_p + to_q) : .5;
  PetscReal t = record->onto == ring[0] ? share : 1. - share;
  const PetscReal *const near = star->ring[record->onto == ring[0] ? 0 : last],
                         *const far = star->ring[record->onto == ring[0] ? last : 0];

  for (PetscInt n = 0; n < MOST_APPROACHES; n++, t *= .6) {
    if (motion == EQM_MOVE_CIRCLE) {
      PetscReal angle = PetscAtan2Real(near[0] * far[1] - near[1] * far[0], near[0] * far[0] + near[1] * far[1]);
      if (near == star->ring[0] && angle > 0.) angle -= 2. * PETSC_PI; /* the one before lies clockwise */
      if (near != star->ring[0] && angle < 0.) angle += 2. * PETSC_PI;
      x[0] = PetscCosReal(t * angle) * near[0] - PetscSinReal(t * angle) * near[1];
      x[1] = PetscSinReal(t * angle) * near[0] + PetscCosReal(t * angle) * near[1];
      EqmRetract(motion, x);
    } else {
      for (PetscInt k = 0; k < 2; k++) x[k] = near[k] == far[k] ? near[k] : (1. - t) * near[k] + t * far[k];
    }
    if (EqmStarImageValue(star, x) < PETSC_INFINITY) return PETSC_TRUE;
    *hard += n == 0;
  }
  return PETSC_FALSE;
}

static PetscBool PlaceInside(const EqmHierarchyLevel *level, const EqmCollapse *record, const EqmStarImage *star,
                             EqmMotion motion, PetscReal *x, PetscInt *hard)
{
  PetscReal lambda[EQM_MOST_RECORD];
  PetscInt onto = 0;

  MeanValueCoordinates(level, record, lambda);
  for (PetscInt c = 0; c < star->dim; c++) x[c] = 0.;
  for (PetscInt k = 0; k < record->size; k++) {
    for (PetscInt c = 0; c < star->dim; c++) x[c] += lambda[k] * star->ring[k][c];
  }
  EqmRetract(motion, x);
  if (EqmStarImageValue(star, x) < PETSC_INFINITY) return PETSC_TRUE;
  (*hard)++;
  while (level->ring[record->start + onto] != record->onto) onto++;
  return CloseIn(star, motion, onto, x);
}

/* One vertex back; false where every place is a fold up to rounding. */
static PetscBool PutBack(const EqmHierarchyLevel *level, const EqmCollapse *record, EqmLevelMap *map, PetscInt *hard)
{
  enum { STEPS = 3 };
  const PetscBool inside = (PetscBool)(level->part[record->vertex] == EQM_INSIDE);
  const EqmMotion motion = (EqmMotion)map->motion[record->vertex];
  PetscReal ring[EQM_MOST_RECORD][3], *const x = map->x + map->dim * record->vertex;
  const EqmStarImage star = {.dim = map->dim,
                             .size = record->size,
                             .num_cells = inside ? record->size : record->size - 1,
                             .total = map->total,
                             .weight = level->ring_weight + record->start,
                             .ring = ring};

  for (PetscInt k = 0; k < record->size; k++) {
    const PetscReal *const p = map->x + map->dim * level->ring[record->start + k];
    for (PetscInt c = 0; c < 3; c++) ring[k][c] = c < map->dim ? p[c] : 0.;
  }
  if (!(inside ? PlaceInside : PlaceOnBoundary)(level, record, &star, motion, x, hard)) return PETSC_FALSE;
  EqmStarImageRelax(&star, motion, STEPS, x);
  return PETSC_TRUE;
}

PetscInt EqmReinsertRecords(PetscInt begin, PetscInt end, EqmLevelMap *map)
{
  PetscInt hard = 0;

  for (PetscInt k = end; k-- > begin;) PutBack(map->level, &map->level->collapse[k], map, &hard);
  return hard;
}

PetscErrorCode EqmReinsert(const EqmLevelMap *from, EqmLevelMap *to, PetscInt *hard)
{
  PetscFunctionBegin;
  to->total = from->total;
  for (PetscInt v = 0; v < from->level->num_vertices; v++)
    PetscCall(PetscArraycpy(to->x + to->dim * from->level->finer[v], from->x + to->dim * v, to->dim));
  *hard = EqmReinsertRecords(0, to->level->num_collapses, to);
  PetscFunctionReturn(0);
}
