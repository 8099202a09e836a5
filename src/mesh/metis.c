/* METIS: parts of a graph, and its nested dissection (G. Karypis, V. Kumar, SIAM Journal on Scientific Computing 20,
   1998). */
#include "mesh/build.h"
#include "base/narrow.h"
#include <metis.h>

enum { SAME_WIDTH = sizeof(idx_t) == sizeof(PetscInt) };

/* An array in METIS' integers: itself where these are PETSc's, else a copy, of what is in it if `filled`. */
static PetscErrorCode ToMetis(PetscInt n, PetscBool filled, PetscInt *array, idx_t **out)
{
  PetscFunctionBegin;
  if (SAME_WIDTH) {
    *out = (idx_t *)array;
  } else {
    PetscCall(PetscMalloc1(n, out));
    for (PetscInt k = 0; filled && k < n; k++) (*out)[k] = (idx_t)array[k];
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

/* Do the sizes of a graph fit METIS' integers? */
static PetscErrorCode CheckGraph(PetscInt n, PetscInt num_neighbors)
{
  PetscFunctionBegin;
  PetscCall(EqmCheckFits(n, sizeof(idx_t), "METIS", "vertices"));
  PetscCall(EqmCheckFits(num_neighbors, sizeof(idx_t), "METIS", "pairs of neighbouring vertices"));
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckResult(int result, const char *function)
{
  PetscFunctionBegin;
  PetscCheck(result != METIS_ERROR_MEMORY, PETSC_COMM_SELF, PETSC_ERR_MEM, "%s", function);
  PetscCheck(result == METIS_OK, PETSC_COMM_SELF, PETSC_ERR_LIB, "%s failed with code %d", function, result);
  PetscFunctionReturn(0);
}

/* Cut a graph into parts of equal size with few edges between them. Not collective. */
PetscErrorCode EqmRunMetis(PetscInt num_parts, PetscInt n, PetscInt *start, PetscInt *neighbor, PetscInt *part)
{
  idx_t num_rows = (idx_t)n, num_constraints = 1, parts = (idx_t)num_parts, cut, *from, *adjacent, *found;
  int result;

  PetscFunctionBegin;
  if (num_parts == 1) { /* METIS divides by zero there */
    PetscCall(PetscArrayzero(part, n));
    PetscFunctionReturn(0);
  }
  PetscCall(CheckGraph(n, start[n]));
  PetscCall(ToMetis(n + 1, PETSC_TRUE, start, &from));
  PetscCall(ToMetis(start[n], PETSC_TRUE, neighbor, &adjacent));
  PetscCall(ToMetis(n, PETSC_FALSE, part, &found));
  result = METIS_PartGraphKway(&num_rows, &num_constraints, from, adjacent, NULL, NULL, NULL, &parts, NULL, NULL, NULL,
                               &cut, found);
  PetscCall(CheckResult(result, "METIS_PartGraphKway"));
  PetscCall(FromMetis(n, PETSC_TRUE, part, &found));
  PetscCall(FromMetis(start[n], PETSC_FALSE, neighbor, &adjacent));
  PetscCall(FromMetis(n + 1, PETSC_FALSE, start, &from));
  PetscFunctionReturn(0);
}

/* Nested dissection of a graph: `order[k]` is eliminated as the k-th. Degrees become starts. Not collective. */
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
  PetscCall(CheckGraph(n, sum));
  PetscCall(ToMetis(n + 1, PETSC_TRUE, degree_then_start, &start));
  PetscCall(ToMetis(sum, PETSC_TRUE, neighbor, &adjacent));
  PetscCall(ToMetis(n, PETSC_FALSE, order, &permutation));
  PetscCall(PetscMalloc1(n, &inverse));
  result = METIS_NodeND(&num_rows, start, adjacent, NULL, NULL, permutation, inverse);
  PetscCall(CheckResult(result, "METIS_NodeND"));
  PetscCall(PetscFree(inverse));
  PetscCall(FromMetis(n, PETSC_TRUE, order, &permutation));
  PetscCall(FromMetis(sum, PETSC_FALSE, neighbor, &adjacent));
  PetscCall(FromMetis(n + 1, PETSC_FALSE, degree_then_start, &start));
  PetscFunctionReturn(0);
}
