/* Maps: made, freed, read from a file. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "store/store.h"
#include "format/image.h"
#include "h5/h5.h"
#include <string.h>

PetscErrorCode EqmMapCreate(EqmSoup soup, PetscInt dim, EqmMap *map)
{
  const PetscInt num_vertices = soup->vertex_end - soup->vertex_start;
  const PetscInt num_cells = soup->cell_end - soup->cell_start;
  PetscMPIInt size;
  EqmMap new_map;

  PetscFunctionBegin;
  PetscCheck(dim == 2 || dim == 3, soup->comm, PETSC_ERR_ARG_OUTOFRANGE,
             "a map has 2 or 3 coordinates, not %" PetscInt_FMT, dim);
  PetscCall(PetscNew(&new_map));
  new_map->soup = soup;
  new_map->dim = dim;
  new_map->image_scale = 1.;
  PetscCall(PetscCalloc1(dim * num_vertices, &new_map->coordinates));
  PetscCall(PetscCalloc1(num_cells, &new_map->cell_ratio));
  PetscCall(PetscCalloc1(num_vertices, &new_map->vertex_ratio));
  if (soup->cell_size == 3) {
    PetscCall(PetscCalloc1(num_cells, &new_map->quasi_conformal));
    PetscCall(PetscCalloc1(num_vertices, &new_map->conformal_factor));
  }
  PetscCallMPI(MPI_Comm_size(soup->comm, &size));
  new_map->cost.ranks = size;
  new_map->cost.threads = 1;
  *map = new_map;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapDestroy(EqmMap *map)
{
  PetscFunctionBegin;
  if (!*map) PetscFunctionReturn(0);
  PetscCall(PetscFree((*map)->coordinates));
  PetscCall(PetscFree((*map)->cell_ratio));
  PetscCall(PetscFree((*map)->vertex_ratio));
  PetscCall(PetscFree((*map)->quasi_conformal));
  PetscCall(PetscFree((*map)->conformal_factor));
  PetscCall(PetscFree((*map)->history));
  PetscCall(PetscFree((*map)->hessian_eigenvalues));
  PetscCall(EqmMapResetExtras(*map));
  PetscCall(PetscFree(*map));
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckCount(EqmSoup soup, PetscInt64 count, const char *file)
{
  PetscFunctionBegin;
  if (count != soup->num_vertices) {
    EqmFail(soup->comm, EQM_ERR_MESH,
            "'%s' has %" PetscInt64_FMT " vertices, but the mesh '%s' has %" PetscInt_FMT
            ": they do not belong together",
            file, count, soup->file, soup->num_vertices);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCheckResultVersion(EqmH5 h5)
{
  PetscInt64 version;

  PetscFunctionBegin;
  PetscCall(EqmH5GetInteger(h5, "format_version", 1, &version));
  if (version > EQM_RESULT_VERSION) {
    EqmFail(h5->comm, EQM_ERR_IO,
            "cannot read '%s': its layout is of version %" PetscInt64_FMT
            ", this equimap (%s) knows them up to version %d; use a newer one",
            h5->name, version, EqmVersion(), EQM_RESULT_VERSION);
  }
  PetscFunctionReturn(0);
}

/* The shape of /map/coordinates in an open result file. */
static PetscErrorCode CheckResult(EqmH5 h5, EqmSoup soup, PetscInt64 *dim)
{
  PetscInt64 complete, count;
  PetscBool has;

  PetscFunctionBegin;
  PetscCall(EqmH5HasDataset(h5, "/map/coordinates", &has));
  if (!has)
    EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': it holds no /map/coordinates, so it is not a result", h5->name);
  PetscCall(EqmH5GetInteger(h5, "complete", 1, &complete)); /* a map made elsewhere has no such mark */
  if (!complete) EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': it was not written to its end", h5->name);
  PetscCall(EqmCheckResultVersion(h5));
  PetscCall(EqmH5GetShape(h5, "/map/coordinates", &count, dim));
  if (*dim != 2 && *dim != 3) {
    EqmFail(h5->comm, EQM_ERR_IO,
            "cannot read '%s': /map/coordinates has %" PetscInt64_FMT " columns instead of 2 or 3", h5->name, *dim);
  }
  PetscCall(CheckCount(soup, count, h5->name));
  PetscFunctionReturn(0);
}

static PetscErrorCode FillFromResult(EqmH5 h5, EqmSoup soup, EqmMap *map)
{
  EqmSlab slab = {soup->num_vertices, soup->vertex_start, soup->vertex_end - soup->vertex_start, 0};
  PetscInt64 dim;

  PetscFunctionBegin;
  PetscCall(CheckResult(h5, soup, &dim));
  PetscCall(EqmMapCreate(soup, (PetscInt)dim, map));
  slab.width = (PetscInt)dim;
  PetscCall(EqmH5ReadReals(h5, "/map/coordinates", slab, (*map)->coordinates));
  PetscCall(EqmH5GetText(h5, "command", "", (*map)->command, sizeof((*map)->command)));
  PetscCall(EqmH5GetText(h5, "method", "", (*map)->method, sizeof((*map)->method)));
  PetscCall(EqmH5GetText(h5, "linear_solver", "", (*map)->linear_solver, sizeof((*map)->linear_solver)));
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadResult(EqmSoup soup, const char *file, EqmMap *map)
{
  PetscErrorCode error;
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(EqmH5Open(soup->comm, file, &h5));
  error = FillFromResult(h5, soup, map);
  PetscCall(EqmH5Close(&h5));
  PetscCall(error);
  PetscFunctionReturn(0);
}

static PetscErrorCode FillFromImage(EqmSoup soup, const EqmImage *image, const char *file, EqmMap *map)
{
  PetscFunctionBegin;
  if (image->num_copies) {
    EqmFail(soup->comm, EQM_ERR_MESH,
            "the texture coordinates of '%s' have seams, %" PetscInt_FMT
            " vertices have several images: as a map it can be measured only",
            file, image->num_copies);
  }
  PetscCall(EqmMapCreate(soup, image->dim, map));
  PetscCall(
      PetscArraycpy((*map)->coordinates, image->coordinates, image->dim * (soup->vertex_end - soup->vertex_start)));
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadImage(EqmSoup soup, const char *file, EqmMap *map)
{
  PetscErrorCode error;
  EqmImage image;

  PetscFunctionBegin;
  PetscCall(EqmImageRead(soup, file, EQM_IMAGE_AUTO, &image));
  error = FillFromImage(soup, &image, file, map);
  PetscCall(EqmImageReset(&image));
  PetscCall(error);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapRead(EqmSoup soup, const char *file, EqmMap *map)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  *map = NULL;
  error = EqmHasSuffix(file, ".h5") ? ReadResult(soup, file, map) : ReadImage(soup, file, map);
  if (error && *map) PetscCall(EqmMapDestroy(map));
  PetscCall(error);
  PetscFunctionReturn(0);
}
