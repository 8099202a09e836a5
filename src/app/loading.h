/* HDF5 begins before MPI does. */
#ifndef EQM_APP_LOADING_H
#define EQM_APP_LOADING_H

#include <petscsys.h>

PETSC_INTERN PetscBool EqmLoadHdf5(void (*at_crash)(int));

#endif
