/* Prolongations between shared levels. The rows of a piece's vertices lead to coarse vertices of the same piece. */
#include "hierarchy/sharedprolongation.h"
#include "base/rows.h"

enum { WIDTH = EQM_PROLONGATION_WIDTH };

/* Means of coarse vertices for all vertices of this rank. */
static PetscErrorCode MakeRows(const EqmSharedLevel *finer, const EqmLevelMap *map, EqmProlongationRow *rows)
{
  const PetscInt *const start = finer->record_start;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < finer->num_owned; v++)
    rows[v] = (EqmProlongationRow){.count = 1, .vertex = {v}, .weight = {1.}};
#pragma omp parallel for schedule(dynamic) if (finer->num_pieces > 1)
  for (PetscInt k = 0; k < finer->num_pieces; k++) EqmProlongationRows(map, start[k], start[k + 1], rows);
  PetscFunctionReturn(0);
}

/* `place`, per vertex of the finer level: which of the coarse vertices that were this rank's it is, or -1;
   `to->number`: of these. Returns how many there are. Collective. */
static PetscErrorCode NumberCoarse(const EqmSharedLevel *finer, const EqmSharedLevel *coarser, PetscInt *place,
                                   PetscInt *num, EqmSharedProlongation *to)
{
  PetscInt *mine, n = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(coarser->num_owned, &mine));
  for (PetscInt c = 0; c < coarser->num_owned; c++) mine[c] = coarser->first + c;
  for (PetscInt v = 0; v < finer->num_owned; v++) place[v] = -1;
  PetscCall(PetscSFReduceBegin(coarser->from_finer, MPIU_INT, mine, place, MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(coarser->from_finer, MPIU_INT, mine, place, MPI_REPLACE));
  PetscCall(PetscFree(mine));
  PetscCall(PetscMalloc1(finer->num_owned, &to->number));
  for (PetscInt v = 0; v < finer->num_owned; v++) {
    if (place[v] < 0) continue;
    to->number[n] = place[v];
    place[v] = n++;
  }
  *num = n;
  PetscFunctionReturn(0);
}

/* to->rows. Collective. */
static PetscErrorCode FindRows(const EqmSharedLevel *coarser, PetscBool first, PetscInt num, const PetscInt *place,
                               EqmSharedProlongation *to)
{
  const PetscInt n = coarser->num_owned;
  PetscInt *source, *at, num_leaves = n;
  const PetscSFNode *from;
  PetscSFNode *remote;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(coarser->comm, &rank));
  PetscCall(PetscSFGetGraph(coarser->from_finer, NULL, NULL, NULL, &from));
  PetscCall(PetscMalloc1(n, &at));
  PetscCall(PetscMalloc1(2 * n, &source));
  PetscCall(EqmRowsOfToLeaves(coarser->from_finer, MPIU_INT, 1, place, at));
  for (PetscInt c = 0; c < n; c++) {
    source[2 * c] = from[c].rank;
    source[2 * c + 1] = at[c];
  }
  PetscCall(PetscFree(at));
  if (first) {
    PetscInt *all;
    num_leaves = rank == 0 ? coarser->num_vertices : 0;
    PetscCall(PetscMalloc1(2 * num_leaves, &all));
    PetscCall(EqmFetchSlab(coarser->comm, n, num_leaves, 0, MPIU_INT, 2, source, all));
    PetscCall(PetscFree(source));
    source = all;
  }
  PetscCall(PetscMalloc1(num_leaves, &remote));
  for (PetscInt c = 0; c < num_leaves; c++)
    remote[c] = (PetscSFNode){.rank = source[2 * c], .index = source[2 * c + 1]};
  PetscCall(PetscFree(source));
  PetscCall(PetscSFCreate(coarser->comm, &to->rows));
  PetscCall(PetscSFSetGraph(to->rows, num, num_leaves, NULL, PETSC_OWN_POINTER, remote, PETSC_OWN_POINTER));
  PetscCall(PetscSFSetUp(to->rows));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedProlongationCreate(const EqmSharedLevel *finer, const EqmLevelMap *map,
                                           const EqmSharedLevel *coarser, PetscBool first, PetscInt num_ghosts,
                                           EqmSharedProlongation *to)
{
  PetscInt *place, num;
  EqmProlongationRow *rows;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(finer->num_owned, &place, finer->num_owned, &rows));
  PetscCall(NumberCoarse(finer, coarser, place, &num, to));
  PetscCall(FindRows(coarser, first, num, place, to));
  PetscCall(MakeRows(finer, map, rows));
  PetscCall(
      EqmProlongationSet(map, rows, place, finer->num_owned, finer->num_owned + num_ghosts, num, &to->prolongation));
  PetscCall(PetscFree2(place, rows));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedProlongationFetch(PetscSF halo, PetscInt num_ghosts, EqmSharedProlongation *to)
{
  EqmProlongation *const p = &to->prolongation;
  const PetscInt n = p->num_fine, mine = p->num_coarse;
  PetscInt *column, *others, num = 0, at;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(WIDTH * n, &column, WIDTH * num_ghosts, &others));
  for (PetscInt q = 0; q < WIDTH * n; q++) column[q] = p->column[q] < 0 ? -1 : to->number[p->column[q]];
  PetscCall(EqmRowsOfToLeaves(halo, MPIU_INT, WIDTH, column, p->column + WIDTH * n));
  PetscCall(EqmRowsToLeaves(halo, 4 * WIDTH, (const PetscReal *)p->entry, (PetscReal *)(p->entry + WIDTH * n)));
  for (PetscInt q = WIDTH * n; q < WIDTH * (n + num_ghosts); q++) {
    if (p->column[q] >= 0) others[num++] = p->column[q];
  }
  PetscCall(PetscSortRemoveDupsInt(&num, others));
  PetscCall(PetscRealloc((mine + num) * sizeof(PetscInt), &to->number));
  for (PetscInt k = 0; k < num; k++) to->number[mine + k] = others[k];
  p->num_columns = mine + num;
  for (PetscInt q = WIDTH * n; q < WIDTH * (n + num_ghosts); q++) {
    if (p->column[q] < 0) continue;
    PetscCall(PetscFindInt(p->column[q], num, others, &at));
    p->column[q] = mine + at;
  }
  EqmProlongationFindPlain(p, n, n + num_ghosts);
  PetscCall(PetscFree2(column, others));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedProlongationDestroy(EqmSharedProlongation *to)
{
  PetscFunctionBegin;
  PetscCall(EqmProlongationDestroy(&to->prolongation));
  PetscCall(PetscFree(to->number));
  PetscCall(PetscSFDestroy(&to->rows));
  PetscFunctionReturn(0);
}
