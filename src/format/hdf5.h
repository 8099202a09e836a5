/* The mesh part of our HDF5 files, for those who read or write it by name. */
#ifndef EQM_FORMAT_HDF5_H
#define EQM_FORMAT_HDF5_H

#include <equimap/soup.h>
#include "h5/h5.h"

/* Do the bytes begin with the eight magic bytes of HDF5? Not collective. */
PETSC_INTERN PetscBool EqmRecogniseHdf5(const char *bytes, size_t length);
/* Read and write /mesh/vertices and /mesh/cells, each rank its slab; read its slab of /cell/density. Errors:
   EQM_ERR_IO, EQM_ERR_MESH (no cells; not one density per cell). Collective. */
PETSC_INTERN PetscErrorCode EqmSoupReadHdf5(MPI_Comm comm, const char *file, EqmSoup *soup);
PETSC_INTERN PetscErrorCode EqmSoupWriteHdf5(EqmSoup soup, const char *file);
/* Is a field of the soup in its result file, and under which path? Not collective. */
PETSC_INTERN PetscBool EqmSoupHasFieldHdf5(EqmSoup soup, const EqmMeshField *field, char *path, size_t length);
/* The fields of a soup and what its file said beside, from an open file; into one, where they are declared before they
   are written. of_result - without those that a result has itself. Collective. Errors: EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmSoupReadFieldsHdf5(EqmH5 h5, EqmSoup soup);
PETSC_INTERN PetscErrorCode EqmSoupDeclareFieldsHdf5(EqmH5 h5, EqmSoup soup, PetscBool of_result);
PETSC_INTERN PetscErrorCode EqmSoupWriteFieldsHdf5(EqmH5 h5, EqmSoup soup, PetscBool of_result);
PETSC_INTERN PetscErrorCode EqmSoupReadDensityHdf5(EqmSoup soup, const char *file, PetscReal *density);

#endif
