/* Binary numbers of every size and byte order. */
#ifndef EQM_FORMAT_SCALAR_H
#define EQM_FORMAT_SCALAR_H

#include <stdint.h>
#include <equimap/base.h>

/* The writers put numbers as they lie in memory into files that say "little endian". */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the mesh writers are made for little-endian machines");
_Static_assert(sizeof(PetscReal) == sizeof(double), "meshes are read and written in double precision");

typedef enum {
  EQM_SCALAR_NONE,
  EQM_SCALAR_INT8,
  EQM_SCALAR_UINT8,
  EQM_SCALAR_INT16,
  EQM_SCALAR_UINT16,
  EQM_SCALAR_INT32,
  EQM_SCALAR_UINT32,
  EQM_SCALAR_INT64,
  EQM_SCALAR_UINT64,
  EQM_SCALAR_FLOAT32,
  EQM_SCALAR_FLOAT64
} EqmScalarType;

PETSC_INTERN size_t EqmScalarSize(EqmScalarType type);
PETSC_INTERN PetscBool EqmScalarIsInteger(EqmScalarType type);
PETSC_INTERN PetscReal EqmLoadReal(const char *bytes, EqmScalarType type, PetscBool big_endian);
PETSC_INTERN PetscInt64 EqmLoadInteger(const char *bytes, EqmScalarType type, PetscBool big_endian);

#endif
