/* Wavefront OBJ: `v x y z`, `vt u v` and `f a/b/c ...` lines; `g` and `o` make groups; everything else (normals,
 * materials) is skipped.
 */
#include "builder.h"
#include "mesh/fields.h"
#include "format.h"
#include "metadata.h"
#include "writers.h"

#include <stdio.h>
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

enum { MOST_GROUPS = 1000, LONGEST_GROUP = 128 }; /* of names that are kept */

/* The groups of the file by name; faces of group 0 are in none. */
typedef struct {
  PetscInt64 num, first; /* number of the first name */
  char name[MOST_GROUPS][LONGEST_GROUP];
} Groups;

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

/* The number of a name: what we wrote for unnamed groups has its number in it, others count from `first`. */
static PetscInt64 GroupOfName(const char *name, Groups *groups)
{
  long long number;
  int length = 0;

  if (!strcmp(name, "default")) return 0;
  if (!groups->num && sscanf(name, "group_%lld%n", &number, &length) == 1 && !name[length]) {
    groups->first = MOST_GROUPS + PetscMax(groups->first, PetscMin(number, PETSC_MAX_INT / 2));
    return number;
  }
  for (PetscInt64 k = 0; k < groups->num; ++k) {
    if (!strcmp(name, groups->name[k])) return groups->first + k;
  }
  if (groups->num == MOST_GROUPS) return 0;
  strcpy(groups->name[groups->num], name);
  return groups->first + groups->num++;
}

/* `g name` or `o name`: the faces that follow belong to the group of that name. */
static PetscErrorCode ParseGroup(EqmInput *in, EqmBuilder *builder, Groups *groups)
{
  char text[LONGEST_GROUP];
  const char *name;
  size_t length;

  EqmSkipBlanks(in);
  name = in->cursor;
  while (in->cursor < in->end && *in->cursor != '\n' && *in->cursor != '\r') ++in->cursor;
  for (length = (size_t)(in->cursor - name); length && EqmIsBlank(name[length - 1]);) --length;
  snprintf(text, sizeof(text), "%.*s", (int)PetscMin(length, sizeof(text) - 1), name);
  EqmBuilderSetGroup(builder, text[0] ? GroupOfName(text, groups) : 0);
  return 0;
}

/* The names go on as metadata. */
static PetscErrorCode KeepNames(const Groups *groups, char **metadata)
{
  char key[40];

  for (PetscInt64 k = 0; k < groups->num; ++k) {
    snprintf(key, sizeof(key), EQM_GROUP_KEY, (long long)(groups->first + k));
    EqmTry(EqmMetadataAdd(metadata, key, groups->name[k]));
  }
  return 0;
}

static PetscErrorCode ParseStatement(EqmInput *in, EqmBuilder *builder, Largest *largest, Groups *groups,
                                     PetscBool *foreign)
{
  const char *word;
  size_t length = EqmReadWord(in, &word);

  if (length == 1 && *word == 'v') {
    EqmTry(ParseVertex(in, builder));
  } else if (length == 2 && !memcmp(word, "vt", 2)) {
    EqmTry(ParseTexturePoint(in, builder));
  } else if (length == 1 && *word == 'f') {
    EqmTry(ParseFace(in, builder, largest));
  } else if (length == 1 && (*word == 'g' || *word == 'o')) {
    EqmTry(ParseGroup(in, builder, groups));
  } else if (EqmWordIs(word, length, "vn") || EqmWordIs(word, length, "usemtl")) {
    EqmBuilderNoteLeft(builder, length == 2 ? "normals" : "materials");
  } else if (length && !IsKeyword(word, length)) {
    *foreign = PETSC_TRUE;
    for (size_t i = 0; i < length; ++i) {
      if ((unsigned char)word[i] < ' ')
        return EqmRejectAt(in, word, EQM_ERR_IO, "binary bytes: this is not an OBJ file");
    }
  }
  return 0;
}

static PetscErrorCode ParseStatements(EqmInput *in, EqmBuilder *builder, Groups *groups)
{
  Largest largest = {-1, in->start};
  PetscBool foreign = PETSC_FALSE;

  EqmSkipMark(in);
  while (in->cursor < in->end) {
    EqmTry(ParseStatement(in, builder, &largest, groups, &foreign));
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
  Groups *groups;
  PetscErrorCode code;

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmTry(PetscCalloc1(1, &groups));
  groups->first = 1;
  EqmBuilderOpen(&builder, &in);
  EqmBuilderSetGroup(&builder, 0);
  code = EqmBuilderFinish(&builder, ParseStatements(&in, &builder, groups), mesh);
  if (!code) EqmTry(KeepNames(groups, &mesh->metadata));
  EqmTry(PetscFree(groups));
  return code;
}

EQM_DEFINE_FORMAT(Obj) = {.name = "OBJ",
                          .suffixes = "obj",
                          .recognise = RecogniseObj,
                          .parse = ParseObj,
                          .write = EqmWriteObj,
                          .writes_texture = PETSC_TRUE,
                          .groups = PETSC_TRUE};
