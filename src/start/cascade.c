/* First maps by a cascade of ever finer meshes (src/hierarchy): smooth, without folds, at a cost that grows with the
   number of vertices. The hierarchy is on one rank. */
#include "start/start.h"
#include "domain/domain_private.h"
#include "hierarchy/cascade.h"

/* From several ranks no larger mesh is gathered on the first. */
static const PetscInt most_gathered = 1000000;

static EqmCascadeTarget TargetOf(EqmDomain domain)
{
  if (domain->dim == 3) return EQM_TARGET_SPHERE;
  return domain->motion[1] == &EqmMotionCircle ? EQM_TARGET_DISK : EQM_TARGET_SQUARE;
}

static PetscErrorCode Cascade(EqmProblem problem, EqmIterate iterate, EqmCascadeResult *result)
{
  const EqmDomain domain = problem->domain;
  const EqmMesh mesh = problem->mesh;
  EqmHierarchyOptions levels;
  EqmCascadeOptions options;
  EqmHierarchy hierarchy;
  PetscBool *corner;
  PetscReal *x;

  PetscFunctionBegin;
  PetscCall(EqmDomainPlaceBoundary(domain, &iterate->place));
  PetscCall(PetscMalloc2(mesh->num_local, &corner, mesh->rank == 0 ? domain->dim * mesh->num_vertices : 0, &x));
  for (PetscInt v = 0; v < mesh->num_local; v++) corner[v] = (PetscBool)(EqmDomainMotion(domain, v) == &EqmMotionCorner);
  PetscCall(EqmHierarchyOptionsDefault(&levels));
  PetscCall(EqmCascadeOptionsDefault(&options));
  levels.corner = corner;
  PetscCall(EqmHierarchyCreate(mesh, &levels, &hierarchy));
  PetscCall(EqmHierarchyGather(hierarchy, domain->dim, iterate->place.x, x));
  PetscCall(EqmCascade(hierarchy, TargetOf(domain), &options, x, result));
  PetscCall(EqmHierarchyScatter(hierarchy, domain->dim, x, iterate->place.x));
  PetscCall(EqmMeshUpdateGhosts(mesh, domain->dim, iterate->place.x));
  PetscCall(EqmHierarchyDestroy(&hierarchy));
  PetscCall(PetscFree2(corner, x));
  PetscFunctionReturn(0);
}

/* The cascade, or the guarded start where it does not serve. */
static PetscErrorCode Run(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  const EqmStartType *const guarded = problem->domain->dim == 3 ? &EqmStartSphereGuarded : &EqmStartPlaneGuarded;
  EqmStartOptions other = *options;
  EqmCascadeResult result = {.folds = 0};

  PetscFunctionBegin;
  if (problem->domain->motion[1] == &EqmMotionHeldOnCircle) {
    PetscCall(EqmProblemNotify(problem, "the start cascade moves the boundary, which is held: guarded instead\n"));
  } else if (problem->mesh->size > 1 && problem->mesh->num_vertices > most_gathered) {
    PetscCall(EqmProblemNotify(problem,
                               "the start cascade works on one rank: not from several for more than %" PetscInt_FMT
                               " vertices; guarded instead\n",
                               most_gathered));
  } else {
    PetscCall(Cascade(problem, iterate, &result));
    if (result.folds == 0) PetscFunctionReturn(0);
    PetscCall(EqmProblemNotify(problem,
                               "the start cascade ends with %" PetscInt_FMT
                               " triangles folded or too small to tell; guarded instead\n",
                               result.folds));
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
