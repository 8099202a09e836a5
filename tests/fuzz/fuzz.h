/* The targets of the fuzzer, one per reader: each takes bytes as the content of a file. */
#ifndef EQM_FUZZ_H
#define EQM_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <petscsys.h>

/* A target; `name` is that of the reader, for formats their suffix. */
typedef void (*EqmFuzzTarget)(const char *name, const uint8_t *bytes, size_t length);

PETSC_INTERN void EqmFuzzParser(const char *name, const uint8_t *bytes, size_t length);
PETSC_INTERN void EqmFuzzPoints(const char *name, const uint8_t *bytes, size_t length);
PETSC_INTERN void EqmFuzzHdf5(const char *name, const uint8_t *bytes, size_t length);
PETSC_INTERN void EqmFuzzXdmf(const char *name, const uint8_t *bytes, size_t length);
PETSC_INTERN void EqmFuzzDensity(const char *name, const uint8_t *bytes, size_t length);
PETSC_INTERN void EqmFuzzTable(const char *name, const uint8_t *bytes, size_t length);
PETSC_INTERN void EqmFuzzOptions(const char *name, const uint8_t *bytes, size_t length);

/* Where the file `name` of a folder for this process, below TMPDIR, is. The text is constant until the next call. */
PETSC_INTERN const char *EqmFuzzFolder(const char *name);
/* A file of that name in the folder, the same one in memory for all names, has these bytes. */
PETSC_INTERN const char *EqmFuzzFile(const char *name, const uint8_t *bytes, size_t length);

/* End the program, which libFuzzer reports with the input, if a claim does not hold. */
#define CLAIM(condition)                                                                                               \
  do {                                                                                                                 \
    if (!(condition)) abort();                                                                                         \
  } while (0)

#endif
