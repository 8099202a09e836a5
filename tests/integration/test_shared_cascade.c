/* Cascades on levels that all ranks share: no fold, as good as on one rank's own hierarchy, and the same map on any
   number of ranks and threads. */
#include "support/testing.h"
#include "hierarchy/relaxer.h"
#include "hierarchy/sharedcascade.h"
#include "mesh/mesh_private.h"
#include <omp.h>

typedef struct {
  TestMesh mesh;
  EqmDomain domain;
  EqmPlace place;
  EqmCascadeResult result, after;
} Test;

static PetscErrorCode CreateDomain(EqmMesh mesh, EqmCascadeTarget target, EqmDomain *domain)
{
  PetscFunctionBegin;
  if (target == EQM_TARGET_DISK)
    PetscCall(EqmDomainCreateDisk(mesh, domain));
  else if (target == EQM_TARGET_SQUARE)
    PetscCall(EqmDomainCreateSquare(mesh, NULL, domain));
  else
    PetscCall(EqmDomainCreateSphere(mesh, domain));
  PetscFunctionReturn(0);
}

/* `shared`: on small shared levels, then relaxed once more; else on the hierarchy of the first rank. `steps`:
   Gauss-Newton steps per level. */
static PetscErrorCode Run(MPI_Comm comm, const char *shape, PetscInt n, EqmCascadeTarget target, PetscBool shared,
                          PetscInt steps, Test *test)
{
  EqmHierarchyOptions options;
  EqmCascadeOptions cascade;
  EqmHierarchy hierarchy;
  EqmRelaxer relaxer;
  EqmShared levels;
  PetscBool *corner;
  PetscReal *x;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(comm, shape, n, 1, &test->mesh));
  PetscCall(CreateDomain(test->mesh.mesh, target, &test->domain));
  PetscCall(EqmPlaceCreate(test->domain, &test->place));
  PetscCall(EqmDomainPlaceBoundary(test->domain, &test->place));
  PetscCall(PetscMalloc1(test->mesh.mesh->num_local, &corner));
  for (PetscInt v = 0; v < test->mesh.mesh->num_local; v++)
    corner[v] = (PetscBool)(EqmDomainMotion(test->domain, v) == &EqmMotionCorner);
  PetscCall(EqmHierarchyOptionsDefault(&options));
  PetscCall(EqmCascadeOptionsDefault(&cascade));
  cascade.steps = steps;
  options.corner = corner;
  options.gathered = 600;
  options.vertices_of_piece = 600;
  if (shared) {
    PetscCall(EqmSharedCreate(test->mesh.mesh, &options, &levels));
    CHECK(levels->num_levels > 2, "%d levels", (int)levels->num_levels);
    PetscCall(EqmSharedCascade(levels, target, &cascade, test->place.x, &test->result));
    cascade.epsilon_finest = .01;
    PetscCall(EqmRelaxerCreate(NULL, levels, target, &relaxer));
    PetscCall(EqmRelaxerRun(relaxer, &cascade, test->place.x, &test->after));
    PetscCall(EqmRelaxerDestroy(&relaxer));
    PetscCall(EqmSharedDestroy(&levels));
  } else {
    PetscCall(EqmHierarchyCreate(test->mesh.mesh, &options, &hierarchy));
    PetscCall(PetscMalloc1(test->domain->dim * hierarchy->level[0].num_vertices, &x));
    PetscCall(EqmHierarchyGather(hierarchy, test->domain->dim, test->place.x, x));
    PetscCall(EqmCascade(hierarchy, target, &cascade, x, &test->result));
    PetscCall(EqmHierarchyDestroy(&hierarchy));
    PetscCall(PetscFree(x));
  }
  PetscCall(PetscFree(corner));
  PetscFunctionReturn(0);
}

static PetscErrorCode End(Test *test)
{
  PetscFunctionBegin;
  PetscCall(EqmPlaceDestroy(&test->place));
  PetscCall(EqmDomainDestroy(&test->domain));
  PetscCall(TestMeshDestroy(&test->mesh));
  PetscFunctionReturn(0);
}

/* The map's triangles counted by the domain, not by the cascade. */
static PetscErrorCode CheckFolds(Test *test, const char *what)
{
  EqmMesh mesh = test->mesh.mesh;
  const PetscInt dim = test->domain->dim;
  PetscReal folds = 0.;

  PetscFunctionBegin;
  PetscCall(EqmMeshUpdateGhosts(mesh, dim, test->place.x));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    const PetscReal *const p = test->place.x + dim * v[0], *const q = test->place.x + dim * v[1],
                           *const r = test->place.x + dim * v[2];
    folds += !((dim == 2 ? EqmArea2(p, q, r) : EqmHalfDet(p, q, r)) > 0.);
  }
  folds = TestSum(PETSC_COMM_WORLD, folds);
  CHECK(folds == 0., "%s: %g folds", what, (double)folds);
  PetscFunctionReturn(0);
}

/* At most `worse` times the objective on one rank's hierarchy. */
static PetscErrorCode TestValue(const char *shape, PetscInt n, EqmCascadeTarget target, PetscReal worse)
{
  Test all, first;

  PetscFunctionBegin;
  PetscCall(Run(PETSC_COMM_WORLD, shape, n, target, PETSC_TRUE, 1, &all));
  PetscCall(Run(PETSC_COMM_WORLD, shape, n, target, PETSC_FALSE, 1, &first));
  CHECK(all.result.folds == 0 && all.after.folds == 0, "%s: folds", shape);
  PetscCall(CheckFolds(&all, shape));
  CHECK(all.result.objective < worse * first.result.objective, "%s: objective %g, not %g", shape,
        (double)all.result.objective, (double)first.result.objective);
  CHECK(all.after.objective < all.after.before, "%s: relaxed from %g to %g", shape, (double)all.after.before,
        (double)all.after.objective);
  PetscCall(End(&all));
  PetscCall(End(&first));
  PetscFunctionReturn(0);
}

/* Without steps, which sum in another order, the same map on all ranks together and on each alone with three threads.
   The weights of cells depend on the number of ranks by their last bits; on one they do not. */
static PetscErrorCode TestRanks(const char *shape, PetscInt n, EqmCascadeTarget target)
{
  const PetscInt dim = target == EQM_TARGET_SPHERE ? 3 : 2;
  Test alone, all;
  PetscReal *ours, *theirs, close;
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(Run(PETSC_COMM_WORLD, shape, n, target, PETSC_TRUE, 0, &all));
  omp_set_num_threads(3);
  PetscCall(Run(PETSC_COMM_SELF, shape, n, target, PETSC_TRUE, 0, &alone));
  omp_set_num_threads(1);
  soup = all.mesh.soup;
  close = all.mesh.mesh->size == 1 ? 0. : 1e-7;
  PetscCall(PetscCalloc2(dim * soup->num_vertices, &ours, dim * soup->num_vertices, &theirs));
  PetscCall(EqmMeshVerticesToInput(alone.mesh.mesh, alone.mesh.soup, dim, alone.place.x, theirs));
  PetscCall(EqmMeshVerticesToInput(all.mesh.mesh, soup, dim, all.place.x, ours));
  for (PetscInt k = 0; k < dim * (soup->vertex_end - soup->vertex_start); k++)
    CHECK_CLOSE(ours[k], theirs[k + dim * soup->vertex_start], close, 1.);
  PetscCall(PetscFree2(ours, theirs));
  PetscCall(End(&alone));
  PetscCall(End(&all));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestValue("hills", 5000, EQM_TARGET_DISK, 1.1));
  PetscCall(TestValue("patch", 5000, EQM_TARGET_SQUARE, 1.1));
  PetscCall(TestValue("head", 5000, EQM_TARGET_SPHERE, 1.1));
  PetscCall(TestValue("starfish", 6000, EQM_TARGET_SPHERE, 1.5));
  PetscCall(TestRanks("hills", 4000, EQM_TARGET_DISK));
  PetscCall(TestRanks("head", 4000, EQM_TARGET_SPHERE));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
