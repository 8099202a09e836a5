/* Wavefront OBJ, written: vertices, texture points, groups, and faces, those of textures as the input had them. */
#include "builder.h"
#include "format.h"
#include "mesh/fields.h"
#include "metadata.h"
#include "polygon.h"
#include "stream.h"
#include "writers.h"

#include <stdio.h>
#include <string.h>

/* A line `g name` where the group changes. */
static void PrintGroup(EqmAtomicFile *file, EqmMeshStream *stream, const EqmField *group, PetscInt cell)
{
  const PetscInt f = EqmStreamIndexOf(stream, group);
  const PetscReal before = group && cell > 0 ? *EqmStreamField(stream, f, cell - 1) : 0.0;
  const PetscReal number = group ? *EqmStreamField(stream, f, cell) : 0.0;
  char key[32], name[256];

  if (!group || (cell > 0 && number == before)) return;
  snprintf(key, sizeof(key), EQM_GROUP_KEY, (long long)number);
  if (!EqmMetadataGet(stream->mesh.metadata, key, name, sizeof(name)))
    snprintf(name, sizeof(name), number == 0.0 ? "default" : "group_%lld", (long long)number);
  EqmAtomicPrint(file, "g %s\n", name);
}

/* How many triangles from `cell` on were cut from its face of the file. */
static PetscInt CountOfFace(EqmMeshStream *stream, PetscInt polygon, PetscInt cell)
{
  PetscInt count = 1;
  PetscReal number;

  if (polygon < 0) return 1;
  number = *EqmStreamField(stream, polygon, cell);
  while (cell + count < stream->mesh.num_cells && count < EQM_MAX_POLYGON - 2 &&
         *EqmStreamField(stream, polygon, cell + count) == number)
    ++count;
  return count;
}

/* The rows of `count` cells, three numbers each. */
static void CopyRows(EqmMeshStream *stream, PetscInt column, PetscInt first, PetscInt count, PetscInt *rows)
{
  for (PetscInt c = 0; c < count; ++c)
    memcpy(rows + 3 * c, EqmColumnRow(&stream->columns[column], first + c), 3 * sizeof(PetscInt));
}

/* A face with its texture points, of which each belongs to one vertex: that of the file, where its triangles still make
   it up, else these. */
static void PrintTexturedFaces(EqmAtomicFile *file, EqmMeshStream *stream, PetscInt first, PetscInt count)
{
  PetscInt corner[3 * (EQM_MAX_POLYGON - 2)], vertex[3 * (EQM_MAX_POLYGON - 2)], cycle[EQM_MAX_POLYGON];
  PetscBool whole;
  PetscInt n;

  CopyRows(stream, EQM_COLUMN_POINTS_OF_CELLS, first, count, corner);
  CopyRows(stream, EQM_COLUMN_CELLS, first, count, vertex);
  whole = EqmPolygonOfTriangles(count, corner, cycle);
  n = whole ? count + 2 : 3 * count;
  for (PetscInt k = 0; k < n; ++k) {
    PetscInt place = k;

    while (whole && corner[place] != cycle[k]) place = (place + 1) % (3 * count);
    EqmAtomicPrint(file, "%s%lld/%lld%s", k == 0 || (!whole && k % 3 == 0) ? "f " : " ", (long long)vertex[place] + 1,
                   (long long)corner[place] + 1, k == n - 1 || (!whole && k % 3 == 2) ? "\n" : "");
  }
}

/* Texture points, one for each different pair of a vertex and a point, and faces that name both. */
static void WriteTexturedFaces(EqmAtomicFile *file, EqmMeshStream *stream, const EqmField *group)
{
  const PetscInt polygon = EqmStreamIndexOf(stream, EqmFieldPolygon(stream->fields, stream->num_fields));
  PetscInt count;

  for (PetscInt i = 0; i < stream->mesh.num_vertices + stream->num_more; ++i) {
    EqmAtomicWrite(file, "vt ", 3);
    EqmAtomicPrintReals(file, 2, EqmStreamPoint(stream, i), ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  for (PetscInt c = 0; c < stream->mesh.num_cells; c += count) {
    count = CountOfFace(stream, polygon, c);
    PrintGroup(file, stream, group, c);
    PrintTexturedFaces(file, stream, c, count);
  }
}

/* Write an OBJ file. See EqmStreamWriter. */
PetscErrorCode EqmWriteObj(EqmAtomicFile *file, EqmMeshStream *stream, char *error, size_t error_length)
{
  const EqmField *const group = EqmFieldGroup(stream->fields, stream->num_fields);

  EqmTry(EqmRequireTriangles(&stream->mesh, "OBJ", error, error_length));
  for (PetscInt i = 0; i < stream->mesh.num_vertices; ++i) {
    EqmAtomicWrite(file, "v ", 2);
    EqmAtomicPrintReals(file, 3, EqmStreamVertex(stream, i), ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  if (stream->has_texture) WriteTexturedFaces(file, stream, group);
  for (PetscInt i = 0; i < stream->mesh.num_cells && !stream->has_texture; ++i) {
    const PetscInt *const cell = EqmStreamCell(stream, i);

    PrintGroup(file, stream, group, i);
    EqmAtomicPrint(file, "f %lld %lld %lld\n", (long long)cell[0] + 1, (long long)cell[1] + 1, (long long)cell[2] + 1);
  }
  return 0;
}
