/* Records sent to other ranks and received from them. */
#ifndef EQM_EXCHANGE_H
#define EQM_EXCHANGE_H

#include <petscsys.h>

/* Records of `width` integers. */
PETSC_INTERN PetscErrorCode EqmExchange(MPI_Comm comm, PetscInt num_records, PetscInt width,
                                        const PetscMPIInt *destination, const PetscInt *records, PetscInt *num_received,
                                        PetscInt **received);
/* Records of any kind, `bytes` each. */
PETSC_INTERN PetscErrorCode EqmExchangeBytes(MPI_Comm comm, PetscInt num_records, size_t bytes,
                                             const PetscMPIInt *destination, const void *records,
                                             PetscInt *num_received, void *received);

#endif
