/* HDF5's beginning, for who does not need its header. */
#ifndef EQM_H5_LOAD_H
#define EQM_H5_LOAD_H

#include <petscsys.h>

PETSC_INTERN PetscBool EqmH5Load(void);

#endif
