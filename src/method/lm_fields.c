/* Motions that the Gauss-Newton matrix hardly sees, for multigrid's coarse spaces. Its first part, a divergence
   squared, vanishes on fields without divergence and its second, the damping, is small on smooth ones: both at once on
   the smooth divergence-free fields, of which a patch of the map sees those of lowest order. */
#include "method/lm.h"

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
PetscErrorCode EqmLmSetFields(EqmSolver solver)
{
  EqmLm *const lm = solver->data;
  const EqmDomain domain = solver->domain;
  const PetscBool sphere = domain->curved_image;
  const PetscInt dim = domain->dim, count = sphere ? SPHERE_FIELDS : PLANAR_FIELDS;
  PetscReal *fields;

  PetscFunctionBegin;
  if (!lm->linear->set_fields) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(count * domain->num_dofs, &fields));
  for (PetscInt k = 0; k < count; k++) {
    const PetscScalar *dofs;
    for (PetscInt v = 0; v < solver->mesh->num_owned; v++) {
      const PetscReal *const x = lm->now.place.x + dim * v;
      if (sphere)
        SphereField(k, x, lm->ambient + dim * v);
      else
        PlanarField(k, x, lm->ambient + dim * v);
    }
    PetscCall(EqmDomainProject(domain, &lm->now.place, lm->ambient, lm->direction));
    PetscCall(VecGetArrayRead(lm->direction, &dofs));
    PetscCall(PetscArraycpy(fields + k * domain->num_dofs, dofs, domain->num_dofs));
    PetscCall(VecRestoreArrayRead(lm->direction, &dofs));
  }
  PetscCall(EqmLinearSetFields(lm->linear, count, fields));
  PetscCall(PetscFree(fields));
  PetscFunctionReturn(0);
}
