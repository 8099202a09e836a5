/* Read a result file for a report. */
#include "picture/load.h"
#include "store/store.h"
#include <math.h>

/* A damaged file must not name vertices that do not exist. */
static PetscErrorCode LoadCells(EqmH5 h5, EqmResult *result)
{
  PetscErrorCode error;
  PetscInt64 rows, width, *wide;
  PetscBool fine = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(EqmH5GetShape(h5, "/mesh/cells", &rows, &width));
  if ((width != 3 && width != 4) || rows > PETSC_MAX_INT / 4) {
    EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': /mesh/cells has an unexpected shape", h5->name);
  }
  result->num_cells = (PetscInt)rows;
  result->cell_size = (PetscInt)width;
  PetscCall(PetscMalloc1(rows * width, &result->cells));
  PetscCall(PetscMalloc1(rows * width, &wide));
  const EqmSlab slab = {(PetscInt)rows, 0, (PetscInt)rows, (PetscInt)width};
  error = EqmH5ReadIntegers(h5, "/mesh/cells", slab, wide);
  for (PetscInt64 k = 0; k < rows * width && !error; k++) {
    fine = (PetscBool)(fine && wide[k] >= 0 && wide[k] < result->num_vertices);
    result->cells[k] = (PetscInt)wide[k];
  }
  PetscCall(PetscFree(wide));
  PetscCall(error);
  if (!fine) EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': /mesh/cells names vertices that do not exist", h5->name);
  PetscFunctionReturn(0);
}

/* Places of the vertices, two or three coordinates each; in the plane z is 0. */
static PetscErrorCode LoadPlaces(EqmH5 h5, const char *path, EqmResult *result, PetscInt *dim, PetscReal **places)
{
  PetscInt64 rows, width;
  PetscReal *compact;
  PetscInt count;

  PetscFunctionBegin;
  PetscCall(EqmH5GetShape(h5, path, &rows, &width));
  if (rows != result->num_vertices || (width != 2 && width != 3)) {
    EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': %s does not fit the mesh", h5->name, path);
  }
  *dim = (PetscInt)width;
  PetscCall(EqmLoadReals(h5, path, width, &count, &compact));
  PetscCall(PetscCalloc1(3 * count, places));
  for (PetscInt i = 0; i < count; i++) {
    for (PetscInt d = 0; d < *dim; d++) (*places)[3 * i + d] = compact[*dim * i + d];
  }
  PetscCall(PetscFree(compact));
  PetscFunctionReturn(0);
}

static PetscErrorCode LoadImages(EqmH5 h5, EqmResult *result)
{
  PetscBool registered;

  PetscFunctionBegin;
  PetscCall(LoadPlaces(h5, "/map/coordinates", result, &result->dim, &result->images));
  PetscCall(EqmH5HasDataset(h5, "/register/target", &registered));
  if (registered) PetscCall(LoadPlaces(h5, "/register/target", result, &result->target_dim, &result->target));
  PetscFunctionReturn(0);
}

/* The rows that all columns have; without the first three there is no history: a map that was measured, not made here.
 */
static PetscErrorCode LoadHistory(EqmH5 h5, EqmResult *result)
{
  static const char *const paths[] = {"/history/iteration", "/history/energy", "/history/seconds",
                                      "/history/gradient_norm"};
  PetscReal **const arrays[] = {&result->iteration, &result->energy, &result->elapsed, &result->gradient};
  PetscInt rows, first = 0;
  PetscBool has;

  PetscFunctionBegin;
  for (int k = 0; k < 4; k++) {
    PetscCall(EqmH5HasDataset(h5, paths[k], &has));
    if (!has && k < 3) PetscFunctionReturn(0);
    if (!has) continue;
    PetscCall(EqmLoadReals(h5, paths[k], 0, &rows, arrays[k]));
    if (k == 0) first = rows;
    if (rows != first) EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': its history is damaged", h5->name);
  }
  result->num_history = first;
  PetscFunctionReturn(0);
}

static PetscErrorCode LoadAttributes(EqmH5 h5, EqmResult *result)
{
  PetscFunctionBegin;
  PetscCall(EqmH5GetText(h5, "command", "", result->command, sizeof(result->command)));
  PetscCall(EqmH5GetText(h5, "method", "", result->method, sizeof(result->method)));
  PetscCall(EqmH5GetText(h5, "status", "", result->status, sizeof(result->status)));
  PetscCall(EqmH5GetText(h5, "message", "", result->message, sizeof(result->message)));
  PetscCall(EqmH5GetText(h5, "mesh_file", "", result->mesh_file, sizeof(result->mesh_file)));
  PetscCall(EqmH5GetText(h5, "register.b.file", "", result->other_file, sizeof(result->other_file)));
  PetscCall(EqmH5GetText(h5, "version", "", result->version, sizeof(result->version)));
  PetscCall(EqmH5GetText(h5, "git_commit", "", result->commit, sizeof(result->commit)));
  PetscCall(EqmH5GetText(h5, "date", "", result->date, sizeof(result->date)));
  PetscCall(EqmH5GetText(h5, "options", "", result->options, sizeof(result->options)));
  PetscCall(EqmH5GetInteger(h5, "iterations", 0, &result->iterations));
  PetscCall(EqmH5GetInteger(h5, "folds", 0, &result->folds));
  PetscCall(EqmH5GetInteger(h5, "ranks", 1, &result->ranks));
  PetscCall(EqmH5GetInteger(h5, "threads", 1, &result->threads));
  PetscCall(EqmH5GetReal(h5, "energy_initial", NAN, &result->energy_initial));
  PetscCall(EqmH5GetReal(h5, "energy_final", NAN, &result->energy_final));
  PetscCall(EqmH5GetReal(h5, "angle_error_mean", NAN, &result->angle_mean));
  PetscCall(EqmH5GetReal(h5, "angle_error_median", NAN, &result->angle_median));
  PetscCall(EqmH5GetReal(h5, "quasiconformal_mean", NAN, &result->quasi_mean));
  PetscCall(EqmH5GetReal(h5, "quasiconformal_median", NAN, &result->quasi_median));
  PetscCall(EqmH5GetReal(h5, "quasiconformal_max", NAN, &result->quasi_max));
  PetscCall(EqmH5GetReal(h5, "seconds_total", NAN, &result->seconds));
  PetscFunctionReturn(0);
}

/* Per cell, if there: what becomes of angles, and the density, 1 where there is none. */
static PetscErrorCode LoadCellValues(EqmH5 h5, EqmResult *result)
{
  PetscInt count;
  PetscBool has;

  PetscFunctionBegin;
  PetscCall(EqmLoadReals(h5, "/cell/ratio", 0, &count, &result->ratio));
  if (count != result->num_cells)
    EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': /cell/ratio does not fit the mesh", h5->name);
  PetscCall(EqmH5HasDataset(h5, "/cell/quasi_conformal", &has));
  if (has) PetscCall(EqmLoadReals(h5, "/cell/quasi_conformal", 0, &count, &result->quasi_conformal));
  if (has && count != result->num_cells)
    EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': /cell/quasi_conformal does not fit the mesh", h5->name);
  PetscCall(EqmH5HasDataset(h5, "/cell/density", &has));
  if (has) {
    PetscCall(EqmLoadReals(h5, "/cell/density", 0, &count, &result->weight));
    if (count != result->num_cells)
      EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': /cell/density does not fit the mesh", h5->name);
  } else {
    PetscCall(PetscMalloc1(result->num_cells, &result->weight));
    for (PetscInt c = 0; c < result->num_cells; c++) result->weight[c] = 1.;
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode LoadAngles(EqmH5 h5, EqmResult *result)
{
  const EqmSlab slab = {EQM_NUM_ANGLE_BINS, 0, EQM_NUM_ANGLE_BINS, 0};
  PetscInt64 rows = 0, width;

  PetscFunctionBegin;
  PetscCall(EqmH5HasDataset(h5, "/histogram/angle_error", &result->has_angles));
  if (result->has_angles) PetscCall(EqmH5GetShape(h5, "/histogram/angle_error", &rows, &width));
  result->has_angles = (PetscBool)(rows == EQM_NUM_ANGLE_BINS);
  if (result->has_angles) PetscCall(EqmH5ReadIntegers(h5, "/histogram/angle_error", slab, result->angle_histogram));
  PetscFunctionReturn(0);
}

static PetscErrorCode Fill(EqmH5 h5, EqmResult *result)
{
  PetscInt64 complete;
  PetscBool has;

  PetscFunctionBegin;
  PetscCall(EqmH5HasDataset(h5, "/map/coordinates", &has));
  PetscCall(EqmH5GetInteger(h5, "complete", 0, &complete));
  if (!has || !complete) {
    EqmFail(h5->comm, EQM_ERR_IO,
            "cannot read '%s': it is not a result that was written to its end; give the .h5 file of a map command",
            h5->name);
  }
  PetscCall(EqmCheckResultVersion(h5));
  PetscCall(LoadAttributes(h5, result));
  PetscCall(EqmLoadReals(h5, "/mesh/vertices", 3, &result->num_vertices, &result->vertices));
  PetscCall(LoadCells(h5, result));
  PetscCall(LoadImages(h5, result));
  PetscCall(LoadCellValues(h5, result));
  PetscCall(LoadAngles(h5, result));
  PetscCall(EqmLoadLandmarks(h5, result));
  PetscCall(LoadHistory(h5, result));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmResultLoad(const char *file, EqmResult *result)
{
  PetscErrorCode error;
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(result, sizeof(*result)));
  PetscCall(EqmH5Open(PETSC_COMM_SELF, file, &h5));
  error = PetscStrncpy(result->file, file, sizeof(result->file));
  if (!error) error = Fill(h5, result);
  PetscCall(EqmH5Close(&h5));
  if (!error) error = EqmResultEvaluate(result);
  if (error) PetscCall(EqmResultReset(result));
  PetscCall(error);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmResultReset(EqmResult *result)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(result->vertices));
  PetscCall(PetscFree(result->images));
  PetscCall(PetscFree(result->target));
  PetscCall(PetscFree(result->distance));
  PetscCall(PetscFree(result->landmark));
  PetscCall(PetscFree(result->landmark_goal));
  PetscCall(PetscFree(result->landmark_target));
  PetscCall(PetscFree(result->curve));
  PetscCall(PetscFree(result->cells));
  PetscCall(PetscFree(result->weight));
  PetscCall(PetscFree(result->quasi_conformal));
  PetscCall(PetscFree(result->ratio));
  PetscCall(PetscFree(result->iteration));
  PetscCall(PetscFree(result->energy));
  PetscCall(PetscFree(result->elapsed));
  PetscCall(PetscFree(result->gradient));
  PetscCall(PetscFree(result->line));
  PetscCall(PetscMemzero(result, sizeof(*result)));
  PetscFunctionReturn(0);
}
