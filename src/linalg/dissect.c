/* Nested dissection of a graph by METIS (G. Karypis, V. Kumar, SIAM Journal on Scientific Computing 20, 1998). */
#include "linalg/linalg.h"
#include "linalg/narrow.h"
#include <metis.h>

enum { SAME_WIDTH = sizeof(idx_t) == sizeof(PetscInt) };

/* The numbers in METIS' integers: the array itself where these are PETSc's, else a copy. */
static PetscErrorCode ToMetis(PetscInt n, PetscInt *array, idx_t **out)
{
  PetscFunctionBegin;
  if (SAME_WIDTH) {
    *out = (idx_t *)array;
  } else {
    PetscCall(PetscMalloc1(n, out));
    for (PetscInt k = 0; k < n; k++) (*out)[k] = (idx_t)array[k];
  }
  PetscFunctionReturn(0);
}

/* Free a copy, after taking its numbers if `back`. */
static PetscErrorCode FromMetis(PetscInt n, PetscBool back, PetscInt *array, idx_t **copy)
{
  PetscFunctionBegin;
  if (!SAME_WIDTH) {
    for (PetscInt k = 0; back && k < n; k++) array[k] = (PetscInt)(*copy)[k];
    PetscCall(PetscFree(*copy));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDissect(PetscInt n, PetscInt *degree_then_start, PetscInt *neighbor, PetscInt *order)
{
  PetscInt sum = 0;
  idx_t num_rows = (idx_t)n, *start, *adjacent, *permutation, *inverse;
  int result;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt degree = degree_then_start[i];
    degree_then_start[i] = sum;
    sum += degree;
  }
  degree_then_start[n] = sum;
  if (sum == 0) { /* nothing to dissect */
    for (PetscInt i = 0; i < n; i++) order[i] = i;
    PetscFunctionReturn(0);
  }
  PetscCall(EqmCheckFits(n, sizeof(idx_t), "METIS", "vertices"));
  PetscCall(EqmCheckFits(sum, sizeof(idx_t), "METIS", "pairs of neighbouring vertices"));
  PetscCall(ToMetis(n + 1, degree_then_start, &start));
  PetscCall(ToMetis(sum, neighbor, &adjacent));
  PetscCall(ToMetis(n, order, &permutation));
  PetscCall(PetscMalloc1(n, &inverse));
  result = METIS_NodeND(&num_rows, start, adjacent, NULL, NULL, permutation, inverse);
  PetscCheck(result == METIS_OK, PETSC_COMM_SELF, PETSC_ERR_LIB, "METIS_NodeND failed with code %d", result);
  PetscCall(PetscFree(inverse));
  PetscCall(FromMetis(n, PETSC_TRUE, order, &permutation));
  PetscCall(FromMetis(sum, PETSC_FALSE, neighbor, &adjacent));
  PetscCall(FromMetis(n + 1, PETSC_FALSE, degree_then_start, &start));
  PetscFunctionReturn(0);
}
