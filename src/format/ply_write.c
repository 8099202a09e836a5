/* PLY, binary little endian, with fields as properties. */
#include "writers.h"
#include "input.h"
#include "scalar.h"

/* Names may not have blanks in PLY. */
static void PrintFieldHeader(EqmAtomicFile *file, const EqmField *field)
{
  for (PetscInt k = 0; k < field->width; ++k) {
    EqmAtomicPrint(file, "property double ");
    for (const char *c = field->name; *c; ++c) EqmAtomicWrite(file, EqmIsSpace(*c) ? "_" : c, 1);
    if (field->width > 1) EqmAtomicPrint(file, "_%d", (int)k);
    EqmAtomicPrint(file, "\n");
  }
}

static void WriteFields(EqmAtomicFile *file, const EqmField *fields, PetscInt num_fields, PetscBool on_cells,
                        PetscInt row)
{
  for (PetscInt f = 0; f < num_fields; ++f) {
    const size_t width = (size_t)fields[f].width;

    if (fields[f].on_cells == on_cells)
      EqmAtomicWrite(file, fields[f].values + width * (size_t)row, width * sizeof(double));
  }
}

static void PrintHeader(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields, PetscInt num_fields)
{
  EqmAtomicPrint(file, "ply\nformat binary_little_endian 1.0\ncomment equimap %s\nelement vertex %lld\n", EqmVersion(),
                 (long long)mesh->num_vertices);
  EqmAtomicPrint(file, "property double x\nproperty double y\nproperty double z\n");
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (!fields[f].on_cells) PrintFieldHeader(file, &fields[f]);
  }
  EqmAtomicPrint(file, "element face %lld\nproperty list uchar int vertex_indices\n", (long long)mesh->num_cells);
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (fields[f].on_cells) PrintFieldHeader(file, &fields[f]);
  }
  EqmAtomicPrint(file, "end_header\n");
}

/* EqmWritePly - write a binary PLY file. See EqmWriter. */
PetscErrorCode EqmWritePly(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields, PetscInt num_fields,
                           char *error, size_t error_length)
{
  EqmTry(EqmRequireTriangles(mesh, "PLY", error, error_length));
  PrintHeader(file, mesh, fields, num_fields);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicWrite(file, mesh->vertices + 3 * (size_t)i, 3 * sizeof(double));
    WriteFields(file, fields, num_fields, PETSC_FALSE, i);
  }
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    const PetscInt *cell = mesh->cells + 3 * (size_t)i;
    const int32_t corners[3] = {(int32_t)cell[0], (int32_t)cell[1], (int32_t)cell[2]};

    EqmAtomicWrite(file, "\3", 1);
    EqmAtomicWrite(file, corners, sizeof(corners));
    WriteFields(file, fields, num_fields, PETSC_TRUE, i);
  }
  return 0;
}
