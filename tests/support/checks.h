/* Checks of the tests in C: the first that fails ends all ranks and says where it stands. */
#ifndef EQM_CHECKS_H
#define EQM_CHECKS_H

#include <petscsys.h>
#include <stdio.h>

/* End all ranks with a message if `condition` does not hold; the other arguments, if any, are a format, which must be a
   literal, and its values. */
#define CHECK(condition, ...)                                                                                          \
  do {                                                                                                                 \
    if (!(condition)) {                                                                                                \
      fprintf(stderr, "%s:%d: not so: %s:", __FILE__, __LINE__, #condition);                                           \
      fprintf(stderr, " " __VA_ARGS__);                                                                                \
      fprintf(stderr, "\n");                                                                                           \
      MPI_Abort(PETSC_COMM_WORLD, 1);                                                                                  \
    }                                                                                                                  \
  } while (0)

/* `got` and `wanted` differ by no more than `tolerance` times `scale`. */
#define CHECK_CLOSE(got, wanted, tolerance, scale)                                                                     \
  CHECK(PetscAbsReal((got) - (wanted)) <= (tolerance) * (scale), "%.17g, not %.17g: off by %.3g of %.3g",              \
        (double)(got), (double)(wanted), (double)(PetscAbsReal((got) - (wanted)) / (scale)), (double)(tolerance))

/* An error is expected: its code must be `code`, and nothing is printed. */
#define CHECK_FAILS(code, call)                                                                                        \
  do {                                                                                                                 \
    PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));                                                   \
    const PetscErrorCode got_error = (call);                                                                           \
    PetscCall(PetscPopErrorHandler());                                                                                 \
    CHECK(got_error == (code), "error %d, not %d", (int)got_error, (int)(code));                                       \
  } while (0)

#endif
