/* From result files to a picture, on any number of ranks. */
#include "picture/picture.h"

/* The files of a page, read. */
typedef struct {
  EqmResult results[EQM_MOST_RESULTS], start;
  PetscInt loaded;
  PetscBool has_start;
} Files;

static PetscErrorCode LoadOne(const char *file, const EqmReportOptions *options, EqmResult *result)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(EqmResultLoad(file, result));
  error = EqmResultFindLines(result, options);
  if (error) PetscCall(EqmResultReset(result));
  PetscFunctionReturn(error); /* the reader has reported the reason */
}

/* The start is a map of the same triangles to a place of the same kind. */
static PetscErrorCode CheckStart(const EqmResult *result, const EqmResult *start)
{
  PetscBool same = (PetscBool)(start->num_vertices == result->num_vertices && start->num_cells == result->num_cells &&
                               start->cell_size == result->cell_size && start->dim == result->dim);

  PetscFunctionBegin;
  if (same) PetscCall(PetscArraycmp(start->cells, result->cells, result->cell_size * result->num_cells, &same));
  if (!same || start->target)
    EqmFail(PETSC_COMM_SELF, EQM_ERR_USAGE,
            "-start %s: it must be a map of the mesh of %s, to the same target; `-max_it 0` makes the start of a run",
            start->file, result->file);
  if (result->target)
    EqmFail(PETSC_COMM_SELF, EQM_ERR_USAGE, "-start %s: %s is a registration, which has no start of its own",
            start->file, result->file);
  PetscFunctionReturn(0);
}

static PetscErrorCode LoadAll(PetscInt num, const char *const *files, const EqmReportOptions *options, Files *all)
{
  PetscFunctionBegin;
  while (all->loaded < num) {
    PetscCall(LoadOne(files[all->loaded], options, &all->results[all->loaded]));
    all->loaded++;
    if (options->curve == EQM_CURVE_GRADIENT && !EqmResultHasGradient(&all->results[all->loaded - 1]))
      EqmFail(PETSC_COMM_SELF, EQM_ERR_USAGE, "-convergence gradient: the history of %s has no gradients; take excess",
              files[all->loaded - 1]);
  }
  if (!options->start[0]) PetscFunctionReturn(0);
  PetscCall(LoadOne(options->start, options, &all->start));
  all->has_start = PETSC_TRUE;
  PetscCall(CheckStart(all->results, &all->start));
  PetscFunctionReturn(0);
}

static PetscErrorCode DrawAlone(PetscInt num, const char *const *files, const char *picture,
                                const EqmReportOptions *options)
{
  Files all = {.loaded = 0};
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code;

  PetscFunctionBegin;
  code = LoadAll(num, files, options, &all);
  if (!code) {
    const EqmPage page = EqmPageOf(num, all.results, all.has_start ? &all.start : NULL, options);
    code = EqmPictureWrite(&page, picture, message, sizeof(message));
  }
  for (PetscInt k = 0; k < all.loaded; k++) PetscCall(EqmResultReset(&all.results[k]));
  if (all.has_start) PetscCall(EqmResultReset(&all.start));
  if (code && message[0]) EqmFail(PETSC_COMM_SELF, code, "%s", message);
  PetscFunctionReturn(code); /* the reader has reported the reason */
}

PetscErrorCode EqmReportWrite(MPI_Comm comm, PetscInt num_results, const char *const *result_files, const char *picture,
                              const EqmReportOptions *options)
{
  PetscErrorCode code = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  if (num_results < 1 || num_results > EQM_MOST_RESULTS)
    EqmFail(comm, EQM_ERR_USAGE, "a report shows 1 to %d results, not %" PetscInt_FMT, EQM_MOST_RESULTS, num_results);
  if (options->start[0] && num_results > 1)
    EqmFail(comm, EQM_ERR_USAGE, "-start %s: beside one result; several stand side by side as they are",
            options->start);
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) code = DrawAlone(num_results, result_files, picture, options);
  PetscCallMPI(MPI_Bcast(&code, 1, MPI_INT, 0, comm));
  PetscFunctionReturn(code); /* rank 0 has reported the reason */
}
