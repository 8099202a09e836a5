/* Legacy VTK as text, version 3.0, which every program reads: triangles as POLYDATA, tetrahedra as UNSTRUCTURED_GRID.
 */
#include "writers.h"
#include "input.h"
#include "stream.h"

static void PrintCells(EqmAtomicFile *file, EqmMeshStream *stream)
{
  const EqmSerialMesh *const mesh = &stream->mesh;
  const PetscInt size = mesh->cell_size;

  EqmAtomicPrint(file, "%s %lld %lld\n", size == 3 ? "POLYGONS" : "CELLS", (long long)mesh->num_cells,
                 (long long)(size + 1) * (long long)mesh->num_cells);
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    const PetscInt *const cell = EqmStreamCell(stream, i);

    EqmAtomicPrint(file, "%d", (int)size);
    for (PetscInt k = 0; k < size; ++k) EqmAtomicPrint(file, " %lld", (long long)cell[k]);
    EqmAtomicWrite(file, "\n", 1);
  }
  if (size == 3) return;
  EqmAtomicPrint(file, "CELL_TYPES %lld\n", (long long)mesh->num_cells);
  for (PetscInt i = 0; i < mesh->num_cells; ++i) EqmAtomicWrite(file, "10\n", 3);
}

/* A name of this format has no blanks. */
static void PrintName(EqmAtomicFile *file, const char *name)
{
  for (; *name; ++name) EqmAtomicWrite(file, EqmIsSpace(*name) ? "_" : name, 1);
}

static void PrintFields(EqmAtomicFile *file, EqmMeshStream *stream, PetscBool on_cells)
{
  const PetscInt count = on_cells ? stream->mesh.num_cells : stream->mesh.num_vertices;
  const EqmField *const fields = stream->fields;
  PetscInt num_arrays = 0;

  for (PetscInt f = 0; f < stream->num_fields; ++f) num_arrays += fields[f].on_cells == on_cells;
  if (!num_arrays) return;
  EqmAtomicPrint(file, "%s %lld\nFIELD FieldData %d\n", on_cells ? "CELL_DATA" : "POINT_DATA", (long long)count,
                 (int)num_arrays);
  for (PetscInt f = 0; f < stream->num_fields; ++f) {
    if (fields[f].on_cells != on_cells) continue;
    PrintName(file, fields[f].name);
    EqmAtomicPrint(file, " %d %lld double\n", (int)fields[f].width, (long long)count);
    for (PetscInt i = 0; i < count; ++i) {
      EqmAtomicPrintReals(file, fields[f].width, EqmStreamField(stream, f, i), ' ');
      EqmAtomicWrite(file, "\n", 1);
    }
  }
}

/* EqmWriteVtk - write a legacy VTK file. See EqmStreamWriter. */
PetscErrorCode EqmWriteVtk(EqmAtomicFile *file, EqmMeshStream *stream, char *error, size_t error_length)
{
  const EqmSerialMesh *const mesh = &stream->mesh;

  EqmTry(EqmRequireSmall(mesh, "legacy VTK", error, error_length));
  EqmAtomicPrint(file, "# vtk DataFile Version 3.0\nequimap\nASCII\nDATASET %s\nPOINTS %lld double\n",
                 mesh->cell_size == 3 ? "POLYDATA" : "UNSTRUCTURED_GRID", (long long)mesh->num_vertices);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicPrintReals(file, 3, EqmStreamVertex(stream, i), ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  PrintCells(file, stream);
  PrintFields(file, stream, PETSC_FALSE);
  PrintFields(file, stream, PETSC_TRUE);
  return 0;
}
