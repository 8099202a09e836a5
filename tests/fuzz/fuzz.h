/* What the fuzz targets share: PETSc, begun once, that returns errors and prints nothing. */
#ifndef EQM_FUZZ_H
#define EQM_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <equimap/soup.h>
#include "base/fatal.h"

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

/* The fuzzer's own options stay with it. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
  static char *none[] = {"fuzz", NULL};
  int one = 1;
  char **arguments = none;

  if (EqmInitialize(&one, &arguments) || PetscPushErrorHandler(PetscReturnErrorHandler, NULL)) abort();
  EqmForgetEnds(); /* the fuzzer ends the program itself */
  return 0;
}

/* End the program, which libFuzzer reports with the input, if a claim does not hold. */
#define CLAIM(condition)                                                                                               \
  do {                                                                                                                 \
    if (!(condition)) abort();                                                                                         \
  } while (0)

#endif
