/* Medit's .meshb, the binary form, versions 1 to 4, of either byte order: blocks of a keyword's code, the offset of the
   next block, a count and records. */
#include "format.h"
#include "medit.h"
#include "stream.h"
#include "scalar.h"

enum { CODE_DIMENSION = 3, CODE_VERTICES = 4, CODE_END = 54 };

typedef struct {
  EqmInput *in;
  EqmBuilder builder;
  PetscBool big_endian;
  EqmScalarType integer, offset, real; /* of this version */
  PetscInt64 dimension;
} Meshb;

/* Byte order and version; PETSC_FALSE if these are not the first bytes of a .meshb file. */
static PetscBool ReadMagic(const char *bytes, size_t length, PetscBool *big_endian, PetscInt64 *version)
{
  if (length < 12) return PETSC_FALSE;
  *big_endian = EqmLoadInteger(bytes, EQM_SCALAR_INT32, PETSC_TRUE) == 1 ? PETSC_TRUE : PETSC_FALSE;
  *version = EqmLoadInteger(bytes + 4, EQM_SCALAR_INT32, *big_endian);
  return EqmLoadInteger(bytes, EQM_SCALAR_INT32, *big_endian) == 1 && *version >= 1 && *version <= 4 &&
                 EqmLoadInteger(bytes + 8, EQM_SCALAR_INT32, *big_endian) == CODE_DIMENSION
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* The number 1, a version, and the keyword Dimension. Not collective. */
static PetscBool RecogniseMeshb(const char *bytes, size_t length)
{
  PetscBool big_endian;
  PetscInt64 version;

  return ReadMagic(bytes, length, &big_endian, &version);
}

static PetscErrorCode TakeInteger(Meshb *meshb, EqmScalarType type, const char *what, PetscInt64 *value)
{
  const char *bytes;

  EqmTry(EqmTakeBytes(meshb->in, EqmScalarSize(type), what, &bytes));
  *value = EqmLoadInteger(bytes, type, meshb->big_endian);
  return 0;
}

/* The number of records, and their bytes if the file holds them. */
static PetscErrorCode TakeRecords(Meshb *meshb, const char *what, size_t record_bytes, PetscInt64 *count,
                                  const char **records)
{
  EqmTry(TakeInteger(meshb, meshb->integer, what, count));
  if (*count < 0 || (size_t)*count > EqmRemaining(meshb->in) / record_bytes) {
    return EqmReject(meshb->in, EQM_ERR_IO, "%lld %s are announced, but the file is too short: it is truncated",
                     (long long)*count, what);
  }
  return EqmTakeBytes(meshb->in, (size_t)*count * record_bytes, what, records);
}

static PetscErrorCode ParseVertices(Meshb *meshb)
{
  const size_t real_bytes = EqmScalarSize(meshb->real);
  const size_t record_bytes = (size_t)meshb->dimension * real_bytes + EqmScalarSize(meshb->integer);
  const char *records;
  PetscInt64 count;
  PetscReal *x;

  if (meshb->builder.num_vertices) return EqmReject(meshb->in, EQM_ERR_IO, "a second block of vertices");
  EqmTry(TakeRecords(meshb, "vertices", record_bytes, &count, &records));
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

static PetscErrorCode ParseCells(Meshb *meshb, const EqmMeditKind *kind)
{
  const size_t bytes = EqmScalarSize(meshb->integer), record_bytes = (size_t)(kind->num_corners + 1) * bytes;
  const char *records;
  PetscInt64 count, corners[EQM_MEDIT_MAX_CORNERS];

  EqmTry(TakeRecords(meshb, kind->keyword, record_bytes, &count, &records));
  EqmTry(EqmMeditStartCells(&meshb->builder, kind, count));
  for (PetscInt64 i = 0; kind->wanted && i < count; ++i) {
    for (PetscInt k = 0; k < kind->num_corners; ++k) {
      const char *const corner = records + (size_t)i * record_bytes + (size_t)k * bytes;

      corners[k] = EqmLoadInteger(corner, meshb->integer, meshb->big_endian);
    }
    EqmTry(EqmMeditAddCell(&meshb->builder, kind, corners,
                           EqmLoadInteger(records + (size_t)(i + 1) * record_bytes - bytes, meshb->integer,
                                          meshb->big_endian)));
  }
  return 0;
}

static PetscErrorCode ParseHeader(Meshb *meshb)
{
  static const EqmScalarType integer[5] = {0, EQM_SCALAR_INT32, EQM_SCALAR_INT32, EQM_SCALAR_INT32, EQM_SCALAR_INT64};
  static const EqmScalarType offset[5] = {0, EQM_SCALAR_INT32, EQM_SCALAR_INT32, EQM_SCALAR_INT64, EQM_SCALAR_INT64};
  EqmInput *const in = meshb->in;
  PetscInt64 version, next;

  in->binary = PETSC_TRUE;
  if (!ReadMagic(in->start, EqmRemaining(in), &meshb->big_endian, &version)) {
    return EqmReject(in, EQM_ERR_IO, "a .meshb file begins with 1, its version (1 to 4) and its dimension");
  }
  in->cursor += 12;
  meshb->integer = integer[version];
  meshb->offset = offset[version];
  meshb->real = version == 1 ? EQM_SCALAR_FLOAT32 : EQM_SCALAR_FLOAT64;
  EqmTry(TakeInteger(meshb, meshb->offset, "dimension", &next));
  EqmTry(TakeInteger(meshb, EQM_SCALAR_INT32, "dimension", &meshb->dimension));
  if (meshb->dimension == 2 || meshb->dimension == 3) return 0;
  return EqmReject(in, EQM_ERR_IO, "dimension %lld: only 2 and 3 are known", (long long)meshb->dimension);
}

static PetscErrorCode ParseBlocks(Meshb *meshb)
{
  EqmInput *const in = meshb->in;
  PetscInt64 code, next;

  EqmTry(ParseHeader(meshb));
  for (;;) {
    EqmTry(TakeInteger(meshb, EQM_SCALAR_INT32, "next keyword", &code));
    if (code == CODE_END) return 0;
    EqmTry(TakeInteger(meshb, meshb->offset, "offset of the next keyword", &next));
    if (next <= in->cursor - in->start || next > in->end - in->start) {
      return EqmReject(in, EQM_ERR_IO, "the next keyword cannot be at byte %lld: the file is truncated or damaged",
                       (long long)next);
    }
    if (code == CODE_VERTICES) EqmTry(ParseVertices(meshb));
    for (int k = 0; k < EQM_MEDIT_NUM_KINDS; ++k) {
      if (code == EqmMeditKinds[k].code) EqmTry(ParseCells(meshb, &EqmMeditKinds[k]));
    }
    if (in->cursor > in->start + next) {
      return EqmReject(in, EQM_ERR_IO, "a block runs into the next one at byte %lld: the file is damaged",
                       (long long)next);
    }
    in->cursor = in->start + next;
  }
}

/* Read a .meshb file. See EqmParser. */
static PetscErrorCode ParseMeshb(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error,
                                 size_t error_length)
{
  EqmInput in;
  Meshb meshb = {.in = &in};

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmBuilderOpen(&meshb.builder, &in);
  return EqmBuilderFinish(&meshb.builder, ParseBlocks(&meshb), mesh);
}

/* The beginning of a block of version 3 with `count` records; moves `offset`, where the block begins, behind it. */
static void StartBlock(EqmAtomicFile *file, int32_t code, PetscInt count, size_t record_bytes, int64_t *offset)
{
  const int32_t number = (int32_t)count;

  *offset += 16 + (int64_t)record_bytes * count;
  EqmAtomicWrite(file, &code, 4);
  EqmAtomicWrite(file, offset, 8);
  EqmAtomicWrite(file, &number, 4);
}

/* Write a .meshb file of version 3 (doubles, 64-bit offsets); reference numbers are those of the groups, 0 elsewhere.
   See EqmStreamWriter. */
static PetscErrorCode WriteMeshb(EqmAtomicFile *file, EqmMeshStream *stream, char *error, size_t error_length)
{
  const EqmSerialMesh *const mesh = &stream->mesh;
  const PetscInt group = EqmStreamIndexOf(stream, EqmFieldGroup(stream->fields, stream->num_fields));
  const PetscInt size = mesh->cell_size;
  const int32_t head[3] = {1, 3, CODE_DIMENSION}, dimension = 3, zero = 0, end = CODE_END;
  const int64_t nowhere = 0;
  int64_t offset = 24;

  EqmTry(EqmRequireSmall(mesh, ".meshb", error, error_length));
  EqmAtomicWrite(file, head, sizeof(head));
  EqmAtomicWrite(file, &offset, 8);
  EqmAtomicWrite(file, &dimension, 4);
  StartBlock(file, CODE_VERTICES, mesh->num_vertices, 28, &offset);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicWrite(file, EqmStreamVertex(stream, i), 24);
    EqmAtomicWrite(file, &zero, 4);
  }
  StartBlock(file, size == 3 ? 6 : 8, mesh->num_cells, 4 * ((size_t)size + 1), &offset);
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    const PetscInt *const cell = EqmStreamCell(stream, i);
    int32_t record[5] = {0, 0, 0, 0, 0};

    for (PetscInt k = 0; k < size; ++k) record[k] = (int32_t)cell[k] + 1;
    record[size] = EqmStreamGroup(stream, group, i);
    EqmAtomicWrite(file, record, 4 * ((size_t)size + 1));
  }
  EqmAtomicWrite(file, &end, 4);
  EqmAtomicWrite(file, &nowhere, 8);
  return 0;
}

EQM_DEFINE_FORMAT(Meshb) = {.name = "Medit meshb",
                            .suffixes = "meshb",
                            .recognise = RecogniseMeshb,
                            .parse = ParseMeshb,
                            .write_stream = WriteMeshb,
                            .groups = PETSC_TRUE};
