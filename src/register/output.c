/* What a registration adds to the result: locations, inverse map, figures. */
#include "register/registration.h"
#include "mesh/mesh_private.h"

/* Values per owned vertex to the slab of the input numbering, as an array of the result; `fallback` for vertices of no
   cell. */
static PetscErrorCode AddReals(EqmRegistration r, const EqmSide *side, const char *path, PetscInt width,
                               PetscReal fallback, const PetscReal *owned)
{
  const EqmSoup soup = side->soup;
  const PetscInt count = soup->vertex_end - soup->vertex_start;
  PetscReal *slab;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(width * count, &slab));
  for (PetscInt k = 0; k < width * count; k++) slab[k] = fallback;
  PetscCall(EqmVerticesToOrigin(side->origin, width, owned, slab));
  PetscCall(EqmMapAddReals(r->map, path, soup->num_vertices, soup->vertex_start, count, width == 1 ? 0 : width, slab));
  PetscFunctionReturn(0);
}

/* Numbers of cells, sent as reals, which represent them exactly. */
static PetscErrorCode AddCells(EqmRegistration r, const EqmSide *side, const char *path, const PetscInt *owned)
{
  const EqmSoup soup = side->soup;
  const PetscInt count = soup->vertex_end - soup->vertex_start;
  PetscReal *numbers, *slab;
  PetscInt64 *cells;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(side->mesh->num_owned, &numbers, count, &slab));
  PetscCall(PetscMalloc1(count, &cells));
  for (PetscInt v = 0; v < side->mesh->num_owned; v++) numbers[v] = owned[v];
  for (PetscInt k = 0; k < count; k++) slab[k] = -1.;
  PetscCall(EqmVerticesToOrigin(side->origin, 1, numbers, slab));
  for (PetscInt k = 0; k < count; k++) cells[k] = (PetscInt64)slab[k];
  PetscCall(PetscFree2(numbers, slab));
  PetscCall(EqmMapAddIntegers(r->map, path, soup->num_vertices, soup->vertex_start, count, 0, cells));
  PetscFunctionReturn(0);
}

/* Cell, barycentric coordinates and distance of every vertex's point on the other mesh, under /GROUP. */
static PetscErrorCode AddLocation(EqmRegistration r, const EqmSide *side, const EqmSide *other, const char *group,
                                  EqmLocation location)
{
  PetscInt *cell;
  PetscReal *barycentric;
  char path[64];

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(location->num, &cell, location->cell_size * location->num, &barycentric));
  PetscCall(EqmLocationInOrigin(other->origin, location, cell, barycentric));
  PetscCall(PetscSNPrintf(path, sizeof(path), "/%s/cell", group));
  PetscCall(AddCells(r, side, path, cell));
  PetscCall(PetscSNPrintf(path, sizeof(path), "/%s/barycentric", group));
  PetscCall(AddReals(r, side, path, location->cell_size, 0., barycentric));
  PetscCall(PetscSNPrintf(path, sizeof(path), "/%s/distance", group));
  PetscCall(AddReals(r, side, path, 1, 0., location->distance));
  PetscCall(PetscFree2(cell, barycentric));
  PetscFunctionReturn(0);
}

static PetscErrorCode AddLandmarkFigures(EqmRegistration r)
{
  const EqmRegisterFigures *const f = &r->figures;

  PetscFunctionBegin;
  PetscCall(EqmMapAddCount(r->map, "register.landmarks.count", r->landmarks.num));
  if (!r->landmarks.num) PetscFunctionReturn(0);
  PetscCall(EqmMapAddFigure(r->map, "register.landmarks.error.mean", f->landmark_mean));
  PetscCall(EqmMapAddFigure(r->map, "register.landmarks.error.max", f->landmark_max));
  if (r->kind != EQM_IMAGE_SPACE) PetscCall(EqmMapAddFigure(r->map, "register.h.energy", f->own_energy));
  if (!f->landmarks_in_space) PetscFunctionReturn(0);
  PetscCall(EqmMapAddFigure(r->map, "register.landmarks.space_error.mean", f->landmark_space_mean));
  PetscCall(EqmMapAddFigure(r->map, "register.landmarks.space_error.max", f->landmark_space_max));
  PetscFunctionReturn(0);
}

static PetscErrorCode AddOfLandmarks(EqmRegistration r, const char *path, PetscInt width, const PetscReal *values)
{
  PetscReal *copy;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(r->comm, &rank));
  const PetscInt count = rank == 0 ? r->landmarks.num : 0, each = PetscMax(width, 1);
  PetscCall(PetscMalloc1(each * count, &copy));
  PetscCall(PetscArraycpy(copy, values, each * count));
  PetscCall(EqmMapAddReals(r->map, path, r->landmarks.num, 0, count, width, copy));
  PetscFunctionReturn(0);
}

static PetscErrorCode AddNumbersOfLandmarks(EqmRegistration r, const char *path, const PetscInt *values)
{
  PetscInt64 *copy;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(r->comm, &rank));
  const PetscInt count = rank == 0 ? r->landmarks.num : 0;
  PetscCall(PetscMalloc1(count, &copy));
  for (PetscInt k = 0; k < count; k++) copy[k] = values[k];
  PetscCall(EqmMapAddIntegers(r->map, path, r->landmarks.num, 0, count, 0, copy));
  PetscFunctionReturn(0);
}

/* The landmarks as their file lists them: vertices of A, and vertices of B or points; and their goals in the target.
   Rank 0 has them. */
static PetscErrorCode AddLandmarks(EqmRegistration r)
{
  const EqmLandmarkList *const list = &r->landmarks;
  PetscInt *other;

  PetscFunctionBegin;
  PetscCall(AddNumbersOfLandmarks(r, "/register/landmarks/vertex", list->vertex));
  if (list->width == 1) {
    PetscCall(PetscMalloc1(list->num, &other));
    for (PetscInt k = 0; k < list->num; k++) other[k] = (PetscInt)list->other[k];
    PetscCall(AddNumbersOfLandmarks(r, "/register/landmarks/vertex_b", other));
    PetscCall(PetscFree(other));
  } else {
    PetscCall(AddOfLandmarks(r, "/register/landmarks/point", list->width, list->other));
  }
  PetscCall(AddOfLandmarks(r, "/register/landmarks/goal", r->dim, r->goal));
  if (list->has_weights) PetscCall(AddOfLandmarks(r, "/register/landmarks/weight", 0, list->weight));
  if (list->has_curves) PetscCall(AddNumbersOfLandmarks(r, "/register/landmarks/curve", list->curve));
  PetscFunctionReturn(0);
}

static PetscErrorCode AddClamped(EqmRegistration r, const char *name, EqmLocation location)
{
  char key[64];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(key, sizeof(key), "register.clamped.%s.count", name));
  PetscCall(EqmMapAddCount(r->map, key, location->num_clamped));
  PetscCall(PetscSNPrintf(key, sizeof(key), "register.clamped.%s.most", name));
  PetscCall(EqmMapAddFigure(r->map, key, location->most_distant));
  PetscFunctionReturn(0);
}

/* B as it was given: /register/cell names its cells. */
static PetscErrorCode AddMeshOfB(EqmRegistration r)
{
  const EqmSoup soup = r->b.soup;
  const PetscInt num_vertices = soup->vertex_end - soup->vertex_start, num_cells = soup->cell_end - soup->cell_start;
  PetscReal *vertices;
  PetscInt64 *cells;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * num_vertices, &vertices));
  PetscCall(PetscArraycpy(vertices, soup->vertices, 3 * num_vertices));
  PetscCall(
      EqmMapAddReals(r->map, "/mesh_b/vertices", soup->num_vertices, soup->vertex_start, num_vertices, 3, vertices));
  PetscCall(PetscMalloc1(soup->cell_size * num_cells, &cells));
  for (PetscInt k = 0; k < soup->cell_size * num_cells; k++) cells[k] = soup->cells[k];
  PetscCall(
      EqmMapAddIntegers(r->map, "/mesh_b/cells", soup->num_cells, soup->cell_start, num_cells, soup->cell_size, cells));
  PetscFunctionReturn(0);
}

/* Figures of B, and the dissimilarity. */
static PetscErrorCode AddFiguresOfB(EqmRegistration r)
{
  const EqmRegisterFigures *const f = &r->figures;

  PetscFunctionBegin;
  PetscCall(EqmMapAddText(r->map, "register.b.file", r->b.soup->file));
  PetscCall(EqmMapAddCount(r->map, "register.b.vertices", r->b.soup->num_vertices));
  PetscCall(EqmMapAddCount(r->map, "register.b.cells", r->b.soup->num_cells));
  PetscCall(EqmMapAddFigure(r->map, "register.b.measure", r->b.map->distortion.mesh_measure));
  PetscCall(EqmMapAddFigure(r->map, "register.b.energy", f->energy_b));
  PetscCall(EqmMapAddCount(r->map, "register.b.folds", f->folds_b));
  if (r->kind == EQM_IMAGE_SPACE) PetscCall(EqmMapAddCount(r->map, "register.folds", f->folds_phi));
  PetscCall(EqmMapAddFigure(r->map, "register.dissimilarity", f->dissimilarity));
  PetscCall(EqmMapAddFigure(r->map, "register.dissimilarity_rigid", f->dissimilarity_rigid));
  PetscCall(AddClamped(r, "forward", r->forward));
  PetscCall(AddClamped(r, "inverse", r->inverse));
  PetscFunctionReturn(0);
}

/* Everything but the map itself, for the result file and the summary. Collective. */
PetscErrorCode EqmAddToResult(EqmRegistration r)
{
  PetscFunctionBegin;
  PetscCall(EqmMapAddText(r->map, "register.target", r->target));
  PetscCall(AddLandmarkFigures(r));
  if (r->landmarks.num) PetscCall(AddLandmarks(r));
  PetscCall(AddReals(r, &r->a, "/register/target", r->dim, 0., r->a.x));
  if (r->bare) PetscFunctionReturn(0);
  PetscCall(AddFiguresOfB(r));
  PetscCall(AddMeshOfB(r));
  PetscCall(AddLocation(r, &r->a, &r->b, "register", r->forward));
  PetscCall(AddReals(r, &r->b, "/inverse/coordinates", 3, 0., r->inverse_image));
  PetscCall(AddReals(r, &r->b, "/inverse/target", r->dim, 0., r->b.x));
  PetscCall(AddLocation(r, &r->b, &r->a, "inverse", r->inverse));
  PetscFunctionReturn(0);
}
