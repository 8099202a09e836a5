/* Meshes whose areas or volumes would over- or underflow are computed in a unit of their own, 2^unit of the files'. */
#include "register/registration.h"
#include "base/quiet.h"
#include "mesh/mesh_private.h"
#include "mesh/soup_private.h"
#include <math.h>

PetscErrorCode EqmTakeUnitOfA(EqmRegistration r)
{
  EqmIntake *const a = &r->a.intake, *const b = &r->b.intake;
  const PetscInt shift = b->unit - a->unit;
  char message[EQM_MESSAGE_MAX];
  PetscErrorCode error;

  PetscFunctionBegin;
  if (shift == 0) PetscFunctionReturn(0);
  PetscCall(EqmSoupShift(b->given, shift));
  if (b->mapped != b->given) PetscCall(EqmSoupShift(b->mapped, shift));
  b->unit = a->unit;
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmSoupCheckExtent(b->given);
  PetscCall(PetscPopErrorHandler());
  if (error)
    EqmFail(r->comm, EQM_ERR_MESH,
            "%s and %s differ in size by so many powers of ten that they have no place in one space: scale one of them "
            "with equimap convert IN OUT -scale FACTOR",
            a->given->file, b->given->file);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRestoreUnit(EqmRegistration r)
{
  const int unit = (int)r->a.intake.unit;
  EqmLandmarkList *const list = &r->landmarks;

  PetscFunctionBegin;
  if (unit == 0) PetscFunctionReturn(0);
  PetscCall(EqmMapRestoreUnit(r->map, unit));
  if (r->found != r->map) PetscCall(EqmMapRestoreUnit(r->found, unit));
  if (r->bare) PetscFunctionReturn(0);
  PetscCall(EqmSoupShift(r->b.soup, unit));
  r->b.map->distortion.mesh_measure = ldexp(r->b.map->distortion.mesh_measure, unit * (r->b.soup->cell_size - 1));
  for (PetscInt k = 0; k < 3 * r->b.mesh->num_owned; k++) r->inverse_image[k] = ldexp(r->inverse_image[k], unit);
  for (PetscInt k = 0; r->set.points == EQM_POINTS_SURFACE && list->width == 3 && k < 3 * list->num; k++)
    list->other[k] = ldexp(list->other[k], unit);
  PetscFunctionReturn(0);
}
