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

/* The map after one relaxation in the place of the map before, if it is better and has no folds; `gained`: by more than
   a twentieth. */
static PetscErrorCode RelaxOnce(EqmProblem problem, EqmRelaxer relaxer, const EqmCascadeOptions *options,
                                EqmIterate iterate, EqmPlace *trial, PetscBool *gained)
{
  const PetscReal least_gain = .05;
  EqmCascadeResult result;
  EqmLevels *levels;
  PetscBool in_order;
  PetscInt64 folds;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetLevels(problem, &levels));
  PetscCall(EqmRelaxerSetImage(relaxer, options, iterate->place.x));
  PetscCall(EqmLevelsRelax(levels, relaxer, options, &iterate->place, trial, &result));
  PetscCall(EqmPlaceMakeFrames(problem->domain, trial));
  PetscCall(EqmImageFolds(problem->domain, trial, iterate->image, &folds));
  PetscCall(EqmDomainBoundaryInOrder(problem->domain, trial, &in_order));
  *gained = (PetscBool)(in_order && folds == 0 && result.objective < (1. - least_gain) * result.before);
  if (*gained) PetscCall(EqmPlaceCopy(problem->domain, trial, &iterate->place));
  PetscFunctionReturn(0);
}

/* What -method cascade does (method/cascade.c), from a map without folds. */
static PetscErrorCode RelaxOnLevels(EqmProblem problem, EqmIterate iterate)
{
  enum { MOST = 10, SWEEPS = 2 };
  PetscBool gained = PETSC_TRUE;
  EqmCascadeOptions options;
  EqmLevels *levels;
  EqmRelaxer relaxer;
  EqmPlace trial;

  PetscFunctionBegin;
  PetscCall(EqmCascadeOptionsDefault(&options));
  options.sweeps = SWEEPS;
  options.least_gain = 0.;
  PetscCall(EqmProblemGetLevels(problem, &levels));
  PetscCall(EqmLevelsCreateRelaxer(levels, &relaxer));
  PetscCall(EqmPlaceCreate(problem->domain, &trial));
  for (PetscInt k = 0; k < MOST && gained; k++) {
    options.epsilon_finest = k == 0 ? .01 : .001;
    PetscCall(RelaxOnce(problem, relaxer, &options, iterate, &trial, &gained));
  }
  PetscCall(EqmPlaceDestroy(&trial));
  PetscCall(EqmRelaxerDestroy(&relaxer));
  PetscFunctionReturn(0);
}

/* The cascade; where it does not serve the guarded start, relaxed on the levels if there are any. */
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
                                 " triangles folded or too small to tell; guarded and relaxed instead\n",
                                 result.folds));
    else
      PetscCall(EqmProblemNotify(problem,
                                 "the start cascade ends with a boundary out of order; guarded and relaxed instead\n"));
  }
  other.steps = guarded->steps;
  PetscCall(guarded->run(problem, iterate, &other));
  if (!obstacle) {
    PetscInt64 folds;
    PetscCall(EqmPlaceMakeFrames(problem->domain, &iterate->place));
    PetscCall(EqmImageFolds(problem->domain, &iterate->place, iterate->image, &folds));
    if (folds == 0) PetscCall(RelaxOnLevels(problem, iterate));
  }
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartPlaneCascade = {
    EQM_STARTS_PLANE, "cascade",
    "from coarse to fine: collapsed edges come back level by level, areas balanced with angles; never folds", 0, Run};
const EqmStartType EqmStartSphereCascade = {
    EQM_STARTS_SPHERE, "cascade",
    "from a tetrahedron to the mesh: collapsed edges come back, areas balanced with angles; never folds", 0, Run};
