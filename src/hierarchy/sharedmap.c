/* The objective on a shared level, and the way from a coarser one. */
#include "hierarchy/sharedmap.h"
#include "hierarchy/reinsert.h"
#include "base/rows.h"

PetscErrorCode EqmSharedMapCreate(const EqmSharedLevel *shared, EqmCascadeTarget target, const PetscReal *finer,
                                  EqmLevelMap *map)
{
  PetscFunctionBegin;
  PetscCall(EqmLevelMapCreate(&shared->level, target, map));
  PetscCall(EqmRowsToLeaves(shared->from_finer, map->dim, finer, map->x));
  PetscCall(EqmSharedUpdateGhosts(shared, map->dim, map->x));
  PetscCall(EqmLevelMapSetMotions(map, target));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedEvaluate(const EqmSharedLevel *shared, EqmLevelMap *map, const PetscReal *x,
                                 EqmLevelValue *value)
{
  enum { NUM_SUMS = sizeof(EqmLevelSums) / sizeof(PetscReal) };
  const PetscInt num = shared->num_pieces, *const start = shared->cell_start;
  PetscReal *area;
  EqmLevelSums *piece, all;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num, &area));
  PetscCall(PetscCalloc1(num, &piece));
#pragma omp parallel for schedule(dynamic) if (num > 1)
  for (PetscInt k = 0; k < num; k++) area[k] = EqmLevelMapArea(map, x, start[k], start[k + 1]);
  PetscCall(EqmSharedSum(shared, 1, area, &map->total));
#pragma omp parallel for schedule(dynamic) if (num > 1)
  for (PetscInt k = 0; k < num; k++) EqmLevelMapSum(map, x, start[k], start[k + 1], &piece[k]);
  PetscCall(EqmSharedSum(shared, NUM_SUMS, (PetscReal *)piece, (PetscReal *)&all));
  PetscCall(PetscFree(area));
  PetscCall(PetscFree(piece));
  EqmLevelMapValue(map, &all, value);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedReinsert(const EqmSharedLevel *coarser, const EqmLevelMap *from, const EqmSharedLevel *finer,
                                 EqmLevelMap *to, PetscInt *hard)
{
  const PetscInt *const start = finer->record_start;
  PetscInt count = 0;

  PetscFunctionBegin;
  to->total = from->total;
  PetscCall(EqmRowsToRoots(coarser->from_finer, to->dim, from->x, to->x));
#pragma omp parallel for schedule(dynamic) reduction(+ : count) if (finer->num_pieces > 1)
  for (PetscInt k = 0; k < finer->num_pieces; k++) count += EqmReinsertRecords(start[k], start[k + 1], to);
  PetscCall(MPIU_Allreduce(&count, hard, 1, MPIU_INT, MPI_SUM, finer->comm));
  PetscCall(EqmSharedUpdateGhosts(finer, to->dim, to->x));
  PetscFunctionReturn(0);
}
