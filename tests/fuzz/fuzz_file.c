/* Readers that open files themselves: meshes in HDF5 (EQM_FUZZ_HDF5) and XDMF (EQM_FUZZ_XDMF), densities
   (EQM_FUZZ_DENSITY), tables of landmarks (EQM_FUZZ_TABLE). */
#define _GNU_SOURCE
#include "fuzz_memory.h"
#include "mesh/mesh_private.h"
#include "format/format.h"
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
#elif defined(EQM_FUZZ_XDMF)
/* The arrays may be those of mesh.h5, beside the file. */
static PetscErrorCode Read(const char *file)
{
  static EqmSoup beside;
  EqmSoup soup = NULL;
  PetscErrorCode code;

  if (!beside) {
    CLAIM(!EqmSoupGenerate(PETSC_COMM_SELF, "hills", 12, 0, &beside));
    CLAIM(!EqmSoupWrite(beside, NameInFolder("mesh.h5")));
  }
  code = EqmFormatOfSuffix(".xdmf")->read_parallel(PETSC_COMM_SELF, file, &soup);
  CLAIM(code ? !soup : soup->num_cells > 0);
  for (PetscInt k = 0; soup && k < soup->cell_size * soup->num_cells; ++k)
    CLAIM(soup->cells[k] >= 0 && soup->cells[k] < soup->num_vertices);
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

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
  char name[1100];

  snprintf(name, sizeof(name), "%s", FileOfBytes("file", bytes, length));
  CLAIM(!Read(name));
  return 0;
}
