/* Medit's .mesh, as text: sections of a keyword, a count and lines that end with a reference number. Vertices count
   from 1. Sections that are no vertices, triangles or tetrahedra are passed over. */
#include "format.h"
#include "medit.h"
#include "stream.h"

#include <ctype.h>

const EqmMeditKind EqmMeditKinds[EQM_MEDIT_NUM_KINDS] = {
    {"Triangles", 6, 2, 3, PETSC_TRUE},   {"Quadrilaterals", 7, 2, 4, PETSC_TRUE},
    {"Tetrahedra", 8, 3, 4, PETSC_TRUE},  {"Prisms", 9, 3, 6, PETSC_FALSE},
    {"Hexahedra", 10, 3, 8, PETSC_FALSE}, {"TrianglesP2", 24, 2, 6, PETSC_FALSE},
    {"Pyramids", 49, 3, 5, PETSC_FALSE},  {"TetrahedraP2", 30, 3, 10, PETSC_FALSE},
};

typedef struct {
  EqmInput *in;
  EqmBuilder builder;
  PetscInt64 dimension;
} Medit;

/* The first keyword, after comments. Not collective. */
static PetscBool RecogniseMedit(const char *bytes, size_t length)
{
  EqmInput in;
  char unused[8];

  EqmInputOpen(&in, bytes, length, unused, sizeof(unused));
  EqmSkipMark(&in);
  EqmSkipSpace(&in, '#');
  return EqmReadKeyword(&in, "MeshVersionFormatted");
}

/* EqmMeditStartCells - `count` cells begin at the cursor; a kind that is not wanted is noted. Not collective. Errors:
   EQM_ERR_IO (quiet) if the vertices are not known yet. */
PetscErrorCode EqmMeditStartCells(EqmBuilder *builder, const EqmMeditKind *kind, PetscInt64 count)
{
  char what[64];

  if (!kind->wanted) {
    snprintf(what, sizeof(what), "%lld %s", (long long)count, kind->keyword);
    if (count) EqmBuilderNoteOther(builder, kind->dimension, builder->in->cursor, what);
    return 0;
  }
  if (builder->num_vertices || !count) return 0;
  return EqmReject(builder->in, EQM_ERR_IO, "the section %s comes before the section Vertices", kind->keyword);
}

/* EqmMeditAddCell - append a cell of a wanted kind by the file's vertex numbers, which count from 1, and its reference
   number. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmMeditAddCell(EqmBuilder *builder, const EqmMeditKind *kind, const PetscInt64 *vertices,
                               PetscInt64 reference)
{
  PetscInt64 corners[EQM_MEDIT_MAX_CORNERS];
  PetscInt *cell;

  for (PetscInt k = 0; k < kind->num_corners; ++k) {
    if (vertices[k] < 1 || vertices[k] > (PetscInt64)builder->num_vertices) {
      return EqmReject(builder->in, EQM_ERR_IO, "%s: vertex number %lld is out of range 1..%zu", kind->keyword,
                       (long long)vertices[k], builder->num_vertices);
    }
    corners[k] = vertices[k] - 1;
  }
  EqmBuilderSetGroup(builder, reference);
  if (kind->dimension == 2)
    return EqmBuilderAddFace(builder, NULL, (PetscInt64)builder->num_vertices, kind->num_corners, corners);
  EqmTry(EqmBuilderAddCells(builder, kind->num_corners, 1, &cell));
  for (PetscInt k = 0; k < kind->num_corners; ++k) cell[k] = (PetscInt)corners[k];
  return 0;
}

static PetscErrorCode ReadInteger(Medit *medit, const char *what, PetscInt64 *value)
{
  EqmSkipSpace(medit->in, '#');
  if (EqmReadInteger(medit->in, value)) return 0;
  return EqmReject(medit->in, EQM_ERR_IO, "%s: a whole number is missing%s", what,
                   medit->in->cursor == medit->in->end ? ": the file is truncated" : "");
}

static PetscErrorCode ParseDimension(Medit *medit)
{
  EqmTry(ReadInteger(medit, "Dimension", &medit->dimension));
  if (medit->dimension == 2 || medit->dimension == 3) return 0;
  return EqmReject(medit->in, EQM_ERR_IO, "dimension %lld: only 2 and 3 are known", (long long)medit->dimension);
}

static PetscErrorCode ParseVertices(Medit *medit)
{
  EqmInput *const in = medit->in;
  PetscInt64 count, reference;
  PetscReal *x;

  if (!medit->dimension) return EqmReject(in, EQM_ERR_IO, "the section Vertices comes before Dimension");
  if (medit->builder.num_vertices) return EqmReject(in, EQM_ERR_IO, "a second section Vertices");
  EqmSkipSpace(in, '#');
  EqmTry(EqmReadCount(in, "vertices", 2 * (size_t)medit->dimension + 2, &count));
  EqmTry(EqmBuilderAddVertices(&medit->builder, (size_t)count, &x));
  for (PetscInt64 i = 0; i < count; ++i) {
    x[3 * i + 2] = 0.0; /* of the plane */
    for (PetscInt64 k = 0; k < medit->dimension; ++k) {
      EqmSkipSpace(in, '#');
      if (!EqmReadReal(in, &x[3 * i + k])) {
        return EqmReject(in, EQM_ERR_IO, "vertex %lld of %lld needs %lld coordinates%s", (long long)i, (long long)count,
                         (long long)medit->dimension, in->cursor == in->end ? ": the file is truncated" : "");
      }
    }
    EqmTry(ReadInteger(medit, "Vertices", &reference));
  }
  return 0;
}

static PetscErrorCode ParseCells(Medit *medit, const EqmMeditKind *kind)
{
  PetscInt64 count, reference, corners[EQM_MEDIT_MAX_CORNERS];

  EqmSkipSpace(medit->in, '#');
  EqmTry(EqmReadCount(medit->in, kind->keyword, 2 * (size_t)kind->num_corners + 2, &count));
  EqmTry(EqmMeditStartCells(&medit->builder, kind, count));
  for (PetscInt64 i = 0; kind->wanted && i < count; ++i) {
    for (PetscInt k = 0; k < kind->num_corners; ++k) EqmTry(ReadInteger(medit, kind->keyword, &corners[k]));
    EqmTry(ReadInteger(medit, kind->keyword, &reference));
    EqmTry(EqmMeditAddCell(&medit->builder, kind, corners, reference));
  }
  return 0;
}

/* Move over numbers, to the next keyword or the end. */
static void SkipNumbers(EqmInput *in)
{
  const char *word;

  for (EqmSkipSpace(in, '#'); in->cursor < in->end && !isalpha((unsigned char)*in->cursor); EqmSkipSpace(in, '#')) {
    (void)EqmReadWord(in, &word);
  }
}

static PetscErrorCode ParseSections(Medit *medit)
{
  EqmInput *const in = medit->in;

  EqmSkipMark(in);
  EqmSkipSpace(in, '#');
  if (!EqmReadKeyword(in, "MeshVersionFormatted")) {
    return EqmReject(in, EQM_ERR_IO, "a .mesh file of Medit begins with MeshVersionFormatted");
  }
  for (SkipNumbers(in); in->cursor < in->end; SkipNumbers(in)) {
    const EqmMeditKind *kind = NULL;
    const char *word;
    const size_t length = EqmReadWord(in, &word);

    if (EqmWordIs(word, length, "End")) return 0;
    for (int k = 0; k < EQM_MEDIT_NUM_KINDS; ++k) {
      if (EqmWordIs(word, length, EqmMeditKinds[k].keyword)) kind = &EqmMeditKinds[k];
    }
    if (EqmWordIs(word, length, "Dimension")) {
      EqmTry(ParseDimension(medit));
    } else if (EqmWordIs(word, length, "Vertices")) {
      EqmTry(ParseVertices(medit));
    } else if (kind) {
      EqmTry(ParseCells(medit, kind));
    }
  }
  return EqmReject(in, EQM_ERR_IO, "the keyword End is missing: the file is truncated");
}

/* Read a .mesh file. See EqmParser. */
static PetscErrorCode ParseMedit(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error,
                                 size_t error_length)
{
  EqmInput in;
  Medit medit = {.in = &in};

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmBuilderOpen(&medit.builder, &in);
  return EqmBuilderFinish(&medit.builder, ParseSections(&medit), mesh);
}

/* Write a .mesh file; reference numbers are those of the groups, 0 elsewhere. See EqmStreamWriter. */
static PetscErrorCode WriteMedit(EqmAtomicFile *file, EqmMeshStream *stream, char *error, size_t error_length)
{
  const EqmSerialMesh *const mesh = &stream->mesh;
  const PetscInt group = EqmStreamIndexOf(stream, EqmFieldGroup(stream->fields, stream->num_fields));
  const PetscInt size = mesh->cell_size;

  EqmAtomicPrint(file, "MeshVersionFormatted 2\nDimension 3\n\nVertices\n%lld\n", (long long)mesh->num_vertices);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicPrintReals(file, 3, EqmStreamVertex(stream, i), ' ');
    EqmAtomicWrite(file, " 0\n", 3);
  }
  EqmAtomicPrint(file, "\n%s\n%lld\n", size == 3 ? "Triangles" : "Tetrahedra", (long long)mesh->num_cells);
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    const PetscInt *const cell = EqmStreamCell(stream, i);

    for (PetscInt k = 0; k < size; ++k) EqmAtomicPrint(file, "%lld ", (long long)cell[k] + 1);
    EqmAtomicPrint(file, "%d\n", EqmStreamGroup(stream, group, i));
  }
  EqmAtomicPrint(file, "\nEnd\n");
  return 0;
}

EQM_DEFINE_FORMAT(Medit) = {.name = "Medit mesh",
                            .suffixes = "mesh",
                            .recognise = RecogniseMedit,
                            .parse = ParseMedit,
                            .write_stream = WriteMedit,
                            .groups = PETSC_TRUE};
