/* Medit's .mesh, as text: sections of a keyword, a count and lines that end with a reference number. Vertices count
   from 1. Sections that are no vertices, triangles or tetrahedra are passed over. */
#include "format.h"
#include "medit_part.h"
#include "stream.h"

#include <ctype.h>

typedef struct {
  EqmInput *in;
  EqmBuilder builder;
  PetscInt64 dimension;
} Medit;

static PetscErrorCode ParseDimension(Medit *medit)
{
  EqmTry(EqmMeditReadInteger(medit->in, "Dimension", &medit->dimension));
  if (medit->dimension == 2 || medit->dimension == 3) return 0;
  return EqmReject(medit->in, EQM_ERR_IO, "dimension %lld: only 2 and 3 are known", (long long)medit->dimension);
}

static PetscErrorCode ParseVertices(Medit *medit)
{
  EqmInput *const in = medit->in;
  PetscInt64 count;

  if (!medit->dimension) return EqmReject(in, EQM_ERR_IO, "the section Vertices comes before Dimension");
  if (medit->builder.num_vertices) return EqmReject(in, EQM_ERR_IO, "a second section Vertices");
  EqmSkipSpace(in, '#');
  EqmTry(EqmReadCount(in, "vertices", 2 * (size_t)medit->dimension + 2, &count));
  return EqmMeditReadVertices(&medit->builder, medit->dimension, count);
}

static PetscErrorCode ParseCells(Medit *medit, const EqmMeditKind *kind)
{
  const PetscInt64 num_vertices = (PetscInt64)medit->builder.num_vertices;
  PetscInt64 count;

  EqmSkipSpace(medit->in, '#');
  EqmTry(EqmReadCount(medit->in, kind->keyword, 2 * (size_t)kind->num_corners + 2, &count));
  EqmTry(EqmMeditStartCells(&medit->builder, kind, num_vertices, count));
  return kind->wanted ? EqmMeditReadCells(&medit->builder, kind, num_vertices, count) : 0;
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
                            .recognise = EqmMeditBegins,
                            .parse = ParseMedit,
                            .parse_part = EqmMeditParsePart,
                            .write_stream = WriteMedit,
                            .groups = PETSC_TRUE};
