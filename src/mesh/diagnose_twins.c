/* Cells with the same vertices. */
#include "mesh/diagnose.h"

static void SortedVertices(const EqmVicinity *vicinity, PetscInt cell, PetscInt sorted[4])
{
  for (PetscInt a = 0; a < vicinity->cell_size; a++) {
    const PetscInt vertex = vicinity->cells[vicinity->cell_size * cell + a];
    PetscInt b = a;

    for (; b > 0 && sorted[b - 1] > vertex; b--) sorted[b] = sorted[b - 1];
    sorted[b] = vertex;
  }
}

/* For each cell the first one, in input order, with the same vertices: itself if it has no earlier twin. Every rank
   that sees one of two twins sees the other, so the ranks agree. Not collective. */
PetscErrorCode EqmVicinityFindDuplicates(const EqmVicinity *vicinity, PetscInt *first)
{
  PetscInt *head, *next;

  PetscFunctionBegin;
  /* chains of the cells whose lowest two local vertices are (v, w), one v at a time: short unless there are twins */
  PetscCall(PetscMalloc2(vicinity->num_local, &head, vicinity->num_cells, &next));
  for (PetscInt v = 0; v < vicinity->num_local; v++) head[v] = -1;
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    for (PetscInt s = vicinity->star_start[v]; s < vicinity->star_start[v + 1]; s++) {
      const PetscInt cell = vicinity->star[s];
      PetscInt sorted[4], other[4], twin;

      SortedVertices(vicinity, cell, sorted);
      if (sorted[0] != v) continue;
      for (twin = head[sorted[1]]; twin >= 0; twin = next[twin]) {
        PetscBool same = PETSC_TRUE;

        SortedVertices(vicinity, twin, other);
        for (PetscInt a = 2; a < vicinity->cell_size; a++) same = (PetscBool)(same && sorted[a] == other[a]);
        if (same) break;
      }
      first[cell] = twin >= 0 ? twin : cell;
      if (twin >= 0) continue;
      next[cell] = head[sorted[1]];
      head[sorted[1]] = cell;
    }
    for (PetscInt s = vicinity->star_start[v]; s < vicinity->star_start[v + 1]; s++) {
      for (PetscInt a = 0; a < vicinity->cell_size; a++) {
        head[vicinity->cells[vicinity->cell_size * vicinity->star[s] + a]] = -1;
      }
    }
  }
  PetscCall(PetscFree2(head, next));
  PetscFunctionReturn(0);
}
