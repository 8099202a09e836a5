/* Geometry of one simplex: products of vectors, areas and volumes with their derivatives; the innermost functions of
   every loop over cells. Knows no mesh: below all other folders but base. */
#ifndef EQM_SIMPLEX_H
#define EQM_SIMPLEX_H

#include <equimap/simplex.h>

/* A point of the plane in one register: both coordinates are added and scaled at once. */
typedef PetscReal EqmPoint2 __attribute__((vector_size(2 * sizeof(PetscReal)), aligned(sizeof(PetscReal)), may_alias));

/* Area of a triangle in space (001 (2.5)). */
static inline PetscReal EqmArea3(const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  const PetscReal u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
  const PetscReal x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
  return .5 * PetscSqrtReal(x * x + y * y + z * z);
}

/* Signed area of a triangle in the plane. Differences first: what cancels is then the edges' own error only. */
static inline PetscReal EqmArea2(const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  return .5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]));
}

/* Signed volume of a tetrahedron. */
static inline PetscReal EqmVolume(const PetscReal *p, const PetscReal *q, const PetscReal *r, const PetscReal *s)
{
  const PetscReal u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
  const PetscReal w[3] = {s[0] - p[0], s[1] - p[1], s[2] - p[2]};
  return ((u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
          (u[0] * v[1] - u[1] * v[0]) * w[2]) /
         6.;
}

/* Gradient of the planar signed area: g[2 a + c] = d area / d (coordinate c of corner a). Constant along the opposite
   edge's normal: half the opposite edge turned by a right angle. */
static inline void EqmArea2Gradient(const PetscReal *p, const PetscReal *q, const PetscReal *r, PetscReal g[6])
{
  g[0] = .5 * (q[1] - r[1]);
  g[1] = .5 * (r[0] - q[0]);
  g[2] = .5 * (r[1] - p[1]);
  g[3] = .5 * (p[0] - r[0]);
  g[4] = .5 * (p[1] - q[1]);
  g[5] = .5 * (q[0] - p[0]);
}

static inline void EqmCross(const PetscReal u[3], const PetscReal v[3], PetscReal w[3])
{
  w[0] = u[1] * v[2] - u[2] * v[1];
  w[1] = u[2] * v[0] - u[0] * v[2];
  w[2] = u[0] * v[1] - u[1] * v[0];
}

static inline PetscReal EqmDot3(const PetscReal u[3], const PetscReal v[3])
{
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* Area of a triangle from the lengths of its edges, accurate for needles (Kahan); zero if they do not close. */
static inline PetscReal EqmAreaOfLengths(const PetscReal length[3])
{
  const PetscReal low = PetscMin(length[0], length[1]), high = PetscMax(length[0], length[1]);
  const PetscReal a = PetscMax(high, length[2]), b = PetscMax(low, PetscMin(high, length[2])),
                  c = PetscMin(low, length[2]);

  return .25 * PetscSqrtReal(PetscMax((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c)), 0.));
}

/* Half the determinant of three points: positive where they run counterclockwise seen from outside the sphere, and near
   the flat area where the triangle is small. */
static inline PetscReal EqmHalfDet(const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  const PetscReal u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
  PetscReal n[3];
  EqmCross(u, v, n); /* differences first: the cross product of two points that are close has few digits */
  return .5 * EqmDot3(p, n);
}

/* Numerator and denominator of the tangent of half the solid angle of three points of the unit sphere (Van Oosterom and
   Strackee 1983, (8)): det(p, q, r) and 1 + p.q + q.r + r.p. */
static inline void EqmSolidAngleTerms(const PetscReal *const p[], PetscReal *det, PetscReal *denominator)
{
  *det = 2. * EqmHalfDet(p[0], p[1], p[2]);
  *denominator = 1. + EqmDot3(p[0], p[1]) + EqmDot3(p[1], p[2]) + EqmDot3(p[2], p[0]);
}

static inline PetscReal EqmSolidAngle(const PetscReal *const p[])
{
  PetscReal det, denominator;

  EqmSolidAngleTerms(p, &det, &denominator);
  return 2. * PetscAtan2Real(det, denominator);
}

/* As the formula above extends beyond the sphere: its tangential part is the angle's. */
static inline void EqmSolidAngleGradient(const PetscReal *const p[], PetscReal *g)
{
  PetscReal det, denominator, scale;

  EqmSolidAngleTerms(p, &det, &denominator);
  scale = 2. / (det * det + denominator * denominator);
  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal *const q = p[(a + 1) % 3], *const r = p[(a + 2) % 3];
    EqmCross(q, r, g + 3 * a);
    for (PetscInt k = 0; k < 3; k++) g[3 * a + k] = scale * (denominator * g[3 * a + k] - det * (q[k] + r[k]));
  }
}

/* Of 2 atan2(n, m): 2 ((m n'' - n m'') - 2 (m n' - n m') (n n' + m m') / s) / s, s = n^2 + m^2. */
static inline PetscReal EqmSolidAngleSecondDerivative(const PetscReal *const p[], const PetscReal *const d[])
{
  PetscReal n, m, n1, m1 = 0., n2, m2 = 0.;

  EqmSolidAngleTerms(p, &n, &m);
  n1 = 2. * (EqmHalfDet(d[0], p[1], p[2]) + EqmHalfDet(p[0], d[1], p[2]) + EqmHalfDet(p[0], p[1], d[2]));
  n2 = 4. * (EqmHalfDet(d[0], d[1], p[2]) + EqmHalfDet(d[0], p[1], d[2]) + EqmHalfDet(p[0], d[1], d[2]));
  for (PetscInt a = 0; a < 3; a++) {
    m1 += EqmDot3(d[a], p[(a + 1) % 3]) + EqmDot3(p[a], d[(a + 1) % 3]);
    m2 += 2. * EqmDot3(d[a], d[(a + 1) % 3]);
  }
  const PetscReal s = n * n + m * m;
  return 2. * ((m * n2 - n * m2) - 2. * (m * n1 - n * m1) * (n * n1 + m * m1) / s) / s;
}

/* ---- one interface to the measures: value, gradient by corner and coordinate, second derivative along straight
   motions; `p` are the corners' positions, `d` their velocities. `kind` is a constant wherever these are called, so
   that each loop is compiled for its measure. */
enum { EQM_MAX_CORNERS = 4 };

static inline PetscInt EqmMeasureDim(EqmMeasureKind kind)
{
  return kind == EQM_MEASURE_AREA2 ? 2 : 3;
}

static inline PetscInt EqmMeasureCorners(EqmMeasureKind kind)
{
  return kind == EQM_MEASURE_VOLUME ? 4 : 3;
}

static inline PetscReal EqmMeasureValue(EqmMeasureKind kind, const PetscReal *const p[])
{
  if (kind == EQM_MEASURE_AREA2) return EqmArea2(p[0], p[1], p[2]);
  if (kind == EQM_MEASURE_VOLUME) return EqmVolume(p[0], p[1], p[2], p[3]);
  if (kind == EQM_MEASURE_SOLID_ANGLE) return EqmSolidAngle(p);
  return kind == EQM_MEASURE_AREA3 ? EqmArea3(p[0], p[1], p[2]) : EqmHalfDet(p[0], p[1], p[2]);
}

/* The edges of a tetrahedron from its first corner. */
static inline void EqmEdgesFromFirst(const PetscReal *const p[], PetscReal e[3][3])
{
  for (PetscInt a = 0; a < 3; a++) {
    for (PetscInt k = 0; k < 3; k++) e[a][k] = p[a + 1][k] - p[0][k];
  }
}

/* The volume's gradient at a corner is a third of the opposite face's area along its normal (003 section 3). */
static inline void EqmVolumeGradient(const PetscReal *const p[], PetscReal *g)
{
  PetscReal e[3][3];

  EqmEdgesFromFirst(p, e);
  for (PetscInt a = 0; a < 3; a++) {
    EqmCross(e[(a + 1) % 3], e[(a + 2) % 3], g + 3 * (a + 1));
    for (PetscInt k = 0; k < 3; k++) g[3 * (a + 1) + k] *= 1. / 6.;
  }
  for (PetscInt k = 0; k < 3; k++) g[k] = -(g[3 + k] + g[6 + k] + g[9 + k]);
}

/* The flat area's gradient at a corner is half the opposite edge turned in the triangle's plane (001 Appendix A,
   corrected); the determinant's is half the cross product of the other two. */
static inline void EqmMeasureGradient(EqmMeasureKind kind, const PetscReal *const p[], PetscReal *g)
{
  if (kind == EQM_MEASURE_AREA2) {
    EqmArea2Gradient(p[0], p[1], p[2], g);
    return;
  }
  if (kind == EQM_MEASURE_VOLUME) {
    EqmVolumeGradient(p, g);
    return;
  }
  if (kind == EQM_MEASURE_SOLID_ANGLE) {
    EqmSolidAngleGradient(p, g);
    return;
  }
  if (kind == EQM_MEASURE_HALF_DET) {
    for (PetscInt a = 0; a < 3; a++) EqmCross(p[(a + 1) % 3], p[(a + 2) % 3], g + 3 * a);
    for (PetscInt k = 0; k < 9; k++) g[k] *= .5;
    return;
  }
  const PetscReal u[3] = {p[1][0] - p[0][0], p[1][1] - p[0][1], p[1][2] - p[0][2]};
  const PetscReal v[3] = {p[2][0] - p[0][0], p[2][1] - p[0][1], p[2][2] - p[0][2]};
  PetscReal n[3], squared, scale;
  EqmCross(u, v, n);
  squared = EqmDot3(n, n);
  scale = squared > 0. ? .5 / PetscSqrtReal(squared) : 0.; /* a triangle shrunk to nothing has no normal */
  for (PetscInt k = 0; k < 3; k++) n[k] *= scale;
  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal *const s = p[(a + 1) % 3], *const t = p[(a + 2) % 3];
    const PetscReal e[3] = {t[0] - s[0], t[1] - s[1], t[2] - s[2]};
    EqmCross(n, e, g + 3 * a);
  }
}

static inline PetscReal EqmDet3(const PetscReal u[3], const PetscReal v[3], const PetscReal w[3])
{
  PetscReal n[3];

  EqmCross(u, v, n);
  return EqmDot3(n, w);
}

/* The volume is a third of a cubic form of the edges: its second derivative has one term per pair of moving edges. */
static inline PetscReal EqmVolumeSecondDerivative(const PetscReal *const p[], const PetscReal *const d[])
{
  PetscReal e[3][3], f[3][3];

  EqmEdgesFromFirst(p, e);
  EqmEdgesFromFirst(d, f);
  return (EqmDet3(f[0], f[1], e[2]) + EqmDet3(f[0], e[1], f[2]) + EqmDet3(e[0], f[1], f[2])) / 3.;
}

/* d2/dt2 of the measure of p + t d at t = 0. */
static inline PetscReal EqmMeasureSecondDerivative(EqmMeasureKind kind, const PetscReal *const p[],
                                                   const PetscReal *const d[])
{
  if (kind == EQM_MEASURE_AREA2) return 2. * EqmArea2(d[0], d[1], d[2]); /* the area is quadratic */
  if (kind == EQM_MEASURE_VOLUME) return EqmVolumeSecondDerivative(p, d);
  if (kind == EQM_MEASURE_SOLID_ANGLE) return EqmSolidAngleSecondDerivative(p, d);
  if (kind == EQM_MEASURE_HALF_DET)
    return 2. * (EqmHalfDet(d[0], d[1], p[2]) + EqmHalfDet(d[0], p[1], d[2]) + EqmHalfDet(p[0], d[1], d[2]));
  /* a = |N|/2, N = N0 + t N1 + t^2 N2 */
  PetscReal u[3], v[3], du[3], dv[3], n[3], n1[3], n2[3], part[3];
  for (PetscInt k = 0; k < 3; k++) {
    u[k] = p[1][k] - p[0][k];
    v[k] = p[2][k] - p[0][k];
    du[k] = d[1][k] - d[0][k];
    dv[k] = d[2][k] - d[0][k];
  }
  EqmCross(u, v, n);
  EqmCross(du, v, n1);
  EqmCross(u, dv, part);
  EqmCross(du, dv, n2);
  for (PetscInt k = 0; k < 3; k++) n1[k] += part[k];
  const PetscReal length = PetscSqrtReal(EqmDot3(n, n)), along = EqmDot3(n, n1) / length;
  return .5 * ((EqmDot3(n1, n1) - along * along) + 2. * EqmDot3(n, n2)) / length;
}

#endif
