/* The parser of the format with the suffix EQM_SUFFIX: whatever the bytes are, it returns, with a mesh that holds
   together or with an error that has a text. */
#include "fuzz.h"
#include <string.h>
#include "format/format.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
  const EqmFormat *const format = EqmFormatOfSuffix("file." EQM_SUFFIX);
  EqmSerialMesh mesh = {0};
  char error[512] = "";
  PetscErrorCode code;

  (void)EqmFormatOfContent((const char *)bytes, length);
  code = format->parse((const char *)bytes, length, &mesh, error, sizeof(error));
  if (code) {
    CLAIM((code == EQM_ERR_IO || code == EQM_ERR_MESH || code == PETSC_ERR_MEM) && (code == PETSC_ERR_MEM || error[0]));
    CLAIM(!mesh.vertices && !mesh.cells && !mesh.texture && !mesh.metadata);
    return 0;
  }
  CLAIM(mesh.num_cells > 0 && (mesh.cell_size == 3 || mesh.cell_size == 4));
  for (size_t i = 0; i < (size_t)mesh.cell_size * (size_t)mesh.num_cells; ++i)
    CLAIM(mesh.cells[i] >= 0 && mesh.cells[i] < mesh.num_vertices);
  CLAIM(!EqmSerialMeshReset(&mesh));
  return 0;
}
