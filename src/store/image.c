/* A map in mesh formats: the input's cells with every vertex at its image, or at its input position with its image as a
 * field.
 */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "mesh/fields.h"
#include "store/store.h"
#include "format/format.h"
#include "base/rows.h"
#include <string.h>

enum { MOST_FIELDS = 8 };

/* Everything on rank 0; empty elsewhere. */
typedef struct {
  EqmSerialMesh mesh;
  PetscReal *images; /* dim per vertex */
  PetscReal *points; /* 3 per vertex: the input, or its image with z = 0 for planar maps */
  PetscReal *arrays[MOST_FIELDS];
  EqmField fields[MOST_FIELDS];
  PetscInt num_fields;
} Gathered;

/* Gather slabs of reals on rank 0, in `all`. */
static PetscErrorCode GatherReals(MPI_Comm comm, PetscInt width, PetscInt count, const PetscReal *slab, PetscReal *all)
{
  PetscLayout layout;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(comm, count, PETSC_DETERMINE, 1, &layout));
  PetscCall(PetscSFCreate(comm, &sf));
  PetscCall(PetscSFSetGraphWithPattern(sf, layout, PETSCSF_PATTERN_GATHER));
  PetscCall(EqmRowsToLeaves(sf, width, slab, all));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscFunctionReturn(0);
}

static void AddField(Gathered *all, const char *name, PetscBool on_cells, PetscInt width, const PetscReal *values)
{
  all->fields[all->num_fields++] = (EqmField){name, on_cells, width, values};
}

/* A field of one real per cell or vertex. */
static PetscErrorCode GatherField(EqmMap map, const char *name, PetscBool on_cells, const PetscReal *slab,
                                  Gathered *all)
{
  const EqmSoup soup = map->soup;
  const PetscInt count = on_cells ? soup->cell_end - soup->cell_start : soup->vertex_end - soup->vertex_start;
  PetscReal **const values = &all->arrays[all->num_fields];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(on_cells ? all->mesh.num_cells : all->mesh.num_vertices, values));
  PetscCall(GatherReals(soup->comm, 1, count, slab, *values));
  AddField(all, name, on_cells, 1, *values);
  PetscFunctionReturn(0);
}

/* On rank 0: of the input's fields those that will not be mistaken for the map's; its texture coordinates where they
   are one field more (`texture`), since in OBJ and PLY they would be taken for the map. */
static void KeepFields(EqmSerialMesh *mesh, PetscBool texture)
{
  PetscInt kept = 0;

  for (PetscInt f = 0; f < mesh->num_fields; f++) {
    const EqmMeshField field = mesh->fields[f];
    if (EqmMeshFieldIsOfResult(field.name))
      (void)PetscFree(mesh->fields[f].values);
    else
      mesh->fields[kept++] = field;
  }
  mesh->num_fields = kept;
  if (!texture) (void)PetscFree(mesh->texture);
}

static PetscErrorCode Gather(EqmMap map, PetscBool texture, Gathered *all)
{
  const EqmSoup soup = map->soup;
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(all, sizeof(*all)));
  PetscCall(EqmSoupGather(soup, &all->mesh));
  KeepFields(&all->mesh, texture);
  n = all->mesh.num_vertices;
  PetscCall(PetscMalloc1(map->dim * n, &all->images));
  PetscCall(GatherReals(soup->comm, map->dim, soup->vertex_end - soup->vertex_start, map->coordinates, all->images));
  PetscCall(PetscCalloc1(3 * n, &all->points));
  PetscCall(GatherField(map, "ratio", PETSC_TRUE, map->cell_ratio, all));
  PetscCall(GatherField(map, "vertex_ratio", PETSC_FALSE, map->vertex_ratio, all));
  if (soup->cell_size == 4) PetscFunctionReturn(0);
  PetscCall(GatherField(map, "quasi_conformal", PETSC_TRUE, map->quasi_conformal, all));
  PetscCall(GatherField(map, "conformal_factor", PETSC_FALSE, map->conformal_factor, all));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(Gathered *all)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < MOST_FIELDS; k++) PetscCall(PetscFree(all->arrays[k]));
  PetscCall(PetscFree(all->images));
  PetscCall(PetscFree(all->points));
  PetscCall(EqmSerialMeshReset(&all->mesh));
  PetscFunctionReturn(0);
}

/* On rank 0: the positions of the vertices go into `points`, their images into the mesh. */
static void MoveVertices(PetscInt dim, PetscReal scale, Gathered *all)
{
  for (PetscInt i = 0; i < all->mesh.num_vertices; i++) {
    for (PetscInt d = 0; d < 3; d++) {
      all->points[3 * i + d] = all->mesh.vertices[3 * i + d];
      all->mesh.vertices[3 * i + d] = d < dim ? scale * all->images[dim * i + d] : 0.;
    }
  }
}

/* On rank 0: the map as fields of the mesh, u and v in the plane. */
static PetscErrorCode AddImages(PetscInt dim, Gathered *all)
{
  static const char *const names[] = {"u", "v"};
  const PetscInt n = all->mesh.num_vertices;

  PetscFunctionBegin;
  if (dim == 3) AddField(all, "map", PETSC_FALSE, 3, all->images);
  for (PetscInt d = 0; d < dim && dim == 2; d++) {
    PetscReal **const values = &all->arrays[all->num_fields];
    PetscCall(PetscMalloc1(n, values));
    for (PetscInt i = 0; i < n; i++) (*values)[i] = all->images[2 * i + d];
    AddField(all, names[d], PETSC_FALSE, 1, *values);
  }
  PetscFunctionReturn(0);
}

/* On rank 0. Both files, or EQM_ERR_IO with a sentence in `message`. */
static PetscErrorCode WriteFiles(EqmMap map, const char *file, Gathered *all, char *message, size_t length,
                                 PetscErrorCode *error)
{
  const PetscInt num_fields = all->num_fields;
  char name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  if (EqmHasSuffix(file, ".vtu")) {
    PetscCall(AddImages(map->dim, all));
    PetscCall(PetscSNPrintf(name, sizeof(name), "%.*s.surface.vtu", (int)(strlen(file) - strlen(".vtu")), file));
    *error = EqmFormatWriteSerial(name, &all->mesh, all->fields, all->num_fields, message, length);
    if (*error) PetscFunctionReturn(0);
    all->num_fields = num_fields;
  }
  MoveVertices(map->dim, map->image_scale, all);
  if (EqmHasSuffix(file, ".vtu") || EqmHasSuffix(file, ".vtk")) AddField(all, "surface", PETSC_FALSE, 3, all->points);
  *error = EqmFormatWriteSerial(file, &all->mesh, all->fields, all->num_fields, message, length);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapSetImageScale(EqmMap map, PetscReal scale)
{
  PetscFunctionBegin;
  if (!(scale > 0.) || PetscIsInfOrNanReal(scale))
    EqmFail(map->soup->comm, EQM_ERR_USAGE, "-radius %.6g: give a positive number", (double)scale);
  map->image_scale = scale;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapWriteImage(EqmMap map, const char *file)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error = 0;
  PetscMPIInt rank;
  Gathered all;

  const EqmFormat *const format = EqmFormatOfSuffix(file);

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(map->soup->comm, &rank));
  PetscCall(Gather(map, (PetscBool)(format && !format->writes_texture), &all));
  if (rank == 0) PetscCall(WriteFiles(map, file, &all, message, sizeof(message), &error));
  PetscCall(Reset(&all));
  PetscCall(EqmAgree(map->soup->comm, error, message));
  PetscFunctionReturn(0);
}
