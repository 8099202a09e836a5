/* The parser of a format: whatever the bytes are, it returns, with a mesh that holds together or with an error that has
   a text. */
#include "fuzz.h"
#include <stdio.h>
#include <equimap/soup.h>
#include "format/format.h"

void EqmFuzzParser(const char *name, const uint8_t *bytes, size_t length)
{
  EqmSerialMesh mesh = {0};
  char file[40], error[512] = "";
  PetscErrorCode code;

  snprintf(file, sizeof(file), "file.%s", name);
  (void)EqmFormatOfContent((const char *)bytes, length);
  code = EqmFormatOfSuffix(file)->parse((const char *)bytes, length, &mesh, error, sizeof(error));
  if (code) {
    CLAIM((code == EQM_ERR_IO || code == EQM_ERR_MESH || code == PETSC_ERR_MEM) && (code == PETSC_ERR_MEM || error[0]));
    CLAIM(!mesh.vertices && !mesh.cells && !mesh.texture && !mesh.metadata);
    return;
  }
  CLAIM(mesh.num_cells > 0 && (mesh.cell_size == 3 || mesh.cell_size == 4));
  for (size_t i = 0; i < (size_t)mesh.cell_size * (size_t)mesh.num_cells; ++i)
    CLAIM(mesh.cells[i] >= 0 && mesh.cells[i] < mesh.num_vertices);
  CLAIM(!EqmSerialMeshReset(&mesh));
}
