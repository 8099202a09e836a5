/* TetGen's pair of files: NAME.node with the vertices, NAME.ele with the tetrahedra, numbered from 0 or from 1 as the
   first vertex says. Either file is named; the parser takes the bytes of both with a form feed between them. Triangle's
   files for the plane look alike and are read, too. */
#include "builder.h"
#include "format.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define BETWEEN_FILES '\f'

/* The first line of either file: four whole numbers at most, of which the second differs between the two files. */
typedef struct {
  PetscInt64 count, width, attributes, markers;
} Header;

static PetscBool ReadHeader(EqmInput *in, Header *header)
{
  PetscInt64 *const optional[2] = {&header->attributes, &header->markers};

  *header = (Header){0, 0, 0, 0};
  EqmSkipMark(in);
  EqmSkipSpace(in, '#');
  if (!EqmReadInteger(in, &header->count) || !EqmReadInteger(in, &header->width)) return PETSC_FALSE;
  for (int k = 0; k < 2 && !EqmAtLineEnd(in) && *in->cursor != '#'; ++k) {
    if (!EqmReadInteger(in, optional[k])) return PETSC_FALSE;
  }
  return EqmAtLineEnd(in) || *in->cursor == '#' ? PETSC_TRUE : PETSC_FALSE;
}

/* A weak guess, since these files have no magic: a first line that fits, and a second one that
   begins with the number 0 or 1. Not collective. */
static PetscBool RecogniseTetgen(const char *bytes, size_t length)
{
  EqmInput in;
  char unused[8];
  Header header;
  PetscInt64 first;

  EqmInputOpen(&in, bytes, length, unused, sizeof(unused));
  if (!ReadHeader(&in, &header) || header.count < 1 || header.width < 2 || header.width > 10) return PETSC_FALSE;
  if (header.attributes < 0 || header.markers < 0 || header.markers > 1) return PETSC_FALSE;
  EqmSkipSpace(&in, '#');
  return EqmReadInteger(&in, &first) && (first == 0 || first == 1) ? PETSC_TRUE : PETSC_FALSE;
}

/* NAME.node or NAME.ele beside the other one; PETSC_FALSE if `file` is neither. */
static PetscBool PartnerOf(const char *file, const char *suffix, char *name, size_t length)
{
  const char *const dot = strrchr(file, '.');

  if (!dot || (strcasecmp(dot, ".node") && strcasecmp(dot, ".ele"))) return PETSC_FALSE;
  return snprintf(name, length, "%.*s%s", (int)(dot - file), file, suffix) < (int)length ? PETSC_TRUE : PETSC_FALSE;
}

/* The bytes of both files. A file under another name holds both already. See EqmLoader. */
static PetscErrorCode LoadTetgen(const char *file, char **bytes, size_t *length, char *error, size_t error_length)
{
  char name[PETSC_MAX_PATH_LEN], *part[2] = {NULL, NULL}, *both = NULL;
  static const char *const suffix[2] = {".node", ".ele"};
  size_t part_length[2] = {0, 0};
  PetscErrorCode code = 0;

  if (!PartnerOf(file, "", name, sizeof(name))) return 0;
  free(*bytes);
  *bytes = NULL;
  for (int k = 0; k < 2 && !code; ++k) {
    (void)PartnerOf(file, suffix[k], name, sizeof(name));
    code = EqmFormatLoadBytes(name, &part[k], &part_length[k], error, error_length);
  }
  if (code) {
    const size_t used = strlen(error);

    snprintf(error + used, error_length - used, " (it belongs to %s)", file);
  }
  if (!code) both = malloc(part_length[0] + part_length[1] + 1);
  if (!code && !both) {
    snprintf(error, error_length, "cannot read %s: %s", file, strerror(ENOMEM));
    code = EQM_ERR_IO;
  }
  if (!code) {
    memcpy(both, part[0], part_length[0]);
    both[part_length[0]] = BETWEEN_FILES;
    memcpy(both + part_length[0] + 1, part[1], part_length[1]);
    *bytes = both;
    *length = part_length[0] + part_length[1] + 1;
  }
  free(part[0]);
  free(part[1]);
  return code;
}

/* A header whose announced lines the file can hold. */
static PetscErrorCode TakeHeader(EqmInput *in, const char *what, Header *header)
{
  const char *const position = in->cursor;

  if (!ReadHeader(in, header) || header->count < 0) {
    return EqmReject(in, EQM_ERR_IO, "the file with the %s must begin with their number and two to four whole numbers",
                     what);
  }
  if ((size_t)header->count <= EqmRemaining(in) / 4 + 1) return 0;
  return EqmRejectAt(in, position, EQM_ERR_IO, "%lld %s are announced, but the file is too short: it is truncated",
                     (long long)header->count, what);
}

/* The number at the beginning of a line: it goes up by one from line to line. */
static PetscErrorCode TakeNumber(EqmInput *in, const char *what, PetscInt64 i, PetscInt64 count, PetscInt64 *first)
{
  PetscInt64 number;

  EqmSkipSpace(in, '#');
  if (!EqmReadInteger(in, &number)) {
    return EqmReject(in, EQM_ERR_IO, "%s %lld of %lld is missing%s", what, (long long)i, (long long)count,
                     in->cursor == in->end ? ": the file is truncated" : "");
  }
  if (!i) *first = number;
  if (number == *first + i && (*first == 0 || *first == 1)) return 0;
  return EqmReject(in, EQM_ERR_IO, "%s number %lld stands here: the numbers must go up by one from 0 or 1", what,
                   (long long)number);
}

static PetscErrorCode ParseNodes(EqmInput *in, EqmBuilder *builder, PetscInt64 *first)
{
  Header header;
  PetscReal *x;

  EqmTry(TakeHeader(in, "vertices", &header));
  if (header.width != 2 && header.width != 3)
    return EqmReject(in, EQM_ERR_IO, "a .node file must come first, and its vertices have 2 or 3 coordinates");
  EqmTry(EqmBuilderAddVertices(builder, (size_t)header.count, &x));
  for (PetscInt64 i = 0; i < header.count; ++i) {
    EqmTry(TakeNumber(in, "vertex", i, header.count, first));
    x[3 * i + 2] = 0.0; /* of the plane */
    for (PetscInt64 k = 0; k < header.width; ++k) {
      if (!EqmReadReal(in, &x[3 * i + k])) {
        return EqmReject(in, EQM_ERR_IO, "vertex %lld needs %lld coordinates%s", (long long)(*first + i),
                         (long long)header.width, in->cursor == in->end ? ": the file is truncated" : "");
      }
    }
    EqmSkipLine(in); /* attributes, boundary marker */
  }
  return 0;
}

static PetscErrorCode ParseCorners(EqmInput *in, PetscInt64 first, PetscInt64 num_vertices, PetscInt size,
                                   PetscInt *cell)
{
  for (PetscInt k = 0; k < size; ++k) {
    PetscInt64 vertex;

    if (!EqmReadInteger(in, &vertex)) return EqmReject(in, EQM_ERR_IO, ".ele: %d vertex numbers are needed", (int)size);
    if (vertex < first || vertex >= first + num_vertices) {
      return EqmReject(in, EQM_ERR_IO, ".ele: vertex number %lld is out of range %lld..%lld", (long long)vertex,
                       (long long)first, (long long)(first + num_vertices - 1));
    }
    cell[k] = (PetscInt)(vertex - first);
  }
  return 0;
}

static PetscErrorCode ParseElements(EqmInput *in, EqmBuilder *builder, PetscInt64 first_vertex)
{
  Header header;
  PetscInt64 first = 0;
  PetscInt *cells;

  EqmTry(TakeHeader(in, "cells", &header));
  if (header.width == 10 || header.width == 6) {
    return EqmReject(in, EQM_ERR_MESH,
                     "the cells have %lld vertices: only tetrahedra with four vertices can be mapped (without -o2)",
                     (long long)header.width);
  }
  if (header.width != 3 && header.width != 4)
    return EqmReject(in, EQM_ERR_IO, ".ele: cells of %lld vertices are unknown", (long long)header.width);
  EqmTry(EqmBuilderAddCells(builder, (PetscInt)header.width, (size_t)header.count, &cells));
  for (PetscInt64 i = 0; i < header.count; ++i) {
    EqmTry(TakeNumber(in, "cell", i, header.count, &first));
    EqmTry(ParseCorners(in, first_vertex, (PetscInt64)builder->num_vertices, (PetscInt)header.width,
                        cells + header.width * i));
    EqmSkipLine(in); /* region */
  }
  return 0;
}

/* Positions in messages are lines of the one file, then of the other. */
static PetscErrorCode ParseBoth(EqmInput *in, EqmBuilder *builder)
{
  const char *const end = in->end, *const border = memchr(in->start, BETWEEN_FILES, EqmRemaining(in));
  PetscInt64 first_vertex = 0;

  if (border) in->end = border;
  EqmTry(ParseNodes(in, builder, &first_vertex));
  if (!border) return EqmReject(in, EQM_ERR_IO, "there is no .ele file behind the .node file");
  in->cursor = in->start = border + 1;
  in->end = end;
  return ParseElements(in, builder, first_vertex);
}

/* Read the two files, one behind the other. See EqmParser. */
static PetscErrorCode ParseTetgen(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error,
                                  size_t error_length)
{
  EqmInput in;
  EqmBuilder builder;

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmBuilderOpen(&builder, &in);
  return EqmBuilderFinish(&builder, ParseBoth(&in, &builder), mesh);
}

static void PrintNodes(EqmAtomicFile *file, const EqmSerialMesh *mesh)
{
  EqmAtomicPrint(file, "%lld 3 0 0\n", (long long)mesh->num_vertices);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicPrint(file, "%lld ", (long long)i);
    EqmAtomicPrintReals(file, 3, mesh->vertices + 3 * (size_t)i, ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
}

static void PrintElements(EqmAtomicFile *file, const EqmSerialMesh *mesh)
{
  EqmAtomicPrint(file, "%lld %d 0\n", (long long)mesh->num_cells, (int)mesh->cell_size);
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    EqmAtomicPrint(file, "%lld", (long long)i);
    for (PetscInt k = 0; k < mesh->cell_size; ++k) {
      EqmAtomicPrint(file, " %lld", (long long)mesh->cells[(size_t)mesh->cell_size * (size_t)i + (size_t)k]);
    }
    EqmAtomicWrite(file, "\n", 1);
  }
}

/* Write both files, numbered from 0, whichever of them is named; the other one is there, complete,
   before the caller finishes this one. See EqmWriter. */
static PetscErrorCode WriteTetgen(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                  PetscInt num_fields, char *error, size_t error_length)
{
  const char *const dot = strrchr(file->path, '.');
  const PetscBool is_node = dot && !strcasecmp(dot, ".node") ? PETSC_TRUE : PETSC_FALSE;
  char name[PETSC_MAX_PATH_LEN];
  EqmAtomicFile partner;

  if (!PartnerOf(file->path, is_node ? ".ele" : ".node", name, sizeof(name))) {
    snprintf(error, error_length, "its link or name leads to no file that ends in .node or .ele");
    return EQM_ERR_USAGE;
  }
  EqmTry(EqmAtomicOpen(name, &partner, error, error_length));
  PrintNodes(is_node ? file : &partner, mesh);
  PrintElements(is_node ? &partner : file, mesh);
  return EqmAtomicCommit(&partner, error, error_length);
}

EQM_DEFINE_FORMAT(Tetgen) = {.name = "TetGen",
                             .suffixes = "node ele",
                             .recognise = RecogniseTetgen,
                             .parse = ParseTetgen,
                             .write = WriteTetgen,
                             .load = LoadTetgen};
