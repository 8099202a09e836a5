/* A result file, read back to be looked at. */
#include "picture.h"
#include "h5/h5.h"
#include "store/store.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* All rows of an array, which must have `width` entries per row (0: one-dimensional). */
static PetscErrorCode LoadReals(EqmH5 h5, const char *path, PetscInt64 width, PetscInt *total, PetscReal **values)
{
  PetscInt64 rows, entries;

  PetscFunctionBegin;
  PetscCall(EqmH5GetShape(h5, path, &rows, &entries));
  if (entries != width || rows > PETSC_MAX_INT / PetscMax(width, 1)) {
    EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': %s has an unexpected shape", h5->name, path);
  }
  PetscCall(PetscMalloc1(rows * PetscMax(width, 1), values));
  const EqmSlab slab = {(PetscInt)rows, 0, (PetscInt)rows, (PetscInt)width};
  PetscCall(EqmH5ReadReals(h5, path, slab, *values));
  *total = (PetscInt)rows;
  PetscFunctionReturn(0);
}

/* Cells name vertices that exist: a damaged file must not lead the painter astray. */
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
  PetscCall(LoadReals(h5, path, width, &count, &compact));
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

static PetscErrorCode LoadHistory(EqmH5 h5, EqmResult *result)
{
  static const char *const paths[] = {"/history/iteration", "/history/energy", "/history/seconds"};
  PetscReal **const arrays[] = {&result->iteration, &result->energy, &result->elapsed};
  PetscInt rows;
  PetscBool has;

  PetscFunctionBegin;
  for (int k = 0; k < 3; k++) {
    PetscCall(EqmH5HasDataset(h5, paths[k], &has));
    if (!has) PetscFunctionReturn(0); /* a map that was measured, not made here */
    PetscCall(LoadReals(h5, paths[k], 0, &rows, arrays[k]));
    if (k > 0 && rows != result->num_history)
      EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': its history is damaged", h5->name);
    result->num_history = rows;
  }
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
  PetscCall(EqmH5GetReal(h5, "seconds_total", NAN, &result->seconds));
  PetscFunctionReturn(0);
}

static int CompareReals(const void *a, const void *b)
{
  const PetscReal x = *(const PetscReal *)a, y = *(const PetscReal *)b;
  return (x > y) - (x < y);
}

static PetscErrorCode ComputeStatistics(EqmResult *result)
{
  EqmStatistics *statistics = &result->ratio_statistics;
  const PetscInt n = result->num_cells;
  PetscReal *sorted, sum = 0.0, squares = 0.0;

  PetscFunctionBegin;
  if (n == 0) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(n, &sorted));
  PetscCall(PetscArraycpy(sorted, result->ratio, n));
  qsort(sorted, (size_t)n, sizeof(*sorted), CompareReals);
  for (PetscInt j = 0; j < n; j++) sum += sorted[j];
  statistics->mean = sum / (PetscReal)n;
  for (PetscInt j = 0; j < n; j++) squares += PetscSqr(sorted[j] - statistics->mean);
  statistics->sd = PetscSqrtReal(squares / (PetscReal)n);
  statistics->min = sorted[0];
  statistics->max = sorted[n - 1];
  statistics->p25 = sorted[(PetscInt)(0.25 * (n - 1))];
  statistics->p50 = sorted[(PetscInt)(0.50 * (n - 1))];
  statistics->p75 = sorted[(PetscInt)(0.75 * (n - 1))];
  statistics->p95 = sorted[(PetscInt)(0.95 * (n - 1))];
  PetscCall(PetscFree(sorted));
  PetscFunctionReturn(0);
}

static PetscErrorCode Fill(EqmH5 h5, EqmResult *result)
{
  PetscInt64 complete;
  PetscInt count;
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
  PetscCall(LoadReals(h5, "/mesh/vertices", 3, &result->num_vertices, &result->vertices));
  PetscCall(LoadCells(h5, result));
  PetscCall(LoadImages(h5, result));
  PetscCall(LoadReals(h5, "/cell/ratio", 0, &count, &result->ratio));
  if (count != result->num_cells)
    EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': /cell/ratio does not fit the mesh", h5->name);
  PetscCall(LoadHistory(h5, result));
  PetscCall(ComputeStatistics(result));
  PetscFunctionReturn(0);
}

/* Read a result file whole. Errors: EQM_ERR_IO (not a result, damaged), and nothing is left to free. Not collective. */
PetscErrorCode EqmResultLoad(const char *file, EqmResult *result)
{
  PetscErrorCode error;
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(result, sizeof(*result)));
  PetscCall(EqmH5Open(PETSC_COMM_SELF, file, &h5));
  error = Fill(h5, result);
  PetscCall(EqmH5Close(&h5));
  if (error) PetscCall(EqmResultReset(result));
  PetscCall(error);
  PetscFunctionReturn(0);
}

/* Free what EqmResultLoad allocated. Not collective. */
PetscErrorCode EqmResultReset(EqmResult *result)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(result->vertices));
  PetscCall(PetscFree(result->images));
  PetscCall(PetscFree(result->target));
  PetscCall(PetscFree(result->cells));
  PetscCall(PetscFree(result->ratio));
  PetscCall(PetscFree(result->iteration));
  PetscCall(PetscFree(result->energy));
  PetscCall(PetscFree(result->elapsed));
  PetscCall(PetscMemzero(result, sizeof(*result)));
  PetscFunctionReturn(0);
}
