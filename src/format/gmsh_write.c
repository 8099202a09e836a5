/* MSH as text, version 2.2, which every program reads; fields as node and element data. */
#include "writers.h"
#include "metadata.h"
#include "stream.h"

#include <stdio.h>
#include <string.h>

/* A field as $NodeData or $ElementData. Gmsh has fields of 1, 3 and 9 numbers per node or element; missing ones are
 * zero. */
static void PrintField(EqmAtomicFile *file, EqmMeshStream *stream, PetscInt f)
{
  const EqmField *const field = &stream->fields[f];
  const PetscInt count = field->on_cells ? stream->mesh.num_cells : stream->mesh.num_vertices;
  const char *const section = field->on_cells ? "ElementData" : "NodeData";
  const PetscInt width = field->width == 1 ? 1 : field->width <= 3 ? 3 : 9;

  if (field->width > 9) return;
  EqmAtomicPrint(file, "$%s\n1\n\"%s\"\n1\n0\n3\n0\n%d\n%lld\n", section, field->name, (int)width, (long long)count);
  for (PetscInt i = 0; i < count; ++i) {
    EqmAtomicPrint(file, "%lld ", (long long)i + 1);
    EqmAtomicPrintReals(file, field->width, EqmStreamField(stream, f, i), ' ');
    for (PetscInt k = field->width; k < width; ++k) EqmAtomicWrite(file, " 0", 2);
    EqmAtomicWrite(file, "\n", 1);
  }
  EqmAtomicPrint(file, "$End%s\n", section);
}

/* The names that the groups had in the input, of those that are in use. */
static void PrintNames(EqmAtomicFile *file, const EqmSerialMesh *mesh)
{
  PetscInt count = 0;

  for (int pass = 0; pass < 2; ++pass) {
    long long group;
    int at;

    for (const char *line = mesh->metadata; line && *line; line += strcspn(line, "\n") + 1) {
      if (sscanf(line, EQM_GROUP_KEY "\t%n", &group, &at) != 1) continue;
      if (pass)
        EqmAtomicPrint(file, "%d %lld \"%.*s\"\n", (int)mesh->cell_size - 1, group, (int)strcspn(line + at, "\"\n"),
                       line + at);
      else
        ++count;
    }
    if (!count) return;
    EqmAtomicPrint(file, pass ? "$EndPhysicalNames\n" : "$PhysicalNames\n%d\n", (int)count);
  }
}

/* EqmWriteGmsh - write an ASCII file of version 2.2, which every program reads. See EqmStreamWriter. */
PetscErrorCode EqmWriteGmsh(EqmAtomicFile *file, EqmMeshStream *stream, char *error, size_t error_length)
{
  const EqmSerialMesh *const mesh = &stream->mesh;
  const EqmField *const groups = EqmFieldGroup(stream->fields, stream->num_fields);
  const PetscInt size = mesh->cell_size;

  EqmAtomicPrint(file, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
  if (groups) PrintNames(file, mesh);
  EqmAtomicPrint(file, "$Nodes\n%lld\n", (long long)mesh->num_vertices);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicPrint(file, "%lld ", (long long)i + 1);
    EqmAtomicPrintReals(file, 3, EqmStreamVertex(stream, i), ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  EqmAtomicPrint(file, "$EndNodes\n$Elements\n%lld\n", (long long)mesh->num_cells);
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    const int group = EqmStreamGroup(stream, EqmStreamIndexOf(stream, groups), i);
    const PetscInt *const cell = EqmStreamCell(stream, i);

    EqmAtomicPrint(file, "%lld %d 2 %d %d", (long long)i + 1, size == 3 ? 2 : 4, group, group ? group : 1);
    for (PetscInt k = 0; k < size; ++k) EqmAtomicPrint(file, " %lld", (long long)cell[k] + 1);
    EqmAtomicWrite(file, "\n", 1);
  }
  EqmAtomicPrint(file, "$EndElements\n");
  for (PetscInt f = 0; f < stream->num_fields; ++f) {
    if (&stream->fields[f] != groups) PrintField(file, stream, f);
  }
  return 0;
}
