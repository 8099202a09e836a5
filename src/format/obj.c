/* Wavefront OBJ: `v x y z`, `vt u v` and `f a/b/c ...` lines; `g` and `o` make groups; everything else (normals,
 * materials) is skipped.
 */
#include "builder.h"
#include "mesh/fields.h"
#include "format.h"
#include "obj_groups.h"
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

/* The largest index of the file, as faces may come before the vertices that they name; words that OBJ does not have. */
typedef struct {
  PetscInt64 index;
  const char *position;
  PetscBool foreign;
} Findings;

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
  const PetscInt64 num_vertices = (PetscInt64)(builder->vertices_before + builder->num_vertices);
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
  if (texture < 0) texture += (PetscInt64)(builder->texture_points_before + builder->num_texture_points) + 1;
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

static PetscErrorCode ParseFace(EqmInput *in, EqmBuilder *builder, Findings *findings)
{
  const char *position = in->cursor;

  EqmBuilderStartFace(builder);
  for (SkipContinuation(in); !EqmAtLineEnd(in) && *in->cursor != '#'; SkipContinuation(in)) {
    PetscInt64 corner;

    EqmTry(ParseCorner(in, builder, &corner));
    if (corner > findings->index) {
      findings->index = corner;
      findings->position = position;
    }
  }
  return EqmBuilderEndFace(builder, position, PETSC_MAX_INT);
}

/* `g name` or `o name`: the faces that follow belong to the group of that name. */
static void ParseGroup(EqmInput *in, EqmBuilder *builder, EqmObjGroups *groups)
{
  char name[EQM_OBJ_LONGEST_GROUP];

  EqmObjReadGroupName(in, name);
  EqmBuilderSetGroup(builder, EqmObjGroupOfName(name, groups));
}

static PetscErrorCode ParseStatement(EqmInput *in, EqmBuilder *builder, EqmObjGroups *groups, Findings *findings)
{
  const char *word;
  size_t length = EqmReadWord(in, &word);

  if (length == 1 && *word == 'v') {
    EqmTry(ParseVertex(in, builder));
  } else if (length == 2 && !memcmp(word, "vt", 2)) {
    EqmTry(ParseTexturePoint(in, builder));
  } else if (length == 1 && *word == 'f') {
    EqmTry(ParseFace(in, builder, findings));
  } else if (length == 1 && (*word == 'g' || *word == 'o')) {
    ParseGroup(in, builder, groups);
  } else if (EqmWordIs(word, length, "vn") || EqmWordIs(word, length, "usemtl")) {
    EqmBuilderNoteLeft(builder, length == 2 ? "normals" : "materials");
  } else if (length && !IsKeyword(word, length)) {
    findings->foreign = PETSC_TRUE;
    for (size_t i = 0; i < length; ++i) {
      if ((unsigned char)word[i] < ' ')
        return EqmRejectAt(in, word, EQM_ERR_IO, "binary bytes: this is not an OBJ file");
    }
  }
  return 0;
}

/* All lines of a file, or of a part of it. */
static PetscErrorCode ParseStatements(EqmInput *in, EqmBuilder *builder, EqmObjGroups *groups, Findings *findings)
{
  *findings = (Findings){-1, in->start, PETSC_FALSE};
  while (in->cursor < in->end) {
    EqmTry(ParseStatement(in, builder, groups, findings));
    EqmSkipLine(in);
  }
  return 0;
}

static PetscErrorCode ParseAll(EqmInput *in, EqmBuilder *builder, EqmObjGroups *groups)
{
  Findings findings;

  EqmSkipMark(in);
  EqmTry(ParseStatements(in, builder, groups, &findings));
  if (findings.foreign && !builder->num_vertices) {
    return EqmRejectAt(in, in->start, EQM_ERR_IO,
                       "this is not an OBJ file: it has no vertices (lines that begin with v)");
  }
  if (findings.index >= (PetscInt64)builder->num_vertices) {
    return EqmRejectAt(in, findings.position, EQM_ERR_IO, "vertex index %lld is out of range 1..%lld",
                       (long long)findings.index + 1, (long long)builder->num_vertices);
  }
  return 0;
}

/* Read an OBJ file. See EqmParser. */
static PetscErrorCode ParseObj(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  EqmInput in;
  EqmBuilder builder;
  EqmObjGroups *groups;
  PetscErrorCode code;

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmTry(PetscCalloc1(1, &groups));
  groups->first = 1;
  EqmBuilderOpen(&builder, &in);
  EqmBuilderSetGroup(&builder, 0);
  code = EqmBuilderFinish(&builder, ParseAll(&in, &builder, groups), mesh);
  if (!code) EqmTry(EqmObjKeepNames(groups, &mesh->metadata));
  EqmTry(PetscFree(groups));
  return code;
}

/* What of a part of the file the others must know before they parse theirs. */
static void Survey(EqmInput *in, PetscInt64 count[2], EqmObjNames *names)
{
  count[0] = count[1] = 0;
  names->first_name = -1;
  while (in->cursor < in->end) {
    const char *word;
    const size_t length = EqmReadWord(in, &word);
    char name[EQM_OBJ_LONGEST_GROUP];

    if (length == 1 && *word == 'v') ++count[0];
    if (length == 2 && !memcmp(word, "vt", 2)) ++count[1];
    if (length == 1 && (*word == 'g' || *word == 'o')) {
      EqmObjReadGroupName(in, name);
      EqmObjAddName(name, names);
    }
    EqmSkipLine(in);
  }
}

/* Everybody's survey: what is before this rank's part, and all there is. Collective. */
static PetscErrorCode ShareSurvey(MPI_Comm comm, EqmInput *in, EqmBuilder *builder, EqmObjGroups groups[2],
                                  PetscInt64 total[2], PetscBool *understood)
{
  PetscInt64 count[2], before[2], group;
  EqmObjNames *names;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(1, &names));
  Survey(in, count, names);
  if (names->overflow) *understood = PETSC_FALSE;
  PetscCallMPI(MPI_Scan(count, before, 2, MPIU_INT64, MPI_SUM, comm));
  PetscCall(MPIU_Allreduce(count, total, 2, MPIU_INT64, MPI_SUM, comm));
  builder->vertices_before = (size_t)(before[0] - count[0]);
  builder->texture_points_before = (size_t)(before[1] - count[1]);
  PetscCall(EqmObjShareNames(comm, names, &groups[0], &group, &groups[1]));
  EqmBuilderSetGroup(builder, group);
  PetscCall(PetscFree(names));
  PetscFunctionReturn(0);
}

/* Read this rank's part of an OBJ file. See EqmPartParser. */
static PetscErrorCode ParseObjPart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood)
{
  char unused[EQM_MESSAGE_MAX];
  EqmFilePart part;
  EqmInput in;
  EqmBuilder builder;
  EqmObjGroups *groups;
  Findings findings;
  PetscInt64 total[2];

  PetscFunctionBegin;
  PetscCall(EqmPartFileLines(file, 0, NULL, &part, understood));
  EqmInputOpen(&in, part.bytes, *understood ? part.length : 0, unused, sizeof(unused));
  if (part.before == 0) EqmSkipMark(&in);
  EqmBuilderOpen(&builder, &in);
  PetscCall(PetscMalloc1(2, &groups));
  PetscCall(ShareSurvey(file->comm, &in, &builder, groups, total, understood));
  in.cursor = in.start;
  if (part.before == 0) EqmSkipMark(&in);
  if (ParseStatements(&in, &builder, &groups[0], &findings)) *understood = PETSC_FALSE;
  if (total[0] > PETSC_MAX_INT || findings.index >= total[0] || (findings.foreign && !total[0]))
    *understood = PETSC_FALSE;
  PetscCall(PetscFree(part.bytes));
  PetscCall(EqmBuilderFinishPart(&builder, file->comm, understood, mesh));
  if (*understood) PetscCall(EqmObjKeepNames(&groups[1], &mesh->metadata));
  PetscCall(PetscFree(groups));
  PetscFunctionReturn(0);
}

EQM_DEFINE_FORMAT(Obj) = {.name = "OBJ",
                          .suffixes = "obj",
                          .recognise = RecogniseObj,
                          .parse = ParseObj,
                          .parse_part = ParseObjPart,
                          .write_stream = EqmWriteObj,
                          .writes_texture = PETSC_TRUE,
                          .groups = PETSC_TRUE};
