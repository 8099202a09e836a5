/* Prolongations between shared levels, and on to those of the first rank. The rows of a piece's vertices lead to coarse
   vertices of the same piece. */
#include "hierarchy/sharedsolve.h"
#include "base/rows.h"

enum { WIDTH = EQM_PROLONGATION_WIDTH };

/* Means of coarse vertices become blocks, in the directions that the vertices have; a direction that a coarse vertex
   lacks is its own, so that no diagonal entry of a coarser matrix is zero. `number`: of each coarse vertex. */
static void SetRow(const EqmLevelMap *map, PetscInt v, const EqmProlongationRow *row, const PetscInt *number,
                   EqmSharedRows *to)
{
  const PetscInt dim = map->dim;
  PetscReal here[6], there[6];
  const PetscInt count = EqmMotionFrame((EqmMotion)map->motion[v], map->x + dim * v, here);

  for (PetscInt j = 0; j < WIDTH; j++) {
    EqmBlock *const entry = &to->entry[WIDTH * v + j];
    *entry = (EqmBlock){{0., 0., 0., 0.}};
    to->column[WIDTH * v + j] = j < row->count ? number[row->vertex[j]] : -1;
    if (j >= row->count) continue;
    const PetscInt u = row->vertex[j], moves = EqmMotionFrame((EqmMotion)map->motion[u], map->x + dim * u, there);
    for (PetscInt k = 0; k < count; k++) {
      for (PetscInt l = 0; l < moves; l++) {
        PetscReal product = 0.;
        for (PetscInt c = 0; c < dim; c++) product += here[dim * k + c] * there[dim * l + c];
        entry->e[2 * k + l] = row->weight[j] * (count == 1 ? 1. : product);
      }
    }
    for (PetscInt k = count; k < 2 && u == v; k++) entry->e[3 * k] = 1.;
  }
}

/* The next prolongation, whose rows are these. Collective. */
static PetscErrorCode Append(MPI_Comm comm, const EqmSharedRows *rows, PetscInt num_coarse, EqmSharedProlongations *to)
{
  PetscFunctionBegin;
  to->rows[to->num] = *rows;
  to->num_coarse[to->num] = num_coarse;
  PetscCall(EqmSharedRowsMatrix(comm, rows, num_coarse, &to->matrix[to->num]));
  to->num++;
  PetscFunctionReturn(0);
}

/* Rows of all vertices that are of the map's first `num`: a coarse one's, whose number is not negative, is itself. */
static PetscErrorCode FillRows(const EqmLevelMap *map, PetscInt num, PetscInt num_pieces, const PetscInt *record_start,
                               const PetscInt *number, EqmSharedRows *to)
{
  EqmProlongationRow *rows;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num, &rows));
  for (PetscInt v = 0; v < num; v++) rows[v] = (EqmProlongationRow){.count = 1, .vertex = {v}, .weight = {1.}};
#pragma omp parallel for schedule(dynamic) if (num_pieces > 1)
  for (PetscInt k = 0; k < num_pieces; k++) EqmProlongationRows(map, record_start[k], record_start[k + 1], rows);
#pragma omp parallel for schedule(static) if (num_pieces > 1)
  for (PetscInt v = 0; v < num; v++) SetRow(map, v, &rows[v], number, to);
  PetscCall(PetscFree(rows));
  PetscFunctionReturn(0);
}

/* Between two shared levels. Collective. */
static PetscErrorCode BetweenShared(const EqmSharedLevel *finer, const EqmLevelMap *map, const EqmSharedLevel *coarser,
                                    EqmSharedProlongations *to)
{
  PetscInt *number, *mine;
  EqmSharedRows rows;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(finer->num_owned, &number, coarser->num_owned, &mine));
  for (PetscInt v = 0; v < finer->num_owned; v++) number[v] = -1;
  for (PetscInt c = 0; c < coarser->num_owned; c++) mine[c] = coarser->first + c;
  PetscCall(PetscSFReduceBegin(coarser->from_finer, MPIU_INT, mine, number, MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(coarser->from_finer, MPIU_INT, mine, number, MPI_REPLACE));
  PetscCall(EqmSharedRowsCreate(finer->comm, finer->num_owned, WIDTH, &rows));
  PetscCall(FillRows(map, finer->num_owned, finer->num_pieces, finer->record_start, number, &rows));
  PetscCall(Append(finer->comm, &rows, coarser->num_owned, to));
  PetscCall(PetscFree2(number, mine));
  PetscFunctionReturn(0);
}

/* Rows on the first rank become those of the ranks that own the vertices. Collective. */
static PetscErrorCode Deal(const EqmSharedLevel *shared, EqmSharedRows *rows)
{
  PetscInt *number;
  EqmSharedRows dealt;

  PetscFunctionBegin;
  PetscCall(EqmSharedRowsCreate(shared->comm, shared->num_owned, WIDTH, &dealt));
  PetscCall(PetscMalloc1(shared->num_owned, &number));
  for (PetscInt v = 0; v < shared->num_owned; v++) number[v] = shared->first + v;
  PetscCall(EqmFetchRows(shared->comm, rows->num_rows, shared->num_owned, number, MPIU_INT, WIDTH, rows->column,
                         dealt.column));
  PetscCall(EqmFetchRows(shared->comm, rows->num_rows, shared->num_owned, number, MPIU_REAL,
                         WIDTH * (PetscInt)(sizeof(EqmBlock) / sizeof(PetscReal)), rows->entry, dealt.entry));
  PetscCall(PetscFree(number));
  PetscCall(EqmSharedRowsDestroy(rows));
  *rows = dealt;
  PetscFunctionReturn(0);
}

/* Between two levels of the first rank: `map` and the next coarser, both empty elsewhere; the rows of the first of them
   are those of the last shared level, `shared`, else NULL. Collective. */
static PetscErrorCode BetweenFirst(MPI_Comm comm, const EqmSharedLevel *shared, const EqmLevelMap *map, PetscBool here,
                                   EqmSharedProlongations *to)
{
  const PetscInt n = here ? map->level->num_vertices : 0, m = here ? map[1].level->num_vertices : 0,
                 record_start[2] = {0, here ? map->level->num_collapses : 0};
  PetscInt *number;
  EqmSharedRows rows;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &number));
  for (PetscInt v = 0; v < n; v++) number[v] = -1;
  for (PetscInt c = 0; c < m; c++) number[map[1].level->finer[c]] = c;
  PetscCall(EqmSharedRowsCreate(comm, n, WIDTH, &rows));
  if (here) PetscCall(FillRows(map, n, 1, record_start, number, &rows));
  PetscCall(PetscFree(number));
  if (shared) PetscCall(Deal(shared, &rows));
  PetscCall(Append(comm, &rows, m, to));
  PetscFunctionReturn(0);
}

/* Those of the hierarchy on the first rank, at the map of the last shared level. Collective. */
static PetscErrorCode GoOnBelow(EqmShared shared, EqmCascadeTarget target, const EqmLevelMap *last, PetscInt direct,
                                EqmSharedProlongations *prolongations)
{
  const EqmHierarchy hierarchy = shared->coarser;
  const PetscBool here = (PetscBool)(hierarchy->rank == 0);
  EqmLevelMap map[EQM_MOST_LEVELS] = {{.level = NULL}};
  PetscReal *x;
  PetscInt num = 0;

  PetscFunctionBegin;
  while (num + 1 < hierarchy->num_levels && hierarchy->level[num].num_vertices > direct) num++;
  PetscCallMPI(MPI_Bcast(&num, 1, MPIU_INT, 0, shared->comm));
  PetscCall(PetscMalloc1(last->dim * hierarchy->level[0].num_vertices, &x));
  PetscCall(EqmHierarchyGather(hierarchy, last->dim, last->x, x));
  for (PetscInt k = 0; k <= num && here; k++) {
    PetscCall(EqmLevelMapCreate(&hierarchy->level[k], target, &map[k]));
    if (k == 0) {
      PetscCall(PetscArraycpy(map[0].x, x, last->dim * hierarchy->level[0].num_vertices));
      PetscCall(EqmLevelMapSetMotions(&map[0], target));
    } else {
      PetscCall(EqmLevelMapRestrict(&map[k - 1], &map[k]));
    }
  }
  for (PetscInt k = 0; k < num; k++)
    PetscCall(BetweenFirst(shared->comm, k == 0 ? &shared->level[shared->num_levels - 1] : NULL, &map[k], here,
                           prolongations));
  for (PetscInt k = 0; k <= num && here; k++) PetscCall(EqmLevelMapDestroy(&map[k]));
  PetscCall(PetscFree(x));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedProlongationsCreate(EqmShared shared, PetscInt k, EqmCascadeTarget target,
                                            const EqmLevelMap *map, PetscInt direct,
                                            EqmSharedProlongations *prolongations)
{
  const PetscInt last = shared->num_levels - 1;
  EqmLevelMap own[EQM_MOST_LEVELS];
  const EqmLevelMap *at = map;

  PetscFunctionBegin;
  prolongations->num = 0;
  for (PetscInt j = k; j < last; j++) {
    PetscCall(EqmSharedMapCreate(&shared->level[j + 1], target, at->x, &own[j + 1]));
    PetscCall(BetweenShared(&shared->level[j], at, &shared->level[j + 1], prolongations));
    at = &own[j + 1];
  }
  PetscCall(GoOnBelow(shared, target, at, direct, prolongations));
  for (PetscInt j = k; j < last; j++) PetscCall(EqmLevelMapDestroy(&own[j + 1]));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedProlongationsDestroy(EqmSharedProlongations *prolongations)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < prolongations->num; k++) {
    PetscCall(EqmSharedRowsDestroy(&prolongations->rows[k]));
    PetscCall(MatDestroy(&prolongations->matrix[k]));
  }
  PetscFunctionReturn(0);
}
