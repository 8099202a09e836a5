/* The result file: the map, the mesh, the distortion, the history and where it all came from, in HDF5. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "store/store.h"
#include "format/hdf5.h"
#include "h5/h5.h"
#include <stddef.h>

static EqmSlab VertexSlab(EqmSoup soup, PetscInt width)
{
  const EqmSlab slab = {soup->num_vertices, soup->vertex_start, soup->vertex_end - soup->vertex_start, width};
  return slab;
}

static EqmSlab CellSlab(EqmSoup soup, PetscInt width)
{
  const EqmSlab slab = {soup->num_cells, soup->cell_start, soup->cell_end - soup->cell_start, width};
  return slab;
}

/* The Hessian's eigenvalues are the same everywhere: rank 0 writes them. */
static EqmSlab HessianSlab(EqmMap map, PetscMPIInt rank)
{
  const EqmSlab slab = {map->num_hessian_eigenvalues, 0, rank == 0 ? map->num_hessian_eigenvalues : 0, 0};
  return slab;
}

static const struct {
  const char *path;
  size_t offset;
} map_reals[] = {{"energy_initial", offsetof(struct _p_EqmMap, energy_initial)},
                 {"energy_final", offsetof(struct _p_EqmMap, energy_final)},
                 {"mesh_measure", offsetof(struct _p_EqmMap, distortion.mesh_measure)},
                 {"image_measure", offsetof(struct _p_EqmMap, distortion.image_measure)},
                 {"ratio_sd", offsetof(struct _p_EqmMap, distortion.ratio.sd)},
                 {"ratio_mean", offsetof(struct _p_EqmMap, distortion.ratio.mean)},
                 {"ratio_min", offsetof(struct _p_EqmMap, distortion.ratio.min)},
                 {"ratio_max", offsetof(struct _p_EqmMap, distortion.ratio.max)},
                 {"ratio_error_mean", offsetof(struct _p_EqmMap, distortion.ratio_error.mean)},
                 {"ratio_weighted_sd", offsetof(struct _p_EqmMap, distortion.weighted_ratio.sd)},
                 {"ratio_weighted_p05", offsetof(struct _p_EqmMap, distortion.weighted_ratio.p05)},
                 {"ratio_weighted_p25", offsetof(struct _p_EqmMap, distortion.weighted_ratio.p25)},
                 {"ratio_weighted_p50", offsetof(struct _p_EqmMap, distortion.weighted_ratio.p50)},
                 {"ratio_weighted_p75", offsetof(struct _p_EqmMap, distortion.weighted_ratio.p75)},
                 {"ratio_weighted_p95", offsetof(struct _p_EqmMap, distortion.weighted_ratio.p95)},
                 {"ratio_outlier_share", offsetof(struct _p_EqmMap, distortion.weighted_ratio.outlier_share)},
                 {"seconds_total", offsetof(struct _p_EqmMap, cost.total_seconds)}},
  angle_reals[] = {{"angle_error_mean", offsetof(struct _p_EqmMap, distortion.angle_error.mean)},
                   {"angle_error_median", offsetof(struct _p_EqmMap, distortion.angle_error.p50)},
                   {"angle_error_max", offsetof(struct _p_EqmMap, distortion.angle_error.max)},
                   {"angle_error_sd", offsetof(struct _p_EqmMap, distortion.angle_error.sd)},
                   {"quasiconformal_mean", offsetof(struct _p_EqmMap, distortion.quasiconformal.mean)},
                   {"quasiconformal_median", offsetof(struct _p_EqmMap, distortion.quasiconformal.p50)},
                   {"quasiconformal_max", offsetof(struct _p_EqmMap, distortion.quasiconformal.max)}};
#define LENGTH(table) ((int)(sizeof(table) / sizeof((table)[0])))

/* And the histogram; `edges` has one entry more. */
static EqmSlab HistogramSlab(PetscMPIInt rank, PetscInt length)
{
  const EqmSlab slab = {length, 0, rank == 0 ? length : 0, 0};
  return slab;
}

/* What is known of surfaces only: angles. */
static PetscErrorCode DeclareAngles(EqmH5 h5, EqmSoup soup)
{
  PetscFunctionBegin;
  PetscCall(EqmH5DeclareReals(h5, "/cell/quasi_conformal", soup->num_cells, 0));
  PetscCall(EqmH5DeclareReals(h5, "/vertex/conformal_factor", soup->num_vertices, 0));
  PetscCall(EqmH5DeclareReals(h5, "/histogram/angle_error_edges", EQM_NUM_ANGLE_BINS + 1, 0));
  PetscCall(EqmH5DeclareIntegers(h5, "/histogram/angle_error", EQM_NUM_ANGLE_BINS, 0));
  PetscFunctionReturn(0);
}

static PetscErrorCode WriteAngles(EqmH5 h5, EqmMap map)
{
  PetscReal edges[EQM_NUM_ANGLE_BINS + 1];

  PetscFunctionBegin;
  for (PetscInt k = 0; k <= EQM_NUM_ANGLE_BINS; k++) edges[k] = k * 180. / EQM_NUM_ANGLE_BINS;
  PetscCall(EqmH5WriteReals(h5, "/cell/quasi_conformal", CellSlab(map->soup, 0), map->quasi_conformal));
  PetscCall(EqmH5WriteReals(h5, "/vertex/conformal_factor", VertexSlab(map->soup, 0), map->conformal_factor));
  PetscCall(
      EqmH5WriteReals(h5, "/histogram/angle_error_edges", HistogramSlab(h5->rank, EQM_NUM_ANGLE_BINS + 1), edges));
  PetscCall(EqmH5WriteIntegers(h5, "/histogram/angle_error", HistogramSlab(h5->rank, EQM_NUM_ANGLE_BINS),
                               map->distortion.angle_histogram));
  PetscFunctionReturn(0);
}

/* The repaired mesh and its map, so that nothing is lost. */
static PetscErrorCode DeclareRepaired(EqmH5 h5, EqmMap repaired)
{
  EqmSoup soup = repaired->soup;

  PetscFunctionBegin;
  PetscCall(EqmH5DeclareReals(h5, "/repaired/coordinates", soup->num_vertices, repaired->dim));
  PetscCall(EqmH5DeclareReals(h5, "/repaired/vertices", soup->num_vertices, 3));
  PetscCall(EqmH5DeclareIntegers(h5, "/repaired/cells", soup->num_cells, soup->cell_size));
  PetscCall(EqmH5DeclareIntegers(h5, "/repaired/parent", soup->num_cells, 0));
  PetscFunctionReturn(0);
}

static PetscErrorCode DeclareArrays(EqmH5 h5, EqmMap map)
{
  EqmSoup soup = map->soup;

  PetscFunctionBegin;
  PetscCall(EqmH5DeclareReals(h5, "/map/coordinates", soup->num_vertices, map->dim));
  PetscCall(EqmH5DeclareReals(h5, "/mesh/vertices", soup->num_vertices, 3));
  PetscCall(EqmH5DeclareIntegers(h5, "/mesh/cells", soup->num_cells, soup->cell_size));
  PetscCall(EqmH5DeclareReals(h5, "/cell/ratio", soup->num_cells, 0));
  PetscCall(EqmH5DeclareReals(h5, "/vertex/ratio", soup->num_vertices, 0));
  if (soup->cell_size == 3) PetscCall(DeclareAngles(h5, soup));
  if (soup->density) PetscCall(EqmH5DeclareReals(h5, "/cell/density", soup->num_cells, 0));
  PetscCall(EqmSoupDeclareFieldsHdf5(h5, soup, PETSC_TRUE));
  PetscCall(EqmResultDeclareHistory(h5, map));
  if (map->num_hessian_eigenvalues)
    PetscCall(EqmH5DeclareReals(h5, "/map/hessian_eigenvalues", map->num_hessian_eigenvalues, 0));
  if (map->repaired) PetscCall(DeclareRepaired(h5, map->repaired));
  for (PetscInt k = 0; k < map->num_arrays; k++) {
    const EqmMapArray *const array = &map->arrays[k];
    if (array->is_real)
      PetscCall(EqmH5DeclareReals(h5, array->path, array->total, array->width));
    else
      PetscCall(EqmH5DeclareIntegers(h5, array->path, array->total, array->width));
  }
  PetscFunctionReturn(0);
}

/* Who made it, from what, how. */
static PetscErrorCode PutProvenance(EqmH5 h5, EqmMap map)
{
  PetscFunctionBegin;
  PetscCall(EqmH5PutProvenance(h5, map->soup->file, map->cost.ranks));
  PetscCall(EqmH5PutInteger(h5, "format_version", EQM_RESULT_VERSION));
  PetscCall(EqmH5PutText(h5, "command", map->command));
  PetscCall(EqmH5PutText(h5, "method", map->method));
  PetscCall(EqmH5PutText(h5, "linear_solver", map->linear_solver));
  PetscCall(EqmH5PutInteger(h5, "mesh_checksum", map->soup->checksum));
  PetscCall(EqmH5PutInteger(h5, "threads", map->cost.threads));
  PetscFunctionReturn(0);
}

static const PetscReal *RealAt(EqmMap map, size_t offset)
{
  return (const PetscReal *)((const char *)map + offset);
}

/* How it went. */
static PetscErrorCode PutOutcome(EqmH5 h5, EqmMap map)
{
  PetscFunctionBegin;
  PetscCall(EqmH5PutText(h5, "status", EqmStatusName(map->status)));
  PetscCall(EqmH5PutInteger(h5, "exit_code", (PetscInt64)map->status));
  PetscCall(EqmH5PutText(h5, "message", map->message));
  PetscCall(EqmH5PutInteger(h5, "iterations", map->iterations));
  PetscCall(EqmH5PutInteger(h5, "folds", map->distortion.folds));
  if (map->soup->cell_size == 4) PetscCall(EqmH5PutInteger(h5, "boundary_folds", map->boundary_folds));
  PetscCall(EqmH5PutInteger(h5, "ratio_outliers", map->distortion.weighted_ratio.outliers));
  for (int k = 0; k < LENGTH(map_reals); k++) {
    PetscCall(EqmH5PutReal(h5, map_reals[k].path, *RealAt(map, map_reals[k].offset)));
  }
  for (int k = 0; k < LENGTH(angle_reals) && map->soup->cell_size == 3; k++) {
    PetscCall(EqmH5PutReal(h5, angle_reals[k].path, *RealAt(map, angle_reals[k].offset)));
  }
  for (PetscInt k = 0; k < map->num_figures; k++) {
    const EqmMapFigure *const figure = &map->figures[k];
    if (figure->kind == EQM_FIGURE_TEXT) PetscCall(EqmH5PutText(h5, figure->key, figure->text));
    if (figure->kind == EQM_FIGURE_COUNT) PetscCall(EqmH5PutInteger(h5, figure->key, figure->count));
    if (figure->kind == EQM_FIGURE_REAL) PetscCall(EqmH5PutReal(h5, figure->key, figure->real));
  }
  PetscFunctionReturn(0);
}

/* The steps of the preparation in one text. */
static PetscErrorCode PutPrepared(EqmH5 h5, EqmMap map)
{
  char text[EQM_MESSAGE_MAX] = "";

  PetscFunctionBegin;
  for (PetscInt k = 0; k < map->num_prepared; k++) {
    PetscCall(PetscStrlcat(text, k ? "; " : "", sizeof(text)));
    PetscCall(PetscStrlcat(text, map->prepared[k].step, sizeof(text)));
    PetscCall(PetscStrlcat(text, ": ", sizeof(text)));
    PetscCall(PetscStrlcat(text, map->prepared[k].what, sizeof(text)));
  }
  PetscCall(EqmH5PutText(h5, "prepared", text));
  PetscFunctionReturn(0);
}

/* What was repaired before the map could be made. */
static PetscErrorCode PutRepair(EqmH5 h5, const EqmRepair *repair)
{
  PetscFunctionBegin;
  PetscCall(EqmH5PutInteger(h5, "repair_duplicate_cells_removed", repair->duplicate_cells_removed));
  PetscCall(EqmH5PutInteger(h5, "repair_degenerate_cells_removed", repair->degenerate_cells_removed));
  PetscCall(EqmH5PutInteger(h5, "repair_cells_flipped", repair->cells_flipped));
  PetscCall(EqmH5PutInteger(h5, "repair_cells_split", repair->cells_split));
  PetscCall(EqmH5PutInteger(h5, "repair_vertices_added", repair->vertices_added));
  PetscCall(EqmH5PutInteger(h5, "repair_vertices_unreferenced", repair->vertices_unreferenced));
  PetscFunctionReturn(0);
}

/* Converted here: HDF5's own conversion would break the collective write. */
static PetscErrorCode WriteIndices(EqmH5 h5, const char *path, EqmSlab slab, const PetscInt *values)
{
  const PetscInt length = PetscMax(1, slab.width) * slab.count;
  PetscErrorCode error;
  PetscInt64 *wide;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(length, &wide));
  for (PetscInt k = 0; k < length; k++) wide[k] = values[k];
  error = EqmH5WriteIntegers(h5, path, slab, wide);
  PetscCall(PetscFree(wide));
  PetscCall(error);
  PetscFunctionReturn(0);
}

static PetscErrorCode WriteRepaired(EqmH5 h5, EqmMap repaired, const PetscInt *parent)
{
  EqmSoup soup = repaired->soup;

  PetscFunctionBegin;
  PetscCall(EqmH5WriteReals(h5, "/repaired/coordinates", VertexSlab(soup, repaired->dim), repaired->coordinates));
  PetscCall(EqmH5WriteReals(h5, "/repaired/vertices", VertexSlab(soup, 3), soup->vertices));
  PetscCall(WriteIndices(h5, "/repaired/cells", CellSlab(soup, soup->cell_size), soup->cells));
  PetscCall(WriteIndices(h5, "/repaired/parent", CellSlab(soup, 0), parent));
  PetscFunctionReturn(0);
}

/* What the command has added. */
static PetscErrorCode WriteExtras(EqmH5 h5, EqmMap map)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < map->num_arrays; k++) {
    const EqmMapArray *const array = &map->arrays[k];
    const EqmSlab slab = {array->total, array->start, array->count, array->width};
    if (array->is_real)
      PetscCall(EqmH5WriteReals(h5, array->path, slab, array->reals));
    else
      PetscCall(EqmH5WriteIntegers(h5, array->path, slab, array->integers));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode WriteArrays(EqmH5 h5, EqmMap map)
{
  EqmSoup soup = map->soup;

  PetscFunctionBegin;
  PetscCall(EqmH5WriteReals(h5, "/map/coordinates", VertexSlab(soup, map->dim), map->coordinates));
  PetscCall(EqmH5WriteReals(h5, "/mesh/vertices", VertexSlab(soup, 3), soup->vertices));
  PetscCall(WriteIndices(h5, "/mesh/cells", CellSlab(soup, soup->cell_size), soup->cells));
  PetscCall(EqmH5WriteReals(h5, "/cell/ratio", CellSlab(soup, 0), map->cell_ratio));
  PetscCall(EqmH5WriteReals(h5, "/vertex/ratio", VertexSlab(soup, 0), map->vertex_ratio));
  if (soup->cell_size == 3) PetscCall(WriteAngles(h5, map));
  if (soup->density) PetscCall(EqmH5WriteReals(h5, "/cell/density", CellSlab(soup, 0), soup->density));
  PetscCall(EqmSoupWriteFieldsHdf5(h5, soup, PETSC_TRUE));
  PetscCall(EqmResultWriteHistory(h5, map));
  if (map->num_hessian_eigenvalues)
    PetscCall(EqmH5WriteReals(h5, "/map/hessian_eigenvalues", HessianSlab(map, h5->rank), map->hessian_eigenvalues));
  if (map->repaired) PetscCall(WriteRepaired(h5, map->repaired, map->parent));
  PetscCall(WriteExtras(h5, map));
  PetscFunctionReturn(0);
}

static PetscErrorCode Fill(EqmH5 h5, EqmMap map)
{
  PetscFunctionBegin;
  PetscCall(DeclareArrays(h5, map));
  PetscCall(PutProvenance(h5, map));
  PetscCall(PutOutcome(h5, map));
  if (map->num_prepared) PetscCall(PutPrepared(h5, map));
  if (map->repaired) PetscCall(PutRepair(h5, &map->repair));
  PetscCall(EqmH5PutInteger(h5, "complete", 0));
  PetscCall(EqmH5Reserve(h5));
  PetscCall(WriteArrays(h5, map));
  PetscFunctionReturn(0);
}

/* Write the result file: everything about the map, in input numbering. It appears under its name when it is complete; a
   file that was there survives a failure. Errors: EQM_ERR_IO on all ranks. Collective. */
PetscErrorCode EqmMapWriteResult(EqmMap map, const char *file)
{
  PetscErrorCode error;
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(EqmH5Create(map->soup->comm, file, &h5));
  error = Fill(h5, map);
  if (!error) error = EqmH5Commit(&h5);
  if (error) PetscCall(EqmH5Close(&h5));
  PetscCall(error);
  PetscFunctionReturn(0);
}
