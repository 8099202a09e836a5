#include "problem/levels.h"
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"

/* From several ranks no larger mesh is gathered on the first. */
static const PetscInt most_gathered = 1000000;

static EqmCascadeTarget TargetOf(EqmDomain domain)
{
  if (domain->dim == 3) return EQM_TARGET_SPHERE;
  return domain->motion[1] == &EqmMotionCircle ? EQM_TARGET_DISK : EQM_TARGET_SQUARE;
}

const char *EqmLevelsObstacle(EqmProblem problem)
{
  if (problem->domain->motion[1] == &EqmMotionHeldOnCircle) return "moves the boundary, which is held";
  if (problem->mesh->size > 1 && problem->mesh->num_vertices > most_gathered)
    return "works on one rank: not from several for more than a million vertices";
  return NULL;
}

PetscErrorCode EqmLevelsCreate(EqmProblem problem, EqmLevels *levels)
{
  const EqmDomain domain = problem->domain;
  const EqmMesh mesh = problem->mesh;
  EqmHierarchyOptions options;
  PetscBool *corner;

  PetscFunctionBegin;
  levels->problem = problem;
  levels->target = TargetOf(domain);
  PetscCall(PetscMalloc1(mesh->rank == 0 ? domain->dim * mesh->num_vertices : 0, &levels->x));
  PetscCall(PetscMalloc1(mesh->num_local, &corner));
  for (PetscInt v = 0; v < mesh->num_local; v++)
    corner[v] = (PetscBool)(EqmDomainMotion(domain, v) == &EqmMotionCorner);
  PetscCall(EqmHierarchyOptionsDefault(&options));
  options.corner = corner;
  PetscCall(EqmHierarchyCreate(mesh, &options, &levels->hierarchy));
  PetscCall(PetscFree(corner));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelsDestroy(EqmLevels *levels)
{
  PetscFunctionBegin;
  if (levels->hierarchy) PetscCall(EqmHierarchyDestroy(&levels->hierarchy));
  PetscCall(PetscFree(levels->x));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelsGather(EqmLevels *levels, const EqmPlace *place)
{
  PetscFunctionBegin;
  PetscCall(EqmHierarchyGather(levels->hierarchy, levels->problem->domain->dim, place->x, levels->x));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelsScatter(EqmLevels *levels, EqmPlace *place)
{
  const PetscInt dim = levels->problem->domain->dim;

  PetscFunctionBegin;
  PetscCall(EqmHierarchyScatter(levels->hierarchy, dim, levels->x, place->x));
  PetscCall(EqmMeshUpdateGhosts(levels->problem->mesh, dim, place->x));
  PetscFunctionReturn(0);
}
