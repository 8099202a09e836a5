/* Pieces of a level for threads. */
#include "hierarchy/level.h"

PetscErrorCode EqmLevelPiecesSort(PetscInt count, PetscInt num, const int *piece, EqmLevelPieces *pieces)
{
  PetscFunctionBegin;
  pieces->count = count;
  PetscCall(PetscCalloc1(count + 3, &pieces->start));
  PetscCall(PetscMalloc1(num, &pieces->item));
  for (PetscInt k = 0; k < num; k++) pieces->start[(piece[k] < 0 ? count : piece[k]) + 2]++;
  for (PetscInt k = 0; k <= count; k++) pieces->start[k + 2] += pieces->start[k + 1];
  for (PetscInt k = 0; k < num; k++) pieces->item[pieces->start[(piece[k] < 0 ? count : piece[k]) + 1]++] = k;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelPiecesCreate(PetscInt num_vertices, PetscInt num, const int *piece, EqmLevelPieces *pieces)
{
  PetscFunctionBegin;
  PetscCall(EqmLevelPiecesSort((num_vertices + EQM_VERTICES_OF_PIECE - 1) / EQM_VERTICES_OF_PIECE, num, piece, pieces));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelPiecesDestroy(EqmLevelPieces *pieces)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(pieces->start));
  PetscCall(PetscFree(pieces->item));
  PetscFunctionReturn(0);
}
