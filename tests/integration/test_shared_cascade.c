/* Cascades on levels that all ranks share: no fold, as good as on one rank's own hierarchy, and the same map on any
   number of ranks and threads. */
#include "support/testing.h"
#include "hierarchy/sharedcascade.h"
#include "mesh/mesh_private.h"
#include <omp.h>

typedef struct {
  TestMesh mesh;
  EqmDomain domain;
  EqmPlace place;
  EqmCascadeResult result, before;
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

/* `shared`: on small shared levels; else on the hierarchy of the first rank. Then relaxed twice more. */
static PetscErrorCode Run(MPI_Comm comm, const char *shape, PetscInt n, EqmCascadeTarget target, PetscBool shared,
                          Test *test)
{
  EqmHierarchyOptions options;
  EqmCascadeOptions cascade;
  EqmHierarchy hierarchy;
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
  options.corner = corner;
  options.gathered = 600;
  options.vertices_of_piece = 600;
  if (shared) {
    PetscCall(EqmSharedCreate(test->mesh.mesh, &options, &levels));
    CHECK(levels->num_levels > 2, "%d levels", (int)levels->num_levels);
    PetscCall(EqmSharedCascade(levels, target, &cascade, test->place.x, &test->result));
    cascade.epsilon_finest = .01;
    PetscCall(EqmSharedCascadeRelax(levels, target, &cascade, test->place.x, &test->before));
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

/* At most `worse` times the objective on one rank's hierarchy. The weights of cells depend on the number of ranks by
   their last bits, which a hard shape magnifies without bound: then `close` is infinite on several. */
static PetscErrorCode TestCascade(const char *shape, PetscInt n, EqmCascadeTarget target, PetscReal worse,
                                  PetscReal close)
{
  Test alone, together, first;
  PetscReal *ours, *theirs;

  PetscFunctionBegin;
  PetscCall(Run(PETSC_COMM_WORLD, shape, n, target, PETSC_TRUE, &together));
  PetscCall(Run(PETSC_COMM_WORLD, shape, n, target, PETSC_FALSE, &first));
  omp_set_num_threads(3);
  PetscCall(Run(PETSC_COMM_SELF, shape, n, target, PETSC_TRUE, &alone));
  omp_set_num_threads(1);
  CHECK(together.result.folds == 0 && together.before.folds == 0, "%s: folds", shape);
  PetscCall(CheckFolds(&together, shape));
  CHECK(together.result.objective < worse * first.result.objective, "%s: objective %g, not %g", shape,
        (double)together.result.objective, (double)first.result.objective);
  CHECK(together.before.objective < together.before.before, "%s: relaxed from %g to %g", shape,
        (double)together.before.before, (double)together.before.objective);
  PetscCall(PetscCalloc2(3 * alone.mesh.soup->num_vertices, &ours, 3 * alone.mesh.soup->num_vertices, &theirs));
  PetscCall(EqmMeshVerticesToInput(alone.mesh.mesh, alone.mesh.soup, alone.domain->dim, alone.place.x, theirs));
  PetscCall(EqmMeshVerticesToInput(together.mesh.mesh, together.mesh.soup, alone.domain->dim, together.place.x, ours));
  for (PetscInt k = 0; k < alone.domain->dim * (together.mesh.soup->vertex_end - together.mesh.soup->vertex_start); k++)
    CHECK_CLOSE(ours[k], theirs[k + alone.domain->dim * together.mesh.soup->vertex_start], close, 1.);
  PetscCall(PetscFree2(ours, theirs));
  PetscCall(End(&alone));
  PetscCall(End(&together));
  PetscCall(End(&first));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscMPIInt size;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(TestCascade("hills", 5000, EQM_TARGET_DISK, 1.3, 1e-7));
  PetscCall(TestCascade("patch", 5000, EQM_TARGET_SQUARE, 1.3, 1e-7));
  PetscCall(TestCascade("head", 5000, EQM_TARGET_SPHERE, 1.3, 1e-7));
  PetscCall(TestCascade("starfish", 6000, EQM_TARGET_SPHERE, 5., size == 1 ? 0. : PETSC_INFINITY));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
