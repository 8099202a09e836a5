/* Records of integers sent to other ranks and received from them. */
#ifndef EQM_EXCHANGE_H
#define EQM_EXCHANGE_H

#include <petscsys.h>

PETSC_INTERN PetscErrorCode EqmExchange(MPI_Comm comm, PetscInt num_records, PetscInt width,
                                        const PetscMPIInt *destination, const PetscInt *records, PetscInt *num_received,
                                        PetscInt **received);

#endif
