/* The end of a mesh that was made: which cells it has, polygons cut, texture coordinates per corner. */
#include "builder.h"
#include "base/rows.h"
#include "mesh/fields.h"

#include <stdio.h>
#include <string.h>

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

/* What the fields of a mesh depend on. Of a part of a file: of the whole file. */
typedef struct {
  PetscBool has_texture; /* all corners of all triangles have texture coordinates */
  PetscBool has_groups;
  PetscInt64 num_polygons, faces_before; /* faces of the parts before this one */
} Facts;

static Facts FactsOf(const EqmBuilder *builder, const EqmCellList *cells, size_t num_texture_points)
{
  const size_t num_corners = 3 * builder->triangles.count;
  Facts facts = {.has_texture = cells == &builder->triangles && builder->num_textured == cells->count,
                 .has_groups = EqmBuilderHasGroups(cells),
                 .num_polygons = (PetscInt64)builder->num_polygons};

  for (size_t i = 0; i < num_corners && facts.has_texture; ++i)
    facts.has_texture = builder->textured[i] >= 0 && (size_t)builder->textured[i] < num_texture_points;
  if (!num_texture_points) facts.has_texture = PETSC_FALSE;
  return facts;
}

static PetscErrorCode TakeTexture(const EqmBuilder *builder, EqmSerialMesh *mesh)
{
  const size_t num_numbers = 6 * builder->triangles.count;

  EqmTry(PetscMalloc1(num_numbers + 1, &mesh->texture)); /* an array, though an empty one */
  for (size_t i = 0; i < num_numbers; ++i)
    mesh->texture[i] = builder->texture_points[2 * (size_t)builder->textured[i / 2] + i % 2];
  return 0;
}

/* A surface with polygons: per triangle the face of the file that it is or was cut from. The triangles of a face follow
   each other. */
static PetscErrorCode AddPolygons(const EqmBuilder *builder, PetscInt64 faces_before, EqmSerialMesh *mesh)
{
  const EqmMeshField kind = {EQM_FIELD_POLYGON, PETSC_TRUE, 1, NULL};
  PetscReal *values, face = (PetscReal)faces_before;
  size_t next = 0, end = 0; /* of the polygons; of the triangles of the last one */

  if (EqmMeshFieldsFind(mesh->num_fields, mesh->fields, EQM_FIELD_POLYGON, PETSC_TRUE)) return 0;
  EqmTry(EqmMeshFieldsAdd(&mesh->num_fields, &mesh->fields, &kind, (size_t)mesh->num_cells, &values));
  for (size_t t = 0; t < (size_t)mesh->num_cells; ++t) {
    if (next < builder->num_polygons && builder->polygons[next].first_triangle == t)
      end = t + (size_t)builder->polygons[next++].num_corners - 2;
    values[t] = face;
    if (t + 1 >= end) face += 1.0;
  }
  return 0;
}

/* Hand over the vertices and one kind of cells, with all that belongs to them. Polygons have been cut. */
static PetscErrorCode HandOver(EqmBuilder *builder, PetscInt cell_size, const Facts *facts, EqmSerialMesh *mesh)
{
  EqmCellList *const list = cell_size == 3 ? &builder->triangles : &builder->tetrahedra;

  mesh->num_vertices = (PetscInt)builder->num_vertices;
  mesh->num_cells = (PetscInt)list->count;
  mesh->cell_size = cell_size;
  mesh->vertices = builder->vertices;
  mesh->cells = list->corners;
  builder->vertices = NULL;
  list->corners = NULL;
  EqmTry(EqmBuilderTakeFields(builder, mesh, list, facts->has_groups));
  if (facts->has_texture) EqmTry(TakeTexture(builder, mesh));
  if (facts->num_polygons && cell_size == 3) {
    EqmTry(AddPolygons(builder, facts->faces_before, mesh));
    snprintf(mesh->note, sizeof(mesh->note), "%lld faces of more than three corners were cut into triangles",
             (long long)facts->num_polygons);
  }
  snprintf(mesh->left, sizeof(mesh->left), "%s", builder->left);
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
  if (!code && cell_size == 3) code = EqmBuilderCutPolygons(builder, NULL);
  if (!code) {
    const Facts facts =
        FactsOf(builder, cell_size == 3 ? &builder->triangles : &builder->tetrahedra, builder->num_texture_points);

    EqmTry(HandOver(builder, cell_size, &facts, mesh));
  }
  EqmTry(FreeLists(builder));
  return code;
}

/* Cut this rank's polygons, whose corners may be other ranks' vertices. Collective. */
static PetscErrorCode CutPolygons(EqmBuilder *builder, MPI_Comm comm)
{
  const PetscInt num_corners = (PetscInt)builder->polygon_corners.count;
  PetscReal *coordinates;
  PetscInt *vertex;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(num_corners, &vertex, 3 * num_corners, &coordinates));
  for (PetscInt k = 0; k < num_corners; ++k) vertex[k] = builder->polygon_corners.corners[2 * k];
  PetscCall(EqmFetchRows(comm, (PetscInt)builder->num_vertices, num_corners, vertex, MPIU_REAL, 3, builder->vertices,
                         coordinates));
  PetscCall(EqmBuilderCutPolygons(builder, coordinates));
  PetscCall(PetscFree2(vertex, coordinates));
  PetscFunctionReturn(0);
}

/* Make the texture points of this rank's corners its own. Collective. */
static PetscErrorCode FetchTexture(EqmBuilder *builder, MPI_Comm comm)
{
  const PetscInt num_corners = 3 * (PetscInt)builder->triangles.count;
  PetscReal *points;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(2 * num_corners, &points));
  PetscCall(EqmFetchRows(comm, (PetscInt)builder->num_texture_points, num_corners, builder->textured, MPIU_REAL, 2,
                         builder->texture_points, points));
  PetscCall(PetscFree(builder->texture_points));
  builder->texture_points = points;
  for (PetscInt i = 0; i < num_corners; ++i) builder->textured[i] = i;
  PetscFunctionReturn(0);
}

/* What the parts have left out, in their order, each once. Collective. */
static PetscErrorCode ShareLeft(EqmBuilder *builder, MPI_Comm comm)
{
  PetscMPIInt size, rank;
  char *all;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscMalloc1(rank == 0 ? (size_t)size * sizeof(builder->left) : 0, &all));
  PetscCallMPI(
      MPI_Gather(builder->left, sizeof(builder->left), MPI_CHAR, all, sizeof(builder->left), MPI_CHAR, 0, comm));
  for (PetscMPIInt r = 1; r < size && rank == 0; ++r) {
    for (char *what = all + (size_t)r * sizeof(builder->left), *next; *what; what = next) {
      next = what + strcspn(what, ",");
      if (*next) {
        *next = '\0';
        next += strlen(", ");
      }
      EqmBuilderNoteLeft(builder, what);
    }
  }
  PetscCallMPI(MPI_Bcast(builder->left, sizeof(builder->left), MPI_CHAR, 0, comm));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(0);
}

/* What the fields of the whole mesh depend on. Collective. */
static PetscErrorCode ShareFacts(const EqmBuilder *builder, const EqmCellList *cells, MPI_Comm comm, Facts *facts)
{
  PetscInt64 sums[2] = {(PetscInt64)builder->num_texture_points, (PetscInt64)builder->num_polygons}, faces, before;

  PetscFunctionBegin;
  faces = (PetscInt64)(builder->triangles.count + 3 * builder->num_polygons - builder->polygon_corners.count);
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_INT64, MPI_SUM, comm));
  PetscCallMPI(MPI_Scan(&faces, &before, 1, MPIU_INT64, MPI_SUM, comm));
  *facts = FactsOf(builder, cells, (size_t)sums[0]);
  facts->num_polygons = sums[1];
  facts->faces_before = before - faces;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &facts->has_texture, 1, MPIU_BOOL, MPI_LAND, comm));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &facts->has_groups, 1, MPIU_BOOL, MPI_LOR, comm));
  PetscFunctionReturn(0);
}

/* Which cells the parts have together; `understood` is false where there are none, or some that one cannot map.
   Collective. */
static PetscErrorCode ShareKinds(const EqmBuilder *builder, MPI_Comm comm, PetscInt *cell_size, PetscBool *has_polygons,
                                 PetscBool *understood)
{
  PetscInt64 sums[6] = {*understood ? 0 : 1,
                        (PetscInt64)builder->triangles.count,
                        (PetscInt64)builder->tetrahedra.count,
                        (PetscInt64)builder->num_polygons,
                        builder->other_surface[0] ? 1 : 0,
                        builder->other_volume[0] ? 1 : 0};

  PetscFunctionBegin;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sums, 6, MPIU_INT64, MPI_SUM, comm));
  *cell_size = sums[2] ? 4 : 3;
  *has_polygons = sums[3] && !sums[2] ? PETSC_TRUE : PETSC_FALSE;
  *understood = !sums[0] && !sums[5] && (sums[2] || (sums[1] && !sums[4])) ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(0);
}

/* EqmBuilderFinishPart - end a mesh of which every rank has made a part: hand the part over, or free everything where
   `understood` is false on a rank or there are no cells that can be mapped, and say so on all. Collective. */
PetscErrorCode EqmBuilderFinishPart(EqmBuilder *builder, MPI_Comm comm, PetscBool *understood, EqmSerialMesh *part)
{
  const EqmCellList *cells;
  PetscInt cell_size;
  PetscBool has_polygons;
  Facts facts;

  PetscFunctionBegin;
  PetscCall(ShareKinds(builder, comm, &cell_size, &has_polygons, understood));
  cells = cell_size == 3 ? &builder->triangles : &builder->tetrahedra;
  if (*understood) {
    if (has_polygons) PetscCall(CutPolygons(builder, comm));
    PetscCall(ShareFacts(builder, cells, comm, &facts));
    if (facts.has_texture && !builder->texture_of_part) PetscCall(FetchTexture(builder, comm));
    PetscCall(ShareLeft(builder, comm));
    PetscCall(HandOver(builder, cell_size, &facts, part));
  }
  PetscCall(FreeLists(builder));
  PetscFunctionReturn(0);
}
