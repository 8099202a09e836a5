#include "base/progress.h"
#include <stdlib.h>
#include <unistd.h>

/* In a log, a phase that took less, in seconds, is not worth a line. */
static const PetscReal long_phase = 5.;

PetscBool EqmOnTerminal(void)
{
  static const char *const launchers[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"};

  for (size_t k = 0; k < sizeof(launchers) / sizeof(launchers[0]); k++) {
    if (getenv(launchers[k])) return PETSC_FALSE;
  }
  return (PetscBool)isatty(STDOUT_FILENO);
}

PetscErrorCode EqmPhasePrint(MPI_Comm comm, const char *phase, PetscReal seconds)
{
  PetscFunctionBegin;
  if (EqmOnTerminal()) {
    if (seconds < 0.)
      PetscCall(PetscPrintf(comm, "\r%s ...\033[K", phase));
    else
      PetscCall(PetscPrintf(comm, "\r\033[K"));
  } else if (seconds >= long_phase) { /* rank 0 decides for itself: it alone prints */
    PetscCall(PetscPrintf(comm, "%s: %.1f s\n", phase, (double)seconds));
  }
  PetscFunctionReturn(0);
}
