/* Coarser meshes of a surface: each is one, stands for the whole, and leads back to the finer. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "hierarchy/level.h"

static PetscErrorCode Make(EqmMesh mesh, const PetscBool *corner, EqmHierarchy *hierarchy)
{
  EqmHierarchyOptions options;

  PetscFunctionBegin;
  PetscCall(EqmHierarchyOptionsDefault(&options));
  options.corner = corner;
  PetscCall(EqmHierarchyCreate(mesh, &options, hierarchy));
  PetscFunctionReturn(0);
}

/* Edges, each once. Every edge has one triangle on either side, boundary edges one alone: `lone` counts these. */
static PetscErrorCode CountEdges(const EqmHierarchyLevel *level, PetscInt *edges, PetscInt *lone)
{
  const PetscInt n = 3 * level->num_cells;
  PetscInt *from, *to, met = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &from, n, &to));
  for (PetscInt k = 0; k < n; k++) {
    from[k] = level->cells[k];
    to[k] = level->cells[3 * (k / 3) + (k + 1) % 3];
  }
  PetscCall(PetscSortIntWithArray(n, from, to));
  for (PetscInt k = 0, end; k < n; k = end) {
    for (end = k; end < n && from[end] == from[k];) end++;
    PetscCall(PetscSortInt(end - k, to + k));
    for (PetscInt j = k + 1; j < end; j++) CHECK(to[j] != to[j - 1], "an edge runs twice from %d", (int)from[k]);
  }
  for (PetscInt k = 0; k < n; k++) { /* is there an edge the other way? */
    PetscInt at;
    PetscCall(PetscFindInt(to[k], n, from, &at));
    for (; at > 0 && from[at - 1] == to[k];) at--;
    for (; at >= 0 && at < n && from[at] == to[k] && to[at] != from[k];) at++;
    met += at >= 0 && at < n && from[at] == to[k];
  }
  *edges = met / 2 + (n - met);
  *lone = n - met;
  PetscCall(PetscFree2(from, to));
  PetscFunctionReturn(0);
}

static int CompareCells(const void *left, const void *right)
{
  const PetscInt *const a = left, *const b = right;

  for (int k = 0; k < 3; k++) {
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  }
  return 0;
}

/* The lowest corner first. */
static void Rotate(PetscInt *cell)
{
  while (cell[0] > cell[1] || cell[0] > cell[2]) {
    const PetscInt first = cell[0];
    cell[0] = cell[1];
    cell[1] = cell[2];
    cell[2] = first;
  }
}

static PetscInt FindCell(PetscInt num, const PetscInt *cells, PetscInt a, PetscInt b, PetscInt c)
{
  PetscInt wanted[3] = {a, b, c};

  Rotate(wanted);
  for (PetscInt k = 0; k < num; k++) {
    if (CompareCells(cells + 3 * k, wanted) == 0) return k;
  }
  return -1;
}

/* Undo the collapses, the last first, on the coarser level's triangles: the finer's must come out. */
static PetscErrorCode CheckWayBack(const EqmHierarchyLevel *finer, const EqmHierarchyLevel *coarser)
{
  PetscInt *cells, *wanted, num = coarser->num_cells;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * finer->num_cells, &cells, 3 * finer->num_cells, &wanted));
  for (PetscInt k = 0; k < 3 * num; k++) cells[k] = coarser->finer[coarser->cells[k]];
  for (PetscInt k = 0; k < num; k++) Rotate(cells + 3 * k);
  for (PetscInt r = finer->num_collapses; r-- > 0;) {
    const EqmCollapse *const record = &finer->collapse[r];
    const PetscInt *const ring = finer->ring + record->start, size = record->size;
    const PetscInt count = finer->part[record->vertex] == EQM_INSIDE ? size : size - 1;
    for (PetscInt k = 0; k < count; k++) {
      const PetscInt p = ring[k], q = ring[(k + 1) % size];
      PetscInt at = num;
      if (p != record->onto && q != record->onto) at = FindCell(num, cells, record->onto, p, q);
      CHECK(at >= 0 && at < finer->num_cells, "triangle %d of a star is not there", (int)k);
      num += at == num;
      cells[3 * at] = record->vertex;
      cells[3 * at + 1] = p;
      cells[3 * at + 2] = q;
      Rotate(cells + 3 * at);
    }
  }
  CHECK(num == finer->num_cells, "%d triangles, not %d", (int)num, (int)finer->num_cells);
  PetscCall(PetscArraycpy(wanted, finer->cells, 3 * num));
  for (PetscInt k = 0; k < num; k++) Rotate(wanted + 3 * k);
  qsort(wanted, num, 3 * sizeof(PetscInt), CompareCells);
  qsort(cells, num, 3 * sizeof(PetscInt), CompareCells);
  for (PetscInt k = 0; k < 3 * num; k++) CHECK(cells[k] == wanted[k], "triangle %d differs", (int)k / 3);
  PetscCall(PetscFree2(cells, wanted));
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckLevel(const EqmHierarchyLevel *level, PetscInt euler)
{
  PetscReal sum = 0.;
  PetscInt edges, lone, boundary = 0;

  PetscFunctionBegin;
  PetscCall(CountEdges(level, &edges, &lone));
  CHECK(level->num_vertices - edges + level->num_cells == euler, "Euler characteristic %d",
        (int)(level->num_vertices - edges + level->num_cells));
  for (PetscInt v = 0; v < level->num_vertices; v++) boundary += level->part[v] != EQM_INSIDE;
  CHECK(lone == level->num_boundary && boundary == lone, "%d boundary edges, %d vertices, %d said", (int)lone,
        (int)boundary, (int)level->num_boundary);
  for (PetscInt c = 0; c < level->num_cells; c++) {
    CHECK(level->weight[c] > 0., "weight %g", (double)level->weight[c]);
    sum += level->weight[c];
  }
  CHECK_CLOSE(sum, 1., 1e-12, 1.);
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
    PetscCall(CheckLevel(level, euler));
    for (PetscInt v = 0; v < level->num_vertices; v++) stay += level->part[v] == EQM_CORNER;
    CHECK(stay == kept, "%d corners, not %d", (int)stay, (int)kept);
    if (level->num_vertices > 400) CHECK(EqmLevelWorstQuality(level) > .05, "%g", (double)EqmLevelWorstQuality(level));
    if (k == 0) continue;
    CHECK(level->num_vertices < level[-1].num_vertices, "level %d is no coarser", (int)k);
    PetscCall(CheckWayBack(level - 1, level));
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
