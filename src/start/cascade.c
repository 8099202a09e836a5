/* First maps by a cascade of ever finer meshes (src/hierarchy): smooth, without folds, at a cost that grows with the
   number of vertices. */
#include "start/start.h"
#include "domain/domain_private.h"
#include "problem/levels.h"

static PetscErrorCode Cascade(EqmProblem problem, EqmIterate iterate, EqmCascadeResult *result)
{
  EqmCascadeOptions options;
  EqmLevels *levels;

  PetscFunctionBegin;
  PetscCall(EqmDomainPlaceBoundary(problem->domain, &iterate->place));
  PetscCall(EqmCascadeOptionsDefault(&options));
  PetscCall(EqmProblemGetLevels(problem, &levels));
  PetscCall(EqmLevelsCascade(levels, &options, &iterate->place, result));
  PetscFunctionReturn(0);
}

/* The cascade, or the guarded start where it does not serve. */
static PetscErrorCode Run(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  const EqmStartType *const guarded = problem->domain->dim == 3 ? &EqmStartSphereGuarded : &EqmStartPlaneGuarded;
  const char *const obstacle = EqmLevelsObstacle(problem);
  EqmStartOptions other = *options;
  EqmCascadeResult result = {.folds = 0};
  PetscBool in_order;

  PetscFunctionBegin;
  if (obstacle) {
    PetscCall(EqmProblemNotify(problem, "the start cascade %s; guarded instead\n", obstacle));
  } else {
    PetscCall(Cascade(problem, iterate, &result));
    PetscCall(EqmDomainBoundaryInOrder(problem->domain, &iterate->place, &in_order));
    if (result.folds == 0 && in_order) PetscFunctionReturn(0);
    if (result.folds > 0)
      PetscCall(EqmProblemNotify(problem,
                                 "the start cascade ends with %" PetscInt_FMT
                                 " triangles folded or too small to tell; guarded instead\n",
                                 result.folds));
    else
      PetscCall(EqmProblemNotify(problem, "the start cascade ends with a boundary out of order; guarded instead\n"));
  }
  other.steps = guarded->steps;
  PetscCall(guarded->run(problem, iterate, &other));
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartPlaneCascade = {
    EQM_STARTS_PLANE, "cascade",
    "from coarse to fine: collapsed edges come back level by level, areas balanced with angles; never folds", 0, Run};
const EqmStartType EqmStartSphereCascade = {
    EQM_STARTS_SPHERE, "cascade",
    "from a tetrahedron to the mesh: collapsed edges come back, areas balanced with angles; never folds", 0, Run};
