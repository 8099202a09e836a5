/* Coarser meshes of a surface: each is one, stands for the whole, and leads back to the finer. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "support/levels.h"

static PetscErrorCode Make(EqmMesh mesh, const PetscBool *corner, EqmHierarchy *hierarchy)
{
  EqmHierarchyOptions options;

  PetscFunctionBegin;
  PetscCall(EqmHierarchyOptionsDefault(&options));
  options.corner = corner;
  PetscCall(EqmHierarchyCreate(mesh, &options, hierarchy));
  PetscFunctionReturn(0);
}

/* A surface; `corners`: every ninth boundary vertex has to stay. */
static PetscErrorCode TestLevels(const char *shape, PetscInt n, PetscInt euler, PetscBool corners)
{
  TestMesh test;
  EqmHierarchy hierarchy;
  PetscBool *corner;
  PetscInt64 bytes;
  PetscInt kept = 0;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 1, &test));
  PetscCall(PetscCalloc1(test.mesh->num_local, &corner));
  for (PetscInt v = 0; v < test.mesh->num_local && corners; v++) corner[v] = (PetscBool)(test.mesh->global[v] % 9 == 0);
  for (PetscInt v = 0; v < test.mesh->num_owned; v++) kept += corner[v] && test.mesh->on_boundary[v];
  kept = (PetscInt)TestSum(PETSC_COMM_WORLD, (PetscReal)kept);
  PetscCall(Make(test.mesh, corner, &hierarchy));
  for (PetscInt k = 0; k < hierarchy->num_levels; k++) {
    const EqmHierarchyLevel *const level = &hierarchy->level[k];
    PetscInt stay = 0;
    PetscCall(TestCheckLevel(level, euler));
    for (PetscInt v = 0; v < level->num_vertices; v++) stay += level->part[v] == EQM_CORNER;
    CHECK(stay == kept, "%d corners, not %d", (int)stay, (int)kept);
    if (level->num_vertices > 400) CHECK(EqmLevelWorstQuality(level) > .05, "%g", (double)EqmLevelWorstQuality(level));
    if (k == 0) continue;
    CHECK(level->num_vertices < level[-1].num_vertices, "level %d is no coarser", (int)k);
    PetscCall(TestCheckWayBack(level - 1, level));
  }
  PetscCall(EqmHierarchyMemory(hierarchy, &bytes));
  CHECK(bytes <= 400 * test.mesh->num_vertices, "%g bytes per vertex", (double)bytes / test.mesh->num_vertices);
  if (test.mesh->rank == 0 && euler == 2)
    CHECK(hierarchy->level[hierarchy->num_levels - 1].num_vertices == 4, "the coarsest is no tetrahedron");
  PetscCall(EqmHierarchyDestroy(&hierarchy));
  PetscCall(PetscFree(corner));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* The levels of all ranks together are those of each alone, and values find their way there and back. */
static PetscErrorCode TestRanks(const char *shape)
{
  TestMesh alone, together;
  EqmHierarchy a, t;
  PetscReal *finest, *back;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_SELF, shape, 1500, 1, &alone));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, 1500, 1, &together));
  PetscCall(Make(alone.mesh, NULL, &a));
  PetscCall(Make(together.mesh, NULL, &t));
  CHECK(t->num_levels == (t->rank == 0 ? a->num_levels : 0), "%d levels", (int)t->num_levels);
  for (PetscInt k = 0; k < t->num_levels; k++) {
    const EqmHierarchyLevel *const p = &a->level[k], *const q = &t->level[k];
    CHECK(p->num_cells == q->num_cells && p->num_collapses == q->num_collapses, "level %d", (int)k);
    for (PetscInt c = 0; c < 3 * q->num_cells; c++) CHECK(p->cells[c] == q->cells[c], "level %d differs", (int)k);
    for (PetscInt c = 0; c < q->num_cells; c++) CHECK_CLOSE(p->weight[c], q->weight[c], 1e-12, p->weight[c]);
  }
  PetscCall(PetscMalloc2(3 * t->level[0].num_vertices, &finest, 3 * together.mesh->num_owned, &back));
  PetscCall(EqmHierarchyGather(t, 3, together.mesh->position, finest));
  for (PetscInt k = 0; k < 3 * t->level[0].num_vertices; k++)
    CHECK(finest[k] == t->level[0].position[k], "place %d", (int)k);
  PetscCall(EqmHierarchyScatter(t, 3, finest, back));
  for (PetscInt k = 0; k < 3 * together.mesh->num_owned; k++)
    CHECK(back[k] == together.mesh->position[k], "place %d", (int)k);
  PetscCall(PetscFree2(finest, back));
  PetscCall(EqmHierarchyDestroy(&a));
  PetscCall(EqmHierarchyDestroy(&t));
  PetscCall(TestMeshDestroy(&alone));
  PetscCall(TestMeshDestroy(&together));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestRefused(void)
{
  TestMesh test;
  EqmHierarchyOptions options;
  EqmHierarchy hierarchy;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "ball", 200, 1, &test));
  PetscCall(EqmHierarchyOptionsDefault(&options));
  CHECK_FAILS(EQM_ERR_USAGE, EqmHierarchyCreate(test.mesh, &options, &hierarchy));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestLevels("hills", 3000, 1, PETSC_FALSE));
  PetscCall(TestLevels("hills", 1000, 1, PETSC_TRUE));
  PetscCall(TestLevels("cap", 1000, 1, PETSC_FALSE));
  PetscCall(TestLevels("head", 2000, 2, PETSC_FALSE));
  PetscCall(TestLevels("starfish", 1500, 2, PETSC_FALSE));
  PetscCall(TestRanks("hills"));
  PetscCall(TestRanks("head"));
  PetscCall(TestRefused());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
