/* The program that libFuzzer drives: fuzz [OPTIONS OF LIBFUZZER] [FOLDERS OR FILES], for the reader that the variable
   of the environment EQUIMAP_FUZZ names. */
#include "fuzz.h"
#include <stdio.h>
#include <string.h>
#include <equimap/soup.h>
#include "base/fatal.h"

static const struct {
  const char *name;
  EqmFuzzTarget target;
} targets[] = {{"ply", EqmFuzzParser},      {"vtu", EqmFuzzParser},   {"gii", EqmFuzzParser},
               {"vtk", EqmFuzzParser},      {"white", EqmFuzzParser}, {"msh", EqmFuzzParser},
               {"mesh", EqmFuzzParser},     {"meshb", EqmFuzzParser}, {"off", EqmFuzzParser},
               {"stl", EqmFuzzParser},      {"node", EqmFuzzParser},  {"obj", EqmFuzzParser},
               {"points", EqmFuzzPoints},   {"hdf5", EqmFuzzHdf5},    {"xdmf", EqmFuzzXdmf},
               {"density", EqmFuzzDensity}, {"table", EqmFuzzTable},  {"options", EqmFuzzOptions}};

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

static const char *chosen;
static EqmFuzzTarget target;

/* The fuzzer's own options stay with it. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
  static char *none[] = {"fuzz", NULL};
  int one = 1;
  char **arguments = none;

  chosen = getenv("EQUIMAP_FUZZ");
  for (size_t k = 0; chosen && k < sizeof(targets) / sizeof(targets[0]); ++k) {
    if (!strcmp(chosen, targets[k].name)) target = targets[k].target;
  }
  if (!target) {
    fprintf(stderr, "fuzz: set EQUIMAP_FUZZ to the name of a reader\n");
    exit(2);
  }
  if (EqmInitialize(&one, &arguments) || PetscPushErrorHandler(PetscReturnErrorHandler, NULL)) abort();
  EqmForgetEnds(); /* the fuzzer ends the program itself */
  return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
  target(chosen, bytes, length);
  return 0;
}
