/* Medit's .meshb of which every rank reads a share of the records. */
#include "meshb.h"

/* A block whose records are read, and where these begin. */
typedef struct {
  PetscInt64 kind; /* place in EqmMeditKinds; -1: vertices */
  PetscInt64 first, count;
} Block;

enum { MOST_BLOCKS = 256 }; /* of a file: others are left to one rank */

/* On rank 0: the next block at `*at`, which moves behind it. False: it is not as it should be. */
static PetscBool LookAtBlock(const EqmMeshb *meshb, EqmFileWindow *window, PetscInt64 *at, PetscInt64 *code,
                             Block *block)
{
  const size_t offset_bytes = EqmScalarSize(meshb->offset), number_bytes = EqmScalarSize(meshb->integer);
  const PetscInt64 begin = *at + 4 + (PetscInt64)offset_bytes;
  const char *bytes = EqmFileWindowAt(window, *at, 4);

  if (!bytes) return PETSC_FALSE;
  *code = EqmLoadInteger(bytes, EQM_SCALAR_INT32, meshb->big_endian);
  if (*code == EQM_MESHB_END) return PETSC_TRUE;
  bytes = EqmFileWindowAt(window, *at + 4, offset_bytes);
  if (!bytes) return PETSC_FALSE;
  *at = EqmLoadInteger(bytes, meshb->offset, meshb->big_endian);
  if (*at <= begin || *at > window->file->length) return PETSC_FALSE;
  *block = (Block){.kind = EQM_MEDIT_NUM_KINDS, .first = begin + (PetscInt64)number_bytes};
  if (*code == EQM_MESHB_VERTICES) block->kind = -1;
  for (int k = 0; k < EQM_MEDIT_NUM_KINDS; ++k) {
    if (*code == EqmMeditKinds[k].code) block->kind = k;
  }
  if (block->kind == EQM_MEDIT_NUM_KINDS) return PETSC_TRUE;
  bytes = EqmFileWindowAt(window, begin, number_bytes);
  if (!bytes) return PETSC_FALSE;
  block->count = EqmLoadInteger(bytes, meshb->integer, meshb->big_endian);
  const size_t record =
      block->kind < 0 ? EqmMeshbBytesOfVertex(meshb) : EqmMeshbBytesOfCell(meshb, &EqmMeditKinds[block->kind]);

  return block->count >= 0 && block->count <= (*at - block->first) / (PetscInt64)record ? PETSC_TRUE : PETSC_FALSE;
}

/* The blocks of a file whose header has been read, on every rank; -1: one rank shall read it. Collective. */
static PetscErrorCode FindBlocks(const EqmMeshb *meshb, const EqmPartFile *file, PetscInt64 at, PetscInt64 *num,
                                 Block block[MOST_BLOCKS])
{
  EqmFileWindow window = {.file = file};
  PetscInt64 code = 0;

  PetscFunctionBegin;
  *num = 0;
  for (PetscInt64 tried = 0; file->rank == 0 && *num >= 0; ++tried) {
    if (tried == MOST_BLOCKS || !LookAtBlock(meshb, &window, &at, &code, &block[*num])) *num = -1;
    if (*num < 0 || code == EQM_MESHB_END) break;
    *num += block[*num].kind < EQM_MEDIT_NUM_KINDS;
  }
  PetscCall(EqmFileWindowReset(&window));
  PetscCallMPI(MPI_Bcast(num, 1, MPIU_INT64, 0, file->comm));
  if (*num > 0) PetscCallMPI(MPI_Bcast(block, 3 * (PetscMPIInt)*num, MPIU_INT64, 0, file->comm));
  PetscFunctionReturn(0);
}

/* The blocks of vertices (dimension 0) or of cells of a dimension: this rank's share of all their records. */
static PetscErrorCode ReadShare(EqmMeshb *meshb, const EqmPartFile *file, PetscInt64 num, const Block *block,
                                PetscInt dimension)
{
  PetscInt64 total = 0, before = 0, own_first, own_count;
  PetscErrorCode code = 0;

  for (int pass = 0; pass < 2; ++pass) {
    if (pass) EqmPartFileShare(file, total, &own_first, &own_count);
    for (PetscInt64 b = 0; b < num && !code; ++b) {
      const EqmMeditKind *const kind = block[b].kind < 0 ? NULL : &EqmMeditKinds[block[b].kind];
      const PetscInt64 bytes = (PetscInt64)(kind ? EqmMeshbBytesOfCell(meshb, kind) : EqmMeshbBytesOfVertex(meshb));
      EqmFilePart part;

      if ((kind ? kind->dimension : 0) != dimension || (kind && !kind->wanted)) continue;
      if (!pass) total += block[b].count;
      if (!pass) continue;
      const PetscInt64 low = PetscMax(own_first - before, 0),
                       high = PetscMin(own_first + own_count - before, block[b].count);

      before += block[b].count;
      if (low >= high) continue;
      EqmTry(EqmPartFileBytes(file, block[b].first + low * bytes, (high - low) * bytes, &part));
      code = !part.bytes ? EQM_ERR_IO
             : kind      ? EqmMeshbReadCells(meshb, kind, part.bytes, high - low)
                         : EqmMeshbReadVertices(meshb, part.bytes, high - low);
      EqmTry(PetscFree(part.bytes));
    }
  }
  return code;
}

/* What does not depend on the part: vertices come once and before cells. */
static PetscBool CheckBlocks(EqmMeshb *meshb, PetscInt64 num, const Block *block)
{
  PetscBool has_vertices = PETSC_FALSE;

  for (PetscInt64 b = 0; b < num; ++b) {
    if (block[b].kind < 0) {
      if (has_vertices || block[b].count > PETSC_MAX_INT) return PETSC_FALSE;
      has_vertices = PETSC_TRUE;
      meshb->num_vertices = block[b].count;
    } else if (EqmMeditStartCells(&meshb->builder, &EqmMeditKinds[block[b].kind], meshb->num_vertices,
                                  block[b].count)) {
      return PETSC_FALSE;
    }
  }
  return has_vertices;
}

PetscErrorCode EqmMeshbParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood)
{
  char unused[EQM_MESSAGE_MAX];
  Block block[MOST_BLOCKS];
  PetscInt64 num = 0;
  EqmInput in;
  EqmMeshb meshb = {.in = &in};

  PetscFunctionBegin;
  EqmInputOpen(&in, file->head, file->head_length, unused, sizeof(unused));
  EqmBuilderOpen(&meshb.builder, &in);
  *understood = EqmMeshbParseHeader(&meshb) ? PETSC_FALSE : PETSC_TRUE;
  if (*understood) { /* the same on every rank, as the head is */
    PetscCall(FindBlocks(&meshb, file, in.cursor - in.start, &num, block));
    *understood = num > 0 ? CheckBlocks(&meshb, num, block) : PETSC_FALSE;
  }
  if (*understood) EqmBuilderSetGroup(&meshb.builder, 0);
  for (PetscInt dimension = 0; dimension <= 3 && *understood; ++dimension) {
    if (ReadShare(&meshb, file, num, block, dimension)) *understood = PETSC_FALSE;
  }
  PetscCall(EqmBuilderFinishPart(&meshb.builder, file->comm, understood, mesh));
  PetscFunctionReturn(0);
}
