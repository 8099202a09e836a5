/* OFF of Geomview, ASCII: also with colours, normals and texture coordinates (COFF, NOFF, STOFF and their mixtures),
   which are passed over. */
#include "builder.h"
#include "format.h"
#include "stream.h"

#include <string.h>
#include <strings.h>

/* Read [ST][C][N]OFF. Geomview's 4OFF and nOFF have vertices in other dimensions. */
static PetscBool ReadMagic(EqmInput *in)
{
  const char *word;
  size_t length = EqmReadWord(in, &word);

  if (length >= 2 && !strncmp(word, "ST", 2)) {
    word += 2;
    length -= 2;
  }
  for (const char *prefix = "CN"; *prefix; ++prefix) {
    if (length && *word == *prefix) {
      ++word;
      --length;
    }
  }
  return length == 3 && !strncmp(word, "OFF", 3) ? PETSC_TRUE : PETSC_FALSE;
}

/* The first word, after comments, is OFF or one of its relatives. Not collective. */
static PetscBool RecogniseOff(const char *bytes, size_t length)
{
  EqmInput in;
  char unused[8];

  EqmInputOpen(&in, bytes, length, unused, sizeof(unused));
  EqmSkipMark(&in);
  EqmSkipSpace(&in, '#');
  return ReadMagic(&in);
}

static PetscErrorCode ParseHeader(EqmInput *in, PetscInt64 *num_vertices, PetscInt64 *num_faces)
{
  EqmSkipMark(in);
  EqmSkipSpace(in, '#');
  if (!ReadMagic(in)) return EqmReject(in, EQM_ERR_IO, "an OFF file begins with OFF, COFF or NOFF");
  if (EqmReadKeyword(in, "BINARY"))
    return EqmReject(in, EQM_ERR_IO, "binary OFF files are not supported: convert to PLY");
  EqmSkipSpace(in, '#');
  EqmTry(EqmReadCount(in, "vertices", 6, num_vertices));
  EqmSkipSpace(in, '#');
  EqmTry(EqmReadCount(in, "faces", 4, num_faces));
  EqmSkipLine(in); /* the number of edges, which is often wrong */
  return 0;
}

static PetscErrorCode ParseVertices(EqmInput *in, PetscInt64 num_vertices, EqmBuilder *builder)
{
  PetscReal *x;

  EqmTry(EqmBuilderAddVertices(builder, (size_t)num_vertices, &x));
  for (PetscInt64 i = 0; i < num_vertices; ++i) {
    EqmSkipSpace(in, '#');
    for (PetscInt k = 0; k < 3; ++k) {
      if (!EqmReadReal(in, &x[3 * i + k])) {
        return EqmReject(in, EQM_ERR_IO, "vertex %lld of %lld needs three numbers%s", (long long)i,
                         (long long)num_vertices, in->cursor == in->end ? ": the file is truncated" : "");
      }
    }
    EqmSkipLine(in); /* colour, normal */
  }
  return 0;
}

/* num_vertices - of the whole file. */
static PetscErrorCode ParseFaces(EqmInput *in, PetscInt64 num_faces, PetscInt64 num_vertices, EqmBuilder *builder)
{
  for (PetscInt64 i = 0; i < num_faces; ++i) {
    PetscInt64 num_corners, corner;
    const char *position;

    EqmSkipSpace(in, '#');
    position = in->cursor;
    if (!EqmReadInteger(in, &num_corners)) {
      return EqmReject(in, EQM_ERR_IO, "face %lld of %lld is missing%s", (long long)i, (long long)num_faces,
                       in->cursor == in->end ? ": the file is truncated" : " its number of corners");
    }
    EqmBuilderStartFace(builder);
    for (PetscInt64 k = 0; k < num_corners; ++k) {
      if (!EqmReadInteger(in, &corner)) {
        return EqmReject(in, EQM_ERR_IO, "face %lld needs %lld vertex indices", (long long)i, (long long)num_corners);
      }
      EqmTry(EqmBuilderAddCorner(builder, corner, -1));
    }
    EqmTry(EqmBuilderEndFace(builder, position, num_vertices));
    EqmSkipLine(in); /* colour */
  }
  return 0;
}

static PetscErrorCode ParseMesh(EqmInput *in, EqmBuilder *builder)
{
  PetscInt64 num_vertices, num_faces;

  EqmTry(ParseHeader(in, &num_vertices, &num_faces));
  EqmTry(ParseVertices(in, num_vertices, builder));
  return ParseFaces(in, num_faces, num_vertices, builder);
}

/* Read an OFF file. See EqmParser. */
static PetscErrorCode ParseOff(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  EqmInput in;
  EqmBuilder builder;

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmBuilderOpen(&builder, &in);
  return EqmBuilderFinish(&builder, ParseMesh(&in, &builder), mesh);
}

/* Move over `count` lines that are neither blank nor comments, and count those there are. */
static PetscInt64 SkipLines(EqmInput *in, PetscInt64 count)
{
  PetscInt64 done = 0;

  for (EqmSkipSpace(in, '#'); done < count && in->cursor < in->end; EqmSkipSpace(in, '#')) {
    EqmSkipLine(in);
    ++done;
  }
  return done;
}

/* This rank's lines from byte `begin` on: vertices first, then faces, each of which has a line. Collective. */
static PetscErrorCode ParseLines(const EqmPartFile *file, PetscInt64 begin, PetscInt64 num_vertices,
                                 PetscInt64 num_faces, EqmBuilder *builder, PetscBool *understood)
{
  EqmInput *const in = builder->in;
  PetscInt64 count, before, total, vertices;
  EqmFilePart part;

  PetscFunctionBegin;
  PetscCall(EqmPartFileLines(file, begin, NULL, &part, understood));
  EqmInputOpen(in, part.bytes, *understood ? part.length : 0, in->error, in->error_length);
  count = SkipLines(in, INT64_MAX);
  in->cursor = in->start;
  PetscCallMPI(MPI_Scan(&count, &before, 1, MPIU_INT64, MPI_SUM, file->comm));
  PetscCall(MPIU_Allreduce(&count, &total, 1, MPIU_INT64, MPI_SUM, file->comm));
  before -= count;
  vertices = PetscMax(0, PetscMin(num_vertices - before, count));
  if (num_vertices > PETSC_MAX_INT || total - num_vertices < num_faces) *understood = PETSC_FALSE;
  count = PetscMax(0, PetscMin(num_vertices + num_faces - before, count) - vertices); /* what follows is no face */
  if (*understood && ParseVertices(in, vertices, builder)) *understood = PETSC_FALSE;
  if (*understood && ParseFaces(in, count, num_vertices, builder)) *understood = PETSC_FALSE;
  PetscCall(PetscFree(part.bytes));
  EqmInputOpen(in, NULL, 0, in->error, in->error_length);
  PetscFunctionReturn(0);
}

/* See EqmPartParser. */
static PetscErrorCode ParseOffPart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood)
{
  char unused[EQM_MESSAGE_MAX];
  PetscInt64 num_vertices, num_faces;
  EqmBuilder builder;
  EqmInput in;

  PetscFunctionBegin;
  EqmInputOpen(&in, file->head, file->head_length, unused, sizeof(unused));
  in.behind = (size_t)file->length - file->head_length;
  EqmBuilderOpen(&builder, &in);
  *understood = ParseHeader(&in, &num_vertices, &num_faces) || in.cursor == in.end ? PETSC_FALSE : PETSC_TRUE;
  if (*understood) { /* the same on every rank, as the head is */
    const PetscInt64 begin = in.cursor - in.start;

    PetscCall(ParseLines(file, begin, num_vertices, num_faces, &builder, understood));
  }
  PetscCall(EqmBuilderFinishPart(&builder, file->comm, understood, mesh));
  PetscFunctionReturn(0);
}

/* Write an OFF file. See EqmStreamWriter. */
static PetscErrorCode WriteOff(EqmAtomicFile *file, EqmMeshStream *stream, char *error, size_t error_length)
{
  const EqmSerialMesh *const mesh = &stream->mesh;

  EqmTry(EqmRequireTriangles(mesh, "OFF", error, error_length));
  EqmAtomicPrint(file, "OFF\n%lld %lld 0\n", (long long)mesh->num_vertices, (long long)mesh->num_cells);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicPrintReals(file, 3, EqmStreamVertex(stream, i), ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    const PetscInt *const cell = EqmStreamCell(stream, i);

    EqmAtomicPrint(file, "3 %lld %lld %lld\n", (long long)cell[0], (long long)cell[1], (long long)cell[2]);
  }
  return 0;
}

EQM_DEFINE_FORMAT(Off) = {.name = "OFF",
                          .suffixes = "off coff noff",
                          .recognise = RecogniseOff,
                          .parse = ParseOff,
                          .parse_part = ParseOffPart,
                          .write_stream = WriteOff};
