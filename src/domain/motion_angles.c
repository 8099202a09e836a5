/* Vertices on the unit sphere that move by their spherical coordinates, polar angle and azimuth (003 (4), (5)). */
#include <equimap/domain.h>

/* 003 (4). */
static void FromAngles(const PetscReal angle[2], PetscReal x[3])
{
  const PetscReal s = PetscSinReal(angle[0]), c = PetscCosReal(angle[0]);
  const PetscReal t = PetscSinReal(angle[1]), d = PetscCosReal(angle[1]);

  x[0] = s * d;
  x[1] = s * t;
  x[2] = c;
}

/* 003 (5). */
static void ToAngles(const PetscReal x[3], PetscReal angle[2])
{
  angle[0] = PetscAtan2Real(PetscSqrtReal(x[0] * x[0] + x[1] * x[1]), x[2]);
  angle[1] = PetscAtan2Real(x[1], x[0]);
}

/* Not orthonormal: the columns turn gradients into derivatives with respect to the angles (003 (7)). */
static void Frame(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal *frame)
{
  const PetscReal s = PetscSinReal(stored[0]), c = PetscCosReal(stored[0]);
  const PetscReal t = PetscSinReal(stored[1]), d = PetscCosReal(stored[1]);
  const PetscReal by_polar[3] = {c * d, c * t, -s}, by_azimuth[3] = {-s * t, s * d, 0.};

  (void)dim;
  (void)x;
  for (PetscInt k = 0; k < 3; k++) {
    frame[k] = by_polar[k];
    frame[3 + k] = by_azimuth[k];
  }
}

static void Retract(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t, const PetscScalar *dofs,
                    PetscReal *y, PetscReal *new_stored)
{
  (void)dim;
  (void)x;
  for (PetscInt k = 0; k < 2; k++) new_stored[k] = stored[k] + t * dofs[k];
  FromAngles(new_stored, y);
}

static void ChooseFrame(const PetscReal *x, PetscReal *stored)
{
  ToAngles(x, stored);
}

const EqmVertexMotion EqmMotionAngles = {
    .name = "spherical-coordinates", .num_dofs = 2, .frame = Frame, .retract = Retract, .choose_frame = ChooseFrame};
