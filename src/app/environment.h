/* What the libraries that the program is linked with read from the environment, before they do. */
#ifndef EQM_APP_ENVIRONMENT_H
#define EQM_APP_ENVIRONMENT_H

#include "commandline.h"

PETSC_INTERN void EqmStartWithoutDaemon(void);
PETSC_INTERN void EqmStartAgain(const EqmCommandLine *line, char **argv);

#endif
