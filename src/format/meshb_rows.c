/* The header of Medit's .meshb, and records of vertices and cells, of the whole file or of a part. */
#include "meshb.h"

PetscBool EqmMeshbReadMagic(const char *bytes, size_t length, PetscBool *big_endian, PetscInt64 *version)
{
  if (length < 12) return PETSC_FALSE;
  *big_endian = EqmLoadInteger(bytes, EQM_SCALAR_INT32, PETSC_TRUE) == 1 ? PETSC_TRUE : PETSC_FALSE;
  *version = EqmLoadInteger(bytes + 4, EQM_SCALAR_INT32, *big_endian);
  return EqmLoadInteger(bytes, EQM_SCALAR_INT32, *big_endian) == 1 && *version >= 1 && *version <= 4 &&
                 EqmLoadInteger(bytes + 8, EQM_SCALAR_INT32, *big_endian) == EQM_MESHB_DIMENSION
             ? PETSC_TRUE
             : PETSC_FALSE;
}

PetscErrorCode EqmMeshbTakeInteger(EqmMeshb *meshb, EqmScalarType type, const char *what, PetscInt64 *value)
{
  const char *bytes;

  EqmTry(EqmTakeBytes(meshb->in, EqmScalarSize(type), what, &bytes));
  *value = EqmLoadInteger(bytes, type, meshb->big_endian);
  return 0;
}

size_t EqmMeshbBytesOfVertex(const EqmMeshb *meshb)
{
  return (size_t)meshb->dimension * EqmScalarSize(meshb->real) + EqmScalarSize(meshb->integer);
}

size_t EqmMeshbBytesOfCell(const EqmMeshb *meshb, const EqmMeditKind *kind)
{
  return (size_t)(kind->num_corners + 1) * EqmScalarSize(meshb->integer);
}

PetscErrorCode EqmMeshbReadVertices(EqmMeshb *meshb, const char *records, PetscInt64 count)
{
  const size_t real_bytes = EqmScalarSize(meshb->real), record_bytes = EqmMeshbBytesOfVertex(meshb);
  PetscReal *x;

  EqmTry(EqmBuilderAddVertices(&meshb->builder, (size_t)count, &x));
  for (PetscInt64 i = 0; i < count; ++i) {
    x[3 * i + 2] = 0.0; /* of the plane */
    for (PetscInt64 k = 0; k < meshb->dimension; ++k) {
      x[3 * i + k] =
          EqmLoadReal(records + (size_t)i * record_bytes + (size_t)k * real_bytes, meshb->real, meshb->big_endian);
    }
  }
  return 0;
}

PetscErrorCode EqmMeshbReadCells(EqmMeshb *meshb, const EqmMeditKind *kind, const char *records, PetscInt64 count)
{
  const size_t bytes = EqmScalarSize(meshb->integer), record_bytes = EqmMeshbBytesOfCell(meshb, kind);
  PetscInt64 corners[EQM_MEDIT_MAX_CORNERS];

  for (PetscInt64 i = 0; i < count; ++i) {
    for (PetscInt k = 0; k < kind->num_corners; ++k) {
      const char *const corner = records + (size_t)i * record_bytes + (size_t)k * bytes;

      corners[k] = EqmLoadInteger(corner, meshb->integer, meshb->big_endian);
    }
    EqmTry(EqmMeditAddCell(&meshb->builder, kind, meshb->num_vertices, corners,
                           EqmLoadInteger(records + (size_t)(i + 1) * record_bytes - bytes, meshb->integer,
                                          meshb->big_endian)));
  }
  return 0;
}

PetscErrorCode EqmMeshbParseHeader(EqmMeshb *meshb)
{
  static const EqmScalarType integer[5] = {0, EQM_SCALAR_INT32, EQM_SCALAR_INT32, EQM_SCALAR_INT32, EQM_SCALAR_INT64};
  static const EqmScalarType offset[5] = {0, EQM_SCALAR_INT32, EQM_SCALAR_INT32, EQM_SCALAR_INT64, EQM_SCALAR_INT64};
  EqmInput *const in = meshb->in;
  PetscInt64 version, next;

  in->binary = PETSC_TRUE;
  if (!EqmMeshbReadMagic(in->start, EqmRemaining(in), &meshb->big_endian, &version)) {
    return EqmReject(in, EQM_ERR_IO, "a .meshb file begins with 1, its version (1 to 4) and its dimension");
  }
  in->cursor += 12;
  meshb->integer = integer[version];
  meshb->offset = offset[version];
  meshb->real = version == 1 ? EQM_SCALAR_FLOAT32 : EQM_SCALAR_FLOAT64;
  EqmTry(EqmMeshbTakeInteger(meshb, meshb->offset, "dimension", &next));
  EqmTry(EqmMeshbTakeInteger(meshb, EQM_SCALAR_INT32, "dimension", &meshb->dimension));
  if (meshb->dimension == 2 || meshb->dimension == 3) return 0;
  return EqmReject(in, EQM_ERR_IO, "dimension %lld: only 2 and 3 are known", (long long)meshb->dimension);
}
