/* The angle energy beside another one (docs/methods.md, Uniqueness): Dirichlet's less the area. */
#include "problem/term.h"
#include "mesh/mesh_private.h"

typedef struct {
  struct _p_EqmTerm term;
  const PetscReal *weights; /* cotangents, the problem's */
  PetscReal *image;
} AngleTerm;

static PetscErrorCode Add(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                          PetscReal *value, Vec gradient)
{
  AngleTerm *const angle = (AngleTerm *)term;
  PetscReal energy;
  EqmWork *work;
  Vec part = NULL;

  PetscFunctionBegin;
  (void)image;
  if (gradient) PetscCall(VecDuplicate(gradient, &part));
  PetscCall(EqmConformalEnergy(problem->domain, angle->weights, NULL, place, angle->image, &energy, part));
  PetscCall(EqmLedgerGetWork(problem->mesh->ledger, &work));
  work->evaluations--; /* one evaluation of the whole */
  *value += term->weight * energy;
  if (gradient) PetscCall(VecAXPY(gradient, term->weight, part));
  PetscCall(VecDestroy(&part));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmTerm term)
{
  AngleTerm *angle = (AngleTerm *)term;

  PetscFunctionBegin;
  PetscCall(PetscFree(angle->image));
  PetscCall(PetscFree(angle));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmTermCreateAngle(EqmProblem problem, PetscReal weight, EqmTerm *term)
{
  AngleTerm *angle;

  PetscFunctionBegin;
  PetscCall(PetscNew(&angle));
  angle->term = (struct _p_EqmTerm){.name = "angle", .weight = weight, .add = Add, .destroy = Destroy};
  PetscCall(EqmProblemGetAngleWeights(problem, &angle->weights));
  PetscCall(PetscMalloc1(problem->mesh->num_local_cells, &angle->image));
  *term = &angle->term;
  PetscFunctionReturn(0);
}
