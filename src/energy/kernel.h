/* Measures of image simplices and their derivatives: the innermost functions of every loop over cells. */
#ifndef EQM_KERNEL_H
#define EQM_KERNEL_H

#include <equimap/domain.h>

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

/* Half the determinant of three points: positive where they run counterclockwise seen from outside the sphere, and near
   the flat area where the triangle is small. */
static inline PetscReal EqmHalfDet(const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  PetscReal n[3];
  EqmCross(q, r, n);
  return .5 * EqmDot3(p, n);
}

/* ---- one interface to the measures: value, gradient by corner and coordinate, second derivative along straight
   motions. `kind` is a constant wherever these are called, so that each loop is compiled for its measure. */

static inline PetscInt EqmMeasureDim(EqmMeasureKind kind)
{
  return kind == EQM_MEASURE_AREA2 ? 2 : 3;
}

static inline PetscReal EqmMeasureValue(EqmMeasureKind kind, const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  if (kind == EQM_MEASURE_AREA2) return EqmArea2(p, q, r);
  return kind == EQM_MEASURE_AREA3 ? EqmArea3(p, q, r) : EqmHalfDet(p, q, r);
}

/* The flat area's gradient at a corner is half the opposite edge turned in the triangle's plane (001 Appendix A,
   corrected); the determinant's is half the cross product of the other two. */
static inline void EqmMeasureGradient(EqmMeasureKind kind, const PetscReal *p, const PetscReal *q, const PetscReal *r,
                                      PetscReal g[9])
{
  const PetscReal *const corner[5] = {p, q, r, p, q};

  if (kind == EQM_MEASURE_AREA2) {
    EqmArea2Gradient(p, q, r, g);
    return;
  }
  if (kind == EQM_MEASURE_HALF_DET) {
    for (PetscInt a = 0; a < 3; a++) EqmCross(corner[a + 1], corner[a + 2], g + 3 * a);
    for (PetscInt k = 0; k < 9; k++) g[k] *= .5;
    return;
  }
  const PetscReal u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
  PetscReal n[3], scale;
  EqmCross(u, v, n);
  scale = .5 / PetscSqrtReal(EqmDot3(n, n));
  for (PetscInt k = 0; k < 3; k++) n[k] *= scale;
  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal *const s = corner[a + 1], *const t = corner[a + 2], e[3] = {t[0] - s[0], t[1] - s[1], t[2] - s[2]};
    EqmCross(n, e, g + 3 * a);
  }
}

/* d2/dt2 of the measure of p + t dp, q + t dq, r + t dr at t = 0. */
static inline PetscReal EqmMeasureBend(EqmMeasureKind kind, const PetscReal *p, const PetscReal *q, const PetscReal *r,
                                       const PetscReal *dp, const PetscReal *dq, const PetscReal *dr)
{
  if (kind == EQM_MEASURE_AREA2) return 2. * EqmArea2(dp, dq, dr); /* the area is quadratic */
  if (kind == EQM_MEASURE_HALF_DET) return 2. * (EqmHalfDet(dp, dq, r) + EqmHalfDet(dp, q, dr) + EqmHalfDet(p, dq, dr));
  /* a = |N|/2, N = N0 + t N1 + t^2 N2 */
  PetscReal u[3], v[3], du[3], dv[3], n[3], n1[3], n2[3], part[3];
  for (PetscInt k = 0; k < 3; k++) {
    u[k] = q[k] - p[k];
    v[k] = r[k] - p[k];
    du[k] = dq[k] - dp[k];
    dv[k] = dr[k] - dp[k];
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
