/* Wavefront OBJ, written: vertices, texture points, groups, and faces, those of textures as the input had them. */
#include "builder.h"
#include "format.h"
#include "mesh/fields.h"
#include "metadata.h"
#include "polygon.h"
#include "seam.h"
#include "stream.h"
#include "writers.h"

#include <stdio.h>

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
static PetscInt CountOfFace(const EqmSerialMesh *mesh, const EqmField *polygon, PetscInt cell)
{
  PetscInt count = 1;

  if (!polygon) return 1;
  while (cell + count < mesh->num_cells && count < EQM_MAX_POLYGON - 2 &&
         polygon->values[cell + count] == polygon->values[cell])
    ++count;
  return count;
}

/* A face with its texture points, of which each belongs to one vertex: that of the file, where its triangles still make
   it up, else these. */
static void PrintTexturedFaces(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmSeams *seams, PetscInt first,
                               PetscInt count)
{
  const PetscInt *const corner = seams->corner + 3 * (size_t)first, *const vertex = mesh->cells + 3 * (size_t)first;
  PetscInt cycle[EQM_MAX_POLYGON];
  const PetscBool whole = EqmPolygonOfTriangles(count, corner, cycle);
  const PetscInt n = whole ? count + 2 : 3 * count;

  for (PetscInt k = 0; k < n; ++k) {
    PetscInt place = k;

    while (whole && corner[place] != cycle[k]) place = (place + 1) % (3 * count);
    EqmAtomicPrint(file, "%s%lld/%lld%s", k == 0 || (!whole && k % 3 == 0) ? "f " : " ", (long long)vertex[place] + 1,
                   (long long)corner[place] + 1, k == n - 1 || (!whole && k % 3 == 2) ? "\n" : "");
  }
}

/* Texture points, one for each different pair of a vertex and a point, and faces that name both. */
static PetscErrorCode WriteTexturedFaces(EqmAtomicFile *file, EqmMeshStream *stream, const EqmField *group)
{
  const EqmSerialMesh *const mesh = &stream->mesh;
  const EqmField *const polygon = EqmFieldPolygon(stream->fields, stream->num_fields);
  EqmSeams seams;
  PetscInt count;

  EqmTry(EqmSeamsFind(mesh->num_vertices, mesh->num_cells, mesh->cells, mesh->texture, &seams));
  for (PetscInt i = 0; i < seams.num; ++i) {
    EqmAtomicWrite(file, "vt ", 3);
    EqmAtomicPrintReals(file, 2, seams.point + 2 * (size_t)i, ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  for (PetscInt c = 0; c < mesh->num_cells; c += count) {
    count = CountOfFace(mesh, polygon, c);
    PrintGroup(file, stream, group, c);
    PrintTexturedFaces(file, mesh, &seams, c, count);
  }
  return EqmSeamsReset(&seams);
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
  if (stream->mesh.texture) return WriteTexturedFaces(file, stream, group);
  for (PetscInt i = 0; i < stream->mesh.num_cells; ++i) {
    const PetscInt *const cell = EqmStreamCell(stream, i);

    PrintGroup(file, stream, group, i);
    EqmAtomicPrint(file, "f %lld %lld %lld\n", (long long)cell[0] + 1, (long long)cell[1] + 1, (long long)cell[2] + 1);
  }
  return 0;
}
