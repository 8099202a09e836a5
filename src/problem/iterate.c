/* Iterates: the map that a run works on. */
#include "problem/problem.h"
#include "mesh/mesh_private.h"
#include "problem/objective.h"

PetscErrorCode EqmIterateCreate(EqmProblem problem, EqmIterate *out)
{
  EqmIterate iterate;

  PetscFunctionBegin;
  PetscCall(PetscNew(&iterate));
  PetscCall(EqmPlaceCreate(problem->domain, &iterate->place));
  PetscCall(PetscMalloc1(problem->mesh->num_local_cells, &iterate->image));
  *out = iterate;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIterateDestroy(EqmIterate *iterate)
{
  PetscFunctionBegin;
  if (!*iterate) PetscFunctionReturn(0);
  PetscCall(EqmPlaceDestroy(&(*iterate)->place));
  PetscCall(PetscFree((*iterate)->image));
  PetscCall(PetscFree(*iterate));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIterateUpdate(EqmProblem problem, EqmIterate iterate)
{
  PetscFunctionBegin;
  PetscCall(EqmImageMeasure(problem->domain, &iterate->place, iterate->image));
  PetscCall(EqmIterateUpdateTotals(problem, iterate));
  PetscFunctionReturn(0);
}

PetscReal EqmIterateMeanEnergy(EqmIterate iterate)
{
  return iterate->totals.energy / iterate->totals.total;
}

PetscErrorCode EqmIterateUpdateTotals(EqmProblem problem, EqmIterate iterate)
{
  PetscFunctionBegin;
  PetscCall(problem->objective->sum(problem, iterate));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIterateAccept(EqmProblem problem, EqmIterate iterate, const EqmPlace *trial, const PetscReal *image,
                                PetscReal objective, PetscReal step_length)
{
  PetscFunctionBegin;
  PetscCall(EqmPlaceCopy(problem->domain, trial, &iterate->place));
  PetscCall(PetscArraycpy(iterate->image, image, problem->mesh->num_local_cells));
  PetscCall(EqmIterateUpdateTotals(problem, iterate));
  iterate->objective = objective;
  iterate->step_length = step_length;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIterateCenter(EqmProblem problem, EqmIterate iterate)
{
  const PetscReal *mass;
  PetscReal offset;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetVertexMass(problem, &mass));
  PetscCall(EqmPlaceCenter(problem->domain, mass, &iterate->place, &offset));
  PetscFunctionReturn(0);
}
