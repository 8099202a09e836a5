/* CRC-32 (zlib's) of arrays that are dealt to the ranks in slabs: the same for any number of ranks. */
#ifndef EQM_CHECKSUM_H
#define EQM_CHECKSUM_H

#include <petscsys.h>

/* The checksum of a run of bytes and its length, so that runs can be joined. */
typedef struct {
  PetscInt64 crc, length;
} EqmChecksum;

PETSC_INTERN EqmChecksum EqmChecksumReals(PetscInt64 count, const PetscReal *values);
PETSC_INTERN EqmChecksum EqmChecksumIntegers(PetscInt64 count, const PetscInt *values);
PETSC_INTERN EqmChecksum EqmChecksumBytes(size_t count, const void *bytes);
/* Of the runs of all ranks one after the other. Collective. */
PETSC_INTERN PetscErrorCode EqmChecksumJoin(MPI_Comm comm, EqmChecksum mine, EqmChecksum *all);
/* Of one run and then another. */
PETSC_INTERN EqmChecksum EqmChecksumAppend(EqmChecksum first, EqmChecksum second);

#endif
