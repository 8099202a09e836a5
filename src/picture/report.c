/* From result files to a picture, on any number of ranks. */
#include "picture/picture.h"

static PetscErrorCode DrawAlone(PetscInt num, const char *const *files, const char *picture,
                                const EqmReportOptions *options)
{
  char message[EQM_MESSAGE_MAX] = "";
  EqmResult results[EQM_MOST_RESULTS];
  PetscErrorCode code = 0;
  PetscInt loaded = 0;

  PetscFunctionBegin;
  while (loaded < num && !code) {
    code = EqmResultLoad(files[loaded], &results[loaded]);
    if (!code) loaded++;
  }
  if (!code) {
    const EqmPage page = EqmPageOf(num, results, options);
    code = EqmPictureWrite(&page, picture, message, sizeof(message));
  }
  for (PetscInt k = 0; k < loaded; k++) PetscCall(EqmResultReset(&results[k]));
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
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) code = DrawAlone(num_results, result_files, picture, options);
  PetscCallMPI(MPI_Bcast(&code, 1, MPI_INT, 0, comm));
  PetscFunctionReturn(code); /* rank 0 has reported the reason */
}
