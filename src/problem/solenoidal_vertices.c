/* Sums over vertices of the space of solenoidal motions. Vertices are sorted by the splines that they meet, so that
   eight of them are computed at once, with the same coefficients, direction after direction. */
#include "problem/solenoidal_private.h"
#include "mesh/mesh_private.h"

enum { LANES = 8, VERTICES_OF_PART = 1024, FIELDS = EQM_FIELDS_PER_SPLINE };

/* ---- parts */

static PetscInt BaseOf(const PetscReal x[3], PetscInt base[3])
{
  for (PetscInt k = 0; k < 3; k++) base[k] = EqmSplineBase(x[k]);
  return EqmSplinePlace(base[0], base[1], base[2]);
}

PetscErrorCode EqmSolenoidalMakeParts(EqmSolenoidal space, const PetscReal *x)
{
  const PetscInt n = space->problem->mesh->num_owned;
  PetscInt start[EQM_SPLINES + 1] = {0}, base[3];

  PetscFunctionBegin;
  if (!space->part) {
    const PetscInt most = EQM_SPLINES + n / VERTICES_OF_PART;
    PetscCall(PetscMalloc3(n, &space->vertex, most + 1, &space->part, EQM_FIELDS_OF_PART * most, &space->partial));
  }
  for (PetscInt v = 0; v < n; v++) start[BaseOf(x + 3 * v, base) + 1]++;
  space->num_parts = 0;
  for (PetscInt s = 0; s < EQM_SPLINES; s++) {
    start[s + 1] += start[s];
    for (PetscInt from = start[s]; from < start[s + 1]; from += VERTICES_OF_PART)
      space->part[space->num_parts++] = from;
  }
  space->part[space->num_parts] = n;
  for (PetscInt v = 0; v < n; v++) space->vertex[start[BaseOf(x + 3 * v, base)]++] = v;
  PetscFunctionReturn(0);
}

/* Which of all fields those of a part are, spline by spline for each of the four; -1: none. */
static void FieldsOfPart(EqmSolenoidal space, const PetscReal *x, PetscInt part, PetscInt *field)
{
  PetscInt base[3];

  BaseOf(x + 3 * space->vertex[space->part[part]], base);
  for (PetscInt m = 0; m < EQM_SPLINES_AT_POINT; m++) {
    const PetscInt place = EqmSplinePlace(base[0] - 1 + m / 9, base[1] - 1 + m / 3 % 3, base[2] - 1 + m % 3);
    const PetscInt which = space->number[place];
    for (PetscInt f = 0; f < FIELDS; f++)
      field[EQM_SPLINES_AT_POINT * f + m] = which < 0 ? -1 : f * space->num_splines + which;
  }
}

/* ---- eight vertices */

/* Their places, and the splines of each direction there. */
typedef struct {
  Vector8 x[3], value[3][3], derivative[3][3];
} Eight;

/* Row k of eight: component k of vectors at `count` vertices, of which the last one fills up. */
EQM_INLINE void Gather(const PetscInt *vertex, PetscInt count, const PetscReal *from, PetscReal to[3][LANES])
{
  for (PetscInt l = 0; l < LANES; l++) {
    const PetscReal *const at = from + 3 * vertex[PetscMin(l, count - 1)];
    for (PetscInt k = 0; k < 3; k++) to[k][l] = at[k];
  }
}

EQM_INLINE void EightAt(const PetscReal place[3][LANES], Eight *e)
{
  for (PetscInt k = 0; k < 3; k++) {
    PetscReal offset[LANES];
    for (PetscInt l = 0; l < LANES; l++) offset[l] = EqmSplineOffset(place[k][l], EqmSplineBase(place[k][l]));
    e->x[k] = *(const Vector8 *)place[k];
    EQM_SPLINES_OF_OFFSET(*(const Vector8 *)offset, e->value[k], e->derivative[k]);
  }
}

/* ---- P^T */

/* sum += products of the fields with the velocities a: EqmSolenoidalAgainst, the factors along each direction taken
   out of the sums over the others. */
EQM_INLINE void Against(const Eight *e, const Vector8 a[3], Vector8 *sum)
{
  const Vector8 *const x = e->x, bubble = 1. - x[0] * x[0] - x[1] * x[1] - x[2] * x[2];
  const Vector8 b[3] = {bubble * a[0], bubble * a[1], bubble * a[2]};
  const Vector8 turn[3] = {x[1] * a[2] - x[2] * a[1], x[2] * a[0] - x[0] * a[2], x[0] * a[1] - x[1] * a[0]},
                none = {0.};
  /* per field: of the value, and of the three derivatives */
  const Vector8 factor[FIELDS][4] = {{2. * turn[0], none, -b[2], b[1]},
                                     {2. * turn[1], b[2], none, -b[0]},
                                     {2. * turn[2], -b[1], b[0], none},
                                     {none, turn[0], turn[1], turn[2]}};

  for (PetscInt f = 0; f < FIELDS; f++) {
    for (PetscInt i = 0; i < 3; i++) {
      const Vector8 along = factor[f][0] * e->value[0][i] + factor[f][1] * e->derivative[0][i];
      const Vector8 second = factor[f][2] * e->value[0][i], third = factor[f][3] * e->value[0][i];
      for (PetscInt j = 0; j < 3; j++) {
        const Vector8 of_value = along * e->value[1][j] + second * e->derivative[1][j],
                      of_derivative = third * e->value[1][j];
        for (PetscInt k = 0; k < 3; k++) *sum++ += of_value * e->value[2][k] + of_derivative * e->derivative[2][k];
      }
    }
  }
}

EQM_CLONES static void RestrictPart(const PetscInt *vertex, PetscInt count, const PetscReal *x, const PetscReal *a,
                                    PetscReal *product)
{
  Vector8 sum[EQM_FIELDS_OF_PART];

  for (PetscInt m = 0; m < EQM_FIELDS_OF_PART; m++) sum[m] = (Vector8){0.};
  for (PetscInt from = 0; from < count; from += LANES) {
    PetscReal place[3][LANES], velocity[3][LANES];
    Vector8 lanes[3];
    Eight e;
    Gather(vertex + from, count - from, x, place);
    Gather(vertex + from, count - from, a, velocity);
    for (PetscInt k = 0; k < 3; k++) {
      for (PetscInt l = count - from; l < LANES; l++) velocity[k][l] = 0.;
      lanes[k] = *(const Vector8 *)velocity[k];
    }
    EightAt(place, &e);
    Against(&e, lanes, sum);
  }
  for (PetscInt m = 0; m < EQM_FIELDS_OF_PART; m++) {
    product[m] = 0.;
    for (PetscInt l = 0; l < LANES; l++) product[m] += sum[m][l];
  }
}

void EqmSolenoidalRestrict(EqmSolenoidal space, const PetscReal *x, const PetscReal *a, PetscReal *coefficient)
{
  PetscInt field[EQM_FIELDS_OF_PART];

#pragma omp parallel for schedule(dynamic)
  for (PetscInt p = 0; p < space->num_parts; p++)
    RestrictPart(space->vertex + space->part[p], space->part[p + 1] - space->part[p], x, a,
                 space->partial + EQM_FIELDS_OF_PART * p);
  for (PetscInt i = 0; i < space->size; i++) coefficient[i] = 0.;
  for (PetscInt p = 0; p < space->num_parts; p++) {
    FieldsOfPart(space, x, p, field);
    for (PetscInt m = 0; m < EQM_FIELDS_OF_PART; m++) {
      if (field[m] >= 0) coefficient[field[m]] += space->partial[EQM_FIELDS_OF_PART * p + m];
    }
  }
}

/* ---- P */

/* A field's coefficients times the splines: the value, and the three derivatives. */
EQM_INLINE void Combine(const Eight *e, const PetscReal *c, Vector8 sum[4])
{
  for (PetscInt m = 0; m < 4; m++) sum[m] = (Vector8){0.};
  for (PetscInt i = 0; i < 3; i++) {
    Vector8 value = {0.}, second = {0.}, third = {0.};
    for (PetscInt j = 0; j < 3; j++, c += 3) {
      const Vector8 along = c[0] * e->value[2][0] + c[1] * e->value[2][1] + c[2] * e->value[2][2];
      const Vector8 across = c[0] * e->derivative[2][0] + c[1] * e->derivative[2][1] + c[2] * e->derivative[2][2];
      value += along * e->value[1][j];
      second += along * e->derivative[1][j];
      third += across * e->value[1][j];
    }
    sum[0] += value * e->value[0][i];
    sum[1] += value * e->derivative[0][i];
    sum[2] += second * e->value[0][i];
    sum[3] += third * e->value[0][i];
  }
}

/* Sums of w x c_123 + (grad phi x x) c_4, w = grad((1 - |x|^2) phi). */
EQM_CLONES static void ProlongPart(const PetscInt *vertex, PetscInt count, const PetscReal *x, const PetscReal *c,
                                   PetscReal *a)
{
  for (PetscInt from = 0; from < count; from += LANES) {
    PetscReal place[3][LANES];
    Vector8 s[FIELDS][4], bubble;
    Eight e;
    Gather(vertex + from, count - from, x, place);
    EightAt(place, &e);
    for (PetscInt f = 0; f < FIELDS; f++) Combine(&e, c + EQM_SPLINES_AT_POINT * f, s[f]);
    bubble = 1. - e.x[0] * e.x[0] - e.x[1] * e.x[1] - e.x[2] * e.x[2];
    for (PetscInt k = 0; k < 3; k++) {
      const PetscInt i = (k + 1) % 3, j = (k + 2) % 3;
      const Vector8 sum = bubble * (s[j][1 + i] - s[i][1 + j]) - 2. * (e.x[i] * s[j][0] - e.x[j] * s[i][0]) +
                          s[3][1 + i] * e.x[j] - s[3][1 + j] * e.x[i];
      for (PetscInt l = 0; l < PetscMin(LANES, count - from); l++) a[3 * vertex[from + l] + k] = sum[l];
    }
  }
}

void EqmSolenoidalProlong(EqmSolenoidal space, const PetscReal *x, const PetscReal *coefficient, PetscReal *a)
{
#pragma omp parallel for schedule(dynamic)
  for (PetscInt p = 0; p < space->num_parts; p++) {
    PetscInt field[EQM_FIELDS_OF_PART];
    PetscReal c[EQM_FIELDS_OF_PART];
    FieldsOfPart(space, x, p, field);
    for (PetscInt m = 0; m < EQM_FIELDS_OF_PART; m++) c[m] = field[m] < 0 ? 0. : coefficient[field[m]];
    ProlongPart(space->vertex + space->part[p], space->part[p + 1] - space->part[p], x, c, a);
  }
}
