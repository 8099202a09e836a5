/* MSH as text, version 2.2, which every program reads; fields as node and element data. */
#include "writers.h"

/* A field as $NodeData or $ElementData. Gmsh has fields of 1, 3 and 9 numbers per node or element; missing ones are
 * zero. */
static void PrintField(EqmAtomicFile *file, const EqmField *field, PetscInt count)
{
  const char *const section = field->on_cells ? "ElementData" : "NodeData";
  const PetscInt width = field->width == 1 ? 1 : field->width <= 3 ? 3 : 9;

  if (field->width > 9) return;
  EqmAtomicPrint(file, "$%s\n1\n\"%s\"\n1\n0\n3\n0\n%d\n%lld\n", section, field->name, (int)width, (long long)count);
  for (PetscInt i = 0; i < count; ++i) {
    EqmAtomicPrint(file, "%lld ", (long long)i + 1);
    EqmAtomicPrintReals(file, field->width, field->values + (size_t)field->width * (size_t)i, ' ');
    for (PetscInt k = field->width; k < width; ++k) EqmAtomicWrite(file, " 0", 2);
    EqmAtomicWrite(file, "\n", 1);
  }
  EqmAtomicPrint(file, "$End%s\n", section);
}

/* EqmWriteGmsh - write an ASCII file of version 2.2, which every program reads. See EqmWriter. */
PetscErrorCode EqmWriteGmsh(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields, PetscInt num_fields,
                            char *error, size_t error_length)
{
  const PetscInt size = mesh->cell_size;

  EqmAtomicPrint(file, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%lld\n", (long long)mesh->num_vertices);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicPrint(file, "%lld ", (long long)i + 1);
    EqmAtomicPrintReals(file, 3, mesh->vertices + 3 * (size_t)i, ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  EqmAtomicPrint(file, "$EndNodes\n$Elements\n%lld\n", (long long)mesh->num_cells);
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    EqmAtomicPrint(file, "%lld %d 2 0 1", (long long)i + 1, size == 3 ? 2 : 4);
    for (PetscInt k = 0; k < size; ++k)
      EqmAtomicPrint(file, " %lld", (long long)mesh->cells[(size_t)size * (size_t)i + (size_t)k] + 1);
    EqmAtomicWrite(file, "\n", 1);
  }
  EqmAtomicPrint(file, "$EndElements\n");
  for (PetscInt f = 0; f < num_fields; ++f) {
    PrintField(file, &fields[f], fields[f].on_cells ? mesh->num_cells : mesh->num_vertices);
  }
  return 0;
}
