/* Conversions to the integers of other libraries. */
#include "base/narrow.h"
#include <stdint.h>

PetscErrorCode EqmCheckFits(PetscInt64 number, size_t width, const char *library, const char *what)
{
  const PetscInt64 largest = width < sizeof(PetscInt64) ? ((PetscInt64)1 << (8 * width - 1)) - 1 : INT64_MAX;

  PetscFunctionBegin;
  PetscCheck(number >= 0 && number <= largest, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "%" PetscInt64_FMT " %s are more than the %d-bit integers of %s can count; use more ranks, "
             "-linear_solver multigrid, or a build of it with longer integers",
             number, what, (int)(8 * width), library);
  PetscFunctionReturn(0);
}
