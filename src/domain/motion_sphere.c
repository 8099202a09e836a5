/* Vertices on the unit sphere, in frames of their own that parallel transport carries along. */
#include <equimap/domain.h>
#include "geometry/simplex.h"

static void Frame(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal *frame)
{
  (void)dim;
  for (PetscInt k = 0; k < 3; k++) frame[k] = stored[k];
  EqmCross(x, frame, frame + 3);
}

/* Follow the great circle of velocity (s1, s2) in the frame (b, x cross b), with parallel transport of b: its
   tangential component rotates with the motion, the rest is constant. */
static void MoveOnSphere(const PetscReal *x, const PetscReal *b, PetscReal s1, PetscReal s2, PetscReal *y,
                         PetscReal *carried)
{
  const PetscReal angle = PetscSqrtReal(s1 * s1 + s2 * s2), c = PetscCosReal(angle), d = PetscSinReal(angle);
  const PetscReal u1 = angle > 0. ? s1 / angle : 1., u2 = angle > 0. ? s2 / angle : 0.;
  PetscReal b2[3], new_x[3], new_b[3], length, along;

  EqmCross(x, b, b2);
  for (PetscInt k = 0; k < 3; k++) {
    const PetscReal ahead = u1 * b[k] + u2 * b2[k];
    new_x[k] = c * x[k] + d * ahead;
    new_b[k] = b[k] + u1 * ((c - 1.) * ahead - d * x[k]);
  }
  length = PetscSqrtReal(EqmDot3(new_x, new_x));
  for (PetscInt k = 0; k < 3; k++) y[k] = new_x[k] / length;
  along = EqmDot3(new_b, y);
  for (PetscInt k = 0; k < 3; k++) new_b[k] -= along * y[k];
  length = PetscSqrtReal(EqmDot3(new_b, new_b));
  for (PetscInt k = 0; k < 3; k++) carried[k] = new_b[k] / length;
}

static void Retract(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t, const PetscScalar *dofs,
                    PetscReal *y, PetscReal *new_stored)
{
  (void)dim;
  MoveOnSphere(x, stored, t * dofs[0], t * dofs[1], y, new_stored);
}

/* At right angles to the place and to the axis farthest from it. */
static void ChooseFrame(const PetscReal *x, PetscReal *stored)
{
  PetscReal axis[3] = {0., 0., 0.}, b[3], length;
  PetscInt smallest = 0;

  for (PetscInt k = 1; k < 3; k++) smallest = PetscAbsReal(x[k]) < PetscAbsReal(x[smallest]) ? k : smallest;
  axis[smallest] = 1.;
  EqmCross(x, axis, b);
  length = PetscSqrtReal(EqmDot3(b, b));
  for (PetscInt k = 0; k < 3; k++) stored[k] = b[k] / length;
}

const EqmVertexMotion EqmMotionSphere = {
    .name = "sphere", .num_dofs = 2, .frame = Frame, .retract = Retract, .choose_frame = ChooseFrame, .curvature = 1.};
