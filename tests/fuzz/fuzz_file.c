/* Readers that open files themselves: meshes in HDF5 (EQM_FUZZ_HDF5), densities (EQM_FUZZ_DENSITY), tables of landmarks
   (EQM_FUZZ_TABLE). */
#define _GNU_SOURCE
#include "fuzz.h"
#include "mesh/mesh_private.h"
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>
#include "format/hdf5.h"
#include "format/table.h"

#ifdef EQM_FUZZ_HDF5
static PetscErrorCode Read(const char *file)
{
  EqmSoup soup = NULL;
  PetscErrorCode code = EqmSoupReadHdf5(PETSC_COMM_SELF, file, &soup);

  CLAIM(code ? !soup : soup->num_cells > 0);
  return EqmSoupDestroy(&soup);
}
#elif defined(EQM_FUZZ_DENSITY)
static PetscErrorCode Read(const char *file)
{
  static EqmSoup soup;

  if (!soup) CLAIM(!EqmSoupGenerate(PETSC_COMM_SELF, "hills", 12, 0, &soup));
  (void)EqmSoupReadDensity(soup, file);
  return 0;
}
#else
static PetscErrorCode Read(const char *file)
{
  EqmTable table;

  (void)EqmTableRead(PETSC_COMM_SELF, file, 2, 4, "a vertex of A and a vertex of B, or a vertex and a point", &table);
  return PetscFree(table.values);
}
#endif

/* The file is one in memory, under its name in /proc. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
  static int descriptor = -1;
  static char name[64];

  if (descriptor < 0) {
    descriptor = memfd_create("fuzz", 0);
    snprintf(name, sizeof(name), "/proc/self/fd/%d", descriptor);
  }
  CLAIM(descriptor >= 0 && !ftruncate(descriptor, 0) && pwrite(descriptor, bytes, length, 0) == (ssize_t)length);
  CLAIM(!Read(name));
  return 0;
}
