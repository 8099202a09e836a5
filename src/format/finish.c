/* The end of a mesh that was made: which cells it has, polygons cut, texture coordinates per corner. */
#include "builder.h"
#include "mesh/fields.h"

#include <stdio.h>

static PetscErrorCode RefuseMesh(const EqmBuilder *builder, const char *format, const char *note)
{
  snprintf(builder->in->error, builder->in->error_length, format, note);
  return EQM_ERR_MESH;
}

/* Tetrahedra if there are any, otherwise triangles. */
static PetscErrorCode ChooseCells(const EqmBuilder *builder, PetscInt *cell_size)
{
  if (builder->other_volume[0]) {
    return RefuseMesh(builder, "%s: only tetrahedra with four vertices can be mapped: convert the mesh",
                      builder->other_volume);
  }
  *cell_size = builder->tetrahedra.count ? 4 : 3;
  if (builder->tetrahedra.count) return 0;
  if (builder->other_surface[0]) {
    return RefuseMesh(builder, "%s: only triangles with three vertices can be mapped: triangulate the mesh first",
                      builder->other_surface);
  }
  if (!builder->triangles.count) {
    return RefuseMesh(builder, "%s", "the mesh has no triangles or tetrahedra: there is nothing to map");
  }
  return 0;
}

/* Texture coordinates of all corners of all triangles; none if one corner has none. */
static PetscErrorCode TakeTexture(const EqmBuilder *builder, EqmSerialMesh *mesh)
{
  const size_t num_corners = 3 * builder->triangles.count;

  if (!builder->num_texture_points || builder->num_textured != builder->triangles.count) return 0;
  for (size_t i = 0; i < num_corners; ++i) {
    if (builder->textured[i] < 0 || (size_t)builder->textured[i] >= builder->num_texture_points) return 0;
  }
  EqmTry(PetscMalloc1(2 * num_corners, &mesh->texture));
  for (size_t i = 0; i < 2 * num_corners; ++i)
    mesh->texture[i] = builder->texture_points[2 * (size_t)builder->textured[i / 2] + i % 2];
  return 0;
}

/* A surface: its polygons are cut, its texture coordinates go with it. */
static PetscErrorCode CompleteSurface(EqmBuilder *builder, EqmSerialMesh *mesh)
{
  EqmTry(EqmBuilderCutPolygons(builder));
  if (builder->num_polygons) {
    snprintf(mesh->note, sizeof(mesh->note), "%zu faces of more than three corners were cut into triangles",
             builder->num_polygons);
  }
  return TakeTexture(builder, mesh);
}

/* A surface with polygons: per triangle the face of the file that it is or was cut from. The triangles of a face follow
   each other. */
static PetscErrorCode AddPolygons(const EqmBuilder *builder, EqmSerialMesh *mesh)
{
  const EqmMeshField kind = {EQM_FIELD_POLYGON, PETSC_TRUE, 1, NULL};
  PetscReal *values, face = 0.0;
  size_t next = 0, end = 0; /* of the polygons; of the triangles of the last one */

  if (!builder->num_polygons || EqmMeshFieldsFind(mesh->num_fields, mesh->fields, EQM_FIELD_POLYGON, PETSC_TRUE))
    return 0;
  EqmTry(EqmMeshFieldsAdd(&mesh->num_fields, &mesh->fields, &kind, (size_t)mesh->num_cells, &values));
  for (size_t t = 0; t < (size_t)mesh->num_cells; ++t) {
    if (next < builder->num_polygons && builder->polygons[next].first_triangle == t)
      end = t + (size_t)builder->polygons[next++].num_corners - 2;
    values[t] = face;
    if (t + 1 >= end) face += 1.0;
  }
  return 0;
}

static PetscErrorCode FreeLists(EqmBuilder *builder)
{
  EqmTry(PetscFree(builder->vertices));
  EqmTry(PetscFree(builder->triangles.corners));
  EqmTry(PetscFree(builder->tetrahedra.corners));
  EqmTry(PetscFree(builder->triangles.row));
  EqmTry(PetscFree(builder->tetrahedra.row));
  while (builder->num_fields) EqmTry(EqmBuilderDropField(builder));
  EqmTry(PetscFree(builder->fields));
  EqmTry(PetscFree(builder->polygons));
  EqmTry(PetscFree(builder->polygon_corners.corners));
  EqmTry(PetscFree(builder->textured));
  EqmTry(PetscFree(builder->texture_points));
  return PetscFree(builder->face);
}

/* EqmBuilderFinish - end the mesh: hand it over if `code` is 0 and it has cells, free everything otherwise. Not
   collective. Returns `code`, or EQM_ERR_MESH (quiet) if there are no triangles or tetrahedra, or other cells among
   them. */
PetscErrorCode EqmBuilderFinish(EqmBuilder *builder, PetscErrorCode code, EqmSerialMesh *mesh)
{
  PetscInt cell_size = 0;

  if (!code) code = ChooseCells(builder, &cell_size);
  if (!code && cell_size == 3) code = CompleteSurface(builder, mesh);
  if (!code) {
    EqmCellList *list = cell_size == 3 ? &builder->triangles : &builder->tetrahedra;

    mesh->num_vertices = (PetscInt)builder->num_vertices;
    mesh->num_cells = (PetscInt)list->count;
    mesh->cell_size = cell_size;
    mesh->vertices = builder->vertices;
    mesh->cells = list->corners;
    builder->vertices = NULL;
    list->corners = NULL;
    EqmTry(EqmBuilderTakeFields(builder, mesh, list));
    if (cell_size == 3) EqmTry(AddPolygons(builder, mesh));
    snprintf(mesh->left, sizeof(mesh->left), "%s", builder->left);
  }
  EqmTry(FreeLists(builder));
  return code;
}
