/* A map of one level to the disk, the square or the sphere, and the objective that it is relaxed by:

       sum_c w rho(r)^2 + (epsilon / A) (E_D - A),   r = a / (A w),   A = sum a,

   rho(r) = r - 1 where a triangle is too large and log r where it is too small (EqmLevelResiduals); E_D is the
   Dirichlet energy. Of the angle energy's A on the sphere 4 pi is taken. */
#ifndef EQM_LEVELMAP_H
#define EQM_LEVELMAP_H

#include "hierarchy/cascade.h"
#include "hierarchy/level.h"

/* Where the image of a vertex may move. */
typedef enum {
  EQM_MOVE_PLANE,
  EQM_MOVE_CIRCLE,
  EQM_MOVE_SIDE_X,
  EQM_MOVE_SIDE_Y,
  EQM_MOVE_SPHERE,
  EQM_MOVE_NOT
} EqmMotion;

typedef struct {
  const EqmHierarchyLevel *level;
  PetscInt dim;           /* coordinates of a place: 2, or 3 on the sphere */
  unsigned char *motion;  /* an EqmMotion per vertex */
  PetscReal *x;           /* dim per vertex */
  const PetscReal *frame; /* 2 dim per vertex: directions of its motion, orthonormal; NULL: those of EqmMotionFrame */
  PetscReal *half;        /* 3 per cell: EqmHalfCotangents; NULL: not kept */
  PetscReal epsilon;      /* weight of the angle energy */
  PetscReal total;        /* A of the map at its last evaluation */
} EqmLevelMap;

typedef struct {
  PetscReal objective, residual; /* infinite where the map folds; residual: sum w rho^2 */
  PetscReal energy;              /* A sum w (r - 1)^2 */
  PetscInt folds;
} EqmLevelValue;

PETSC_INTERN PetscErrorCode EqmLevelMapCreate(const EqmHierarchyLevel *level, EqmCascadeTarget target,
                                              EqmLevelMap *map);
PETSC_INTERN PetscErrorCode EqmLevelMapDestroy(EqmLevelMap *map);
/* The finest level's motions, from the places of boundary vertices. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelMapSetMotions(EqmLevelMap *map, EqmCascadeTarget target);
/* Motions and places of the vertices that the next coarser level has. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelMapRestrict(const EqmLevelMap *finer, EqmLevelMap *coarser);
/* Evaluate the objective at x instead of the map's own coordinates; sets `map->total`. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelMapEvaluate(EqmLevelMap *map, const PetscReal *x, EqmLevelValue *value);
/* Its parts, over the cells begin .. end - 1: their area, then, once that of all is map->total, the sums that the value
   is made of. Not collective. */
typedef struct {
  PetscReal folds, energy, residual, angle;
} EqmLevelSums;
PETSC_INTERN PetscReal EqmLevelMapArea(const EqmLevelMap *map, const PetscReal *x, PetscInt begin, PetscInt end);
PETSC_INTERN void EqmLevelMapSum(const EqmLevelMap *map, const PetscReal *x, PetscInt begin, PetscInt end,
                                 EqmLevelSums *sums);
PETSC_INTERN void EqmLevelMapValue(const EqmLevelMap *map, const EqmLevelSums *sums, EqmLevelValue *value);
/* Half cotangents of a cell's angles on the surface, with slivers changed so that its Laplacian is bounded: positive
   semidefinite for any triangle. Not collective. */
PETSC_INTERN void EqmHalfCotangents(const EqmHierarchyLevel *level, PetscInt cell, PetscReal half[3]);

/* Keep them for all cells, for maps that are worked on. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelMapKeepAngles(EqmLevelMap *map);

/* Those of a map's cell; `scratch` is for where they are not kept. */
static inline const PetscReal *EqmMapHalfCotangents(const EqmLevelMap *map, PetscInt cell, PetscReal scratch[3])
{
  if (map->half) return map->half + 3 * cell;
  EqmHalfCotangents(map->level, cell, scratch);
  return scratch;
}

/* Factor of the angle energy. */
static inline PetscReal EqmAngleFactor(const EqmLevelMap *map)
{
  return map->epsilon / (map->dim == 2 ? map->total : 4. * PETSC_PI);
}

/* Positive where the image triangle is not folded: its area in the plane; on the sphere half its determinant, which is
   its area times its plane's distance from the centre. */
static inline PetscReal EqmLevelOrientation(PetscInt dim, const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  return dim == 2 ? EqmArea2(p, q, r) : EqmHalfDet(p, q, r);
}

/* Its area. */
static inline PetscReal EqmLevelArea(PetscInt dim, const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  return dim == 2 ? EqmArea2(p, q, r) : EqmArea3(p, q, r);
}

/* Residual of an image triangle: rho, and its derivative by the measure that it depends on. */
typedef struct {
  PetscReal rho, slope;
  PetscBool of_area; /* else of the orientation */
} EqmLevelResidual;

/* Too large by its area: r - 1; too small by its orientation, so that it cannot fold: log r. In the plane one of the
   two, on the sphere both for long thin triangles. `scale`: 1 / (A w). Returns how many; -1 where the triangle is
   folded or so small that its sign is rounding. */
static inline PetscInt EqmLevelResiduals(PetscInt dim, const PetscReal *p, const PetscReal *q, const PetscReal *r,
                                         PetscReal scale, EqmLevelResidual residual[2])
{
  const PetscReal least_ratio = 1e-14, small = scale * EqmLevelOrientation(dim, p, q, r),
                  large = dim == 2 ? small : scale * EqmArea3(p, q, r);
  PetscInt count = 0;

  if (!(small > least_ratio)) return -1;
  if (large > 1.) residual[count++] = (EqmLevelResidual){.rho = large - 1., .slope = scale, .of_area = PETSC_TRUE};
  if (small <= 1.)
    residual[count++] = (EqmLevelResidual){.rho = PetscLogReal(small), .slope = scale / small, .of_area = PETSC_FALSE};
  return count;
}

/* The gradient of that measure in the place of p. */
static inline void EqmLevelGradient(PetscInt dim, PetscBool of_area, const PetscReal *p, const PetscReal *q,
                                    const PetscReal *r, PetscReal *gradient)
{
  if (dim == 2) {
    gradient[0] = .5 * (q[1] - r[1]);
    gradient[1] = .5 * (r[0] - q[0]);
  } else if (of_area) {
    const PetscReal u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
    const PetscReal side[3] = {r[0] - q[0], r[1] - q[1], r[2] - q[2]};
    PetscReal normal[3], length;
    EqmCross(u, v, normal);
    length = PetscSqrtReal(EqmDot3(normal, normal));
    EqmCross(normal, side, gradient);
    for (PetscInt k = 0; k < 3; k++) gradient[k] *= .5 / length;
  } else {
    EqmCross(q, r, gradient);
    for (PetscInt k = 0; k < 3; k++) gradient[k] *= .5;
  }
}

/* Directions in which x may move: orthonormal rows of `dim`; returns how many. */
static inline PetscInt EqmMotionFrame(EqmMotion motion, const PetscReal *x, PetscReal frame[6])
{
  if (motion == EQM_MOVE_NOT) return 0;
  if (motion == EQM_MOVE_SPHERE) {
    const PetscReal ax = PetscAbsReal(x[0]), ay = PetscAbsReal(x[1]), az = PetscAbsReal(x[2]);
    const PetscReal axis[3] = {ax <= ay && ax <= az, ay < ax && ay <= az, az < ax && az < ay};
    PetscReal length;
    EqmCross(axis, x, frame);
    length = PetscSqrtReal(EqmDot3(frame, frame));
    for (PetscInt k = 0; k < 3; k++) frame[k] /= length;
    EqmCross(x, frame, frame + 3);
    return 2;
  }
  frame[0] = motion == EQM_MOVE_CIRCLE ? -x[1] : motion != EQM_MOVE_SIDE_Y;
  frame[1] = motion == EQM_MOVE_CIRCLE ? x[0] : motion == EQM_MOVE_SIDE_Y;
  frame[2] = 0.;
  frame[3] = 1.;
  return motion == EQM_MOVE_PLANE ? 2 : 1;
}

/* Project a point back to the circle or the sphere. */
static inline void EqmRetract(EqmMotion motion, PetscReal *x)
{
  const PetscInt dim = motion == EQM_MOVE_SPHERE ? 3 : 2;
  PetscReal squared = 0.;

  if (motion != EQM_MOVE_SPHERE && motion != EQM_MOVE_CIRCLE) return;
  for (PetscInt k = 0; k < dim; k++) squared += x[k] * x[k];
  for (PetscInt k = 0; k < dim; k++) x[k] /= PetscSqrtReal(squared);
}

#endif
