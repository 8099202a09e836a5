/* The parser of a format: whatever the bytes are, it returns, with a mesh that holds together or with an error that has
   a text; and the parser of parts, with all of the file as its one part: what it understands is the same mesh. */
#include "fuzz.h"
#include <stdio.h>
#include <string.h>
#include <equimap/soup.h>
#include "format/format.h"

/* whole - what the parser of the whole file makes of the bytes, without cells where it refuses them. */
static void TryPart(const EqmFormat *format, const uint8_t *bytes, size_t length, const EqmSerialMesh *whole)
{
  EqmPartFile opened;
  EqmSerialMesh mesh = {0};
  PetscBool understood = PETSC_FALSE;

  CLAIM(!EqmPartFileOpen(PETSC_COMM_SELF, EqmFuzzFile("part", bytes, length), &opened, &understood) && understood);
  CLAIM(!format->parse_part(&opened, &mesh, &understood));
  CLAIM(!EqmPartFileClose(&opened));
  if (!understood) return;
  CLAIM(mesh.num_vertices == whole->num_vertices && mesh.num_cells == whole->num_cells &&
        mesh.cell_size == whole->cell_size && mesh.num_fields == whole->num_fields && !mesh.texture == !whole->texture);
  CLAIM(!memcmp(mesh.vertices, whole->vertices, 3 * (size_t)mesh.num_vertices * sizeof(*mesh.vertices)));
  CLAIM(!memcmp(mesh.cells, whole->cells, (size_t)(mesh.cell_size * mesh.num_cells) * sizeof(*mesh.cells)));
  CLAIM(!EqmSerialMeshReset(&mesh));
}

void EqmFuzzParser(const char *name, const uint8_t *bytes, size_t length)
{
  EqmSerialMesh mesh = {0};
  const EqmFormat *format;
  char file[40], error[512] = "";
  PetscErrorCode code;

  snprintf(file, sizeof(file), "file.%s", name);
  (void)EqmFormatOfContent((const char *)bytes, length);
  format = EqmFormatOfSuffix(file);
  code = format->parse((const char *)bytes, length, &mesh, error, sizeof(error));
  if (code) {
    CLAIM((code == EQM_ERR_IO || code == EQM_ERR_MESH || code == PETSC_ERR_MEM) && (code == PETSC_ERR_MEM || error[0]));
    CLAIM(!mesh.vertices && !mesh.cells && !mesh.texture && !mesh.metadata);
  }
  if (format->parse_part && code != PETSC_ERR_MEM) TryPart(format, bytes, length, &mesh);
  if (code) return;
  CLAIM(mesh.num_cells > 0 && (mesh.cell_size == 3 || mesh.cell_size == 4));
  for (size_t i = 0; i < (size_t)mesh.cell_size * (size_t)mesh.num_cells; ++i)
    CLAIM(mesh.cells[i] >= 0 && mesh.cells[i] < mesh.num_vertices);
  CLAIM(!EqmSerialMeshReset(&mesh));
}
