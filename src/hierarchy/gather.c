/* The mesh on the first rank, numbered along Morton's curve (Morton 1966): neighbours in space are neighbours in
   memory, and the numbers do not depend on the distribution of the mesh. */
#include "hierarchy/gather.h"
#include "mesh/mesh_private.h"
#include "base/rows.h"
#include "base/sort.h"
#include <stdint.h>
#include <stdlib.h>

/* What is sorted: by key, and among equal keys by the number in the input. */
typedef struct {
  uint64_t key;
  PetscInt input, at;
} Item;

static int CompareItems(const void *left, const void *right)
{
  const Item *const a = left, *const b = right;

  if (a->key != b->key) return a->key < b->key ? -1 : 1;
  return a->input < b->input ? -1 : a->input > b->input;
}

enum { BITS = 21 };

/* The lowest BITS bits, two zeros before each. */
static uint64_t Spread(uint64_t x)
{
  x = (x | x << 32) & 0x1f00000000ffffu;
  x = (x | x << 16) & 0x1f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  return (x | x << 2) & 0x1249249249249249u;
}

/* The vertices' order along the curve: `items` come out sorted. */
static void SortVertices(PetscInt n, const PetscReal *position, const PetscInt *input, Item *items)
{
  PetscReal low[3] = {PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL}, width = 0., scale;

  for (PetscInt k = 0; k < 3 * n; k++) low[k % 3] = PetscMin(low[k % 3], position[k]);
  for (PetscInt k = 0; k < 3 * n; k++) width = PetscMax(width, position[k] - low[k % 3]);
  scale = width > 0. ? (PetscReal)((1 << BITS) - 1) / width : 0.;
  for (PetscInt v = 0; v < n; v++) {
    items[v] = (Item){.key = 0, .input = input[v], .at = v};
    for (PetscInt c = 0; c < 3; c++) items[v].key |= Spread((uint64_t)((position[3 * v + c] - low[c]) * scale)) << c;
  }
  EqmSort(items, n, sizeof(*items), CompareItems);
}

/* All rows of an array that is dealt to the ranks, on the first rank. Collective. */
static PetscErrorCode AllRows(EqmMesh mesh, PetscInt count, PetscInt total, MPI_Datatype unit, PetscInt width,
                              const void *slab, void *rows)
{
  PetscFunctionBegin;
  PetscCall(EqmFetchSlab(mesh->comm, count, mesh->rank == 0 ? total : 0, 0, unit, width, slab, rows));
  PetscFunctionReturn(0);
}

/* Vertices: order, position, part. `number`: of each global vertex on level 0. Collective. */
static PetscErrorCode GatherVertices(EqmMesh mesh, const PetscBool *corner, EqmHierarchy hierarchy, PetscInt **number)
{
  EqmHierarchyLevel *const level = &hierarchy->level[0];
  const PetscInt n = mesh->rank == 0 ? mesh->num_vertices : 0;
  PetscReal *position;
  PetscInt *input, *part, *all;
  Item *items;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_owned, &part));
  for (PetscInt v = 0; v < mesh->num_owned; v++)
    part[v] = !mesh->on_boundary[v] ? EQM_INSIDE : corner && corner[v] ? EQM_CORNER : EQM_ON_BOUNDARY;
  PetscCall(PetscMalloc4(3 * n, &position, n, &input, n, &all, n, &items));
  PetscCall(PetscMalloc1(n, number));
  PetscCall(AllRows(mesh, mesh->num_owned, n, MPIU_REAL, 3, mesh->position, position));
  PetscCall(AllRows(mesh, mesh->num_owned, n, MPIU_INT, 1, mesh->vertex_input, input));
  PetscCall(AllRows(mesh, mesh->num_owned, n, MPIU_INT, 1, part, all));
  PetscCall(PetscFree(part));
  SortVertices(n, position, input, items);
  PetscCall(PetscMalloc1(n, &hierarchy->order));
  PetscCall(PetscMalloc1(3 * n, &level->position));
  PetscCall(PetscMalloc1(n, &level->part));
  level->num_vertices = n;
  level->num_boundary = 0;
  for (PetscInt v = 0; v < n; v++) {
    const PetscInt from = items[v].at;
    hierarchy->order[v] = from;
    (*number)[from] = v;
    PetscCall(PetscArraycpy(level->position + 3 * v, position + 3 * from, 3));
    level->part[v] = (unsigned char)all[from];
    level->num_boundary += all[from] != EQM_INSIDE;
  }
  PetscCall(PetscFree4(position, input, all, items));
  PetscFunctionReturn(0);
}

/* Cells in the order of their first vertices; weights are bounded below, so that they are not lost to rounding.
 * Collective. */
static PetscErrorCode GatherCells(EqmMesh mesh, const PetscInt *number, EqmHierarchy hierarchy)
{
  EqmHierarchyLevel *const level = &hierarchy->level[0];
  const PetscInt m = mesh->rank == 0 ? mesh->num_cells : 0, owned = mesh->num_owned_cells;
  const PetscReal least = 1e-12 / PetscMax(m, 1);
  PetscInt *corners, *all, *input;
  PetscReal *weight, sum = 0.;
  Item *items;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * owned, &corners));
  for (PetscInt k = 0; k < 3 * owned; k++) corners[k] = mesh->global[mesh->cells[k]];
  PetscCall(PetscMalloc4(3 * m, &all, m, &input, m, &weight, m, &items));
  PetscCall(AllRows(mesh, owned, m, MPIU_INT, 3, corners, all));
  PetscCall(AllRows(mesh, owned, m, MPIU_INT, 1, mesh->cell_input, input));
  PetscCall(AllRows(mesh, owned, m, MPIU_REAL, 1, mesh->weight, weight));
  PetscCall(PetscFree(corners));
  for (PetscInt k = 0; k < 3 * m; k++) all[k] = number[all[k]];
  for (PetscInt c = 0; c < m; c++) {
    const PetscInt *const v = all + 3 * c;
    items[c] = (Item){.key = (uint64_t)PetscMin(v[0], PetscMin(v[1], v[2])), .input = input[c], .at = c};
  }
  EqmSort(items, m, sizeof(*items), CompareItems);
  PetscCall(PetscMalloc1(3 * m, &level->cells));
  PetscCall(PetscMalloc1(m, &level->weight));
  PetscCall(PetscMalloc1(m, &hierarchy->cell_order));
  level->num_cells = m;
  for (PetscInt c = 0; c < m; c++) {
    hierarchy->cell_order[c] = items[c].at;
    PetscCall(PetscArraycpy(level->cells + 3 * c, all + 3 * items[c].at, 3));
    level->weight[c] = PetscMax(weight[items[c].at], least);
    sum += level->weight[c];
  }
  for (PetscInt c = 0; c < m; c++) level->weight[c] /= sum;
  PetscCall(PetscFree4(all, input, weight, items));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGatherFinest(EqmMesh mesh, const PetscBool *corner, EqmHierarchy hierarchy)
{
  PetscInt *number;

  PetscFunctionBegin;
  PetscCall(GatherVertices(mesh, corner, hierarchy, &number));
  PetscCall(GatherCells(mesh, number, hierarchy));
  PetscCall(PetscFree(number));
  PetscFunctionReturn(0);
}
