/* The files that a run is to write. */
#ifndef EQM_OUTPUT_H
#define EQM_OUTPUT_H

#include <equimap/base.h>

/* EqmCheckOutput - can every name in the comma-separated `files` be written, and is none of them the file `mesh` (NULL:
   there is no such file)? Collective; rank 0 looks. Errors: EQM_ERR_USAGE (no name, or the mesh would be overwritten),
   EQM_ERR_IO (no such directory, no permission). */
PETSC_INTERN PetscErrorCode EqmCheckOutput(MPI_Comm comm, const char *mesh, const char *files);
/* EqmSweepOutput - remove temporaries of the comma-separated `files` that a killed run has left behind. For runs with
   checkpoints, which are killed and started again, one at a time. Collective; rank 0 looks. */
PETSC_INTERN PetscErrorCode EqmSweepOutput(MPI_Comm comm, const char *files);

#endif
