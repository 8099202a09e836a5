/* Vertices on the unit circle (000 (6)). */
#include "domain/domain_private.h"

/* The direction in which the angle grows. */
static void Frame(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal *frame)
{
  (void)dim;
  (void)stored;
  frame[0] = -x[1];
  frame[1] = x[0];
}

/* Rotate a point by an angle. The length is set to one, so that rounding does not accumulate. */
static void Retract(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t, const PetscScalar *dofs,
                    PetscReal *y, PetscReal *new_stored)
{
  const PetscReal angle = t * dofs[0], c = PetscCosReal(angle), d = PetscSinReal(angle);
  const PetscReal turned[2] = {c * x[0] - d * x[1], d * x[0] + c * x[1]};
  const PetscReal length = PetscSqrtReal(turned[0] * turned[0] + turned[1] * turned[1]);

  (void)dim;
  (void)stored;
  (void)new_stored;
  y[0] = turned[0] / length;
  y[1] = turned[1] / length;
}

/* The angle from p to q. */
static PetscReal Advance(const PetscReal *p, const PetscReal *q)
{
  return PetscAtan2Real(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]);
}

const EqmVertexMotion EqmMotionCircle = {
    .name = "circle", .num_dofs = 1, .frame = Frame, .retract = Retract, .advance = Advance, .curvature = 1.};
const EqmVertexMotion EqmMotionHeldOnCircle = {.name = "held-on-circle",
                                               .num_dofs = 0,
                                               .retract = EqmRetractNowhere,
                                               .advance = Advance};
