/* The fields of the space of solenoidal motions at a point. */
#ifndef EQM_SOLENOIDAL_PRIVATE_H
#define EQM_SOLENOIDAL_PRIVATE_H

#include "linalg/dense_vectors.h"
#include "problem/solenoidal.h"

/* B-splines stand EQM_SPLINE_STEP apart, in a cube of EQM_SPLINE_SIDE of them each way around the ball; three each way
   are not zero at a point. */
#define EQM_SPLINE_STEP .4
enum { EQM_SPLINE_SIDE = 9, EQM_SPLINES = 729, EQM_FIELDS_PER_SPLINE = 4, EQM_SPLINES_AT_POINT = 27 };
enum { EQM_FIELDS_OF_PART = EQM_FIELDS_PER_SPLINE * EQM_SPLINES_AT_POINT };

struct _p_EqmSolenoidal {
  EqmProblem problem;
  PetscInt number[EQM_SPLINES]; /* of those that reach into the ball, others: -1 */
  PetscInt num_splines;         /* of these */
  PetscInt size;                /* fields in all: the first of every spline, then the second, ... */
  PetscScalar *factor;          /* Cholesky's, size x size by columns; NULL before the first */
  PetscReal *coefficient;
  PetscReal *ambient;      /* velocities in space, per owned vertex */
  PetscInt *vertex, *part; /* owned vertices, sorted; parts of the list, whose vertices meet the same splines */
  PetscInt num_parts;
  PetscReal *partial; /* sums over the parts */
};

/* Splines at x with their gradients: spline (base + (i, j, k) - 1) is number 9 i + 3 j + k. */
typedef struct {
  PetscInt base[3];
  PetscReal value[EQM_SPLINES_AT_POINT], gradient[3][EQM_SPLINES_AT_POINT];
} EqmSplines;

/* How many steps from the centre the middle one of the splines at x is. */
EQM_INLINE PetscInt EqmSplineBase(PetscReal x)
{
  const PetscInt half = EQM_SPLINE_SIDE / 2, nearest = (PetscInt)PetscFloorReal(x / EQM_SPLINE_STEP + .5);

  return PetscMax(1 - half, PetscMin(half - 1, nearest));
}

/* How many steps x lies behind it; half a step at most, as nothing is beyond the ball. */
EQM_INLINE PetscReal EqmSplineOffset(PetscReal x, PetscInt base)
{
  return PetscMax(-.5, PetscMin(.5, x / EQM_SPLINE_STEP - (PetscReal)base));
}

/* There, values and derivatives of three quadratic B-splines; numbers or vectors. */
#define EQM_SPLINES_OF_OFFSET(t, value, derivative)                                                                    \
  do {                                                                                                                 \
    (value)[0] = .5 * (.5 - (t)) * (.5 - (t));                                                                         \
    (value)[1] = .75 - (t) * (t);                                                                                      \
    (value)[2] = .5 * (.5 + (t)) * (.5 + (t));                                                                         \
    (derivative)[0] = ((t)-.5) / EQM_SPLINE_STEP;                                                                      \
    (derivative)[1] = -2. * (t) / EQM_SPLINE_STEP;                                                                     \
    (derivative)[2] = ((t) + .5) / EQM_SPLINE_STEP;                                                                    \
  } while (0)

/* The same in one direction at x, the middle one `base` steps from the centre. */
EQM_INLINE PetscInt EqmSplinesAlong(PetscReal x, PetscReal value[3], PetscReal derivative[3])
{
  const PetscInt base = EqmSplineBase(x);
  const PetscReal t = EqmSplineOffset(x, base);

  EQM_SPLINES_OF_OFFSET(t, value, derivative);
  return base;
}

EQM_INLINE void EqmSplinesAt(const PetscReal x[3], EqmSplines *s)
{
  PetscReal v[3][3], d[3][3];

  for (PetscInt k = 0; k < 3; k++) s->base[k] = EqmSplinesAlong(x[k], v[k], d[k]);
  for (PetscInt i = 0; i < 3; i++) {
    for (PetscInt j = 0; j < 3; j++) {
      const PetscReal plane = v[0][i] * v[1][j], by_x = d[0][i] * v[1][j], by_y = v[0][i] * d[1][j];
      for (PetscInt k = 0; k < 3; k++) {
        const PetscInt m = 9 * i + 3 * j + k;
        s->value[m] = plane * v[2][k];
        s->gradient[0][m] = by_x * v[2][k];
        s->gradient[1][m] = by_y * v[2][k];
        s->gradient[2][m] = plane * d[2][k];
      }
    }
  }
}

/* Place of a spline in the cube. */
EQM_INLINE PetscInt EqmSplinePlace(PetscInt i, PetscInt j, PetscInt k)
{
  const PetscInt half = EQM_SPLINE_SIDE / 2;

  return (EQM_SPLINE_SIDE * (i + half) + j + half) * EQM_SPLINE_SIDE + k + half;
}

/* Velocities a at x, against the four fields of each spline there: with w = grad((1 - |x|^2) phi) the first three are
   w x e_k, whose products with a are a x w; the fourth is grad phi x x. */
EQM_INLINE void EqmSolenoidalAgainst(const EqmSplines *s, const PetscReal x[3], const PetscReal a[3],
                                     PetscReal product[EQM_FIELDS_PER_SPLINE][EQM_SPLINES_AT_POINT])
{
  const PetscReal bubble = 1. - x[0] * x[0] - x[1] * x[1] - x[2] * x[2];
  const PetscReal turn[3] = {x[1] * a[2] - x[2] * a[1], x[2] * a[0] - x[0] * a[2], x[0] * a[1] - x[1] * a[0]};
  const PetscReal b[3] = {bubble * a[0], bubble * a[1], bubble * a[2]};

  for (PetscInt m = 0; m < EQM_SPLINES_AT_POINT; m++) {
    const PetscReal value = 2. * s->value[m], gx = s->gradient[0][m], gy = s->gradient[1][m], gz = s->gradient[2][m];
    product[0][m] = b[1] * gz - b[2] * gy + turn[0] * value;
    product[1][m] = b[2] * gx - b[0] * gz + turn[1] * value;
    product[2][m] = b[0] * gy - b[1] * gx + turn[2] * value;
    product[3][m] = turn[0] * gx + turn[1] * gy + turn[2] * gz;
  }
}

/* Sort the owned vertices at x for the sums over them. Not collective. */
PETSC_INTERN PetscErrorCode EqmSolenoidalMakeParts(EqmSolenoidal space, const PetscReal *x);
/* coefficient = P^T a, of this rank's velocities, and a = P coefficient, P the fields at the vertices that have been
   sorted. The same for any number of threads. Not collective. */
PETSC_INTERN void EqmSolenoidalRestrict(EqmSolenoidal space, const PetscReal *x, const PetscReal *a,
                                        PetscReal *coefficient);
PETSC_INTERN void EqmSolenoidalProlong(EqmSolenoidal space, const PetscReal *x, const PetscReal *coefficient,
                                       PetscReal *a);

#endif
