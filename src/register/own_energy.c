/* The energy of h itself, which moves the target: its mesh is the image of f, and what it should keep are the areas
   there (000 section 6 gives E_A(h)). */
#include "register/registration.h"
#include "geometry/simplex.h"
#include "mesh/mesh_private.h"

static PetscReal Area(const EqmRegistration r, const PetscReal *x, const PetscInt *v)
{
  if (r->dim == 2) return EqmArea2(x + 2 * v[0], x + 2 * v[1], x + 2 * v[2]);
  return EqmArea3(x + 3 * v[0], x + 3 * v[1], x + 3 * v[2]);
}

PetscErrorCode EqmMeasureOwnEnergy(EqmRegistration r, const PetscReal *before)
{
  const EqmSide *const side = &r->a;
  const EqmMesh mesh = side->mesh;
  PetscReal sum[2] = {0., 0.}, squares = 0.;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    sum[0] += Area(r, before, mesh->cells + 3 * c);
    sum[1] += Area(r, side->x, mesh->cells + 3 * c);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, r->comm));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscReal w = Area(r, before, mesh->cells + 3 * c) / sum[0], a = Area(r, side->x, mesh->cells + 3 * c);
    if (w > 0.) squares += w * PetscSqr(a / (sum[1] * w) - 1.);
  }
  PetscCall(MPIU_Allreduce(&squares, &r->figures.own_energy, 1, MPIU_REAL, MPIU_SUM, r->comm));
  r->figures.own_energy *= sum[1];
  PetscFunctionReturn(0);
}
