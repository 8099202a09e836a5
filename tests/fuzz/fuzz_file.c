/* Readers that open files themselves: meshes in HDF5 and XDMF, densities, tables of landmarks. */
#include "fuzz.h"
#include <equimap/soup.h>
#include "mesh/mesh_private.h"
#include "format/format.h"
#include "format/hdf5.h"
#include "format/table.h"

/* A small mesh, made once. */
static EqmSoup Hills(void)
{
  static EqmSoup soup;

  if (!soup) CLAIM(!EqmSoupGenerate(PETSC_COMM_SELF, "hills", 12, 0, &soup));
  return soup;
}

void EqmFuzzHdf5(const char *name, const uint8_t *bytes, size_t length)
{
  EqmSoup soup = NULL;
  const PetscErrorCode code = EqmSoupReadHdf5(PETSC_COMM_SELF, EqmFuzzFile("file", bytes, length), &soup);

  CLAIM(code ? !soup : soup->num_cells > 0);
  CLAIM(!EqmSoupDestroy(&soup));
}

/* The arrays may be those of mesh.h5, beside the file. */
void EqmFuzzXdmf(const char *name, const uint8_t *bytes, size_t length)
{
  static PetscBool beside;
  EqmSoup soup = NULL;
  PetscErrorCode code;

  if (!beside) CLAIM(!EqmSoupWrite(Hills(), EqmFuzzFolder("mesh.h5")));
  beside = PETSC_TRUE;
  code = EqmFormatOfSuffix(".xdmf")->read_parallel(PETSC_COMM_SELF, EqmFuzzFile("file", bytes, length), &soup);
  CLAIM(code ? !soup : soup->num_cells > 0);
  for (PetscInt k = 0; soup && k < soup->cell_size * soup->num_cells; ++k)
    CLAIM(soup->cells[k] >= 0 && soup->cells[k] < soup->num_vertices);
  CLAIM(!EqmSoupDestroy(&soup));
}

void EqmFuzzDensity(const char *name, const uint8_t *bytes, size_t length)
{
  (void)EqmSoupReadDensity(Hills(), EqmFuzzFile("file", bytes, length));
}

void EqmFuzzTable(const char *name, const uint8_t *bytes, size_t length)
{
  EqmTable table;

  (void)EqmTableRead(PETSC_COMM_SELF, EqmFuzzFile("file", bytes, length), 2, 4,
                     "a vertex of A and a vertex of B, or a vertex and a point", &table);
  CLAIM(!PetscFree(table.values));
}
