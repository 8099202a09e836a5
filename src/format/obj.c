/* Wavefront OBJ: `v x y z`, `vt u v` and `f a/b/c ...` lines; everything else (normals, groups, materials) is skipped.
 */
#include "builder.h"
#include "format.h"
#include "seam.h"

#include <string.h>

/* The keywords of OBJ: a file with other first words is no OBJ file. */
static PetscBool IsKeyword(const char *word, size_t length)
{
  static const char *const keyword[] = {"v",      "vt",     "vn",     "vp",   "f",      "p",      "l",
                                        "g",      "o",      "s",      "mg",   "mtllib", "usemtl", "#",
                                        "usemap", "maplib", "cstype", "deg",  "bmat",   "step",   "curv",
                                        "curv2",  "surf",   "parm",   "trim", "hole",   "end"};

  for (size_t i = 0; i < sizeof(keyword) / sizeof(keyword[0]); ++i) {
    if (strlen(keyword[i]) == length && !memcmp(keyword[i], word, length)) return PETSC_TRUE;
  }
  return length && word[0] == '#' ? PETSC_TRUE : PETSC_FALSE;
}

/* A weak guess, since OBJ has no magic: the first statement is one that OBJ has. Not collective. */
static PetscBool RecogniseObj(const char *bytes, size_t length)
{
  EqmInput in;
  char unused[8];
  const char *word;
  size_t word_length;

  EqmInputOpen(&in, bytes, length, unused, sizeof(unused));
  EqmSkipMark(&in);
  EqmSkipSpace(&in, '#');
  word_length = EqmReadWord(&in, &word);
  return word_length && !EqmAtLineEnd(&in) && IsKeyword(word, word_length) ? PETSC_TRUE : PETSC_FALSE;
}

/* The largest index of the file; faces may come before the vertices that they name. */
typedef struct {
  PetscInt64 index;
  const char *position;
} Largest;

static PetscErrorCode ParseVertex(EqmInput *in, EqmBuilder *builder)
{
  PetscReal *x;

  EqmTry(EqmBuilderAddVertices(builder, 1, &x));
  for (PetscInt k = 0; k < 3; ++k) {
    if (!EqmReadReal(in, &x[k])) return EqmReject(in, EQM_ERR_IO, "a vertex needs three numbers after the v");
  }
  return 0;
}

/* `vt u` or `vt u v`; a third number, of textures in space, is not read. */
static PetscErrorCode ParseTexturePoint(EqmInput *in, EqmBuilder *builder)
{
  PetscReal *uv;

  EqmTry(EqmBuilderAddTexturePoints(builder, 1, &uv));
  uv[0] = uv[1] = 0.0;
  if (!EqmReadReal(in, &uv[0])) return EqmReject(in, EQM_ERR_IO, "a texture point needs two numbers after the vt");
  (void)EqmReadReal(in, &uv[1]);
  return 0;
}

/* One corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative indices count back from the last vertex so far. */
static PetscErrorCode ParseCorner(EqmInput *in, EqmBuilder *builder, PetscInt64 *corner)
{
  const PetscInt64 num_vertices = (PetscInt64)builder->num_vertices;
  const char *next = EqmParseInteger(in->cursor, in->end, corner), *after;
  PetscInt64 texture = 0;

  if (!next || (next < in->end && !EqmIsSpace(*next) && *next != '/')) {
    return EqmReject(in, EQM_ERR_IO, "a corner of a face must be a vertex index, or indices separated by slashes");
  }
  if (*corner == 0 || *corner < -num_vertices || *corner > PETSC_MAX_INT) {
    return EqmReject(in, EQM_ERR_IO, "vertex index %lld is out of range 1..%lld", (long long)*corner,
                     (long long)num_vertices);
  }
  *corner = *corner > 0 ? *corner - 1 : *corner + num_vertices;
  after = next < in->end && *next == '/' ? EqmParseInteger(next + 1, in->end, &texture) : NULL;
  if (!after) texture = 0;
  if (texture < 0) texture += (PetscInt64)builder->num_texture_points + 1;
  in->cursor = next;
  while (in->cursor < in->end && !EqmIsSpace(*in->cursor)) ++in->cursor;
  return EqmBuilderAddCorner(builder, *corner, texture - 1);
}

/* A backslash at the end of a line continues it. */
static void SkipContinuation(EqmInput *in)
{
  EqmSkipBlanks(in);
  while (EqmRemaining(in) > 1 && in->cursor[0] == '\\' && (in->cursor[1] == '\n' || in->cursor[1] == '\r')) {
    EqmSkipLine(in);
    EqmSkipBlanks(in);
  }
}

static PetscErrorCode ParseFace(EqmInput *in, EqmBuilder *builder, Largest *largest)
{
  const char *position = in->cursor;

  EqmBuilderStartFace(builder);
  for (SkipContinuation(in); !EqmAtLineEnd(in) && *in->cursor != '#'; SkipContinuation(in)) {
    PetscInt64 corner;

    EqmTry(ParseCorner(in, builder, &corner));
    if (corner > largest->index) *largest = (Largest){corner, position};
  }
  return EqmBuilderEndFace(builder, position, PETSC_MAX_INT);
}

static PetscErrorCode ParseStatement(EqmInput *in, EqmBuilder *builder, Largest *largest, PetscBool *foreign)
{
  const char *word;
  size_t length = EqmReadWord(in, &word);

  if (length == 1 && *word == 'v') {
    EqmTry(ParseVertex(in, builder));
  } else if (length == 2 && !memcmp(word, "vt", 2)) {
    EqmTry(ParseTexturePoint(in, builder));
  } else if (length == 1 && *word == 'f') {
    EqmTry(ParseFace(in, builder, largest));
  } else if (length && !IsKeyword(word, length)) {
    *foreign = PETSC_TRUE;
    for (size_t i = 0; i < length; ++i) {
      if ((unsigned char)word[i] < ' ')
        return EqmRejectAt(in, word, EQM_ERR_IO, "binary bytes: this is not an OBJ file");
    }
  }
  return 0;
}

static PetscErrorCode ParseStatements(EqmInput *in, EqmBuilder *builder)
{
  Largest largest = {-1, in->start};
  PetscBool foreign = PETSC_FALSE;

  EqmSkipMark(in);
  while (in->cursor < in->end) {
    EqmTry(ParseStatement(in, builder, &largest, &foreign));
    EqmSkipLine(in);
  }
  if (foreign && !builder->num_vertices) {
    return EqmRejectAt(in, in->start, EQM_ERR_IO,
                       "this is not an OBJ file: it has no vertices (lines that begin with v)");
  }
  if (largest.index >= (PetscInt64)builder->num_vertices) {
    return EqmRejectAt(in, largest.position, EQM_ERR_IO, "vertex index %lld is out of range 1..%lld",
                       (long long)largest.index + 1, (long long)builder->num_vertices);
  }
  return 0;
}

/* Read an OBJ file. See EqmParser. */
static PetscErrorCode ParseObj(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  EqmInput in;
  EqmBuilder builder;

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmBuilderOpen(&builder, &in);
  return EqmBuilderFinish(&builder, ParseStatements(&in, &builder), mesh);
}

/* Texture points, one for each different pair of a vertex and a point, and faces that name both. */
static PetscErrorCode WriteTexturedFaces(EqmAtomicFile *file, const EqmSerialMesh *mesh)
{
  EqmSeams seams;

  EqmTry(EqmSeamsFind(mesh->num_vertices, mesh->num_cells, mesh->cells, mesh->texture, &seams));
  for (PetscInt i = 0; i < seams.num; ++i) {
    EqmAtomicWrite(file, "vt ", 3);
    EqmAtomicPrintReals(file, 2, seams.point + 2 * (size_t)i, ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  for (size_t i = 0; i < 3 * (size_t)mesh->num_cells; ++i) {
    EqmAtomicPrint(file, "%s%lld/%lld%s", i % 3 ? " " : "f ", (long long)mesh->cells[i] + 1,
                   (long long)seams.corner[i] + 1, i % 3 == 2 ? "\n" : "");
  }
  return EqmSeamsReset(&seams);
}

/* Write an OBJ file. See EqmWriter. */
static PetscErrorCode WriteObj(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                               PetscInt num_fields, char *error, size_t error_length)
{
  EqmTry(EqmRequireTriangles(mesh, "OBJ", error, error_length));
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicWrite(file, "v ", 2);
    EqmAtomicPrintReals(file, 3, mesh->vertices + 3 * (size_t)i, ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  if (mesh->texture) return WriteTexturedFaces(file, mesh);
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    const PetscInt *cell = mesh->cells + 3 * (size_t)i;

    EqmAtomicPrint(file, "f %lld %lld %lld\n", (long long)cell[0] + 1, (long long)cell[1] + 1, (long long)cell[2] + 1);
  }
  return 0;
}

EQM_DEFINE_FORMAT(Obj) = {.name = "OBJ",
                          .suffixes = "obj",
                          .recognise = RecogniseObj,
                          .parse = ParseObj,
                          .write = WriteObj,
                          .writes_texture = PETSC_TRUE};
