#include "problem/levels.h"
#include "hierarchy/sharedcascade.h"
#include "linalg/onlevels.h"
#include "linalg/onshared.h"
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"

static EqmCascadeTarget TargetOf(EqmDomain domain)
{
  if (domain->dim == 3) return EQM_TARGET_SPHERE;
  return domain->motion[1] == &EqmMotionCircle ? EQM_TARGET_DISK : EQM_TARGET_SQUARE;
}

const char *EqmLevelsObstacle(EqmProblem problem)
{
  if (problem->domain->motion[1] == &EqmMotionHeldOnCircle) return "moves the boundary, which is held";
  return NULL;
}

const char *EqmLevelsObstacleToLinear(EqmProblem problem)
{
  if (problem->mesh->cell_size != 3) return "is for surfaces";
  return EqmLevelsObstacle(problem);
}

/* The options of the problem's hierarchies; `corner` is new. */
static PetscErrorCode MakeOptions(EqmProblem problem, EqmHierarchyOptions *options, PetscBool **corner)
{
  const EqmMesh mesh = problem->mesh;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local, corner));
  for (PetscInt v = 0; v < mesh->num_local; v++)
    (*corner)[v] = (PetscBool)(EqmDomainMotion(problem->domain, v) == &EqmMotionCorner);
  PetscCall(EqmHierarchyOptionsDefault(options));
  options->corner = *corner;
  PetscFunctionReturn(0);
}

static PetscErrorCode Create(EqmProblem problem, EqmLevels **levels)
{
  EqmHierarchyOptions options;
  PetscBool *corner;

  PetscFunctionBegin;
  PetscCall(PetscNew(levels));
  **levels = (EqmLevels){.problem = problem, .target = TargetOf(problem->domain)};
  PetscCall(MakeOptions(problem, &options, &corner));
  if (problem->mesh->num_vertices <= options.gathered)
    PetscCall(EqmHierarchyCreate(problem->mesh, &options, &(*levels)->hierarchy));
  else
    PetscCall(EqmSharedCreate(problem->mesh, &options, &(*levels)->shared));
  PetscCall(PetscFree(corner));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemGetLevels(EqmProblem problem, EqmLevels **levels)
{
  PetscFunctionBegin;
  if (!problem->levels) PetscCall(Create(problem, &problem->levels));
  *levels = problem->levels;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemDropLevels(EqmProblem problem)
{
  EqmLevels *const levels = problem->levels;

  PetscFunctionBegin;
  if (!levels) PetscFunctionReturn(0);
  PetscCall(EqmHierarchyDestroy(&levels->hierarchy));
  PetscCall(EqmSharedDestroy(&levels->shared));
  PetscCall(PetscFree(problem->levels));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemCreateLinearOnLevels(EqmProblem problem, EqmLinear *linear)
{
  const EqmUnknowns unknowns = EqmDomainUnknowns(problem->domain);
  EqmLevels *levels;

  PetscFunctionBegin;
  PetscCall(EqmLinearDestroy(&problem->scalar));
  PetscCall(PetscFree(problem->scalar_count));
  PetscCall(EqmProblemGetLevels(problem, &levels));
  if (levels->shared)
    PetscCall(EqmLinearCreateOnShared(problem->mesh, &unknowns, levels->shared, levels->target, linear));
  else
    PetscCall(EqmLinearCreateOnLevels(problem->mesh, &unknowns, levels->hierarchy, levels->target, linear));
  PetscCall(EqmLinearDescribe(*linear, problem->linear_solver, sizeof(problem->linear_solver)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelsCascade(EqmLevels *levels, const EqmCascadeOptions *options, EqmPlace *place,
                                EqmCascadeResult *result)
{
  const EqmHierarchy hierarchy = levels->hierarchy;
  const PetscInt dim = levels->problem->domain->dim;
  PetscReal *x;

  PetscFunctionBegin;
  if (levels->shared) {
    PetscCall(EqmSharedCascade(levels->shared, levels->target, options, place->x, result));
  } else {
    PetscCall(PetscMalloc1(dim * hierarchy->level[0].num_vertices, &x));
    PetscCall(EqmHierarchyGather(hierarchy, dim, place->x, x));
    PetscCall(EqmCascade(hierarchy, levels->target, options, x, result));
    PetscCall(EqmHierarchyScatter(hierarchy, dim, x, place->x));
    PetscCall(PetscFree(x));
  }
  PetscCall(EqmMeshUpdateGhosts(levels->problem->mesh, dim, place->x));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelsCreateRelaxer(EqmLevels *levels, EqmRelaxer *relaxer)
{
  PetscFunctionBegin;
  PetscCall(EqmRelaxerCreate(levels->hierarchy, levels->shared, levels->target, relaxer));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelsRelax(EqmLevels *levels, EqmRelaxer relaxer, const EqmCascadeOptions *options,
                              const EqmPlace *from, EqmPlace *to, EqmCascadeResult *result)
{
  const PetscInt dim = levels->problem->domain->dim;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(to->x, from->x, dim * levels->problem->mesh->num_local));
  PetscCall(EqmRelaxerRun(relaxer, options, to->x, result));
  PetscCall(EqmMeshUpdateGhosts(levels->problem->mesh, dim, to->x));
  PetscFunctionReturn(0);
}
