#include "problem/solenoidal_private.h"
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"
#include <petscblaslapack.h>

/* Number the splines that are not zero everywhere in the ball. */
static PetscInt NumberSplines(PetscInt number[EQM_SPLINES])
{
  const PetscInt half = EQM_SPLINE_SIDE / 2;
  PetscInt count = 0;

  for (PetscInt i = -half; i <= half; i++) {
    for (PetscInt j = -half; j <= half; j++) {
      for (PetscInt k = -half; k <= half; k++) {
        const PetscInt at[] = {i, j, k};
        PetscReal square = 0.;
        for (PetscInt d = 0; d < 3; d++)
          square += PetscSqr(PetscMax(0., EQM_SPLINE_STEP * ((PetscReal)PetscAbsInt(at[d]) - 1.5)));
        number[EqmSplinePlace(i, j, k)] = square < 1. ? count++ : -1;
      }
    }
  }
  return count;
}

PetscErrorCode EqmSolenoidalCreate(EqmProblem problem, EqmSolenoidal *out)
{
  EqmSolenoidal space;

  PetscFunctionBegin;
  PetscCall(PetscNew(&space));
  space->problem = problem;
  space->num_splines = NumberSplines(space->number);
  space->size = EQM_FIELDS_PER_SPLINE * space->num_splines;
  PetscCall(PetscMalloc2(space->size, &space->coefficient, 3 * problem->mesh->num_owned, &space->ambient));
  *out = space;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolenoidalDestroy(EqmSolenoidal *space)
{
  PetscFunctionBegin;
  if (!*space) PetscFunctionReturn(0);
  PetscCall(PetscFree2((*space)->coefficient, (*space)->ambient));
  PetscCall(PetscFree3((*space)->vertex, (*space)->part, (*space)->partial));
  PetscCall(PetscFree((*space)->factor));
  PetscCall(PetscFree(*space));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolenoidalSolve(EqmSolenoidal space, const EqmPlace *place, Vec g)
{
  const EqmDomain domain = space->problem->domain;
  const PetscBLASInt one = 1;
  PetscBLASInt n, info;
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(domain->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(EqmDomainExpandOwned(domain, place, g, space->ambient));
  EqmSolenoidalRestrict(space, place->x, space->ambient, space->coefficient);
  PetscCall(PetscMPIIntCast(space->size, &count));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, space->coefficient, count, MPIU_REAL, MPI_SUM, domain->mesh->comm));
  PetscCall(PetscBLASIntCast(space->size, &n));
  PetscCallBLAS("LAPACKpotrs", LAPACKpotrs_("L", &n, &one, space->factor, &n, space->coefficient, &n, &info));
  PetscCall(EqmEventEnd(domain->mesh->ledger, EQM_EVENT_SOLVE));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolenoidalAdd(EqmSolenoidal space, const EqmPlace *place, Vec h)
{
  const EqmDomain domain = space->problem->domain;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(domain->mesh->ledger, EQM_EVENT_SOLVE));
  EqmSolenoidalProlong(space, place->x, space->coefficient, space->ambient);
  PetscCall(EqmDomainAddProjected(domain, place, space->ambient, h));
  PetscCall(EqmEventEnd(domain->mesh->ledger, EQM_EVENT_SOLVE));
  PetscFunctionReturn(0);
}
