/* From a result file to a picture, on any number of ranks. */
#include "picture.h"

static PetscErrorCode DrawAlone(const char *result_file, const char *picture, PetscInt width)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code;
  EqmResult result;

  PetscFunctionBegin;
  PetscCall(EqmResultLoad(result_file, &result));
  code = EqmPictureWrite(&result, picture, (int)width, message, sizeof(message));
  PetscCall(EqmResultReset(&result));
  if (code) EqmFail(PETSC_COMM_SELF, code, "%s", message);
  PetscFunctionReturn(0);
}

/* Draw one page of a result into `picture`, its format by suffix: .png .pdf .svg .html; `width` in pixels. Errors:
   EQM_ERR_USAGE (suffix, or built without cairo), EQM_ERR_IO (not a result, cannot be written). Collective; rank 0
   draws. */
PetscErrorCode EqmReportWrite(MPI_Comm comm, const char *result_file, const char *picture, PetscInt width)
{
  PetscErrorCode code = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) code = DrawAlone(result_file, picture, width);
  PetscCallMPI(MPI_Bcast(&code, 1, MPI_INT, 0, comm));
  PetscFunctionReturn(code); /* rank 0 has said why */
}
