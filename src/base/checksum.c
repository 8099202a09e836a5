#include "base/checksum.h"
#include <zlib.h>

/* Of any bytes. Not collective. */
EqmChecksum EqmChecksumBytes(size_t count, const void *bytes)
{
  const EqmChecksum checksum = {(PetscInt64)crc32_z(crc32_z(0, NULL, 0), bytes, count), (PetscInt64)count};
  return checksum;
}

EqmChecksum EqmChecksumAppend(EqmChecksum first, EqmChecksum second)
{
  const EqmChecksum both = {(PetscInt64)crc32_combine((uLong)first.crc, (uLong)second.crc, (z_off_t)second.length),
                            first.length + second.length};
  return both;
}

/* Of doubles, so that it does not depend on PetscReal. Not collective. */
EqmChecksum EqmChecksumReals(PetscInt64 count, const PetscReal *values)
{
  double part[1024];
  uLong crc = crc32(0, NULL, 0);

  for (PetscInt64 i = 0; i < count; i += 1024) {
    const PetscInt64 length = PetscMin(count - i, 1024);
    for (PetscInt64 k = 0; k < length; k++) part[k] = (double)values[i + k];
    crc = crc32(crc, (const Bytef *)part, (uInt)length * (uInt)sizeof(double));
  }
  return (EqmChecksum){(PetscInt64)crc, count * (PetscInt64)sizeof(double)};
}

/* Of 64-bit integers, so that it does not depend on PetscInt. Not collective. */
EqmChecksum EqmChecksumIntegers(PetscInt64 count, const PetscInt *values)
{
  PetscInt64 part[1024];
  uLong crc = crc32(0, NULL, 0);

  for (PetscInt64 i = 0; i < count; i += 1024) {
    const PetscInt64 length = PetscMin(count - i, 1024);
    for (PetscInt64 k = 0; k < length; k++) part[k] = values[i + k];
    crc = crc32(crc, (const Bytef *)part, (uInt)length * (uInt)sizeof(PetscInt64));
  }
  return (EqmChecksum){(PetscInt64)crc, count * (PetscInt64)sizeof(PetscInt64)};
}

PetscErrorCode EqmChecksumJoin(MPI_Comm comm, EqmChecksum mine, EqmChecksum *all)
{
  EqmChecksum *parts;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(size, &parts));
  PetscCallMPI(MPI_Allgather(&mine, 2, MPIU_INT64, parts, 2, MPIU_INT64, comm));
  *all = parts[0];
  for (PetscMPIInt r = 1; r < size; r++) *all = EqmChecksumAppend(*all, parts[r]);
  PetscCall(PetscFree(parts));
  PetscFunctionReturn(0);
}
