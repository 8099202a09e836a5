/* The program's commands by name. */
#ifndef EQM_COMMANDS_H
#define EQM_COMMANDS_H

#include "app.h"

typedef struct {
  const char *name;
  EqmCommand run;
  const char *usage, *purpose; /* NULL: that of the target of this name */
} EqmCommandRow;

/* The command of that name. Errors: EQM_ERR_USAGE, with the nearest name. Collective on PETSC_COMM_WORLD. */
PETSC_INTERN PetscErrorCode EqmCommandFind(const char *name, const EqmCommandRow **row);
/* --version, --help without a command, or no command at all: rank 0 prints. The status becomes the exit code. Needs
   neither MPI nor PETSc. Not collective. */
PETSC_INTERN EqmStatus EqmIntroduce(const EqmCommandLine *line, int rank);

/* One line about a command, for lists and help. Not collective. */
PETSC_INTERN const char *EqmCommandPurpose(const EqmCommandRow *row);

#endif
