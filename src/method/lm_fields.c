/* Motions that the Gauss-Newton matrix hardly sees, for multigrid's coarse spaces. Its first part, a divergence
   squared, vanishes on fields without divergence and its second, the damping, is small on smooth ones: both at once on
   the smooth divergence-free fields, of which a patch of the map sees those of lowest order. */
#include "method/lm.h"
#include "domain/domain_private.h"

enum { PLANAR_FIELDS = 5, SPHERE_FIELDS = 8 };

/* Plane: two translations and the linear fields without divergence. */
static void PlanarField(PetscInt which, const PetscReal *x, PetscReal *field)
{
  const PetscReal values[PLANAR_FIELDS][2] = {{1., 0.}, {0., 1.}, {-x[1], x[0]}, {x[0], -x[1]}, {x[1], x[0]}};

  field[0] = values[which][0];
  field[1] = values[which][1];
}

/* Sphere: x times the gradient of a stream function, which is a coordinate (rotations: Killing's fields) or a harmonic
   quadratic. */
static void SphereField(PetscInt which, const PetscReal *x, PetscReal *field)
{
  const PetscReal gradient[SPHERE_FIELDS][3] = {{1., 0., 0.},      {0., 1., 0.},     {0., 0., 1.},
                                                {x[1], x[0], 0.},  {0., x[2], x[1]}, {x[2], 0., x[0]},
                                                {x[0], -x[1], 0.}, {0., x[1], -x[2]}};
  const PetscReal *const g = gradient[which];

  field[0] = x[1] * g[2] - x[2] * g[1];
  field[1] = x[2] * g[0] - x[0] * g[2];
  field[2] = x[0] * g[1] - x[1] * g[0];
}

/* Tell the linear solver, if it wants to know. Collective. */
PetscErrorCode EqmLmSetFields(EqmMethod method)
{
  EqmLm *const lm = method->data;
  const PetscBool sphere = method->problem->domain->curved_image;

  PetscFunctionBegin;
  PetscCall(EqmProblemSetFields(method->problem, &lm->now.place, lm->linear, sphere ? SPHERE_FIELDS : PLANAR_FIELDS,
                                sphere ? SphereField : PlanarField));
  PetscFunctionReturn(0);
}
