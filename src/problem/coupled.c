/* Matrices of all degrees of freedom of the domain. */
#include "problem/problem.h"
#include "domain/domain_private.h"

PetscErrorCode EqmProblemCreateLinear(EqmProblem problem, EqmMatrixUse use, EqmLinear *linear)
{
  const EqmUnknowns unknowns = EqmDomainUnknowns(problem->domain);

  PetscFunctionBegin;
  PetscCall(EqmLinearDestroy(&problem->scalar));
  PetscCall(PetscFree(problem->scalar_count));
  PetscCall(EqmProblemDropLevels(problem));
  PetscCall(EqmLinearCreate(problem->mesh, problem->ordering, &unknowns, use, linear));
  PetscCall(EqmLinearDescribe(*linear, problem->linear_solver, sizeof(problem->linear_solver)));
  PetscFunctionReturn(0);
}

/* Near-null fields for `linear`, if it uses them (multigrid): `field` gives the velocity of the field
   of number `which` at the place x of a vertex, in space. Collective. */
PetscErrorCode EqmProblemSetFields(EqmProblem problem, const EqmPlace *place, EqmLinear linear, PetscInt count,
                                   void (*field)(PetscInt which, const PetscReal *x, PetscReal *velocity))
{
  const EqmDomain domain = problem->domain;
  const PetscInt dim = domain->dim, num_owned = problem->mesh->num_owned;
  PetscReal *fields, *velocity;
  Vec dofs;

  PetscFunctionBegin;
  if (!linear->set_fields) PetscFunctionReturn(0);
  PetscCall(PetscMalloc2(count * domain->num_dofs, &fields, dim * num_owned, &velocity));
  PetscCall(EqmDomainCreateVec(domain, &dofs));
  for (PetscInt k = 0; k < count; k++) {
    const PetscScalar *array;
    for (PetscInt v = 0; v < num_owned; v++) field(k, place->x + dim * v, velocity + dim * v);
    PetscCall(EqmDomainProject(domain, place, velocity, dofs));
    PetscCall(VecGetArrayRead(dofs, &array));
    PetscCall(PetscArraycpy(fields + k * domain->num_dofs, array, domain->num_dofs));
    PetscCall(VecRestoreArrayRead(dofs, &array));
  }
  PetscCall(EqmLinearSetFields(linear, count, fields));
  PetscCall(VecDestroy(&dofs));
  PetscCall(PetscFree2(fields, velocity));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemSetImage(EqmProblem problem, const EqmPlace *place, EqmLinear linear)
{
  const PetscInt dim = problem->domain->dim, num_owned = problem->mesh->num_owned;
  PetscReal *frames = NULL;

  PetscFunctionBegin;
  if (!linear->set_image) PetscFunctionReturn(0);
  if (dim == 3) {
    PetscCall(PetscMalloc1(6 * num_owned, &frames));
#pragma omp parallel for schedule(static)
    for (PetscInt v = 0; v < num_owned; v++) {
      PetscReal frame[9];
      EqmDomainFrame(problem->domain, place, v, frame);
      for (PetscInt k = 0; k < 6; k++) frames[6 * v + k] = frame[k];
    }
  }
  PetscCall(EqmLinearSetImage(linear, dim, place->x, frames));
  PetscCall(PetscFree(frames));
  PetscFunctionReturn(0);
}
