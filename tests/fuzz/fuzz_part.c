/* The parser by parts of the format SUFFIX, named SUFFIX_part, with all of the file as its one part: it returns, and
   what it understands is what the parser of the whole file makes of the bytes. */
#include "fuzz.h"
#include <stdio.h>
#include <string.h>
#include <equimap/soup.h>
#include "format/format.h"

void EqmFuzzPart(const char *name, const uint8_t *bytes, size_t length)
{
  EqmFilePart part = {.length = length};
  EqmSerialMesh mesh = {0}, whole = {0};
  const EqmFormat *format;
  char file[40], error[512] = "";
  PetscBool understood = PETSC_FALSE;

  snprintf(file, sizeof(file), "file.%.*s", (int)strcspn(name, "_"), name);
  format = EqmFormatOfSuffix(file);
  CLAIM(part.bytes = malloc(length + !length)); /* of its own: a step beyond its end is seen */
  if (length) memcpy(part.bytes, bytes, length);
  CLAIM(!format->parse_part(PETSC_COMM_SELF, &part, &mesh, &understood));
  if (understood) {
    CLAIM(!format->parse((const char *)bytes, length, &whole, error, sizeof(error)));
    CLAIM(mesh.num_vertices == whole.num_vertices && mesh.num_cells == whole.num_cells &&
          mesh.cell_size == whole.cell_size && mesh.num_fields == whole.num_fields && !mesh.texture == !whole.texture);
    CLAIM(!memcmp(mesh.vertices, whole.vertices, 3 * (size_t)mesh.num_vertices * sizeof(*mesh.vertices)));
    CLAIM(!memcmp(mesh.cells, whole.cells, (size_t)(mesh.cell_size * mesh.num_cells) * sizeof(*mesh.cells)));
  }
  CLAIM(!EqmSerialMeshReset(&mesh) && !EqmSerialMeshReset(&whole));
  free(part.bytes);
}
