#include "scalar.h"

#include <string.h>

/* EqmScalarSize - bytes of one number, 0 for EQM_SCALAR_NONE. Not collective. */
size_t EqmScalarSize(EqmScalarType type)
{
  static const size_t size[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

  return size[type];
}

/* EqmScalarIsInteger - whole numbers? Not collective. */
PetscBool EqmScalarIsInteger(EqmScalarType type)
{
  return type >= EQM_SCALAR_INT8 && type <= EQM_SCALAR_UINT64 ? PETSC_TRUE : PETSC_FALSE;
}

static uint64_t LoadBits(const char *bytes, size_t size, PetscBool big_endian)
{
  uint64_t bits = 0;

  memcpy(&bits, bytes, size); /* this machine is little endian: the low bytes come first */
  return big_endian && size ? __builtin_bswap64(bits) >> (64 - 8 * size) : bits;
}

/* EqmLoadReal - the number at `bytes`, which need not be aligned. Not collective. */
PetscReal EqmLoadReal(const char *bytes, EqmScalarType type, PetscBool big_endian)
{
  if (type == EQM_SCALAR_FLOAT64) {
    uint64_t bits = LoadBits(bytes, 8, big_endian);
    double value;

    memcpy(&value, &bits, sizeof(value));
    return value;
  }
  if (type == EQM_SCALAR_FLOAT32) {
    uint32_t bits = (uint32_t)LoadBits(bytes, 4, big_endian);
    float value;

    memcpy(&value, &bits, sizeof(value));
    return (PetscReal)value;
  }
  return (PetscReal)EqmLoadInteger(bytes, type, big_endian);
}

/* EqmLoadInteger - the number at `bytes`, which need not be aligned; -1, which is no index and no count, for one that
   is not whole or too large. Not collective. */
PetscInt64 EqmLoadInteger(const char *bytes, EqmScalarType type, PetscBool big_endian)
{
  const uint64_t bits = LoadBits(bytes, EqmScalarSize(type), big_endian);

  switch (type) {
  case EQM_SCALAR_INT8:
    return (int8_t)bits;
  case EQM_SCALAR_INT16:
    return (int16_t)bits;
  case EQM_SCALAR_INT32:
    return (int32_t)bits;
  case EQM_SCALAR_UINT8:
  case EQM_SCALAR_UINT16:
  case EQM_SCALAR_UINT32:
    return (PetscInt64)bits;
  case EQM_SCALAR_INT64:
  case EQM_SCALAR_UINT64:
    return bits <= INT64_MAX || type == EQM_SCALAR_INT64 ? (int64_t)bits : -1;
  case EQM_SCALAR_FLOAT32:
  case EQM_SCALAR_FLOAT64: {
    PetscReal value = EqmLoadReal(bytes, type, big_endian);
    return value > -9e15 && value < 9e15 && value == (PetscReal)(PetscInt64)value ? (PetscInt64)value : -1;
  }
  case EQM_SCALAR_NONE:
    break;
  }
  return -1;
}
