/* Measures of image simplices and their derivatives: the innermost functions of every loop over cells. */
#ifndef EQM_KERNEL_H
#define EQM_KERNEL_H

#include <petscsys.h>

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

#endif
