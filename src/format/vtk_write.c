/* Legacy VTK as text, version 3.0, which every program reads: triangles as POLYDATA, tetrahedra as UNSTRUCTURED_GRID.
 */
#include "writers.h"
#include "input.h"

static void PrintCells(EqmAtomicFile *file, const EqmSerialMesh *mesh)
{
  const PetscInt size = mesh->cell_size;

  EqmAtomicPrint(file, "%s %lld %lld\n", size == 3 ? "POLYGONS" : "CELLS", (long long)mesh->num_cells,
                 (long long)(size + 1) * (long long)mesh->num_cells);
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    EqmAtomicPrint(file, "%d", (int)size);
    for (PetscInt k = 0; k < size; ++k) {
      EqmAtomicPrint(file, " %lld", (long long)mesh->cells[(size_t)size * (size_t)i + (size_t)k]);
    }
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

static void PrintFields(EqmAtomicFile *file, const char *section, PetscInt count, const EqmField *fields,
                        PetscInt num_fields, PetscBool on_cells)
{
  PetscInt num_arrays = 0;

  for (PetscInt f = 0; f < num_fields; ++f) num_arrays += fields[f].on_cells == on_cells;
  if (!num_arrays) return;
  EqmAtomicPrint(file, "%s %lld\nFIELD FieldData %d\n", section, (long long)count, (int)num_arrays);
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (fields[f].on_cells != on_cells) continue;
    PrintName(file, fields[f].name);
    EqmAtomicPrint(file, " %d %lld double\n", (int)fields[f].width, (long long)count);
    for (PetscInt i = 0; i < count; ++i) {
      EqmAtomicPrintReals(file, fields[f].width, fields[f].values + (size_t)fields[f].width * (size_t)i, ' ');
      EqmAtomicWrite(file, "\n", 1);
    }
  }
}

/* EqmWriteVtk - write a legacy VTK file. See EqmWriter. */
PetscErrorCode EqmWriteVtk(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields, PetscInt num_fields,
                           char *error, size_t error_length)
{
  EqmTry(EqmRequireSmall(mesh, "legacy VTK", error, error_length));
  EqmAtomicPrint(file, "# vtk DataFile Version 3.0\nequimap\nASCII\nDATASET %s\nPOINTS %lld double\n",
                 mesh->cell_size == 3 ? "POLYDATA" : "UNSTRUCTURED_GRID", (long long)mesh->num_vertices);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicPrintReals(file, 3, mesh->vertices + 3 * (size_t)i, ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  PrintCells(file, mesh);
  PrintFields(file, "POINT_DATA", mesh->num_vertices, fields, num_fields, PETSC_FALSE);
  PrintFields(file, "CELL_DATA", mesh->num_cells, fields, num_fields, PETSC_TRUE);
  return 0;
}
