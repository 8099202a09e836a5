/* Levels that all ranks share: each is a surface, stands for the whole, leads back to the finer, and is the same to the
   last bit on any number of ranks and threads. */
#include "support/levels.h"
#include "base/exchange.h"
#include "base/rows.h"
#include "hierarchy/shared.h"
#include "mesh/mesh_private.h"
#include <omp.h>

static PetscErrorCode Make(EqmMesh mesh, const PetscBool *corner, EqmShared *shared)
{
  EqmHierarchyOptions options;

  PetscFunctionBegin;
  PetscCall(EqmHierarchyOptionsDefault(&options));
  options.corner = corner;
  options.gathered = 300;
  options.vertices_of_piece = 400;
  PetscCall(EqmSharedCreate(mesh, &options, shared));
  PetscFunctionReturn(0);
}

typedef struct {
  PetscInt vertex, onto, size, ring[EQM_MOST_RECORD];
  PetscReal weight[EQM_MOST_RECORD];
} Record;

/* The records of all ranks, on the first, in the numbers along the curve. */
static PetscErrorCode GatherRecords(const EqmSharedLevel *shared, EqmHierarchyLevel *to)
{
  const EqmHierarchyLevel *const from = &shared->level;
  PetscMPIInt *zero;
  Record *mine, *all;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(from->num_collapses, &zero, from->num_collapses, &mine));
  for (PetscInt r = 0; r < from->num_collapses; r++) {
    const EqmCollapse *const record = &from->collapse[r];
    mine[r] = (Record){.vertex = EqmSharedGlobal(shared, record->vertex),
                       .onto = EqmSharedGlobal(shared, record->onto),
                       .size = record->size};
    for (PetscInt k = 0; k < record->size; k++) {
      mine[r].ring[k] = EqmSharedGlobal(shared, from->ring[record->start + k]);
      mine[r].weight[k] = from->ring_weight[record->start + k];
    }
  }
  PetscCall(EqmExchangeBytes(shared->comm, from->num_collapses, sizeof(*mine), zero, mine, &to->num_collapses, &all));
  PetscCall(PetscFree2(zero, mine));
  PetscCall(PetscMalloc1(to->num_collapses, &to->collapse));
  PetscCall(PetscMalloc1(EQM_MOST_RECORD * to->num_collapses, &to->ring));
  PetscCall(PetscMalloc1(EQM_MOST_RECORD * to->num_collapses, &to->ring_weight));
  for (PetscInt r = 0; r < to->num_collapses; r++) {
    to->collapse[r] =
        (EqmCollapse){.vertex = all[r].vertex, .onto = all[r].onto, .start = EQM_MOST_RECORD * r, .size = all[r].size};
    PetscCall(PetscArraycpy(to->ring + EQM_MOST_RECORD * r, all[r].ring, EQM_MOST_RECORD));
    PetscCall(PetscArraycpy(to->ring_weight + EQM_MOST_RECORD * r, all[r].weight, EQM_MOST_RECORD));
  }
  to->ring_length = EQM_MOST_RECORD * to->num_collapses;
  PetscCall(PetscFree(all));
  PetscFunctionReturn(0);
}

/* A level on the first rank; the others get an empty one. */
static PetscErrorCode Gather(const EqmSharedLevel *shared, const EqmSharedLevel *finer, EqmHierarchyLevel *to)
{
  const EqmHierarchyLevel *const from = &shared->level;
  const PetscInt foreign = shared->num_foreign_cells, owned = from->num_cells - foreign;
  PetscInt *corner, *number, *mine;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(shared->comm, &rank));
  PetscCall(PetscMemzero(to, sizeof(*to)));
  to->num_vertices = rank == 0 ? shared->num_vertices : 0;
  to->num_cells = rank == 0 ? shared->num_cells : 0;
  to->num_boundary = rank == 0 ? shared->num_boundary : 0;
  PetscCall(PetscMalloc1(3 * to->num_vertices, &to->position));
  PetscCall(PetscMalloc1(to->num_vertices, &to->part));
  PetscCall(PetscMalloc1(to->num_vertices, &to->finer));
  PetscCall(PetscMalloc1(3 * to->num_cells, &to->cells));
  PetscCall(PetscMalloc1(to->num_cells, &to->weight));
  PetscCall(PetscMalloc1(3 * owned, &corner));
  for (PetscInt k = 0; k < 3 * owned; k++) corner[k] = EqmSharedGlobal(shared, from->cells[3 * foreign + k]);
  PetscCall(
      EqmFetchSlab(shared->comm, shared->num_owned, to->num_vertices, 0, MPIU_REAL, 3, from->position, to->position));
  PetscCall(
      EqmFetchSlab(shared->comm, shared->num_owned, to->num_vertices, 0, MPI_UNSIGNED_CHAR, 1, from->part, to->part));
  PetscCall(EqmFetchSlab(shared->comm, owned, to->num_cells, 0, MPIU_INT, 3, corner, to->cells));
  PetscCall(EqmFetchSlab(shared->comm, owned, to->num_cells, 0, MPIU_REAL, 1, from->weight + foreign, to->weight));
  PetscCall(PetscFree(corner));
  if (finer) {
    PetscCall(PetscMalloc2(finer->num_owned, &number, shared->num_owned, &mine));
    for (PetscInt v = 0; v < finer->num_owned; v++) number[v] = finer->first + v;
    PetscCall(PetscSFBcastBegin(shared->from_finer, MPIU_INT, number, mine, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(shared->from_finer, MPIU_INT, number, mine, MPI_REPLACE));
    PetscCall(EqmFetchSlab(shared->comm, shared->num_owned, to->num_vertices, 0, MPIU_INT, 1, mine, to->finer));
    PetscCall(PetscFree2(number, mine));
  }
  PetscCall(GatherRecords(shared, to));
  PetscFunctionReturn(0);
}

/* Ghosts have what their owners have; cells around an owned vertex are all here, once. */
static PetscErrorCode CheckPart(const EqmSharedLevel *shared)
{
  const EqmHierarchyLevel *const level = &shared->level;
  PetscReal *number;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(level->num_vertices, &number));
  for (PetscInt v = 0; v < shared->num_owned; v++) number[v] = (PetscReal)(shared->first + v);
  PetscCall(EqmSharedUpdateGhosts(shared, 1, number));
  for (PetscInt v = 0; v < level->num_vertices; v++)
    CHECK(number[v] == EqmSharedGlobal(shared, v), "ghost %d is %g", (int)v, (double)number[v]);
  for (PetscInt c = 0; c < level->num_cells; c++) {
    PetscInt lowest = PETSC_MAX_INT, mine = 0;
    for (PetscInt a = 0; a < 3; a++) {
      lowest = PetscMin(lowest, EqmSharedGlobal(shared, level->cells[3 * c + a]));
      mine += level->cells[3 * c + a] < shared->num_owned;
    }
    CHECK(mine > 0 && (c < shared->num_foreign_cells) == (lowest < shared->first), "cell %d", (int)c);
  }
  for (PetscInt k = 0; k < shared->num_pieces; k++) {
    for (PetscInt v = shared->vertex_start[k]; v < shared->vertex_start[k + 1]; v++)
      CHECK(EqmSharedPiece(shared, shared->first + v) == shared->first_piece + k, "piece of %d", (int)v);
  }
  PetscCall(PetscFree(number));
  PetscFunctionReturn(0);
}

/* A surface; `corners`: every ninth boundary vertex has to stay. */
static PetscErrorCode TestLevels(const char *shape, PetscInt n, PetscInt euler, PetscBool corners)
{
  TestMesh test;
  EqmShared shared;
  PetscBool *corner;
  EqmHierarchyLevel finer, level;
  PetscReal worst = 0.;
  PetscInt64 bytes;
  PetscInt kept = 0;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 1, &test));
  PetscCall(PetscCalloc1(test.mesh->num_local, &corner));
  for (PetscInt v = 0; v < test.mesh->num_local && corners; v++) corner[v] = (PetscBool)(test.mesh->global[v] % 9 == 0);
  for (PetscInt v = 0; v < test.mesh->num_owned; v++) kept += corner[v] && test.mesh->on_boundary[v];
  kept = (PetscInt)TestSum(PETSC_COMM_WORLD, (PetscReal)kept);
  PetscCall(Make(test.mesh, corner, &shared));
  PetscCall(EqmSharedMemory(shared, &bytes));
  CHECK(bytes <= 400 * test.mesh->num_vertices, "%g bytes per vertex", (double)bytes / test.mesh->num_vertices);
  CHECK(shared->num_levels > 2, "%d levels of %s", (int)shared->num_levels, shape);
  for (PetscInt k = 0; k < shared->num_levels; k++) {
    const EqmSharedLevel *const here = &shared->level[k];
    PetscInt stay = 0;
    PetscCall(CheckPart(here));
    PetscCall(Gather(here, k > 0 ? here - 1 : NULL, &level));
    if (test.mesh->rank == 0) PetscCall(TestCheckLevel(&level, euler));
    for (PetscInt v = 0; v < level.num_vertices; v++) stay += level.part[v] == EQM_CORNER;
    if (test.mesh->rank == 0) CHECK(stay == kept, "%d corners, not %d", (int)stay, (int)kept);
    if (k == 0) worst = PetscMin(.1, EqmLevelWorstQuality(&level));
    CHECK(EqmLevelWorstQuality(&level) > .5 * worst, "%s, %d vertices: worst quality %g", shape,
          (int)here->num_vertices, (double)EqmLevelWorstQuality(&level));
    if (k > 0) {
      CHECK(here->num_vertices < .8 * here[-1].num_vertices, "%d of %d vertices", (int)here->num_vertices,
            (int)here[-1].num_vertices);
      if (test.mesh->rank == 0) PetscCall(TestCheckWayBack(&finer, &level));
      PetscCall(EqmLevelReset(&finer));
    }
    finer = level;
  }
  for (PetscInt c = 0; c < 3 * finer.num_cells; c++)
    CHECK(finer.cells[c] == shared->coarser->level[0].cells[c], "the first rank's level differs");
  PetscCall(EqmLevelReset(&finer));
  PetscCall(EqmSharedDestroy(&shared));
  PetscCall(PetscFree(corner));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* The levels of all ranks together are those of each alone, and those of two threads those of one. */
static PetscErrorCode TestRanks(const char *shape, PetscInt n)
{
  TestMesh alone, together;
  EqmShared a, t;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_SELF, shape, n, 1, &alone));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 1, &together));
  omp_set_num_threads(3);
  PetscCall(Make(alone.mesh, NULL, &a));
  omp_set_num_threads(1);
  PetscCall(Make(together.mesh, NULL, &t));
  CHECK(t->num_levels == a->num_levels, "%d levels", (int)t->num_levels);
  for (PetscInt k = 0; k < t->num_levels; k++) {
    EqmHierarchyLevel p, q;
    PetscCall(Gather(&a->level[k], k > 0 ? &a->level[k - 1] : NULL, &p));
    PetscCall(Gather(&t->level[k], k > 0 ? &t->level[k - 1] : NULL, &q));
    if (together.mesh->rank == 0)
      CHECK(p.num_cells == q.num_cells && p.num_collapses == q.num_collapses, "level %d", (int)k);
    for (PetscInt c = 0; c < 3 * q.num_cells; c++) CHECK(p.cells[c] == q.cells[c], "level %d differs", (int)k);
    for (PetscInt c = 0; c < q.num_cells; c++)
      CHECK_CLOSE(p.weight[c], q.weight[c], 1e-13, p.weight[c]); /* the mesh's own depend on the ranks' sums */
    for (PetscInt c = 0; c < 3 * q.num_vertices; c++) CHECK(p.position[c] == q.position[c], "place %d", (int)c);
    for (PetscInt c = 0; c < q.ring_length; c++)
      CHECK(p.ring[c] == q.ring[c] || c % EQM_MOST_RECORD >= q.collapse[c / EQM_MOST_RECORD].size, "record %d", (int)c);
    PetscCall(EqmLevelReset(&p));
    PetscCall(EqmLevelReset(&q));
  }
  PetscCall(EqmSharedDestroy(&a));
  PetscCall(EqmSharedDestroy(&t));
  PetscCall(TestMeshDestroy(&alone));
  PetscCall(TestMeshDestroy(&together));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestLevels("hills", 3000, 1, PETSC_FALSE));
  PetscCall(TestLevels("hills", 2000, 1, PETSC_TRUE));
  PetscCall(TestLevels("head", 4000, 2, PETSC_FALSE));
  PetscCall(TestLevels("starfish", 3000, 2, PETSC_FALSE));
  PetscCall(TestRanks("hills", 4000));
  PetscCall(TestRanks("head", 4000));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
