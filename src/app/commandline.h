/* The command line before PETSc sees it. */
#ifndef EQM_COMMANDLINE_H
#define EQM_COMMANDLINE_H

#include "app.h"

/* Split the command line into command, arguments, options files, requests for help and what is left for PETSc, which
   becomes `*options`, a list of its own that ends with NULL, with argv[0] in front. Options are brought into PETSc's
   form: --name, -na-me and -name=value become -name, -na_me and -name value. Not collective; works before MPI_Init. */
PETSC_INTERN PetscErrorCode EqmCommandLineParse(int argc, char **argv, EqmCommandLine *line, int *num_options,
                                                char ***options);
/* Give back what EqmCommandLineParse has allocated. */
PETSC_INTERN void EqmCommandLineFree(EqmCommandLine *line, char **options);

#endif
