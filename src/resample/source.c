/* The mesh and the map that are resampled, and the places of a mesh that takes its connectivity from elsewhere. */
#include "resample/resample.h"
#include "format/image.h"
#include "h5/h5.h"
#include "mesh/mesh_private.h"
#include "register/closest.h"
#include "store/map_private.h"
#include "store/store.h"
#include <string.h>

/* The prepared mesh of a result, with its map. */
static PetscErrorCode ReadPrepared(EqmH5 h5, PetscInt cell_size, const char *file, EqmSoup *soup, PetscInt **parent,
                                   PetscInt *dim, PetscReal **coordinates)
{
  PetscInt64 rows, width, num_cells, *numbers;
  EqmSlab slab = {0}, cells = {.width = cell_size};
  PetscInt end, *corner;
  PetscReal *vertices;

  PetscFunctionBegin;
  PetscCall(EqmH5GetShape(h5, "/repaired/parent", &num_cells, &width));
  PetscCall(EqmH5GetShape(h5, "/repaired/coordinates", &rows, &width));
  *dim = slab.width = (PetscInt)width;
  slab.total = (PetscInt)rows;
  cells.total = (PetscInt)num_cells;
  slab.count = cells.count = PETSC_DECIDE;
  PetscCall(PetscSplitOwnership(h5->comm, &slab.count, &slab.total));
  PetscCall(PetscSplitOwnership(h5->comm, &cells.count, &cells.total));
  PetscCallMPI(MPI_Scan(&slab.count, &end, 1, MPIU_INT, MPI_SUM, h5->comm));
  slab.start = end - slab.count;
  PetscCallMPI(MPI_Scan(&cells.count, &end, 1, MPIU_INT, MPI_SUM, h5->comm));
  cells.start = end - cells.count;
  PetscCall(PetscMalloc1(slab.width * slab.count + 1, coordinates));
  PetscCall(PetscMalloc1(3 * slab.count + 1, &vertices));
  PetscCall(PetscMalloc1(cell_size * cells.count + 1, &corner));
  PetscCall(PetscMalloc1(cells.count + 1, parent));
  PetscCall(PetscMalloc1(cell_size * cells.count + 1, &numbers));
  PetscCall(EqmH5ReadReals(h5, "/repaired/coordinates", slab, *coordinates));
  slab.width = 3;
  PetscCall(EqmH5ReadReals(h5, "/repaired/vertices", slab, vertices));
  PetscCall(EqmH5ReadIntegers(h5, "/repaired/cells", cells, numbers));
  for (PetscInt k = 0; k < cell_size * cells.count; k++) corner[k] = (PetscInt)numbers[k];
  cells.width = 0;
  PetscCall(EqmH5ReadIntegers(h5, "/repaired/parent", cells, numbers));
  for (PetscInt k = 0; k < cells.count; k++) (*parent)[k] = (PetscInt)numbers[k];
  PetscCall(PetscFree(numbers));
  PetscCall(EqmSoupCreateFromSlabs(h5->comm, cell_size, slab.count, vertices, cells.count, corner, file, soup));
  PetscFunctionReturn(0);
}

/* Mesh and coordinates of a result: of the prepared mesh, where there is one. */
static PetscErrorCode ReadResult(const char *file, EqmResampleSource *source, PetscReal **coordinates)
{
  PetscBool has_map = PETSC_FALSE, is_prepared = PETSC_FALSE;
  EqmH5 h5;

  PetscFunctionBegin;
  if (EqmHasSuffix(file, ".h5")) {
    PetscCall(EqmH5Open(source->given->comm, file, &h5));
    PetscCall(EqmCheckResultVersion(h5));
    PetscCall(EqmH5HasDataset(h5, "/map/coordinates", &has_map));
    PetscCall(EqmH5HasDataset(h5, "/repaired/coordinates", &is_prepared));
    if (has_map && is_prepared) {
      PetscCall(ReadPrepared(h5, source->given->cell_size, file, &source->mapped, &source->parent, &source->dim,
                             coordinates));
    }
    PetscCall(EqmH5Close(&h5));
  }
  if (!has_map)
    EqmFail(source->given->comm, EQM_ERR_USAGE,
            "%s is no result of a map; give one (equimap disk MESH -o map.h5), or a mesh and a map: equimap resample "
            "MESH MAP",
            file);
  PetscFunctionReturn(0);
}

/* The coordinates of a map that any program made. */
static PetscErrorCode ReadMap(EqmSoup soup, const char *file, PetscInt *dim, PetscReal **coordinates)
{
  PetscReal *values;
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(EqmMapRead(soup, file, &map));
  PetscCall(EqmMapGetDimension(map, dim));
  PetscCall(EqmMapGetCoordinates(map, &values));
  PetscCall(PetscMalloc1(*dim * (soup->vertex_end - soup->vertex_start) + 1, coordinates));
  PetscCall(PetscArraycpy(*coordinates, values, *dim * (soup->vertex_end - soup->vertex_start)));
  PetscCall(EqmMapDestroy(&map));
  PetscFunctionReturn(0);
}

/* Only what some command takes has a map that can be inverted. */
static PetscErrorCode CheckTopology(EqmSoup soup)
{
  EqmDiagnosis diagnosis;

  PetscFunctionBegin;
  PetscCall(EqmSoupDiagnose(soup, &diagnosis));
  if (diagnosis.topology == EQM_TOPOLOGY_OTHER)
    EqmFail(soup->comm, EQM_ERR_MESH,
            "%s is neither disk, sphere nor ball: no map of it can be resampled; see equimap check", soup->file);
  PetscFunctionReturn(0);
}

/* Into the unit target; `shape` is what the image fills. */
static PetscErrorCode ToTarget(EqmMesh mesh, PetscInt dim, const char *file, EqmDomainShape *shape, PetscReal *x)
{
  EqmImagePlacement placement;

  PetscFunctionBegin;
  PetscCall(EqmImageRecognise(mesh, dim, x, &placement));
  *shape = placement.shape;
  if (!EqmDomainShapeTarget(*shape))
    EqmFail(mesh->comm, EQM_ERR_USAGE,
            "%s: its image fills no target (it is %s); wanted is a map to the disk, the square, the sphere, the ball "
            "or the "
            "cube",
            file, EqmDomainShapeName(*shape));
  EqmImageToUnit(mesh, dim, &placement, x);
  PetscFunctionReturn(0);
}

/* Reflect an image whose cells are turned over for the most part, so that the new cells turn as the old ones: two
   coordinates change places, which keeps every target where it is. Count the folds. */
static PetscErrorCode TurnOver(EqmResampleSource *source)
{
  PetscInt64 count[2] = {0, 0}; /* turned; not turned */

  PetscFunctionBegin;
  for (PetscInt c = 0; c < source->mesh->num_owned_cells; c++) {
    const PetscInt cs = source->mesh->cell_size, *const v = source->mesh->cells + cs * c;
    const PetscReal *corner[4];

    for (PetscInt a = 0; a < cs; a++) corner[a] = source->x + source->dim * v[a];
    count[EqmSignedMeasure(source->kind, cs, corner) > 0.]++;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 2, MPIU_INT64, MPI_SUM, source->mesh->comm));
  source->folds = PetscMin(count[0], count[1]);
  for (PetscInt v = 0; v < source->mesh->num_local && count[0] > count[1]; v++) {
    PetscReal *const x = source->x + source->dim * v, first = x[0];
    x[0] = x[1];
    x[1] = first;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmResampleSourceRead(MPI_Comm comm, const char *file, const char *map_file, EqmLedger ledger,
                                     EqmResampleSource *source)
{
  PetscReal *coordinates = NULL;
  EqmDomainShape shape;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(source, sizeof(*source)));
  PetscCall(EqmSoupRead(comm, file, &source->given));
  if (!map_file) PetscCall(ReadResult(file, source, &coordinates));
  if (!source->mapped) source->mapped = source->given;
  if (!coordinates) PetscCall(ReadMap(source->given, map_file ? map_file : file, &source->dim, &coordinates));
  PetscCall(CheckTopology(source->mapped));
  PetscCall(EqmMeshCreate(source->mapped, ledger, &source->mesh));
  PetscCall(PetscMalloc1(source->dim * source->mesh->num_local, &source->x));
  PetscCall(EqmMeshVerticesFromInput(source->mesh, source->mapped, source->dim, coordinates, source->x));
  PetscCall(PetscFree(coordinates));
  PetscCall(ToTarget(source->mesh, source->dim, map_file ? map_file : file, &shape, source->x));
  source->target = EqmDomainShapeTarget(shape);
  source->kind = shape == EQM_FILLS_SPHERE      ? EQM_IMAGE_SPHERE
                 : source->mesh->cell_size == 4 ? EQM_IMAGE_SPACE
                                                : EQM_IMAGE_PLANE;
  PetscCall(TurnOver(source));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmResampleSourceReset(EqmResampleSource *source)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(source->x));
  PetscCall(EqmMeshDestroy(&source->mesh));
  if (source->mapped != source->given) PetscCall(EqmSoupDestroy(&source->mapped));
  PetscCall(EqmSoupDestroy(&source->given));
  PetscCall(PetscFree(source->parent));
  PetscFunctionReturn(0);
}

/* ---- another mesh in the target */

/* Its images: of a result the map, of any other file its texture coordinates or vertices. */
static PetscErrorCode ReadImages(EqmSoup soup, const char *file, PetscInt *dim, PetscReal **coordinates)
{
  const PetscInt count = soup->vertex_end - soup->vertex_start;
  PetscBool has_map = PETSC_FALSE;
  EqmImage image;
  EqmH5 h5;

  PetscFunctionBegin;
  if (EqmHasSuffix(file, ".h5")) {
    PetscCall(EqmH5Open(soup->comm, file, &h5));
    PetscCall(EqmH5HasDataset(h5, "/map/coordinates", &has_map));
    PetscCall(EqmH5Close(&h5));
  }
  if (has_map) {
    PetscCall(ReadMap(soup, file, dim, coordinates));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmImageRead(soup, file, EQM_IMAGE_AUTO, &image));
  if (image.num_copies)
    EqmFail(soup->comm, EQM_ERR_USAGE, "-onto %s: its texture coordinates have seams, its vertices several places",
            file);
  *dim = image.dim;
  PetscCall(PetscMalloc1(*dim * count + 1, coordinates));
  PetscCall(PetscArraycpy(*coordinates, image.coordinates, *dim * count));
  PetscCall(EqmImageReset(&image));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmResamplePlaces(const EqmResampleSource *source, const char *file, EqmLedger ledger, EqmSoup *soup,
                                 PetscReal **place)
{
  EqmDomainShape shape = EQM_FILLS_SPACE;
  PetscReal *x;
  PetscInt dim;
  EqmMesh mesh;

  PetscFunctionBegin;
  PetscCall(EqmSoupRead(source->given->comm, file, soup));
  PetscCall(CheckTopology(*soup));
  PetscCall(ReadImages(*soup, file, &dim, place));
  PetscCall(EqmMeshCreate(*soup, ledger, &mesh));
  PetscCall(PetscMalloc1(dim * mesh->num_local, &x));
  PetscCall(EqmMeshVerticesFromInput(mesh, *soup, dim, *place, x));
  PetscCall(ToTarget(mesh, dim, file, &shape, x));
  if (strcmp(EqmDomainShapeTarget(shape), source->target) || dim != source->dim ||
      mesh->cell_size != source->mesh->cell_size)
    EqmFail((*soup)->comm, EQM_ERR_USAGE, "-onto %s: it lies in another target (%s) than the map of %s (%s)", file,
            EqmDomainShapeName(shape), source->given->file, source->target);
  PetscCall(EqmMeshVerticesToInput(mesh, *soup, dim, x, *place));
  PetscCall(PetscFree(x));
  PetscCall(EqmMeshDestroy(&mesh));
  PetscFunctionReturn(0);
}
