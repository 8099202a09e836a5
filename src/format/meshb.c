/* Medit's .meshb, the binary form, versions 1 to 4, of either byte order: blocks of a keyword's code, the offset of the
   next block, a count and records. */
#include "format.h"
#include "meshb.h"
#include "stream.h"

/* The number 1, a version, and the keyword Dimension. Not collective. */
static PetscBool RecogniseMeshb(const char *bytes, size_t length)
{
  PetscBool big_endian;
  PetscInt64 version;

  return EqmMeshbReadMagic(bytes, length, &big_endian, &version);
}

/* The number of records, and their bytes if the file holds them. */
static PetscErrorCode TakeRecords(EqmMeshb *meshb, const char *what, size_t record_bytes, PetscInt64 *count,
                                  const char **records)
{
  EqmTry(EqmMeshbTakeInteger(meshb, meshb->integer, what, count));
  if (*count < 0 || (size_t)*count > EqmRemaining(meshb->in) / record_bytes) {
    return EqmReject(meshb->in, EQM_ERR_IO, "%lld %s are announced, but the file is too short: it is truncated",
                     (long long)*count, what);
  }
  return EqmTakeBytes(meshb->in, (size_t)*count * record_bytes, what, records);
}

static PetscErrorCode ParseVertices(EqmMeshb *meshb)
{
  const char *records;

  if (meshb->builder.num_vertices) return EqmReject(meshb->in, EQM_ERR_IO, "a second block of vertices");
  EqmTry(TakeRecords(meshb, "vertices", EqmMeshbBytesOfVertex(meshb), &meshb->num_vertices, &records));
  return EqmMeshbReadVertices(meshb, records, meshb->num_vertices);
}

static PetscErrorCode ParseCells(EqmMeshb *meshb, const EqmMeditKind *kind)
{
  const char *records;
  PetscInt64 count;

  EqmTry(TakeRecords(meshb, kind->keyword, EqmMeshbBytesOfCell(meshb, kind), &count, &records));
  EqmTry(EqmMeditStartCells(&meshb->builder, kind, meshb->num_vertices, count));
  return kind->wanted ? EqmMeshbReadCells(meshb, kind, records, count) : 0;
}

static PetscErrorCode ParseBlocks(EqmMeshb *meshb)
{
  EqmInput *const in = meshb->in;
  PetscInt64 code, next;

  EqmTry(EqmMeshbParseHeader(meshb));
  for (;;) {
    EqmTry(EqmMeshbTakeInteger(meshb, EQM_SCALAR_INT32, "next keyword", &code));
    if (code == EQM_MESHB_END) return 0;
    EqmTry(EqmMeshbTakeInteger(meshb, meshb->offset, "offset of the next keyword", &next));
    if (next <= in->cursor - in->start || next > in->end - in->start) {
      return EqmReject(in, EQM_ERR_IO, "the next keyword cannot be at byte %lld: the file is truncated or damaged",
                       (long long)next);
    }
    if (code == EQM_MESHB_VERTICES) EqmTry(ParseVertices(meshb));
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
  EqmMeshb meshb = {.in = &in};

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
  const int32_t head[3] = {1, 3, EQM_MESHB_DIMENSION}, dimension = 3, zero = 0, end = EQM_MESHB_END;
  const int64_t nowhere = 0;
  int64_t offset = 24;

  EqmTry(EqmRequireSmall(mesh, ".meshb", error, error_length));
  EqmAtomicWrite(file, head, sizeof(head));
  EqmAtomicWrite(file, &offset, 8);
  EqmAtomicWrite(file, &dimension, 4);
  StartBlock(file, EQM_MESHB_VERTICES, mesh->num_vertices, 28, &offset);
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
                            .parse_part = EqmMeshbParsePart,
                            .write_stream = WriteMeshb,
                            .groups = PETSC_TRUE};
