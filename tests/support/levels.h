/* Is a level of a hierarchy a surface that stands for the whole, and does it lead back to the finer one? */
#ifndef EQM_TESTING_LEVELS_H
#define EQM_TESTING_LEVELS_H

#include "support/testing.h"
#include "hierarchy/level.h"

/* Edges, each once. Every edge has one triangle on either side, boundary edges one alone: `lone` counts these. */
static inline PetscErrorCode TestCountEdges(const EqmHierarchyLevel *level, PetscInt *edges, PetscInt *lone)
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

static inline int TestCompareCells(const void *left, const void *right)
{
  const PetscInt *const a = left, *const b = right;

  for (int k = 0; k < 3; k++) {
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  }
  return 0;
}

/* The lowest corner first. */
static inline void TestRotate(PetscInt *cell)
{
  while (cell[0] > cell[1] || cell[0] > cell[2]) {
    const PetscInt first = cell[0];
    cell[0] = cell[1];
    cell[1] = cell[2];
    cell[2] = first;
  }
}

static inline PetscInt TestFindCell(PetscInt num, const PetscInt *cells, PetscInt a, PetscInt b, PetscInt c)
{
  PetscInt wanted[3] = {a, b, c};

  TestRotate(wanted);
  for (PetscInt k = 0; k < num; k++) {
    if (TestCompareCells(cells + 3 * k, wanted) == 0) return k;
  }
  return -1;
}

/* Undo the collapses, the last first, on the coarser level's triangles: the finer's must come out. */
static inline PetscErrorCode TestCheckWayBack(const EqmHierarchyLevel *finer, const EqmHierarchyLevel *coarser)
{
  PetscInt *cells, *wanted, num = coarser->num_cells;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * finer->num_cells, &cells, 3 * finer->num_cells, &wanted));
  for (PetscInt k = 0; k < 3 * num; k++) cells[k] = coarser->finer[coarser->cells[k]];
  for (PetscInt k = 0; k < num; k++) TestRotate(cells + 3 * k);
  for (PetscInt r = finer->num_collapses; r-- > 0;) {
    const EqmCollapse *const record = &finer->collapse[r];
    const PetscInt *const ring = finer->ring + record->start, size = record->size;
    const PetscInt count = finer->part[record->vertex] == EQM_INSIDE ? size : size - 1;
    for (PetscInt k = 0; k < count; k++) {
      const PetscInt p = ring[k], q = ring[(k + 1) % size];
      PetscInt at = num;
      if (p != record->onto && q != record->onto) at = TestFindCell(num, cells, record->onto, p, q);
      CHECK(at >= 0 && at < finer->num_cells, "triangle %d of a star is not there", (int)k);
      num += at == num;
      cells[3 * at] = record->vertex;
      cells[3 * at + 1] = p;
      cells[3 * at + 2] = q;
      TestRotate(cells + 3 * at);
    }
  }
  CHECK(num == finer->num_cells, "%d triangles, not %d", (int)num, (int)finer->num_cells);
  PetscCall(PetscArraycpy(wanted, finer->cells, 3 * num));
  for (PetscInt k = 0; k < num; k++) TestRotate(wanted + 3 * k);
  qsort(wanted, num, 3 * sizeof(PetscInt), TestCompareCells);
  qsort(cells, num, 3 * sizeof(PetscInt), TestCompareCells);
  for (PetscInt k = 0; k < 3 * num; k++) CHECK(cells[k] == wanted[k], "triangle %d differs", (int)k / 3);
  PetscCall(PetscFree2(cells, wanted));
  PetscFunctionReturn(0);
}

static inline PetscErrorCode TestCheckLevel(const EqmHierarchyLevel *level, PetscInt euler)
{
  PetscReal sum = 0.;
  PetscInt edges, lone, boundary = 0;

  PetscFunctionBegin;
  PetscCall(TestCountEdges(level, &edges, &lone));
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

#endif
