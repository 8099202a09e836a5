#include "problem/problem.h"
#include "domain/domain_private.h"
#include "problem/term.h"
#include <stdarg.h>

PetscErrorCode EqmProblemCreate(EqmDomain domain, const EqmObjective *objective, EqmProblem *out)
{
  EqmProblem problem;

  PetscFunctionBegin;
  PetscCall(PetscNew(&problem));
  problem->comm = domain->mesh->comm;
  problem->mesh = domain->mesh;
  problem->domain = domain;
  problem->objective = objective;
  PetscCall(EqmOrderingCreate(problem->mesh, &problem->ordering));
  *out = problem;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemDestroy(EqmProblem *problem)
{
  EqmProblem p = *problem;

  PetscFunctionBegin;
  if (!p) PetscFunctionReturn(0);
  PetscCall(EqmLinearDestroy(&p->scalar));
  PetscCall(EqmProblemDropLevels(p));
  PetscCall(EqmOrderingDestroy(&p->ordering));
  PetscCall(PetscFree(p->scalar_count));
  PetscCall(PetscFree(p->angle_weights));
  PetscCall(PetscFree(p->vertex_mass));
  PetscCall(EqmLandmarksReset(&p->landmarks));
  PetscCall(EqmProblemDestroyTerms(p));
  PetscCall(EqmDomainDestroy(&p->domain));
  PetscCall(PetscFree(*problem));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemNotify(EqmProblem problem, const char *format, ...)
{
  char text[EQM_MESSAGE_MAX];
  va_list arguments;

  PetscFunctionBegin;
  if (!problem->notify) PetscFunctionReturn(0);
  va_start(arguments, format);
  PetscCall(PetscVSNPrintf(text, sizeof(text), format, NULL, arguments));
  va_end(arguments);
  PetscCall(problem->notify(problem->context, text));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemStopRequested(EqmProblem problem, PetscBool *stop)
{
  PetscFunctionBegin;
  *stop = PETSC_FALSE;
  if (problem->stop_requested) PetscCall(problem->stop_requested(problem->context, stop));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemGetAngleWeights(EqmProblem problem, const PetscReal **weights)
{
  PetscFunctionBegin;
  if (!problem->angle_weights) {
    PetscCall(PetscMalloc1(3 * problem->mesh->num_local_cells, &problem->angle_weights));
    PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_COTANGENT, NULL, problem->angle_weights));
  }
  *weights = problem->angle_weights;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemGetVertexMass(EqmProblem problem, const PetscReal **mass)
{
  PetscFunctionBegin;
  if (!problem->vertex_mass) {
    PetscCall(PetscMalloc1(problem->mesh->num_owned + 1, &problem->vertex_mass)); /* of a rank without vertices, too */
    PetscCall(EqmMeshVertexWeights(problem->mesh, problem->vertex_mass));
  }
  *mass = problem->vertex_mass;
  PetscFunctionReturn(0);
}
