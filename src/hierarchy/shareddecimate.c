/* From a shared level to the next coarser one: piece by piece, on all ranks and threads. */
#include "hierarchy/sharedpiece.h"
#include <omp.h>

static PetscErrorCode RestCreate(const EqmSharedLevel *shared, EqmSharedRest *rest)
{
  const EqmHierarchyLevel *const level = &shared->level;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * level->num_cells, &rest->cells, level->num_cells, &rest->weight));
  PetscCall(PetscCalloc2(level->num_cells, &rest->dead, shared->num_owned, &rest->gone));
  PetscCall(PetscArraycpy(rest->cells, level->cells, 3 * level->num_cells));
  PetscCall(PetscArraycpy(rest->weight, level->weight, level->num_cells));
  PetscFunctionReturn(0);
}

static PetscErrorCode RestDestroy(EqmSharedRest *rest)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(rest->cells, rest->weight));
  PetscCall(PetscFree2(rest->dead, rest->gone));
  PetscFunctionReturn(0);
}

/* `count`: collapses per piece. */
static PetscErrorCode DecimatePieces(EqmSharedLevel *shared, PetscReal ratio, PetscInt least_boundary,
                                     EqmSharedRest *rest, PetscInt *count)
{
  const PetscInt num_threads = PetscMin(omp_get_max_threads(), PetscMax(1, shared->num_pieces));
  EqmPieceCells cells;
  EqmPieceWork *work;

  PetscFunctionBegin;
  PetscCall(EqmPieceCellsCreate(shared, &cells));
  PetscCall(PetscMalloc1(num_threads, &work));
  for (PetscInt t = 0; t < num_threads; t++) PetscCall(EqmPieceWorkCreate(shared, &cells, &work[t]));
#pragma omp parallel for schedule(dynamic) num_threads((int)num_threads)
  for (PetscInt k = 0; k < shared->num_pieces; k++)
    count[k] = EqmPieceDecimate(shared, k, &cells, ratio, least_boundary, &work[omp_get_thread_num()], rest);
  for (PetscInt t = 0; t < num_threads; t++) PetscCall(EqmPieceWorkDestroy(&work[t]));
  PetscCall(PetscFree(work));
  PetscCall(EqmPieceCellsDestroy(&cells));
  PetscFunctionReturn(0);
}

/* The records of all pieces one after the other. */
static PetscErrorCode JoinRecords(EqmSharedLevel *shared, const PetscInt *count)
{
  EqmHierarchyLevel *const level = &shared->level;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(shared->num_pieces + 1, &shared->record_start));
  level->num_collapses = level->ring_length = shared->record_start[0] = 0;
  for (PetscInt k = 0; k < shared->num_pieces; k++) {
    for (PetscInt r = 0; r < count[k]; r++) {
      EqmCollapse *const to = &level->collapse[level->num_collapses++];
      *to = level->collapse[shared->vertex_start[k] + r];
      for (PetscInt q = 0; q < to->size; q++) {
        level->ring[level->ring_length + q] = level->ring[to->start + q];
        level->ring_weight[level->ring_length + q] = level->ring_weight[to->start + q];
      }
      to->start = level->ring_length;
      level->ring_length += to->size;
    }
    shared->record_start[k + 1] = level->num_collapses;
  }
  PetscCall(EqmLevelShrinkRecords(level));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedDecimate(EqmSharedLevel *finer, const EqmHierarchyOptions *options, PetscInt least_boundary,
                                 PetscInt where, EqmSharedLevel *coarser)
{
  EqmHierarchyLevel *const level = &finer->level;
  EqmSharedSource source;
  EqmSharedRest rest;
  PetscInt *count, *number, gone;

  PetscFunctionBegin;
  PetscCall(RestCreate(finer, &rest));
  PetscCall(PetscMalloc1(finer->num_pieces, &count));
  PetscCall(PetscMalloc1(finer->num_owned, &level->collapse));
  PetscCall(PetscMalloc1(EQM_MOST_RECORD * finer->num_owned, &level->ring));
  PetscCall(PetscMalloc1(EQM_MOST_RECORD * finer->num_owned, &level->ring_weight));
  PetscCall(DecimatePieces(finer, options->ratio, least_boundary, &rest, count));
  PetscCall(JoinRecords(finer, count));
  PetscCall(PetscFree(count));
  PetscCall(MPIU_Allreduce(&level->num_collapses, &gone, 1, MPIU_INT, MPI_SUM, finer->comm));
  PetscCall(PetscMalloc1(finer->num_owned, &number));
  for (PetscInt v = 0; v < finer->num_owned; v++) number[v] = finer->first + v;
  source = (EqmSharedSource){.comm = finer->comm,
                             .halo = finer->halo,
                             .num_owned = finer->num_owned,
                             .num_local = level->num_vertices,
                             .num_kept = finer->num_vertices - gone,
                             .gone = rest.gone,
                             .position = level->position,
                             .number = number,
                             .part = level->part,
                             .num_cells = level->num_cells - finer->num_foreign_cells,
                             .dead = rest.dead + finer->num_foreign_cells,
                             .cells = rest.cells + 3 * finer->num_foreign_cells,
                             .weight = rest.weight + finer->num_foreign_cells};
  PetscCall(EqmSharedLevelCreate(&source, where, options->vertices_of_piece, coarser));
  PetscCall(PetscFree(number));
  PetscCall(RestDestroy(&rest));
  PetscFunctionReturn(0);
}
