/* FreeSurfer's surfaces (lh.white, lh.sphere, ...): binary triangles, big endian, in single precision, with the
   geometry of the volume behind them, which goes on into a FreeSurfer file that the surface is written to. And its
   curvature files: a number per vertex. */
#include "builder.h"
#include "format.h"
#include "metadata.h"
#include "scalar.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char triangle_magic[] = "\377\377\376", curvature_magic[] = "\377\377\377";
static const char footer_key[] = "freesurfer.footer"; /* the bytes behind the triangles, as hexadecimal digits */

enum { MAX_FOOTER = 65536 }; /* bytes; a real one has some hundred */

/* The magic bytes and a line about who made the file. */
static PetscBool RecogniseSurface(const char *bytes, size_t length)
{
  return length >= 4 && !memcmp(bytes, triangle_magic, 3) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode TakeCount(EqmInput *in, const char *what, PetscInt64 *count)
{
  const char *bytes;

  EqmTry(EqmTakeBytes(in, 4, what, &bytes));
  *count = EqmLoadInteger(bytes, EQM_SCALAR_INT32, PETSC_TRUE);
  if (*count >= 0 && (size_t)*count <= EqmRemaining(in) / 12) return 0;
  return EqmReject(in, EQM_ERR_IO, "%lld %s are announced, but the file is too short for them: it is truncated",
                   (long long)*count, what);
}

/* After the magic bytes a comment that ends with an empty line. */
static PetscErrorCode SkipComment(EqmInput *in)
{
  const char *const end = memchr(in->cursor, '\n', EqmRemaining(in));

  if (!end) return EqmReject(in, EQM_ERR_IO, "the comment has no end: the file is truncated");
  in->cursor = end + 1;
  if (in->cursor < in->end && *in->cursor == '\n') ++in->cursor;
  return 0;
}

static PetscErrorCode ParseArrays(EqmInput *in, EqmBuilder *builder)
{
  const char *bytes;
  PetscInt64 num_vertices, num_triangles, corners[3];
  PetscReal *x;

  EqmTry(SkipComment(in));
  EqmTry(TakeCount(in, "vertices", &num_vertices));
  EqmTry(EqmTakeBytes(in, 4, "number of triangles", &bytes));
  num_triangles = EqmLoadInteger(bytes, EQM_SCALAR_INT32, PETSC_TRUE);
  EqmTry(EqmTakeBytes(in, 12 * (size_t)num_vertices, "vertices", &bytes));
  EqmTry(EqmBuilderAddVertices(builder, (size_t)num_vertices, &x));
  for (PetscInt64 i = 0; i < 3 * num_vertices; ++i) x[i] = EqmLoadReal(bytes + 4 * i, EQM_SCALAR_FLOAT32, PETSC_TRUE);
  if (num_triangles < 0) return EqmReject(in, EQM_ERR_IO, "the number of triangles is negative: the file is damaged");
  EqmTry(EqmTakeBytes(in, 12 * (size_t)num_triangles, "triangles", &bytes));
  for (PetscInt64 t = 0; t < num_triangles; ++t) {
    for (int k = 0; k < 3; ++k) corners[k] = EqmLoadInteger(bytes + 12 * t + 4 * k, EQM_SCALAR_INT32, PETSC_TRUE);
    EqmTry(EqmBuilderAddFace(builder, bytes + 12 * t, num_vertices, 3, corners));
  }
  return 0;
}

static PetscErrorCode KeepFooter(const EqmInput *in, EqmSerialMesh *mesh)
{
  static const char digits[] = "0123456789abcdef";
  const size_t length = EqmRemaining(in);
  char *text;
  PetscErrorCode code;

  if (!length || length > MAX_FOOTER) return 0;
  EqmTry(PetscMalloc1(2 * length + 1, &text));
  for (size_t i = 0; i < length; ++i) {
    const unsigned char byte = (unsigned char)in->cursor[i];

    text[2 * i] = digits[byte >> 4];
    text[2 * i + 1] = digits[byte & 15];
  }
  text[2 * length] = '\0';
  code = EqmMetadataAdd(&mesh->metadata, footer_key, text);
  EqmTry(PetscFree(text));
  return code;
}

/* Read a surface. See EqmParser. */
static PetscErrorCode ParseSurface(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error,
                                   size_t error_length)
{
  EqmInput in;
  EqmBuilder builder;
  PetscErrorCode code;

  EqmInputOpen(&in, bytes, length, error, error_length);
  in.binary = PETSC_TRUE;
  EqmBuilderOpen(&builder, &in);
  if (RecogniseSurface(bytes, length)) {
    in.cursor += 3;
    code = ParseArrays(&in, &builder);
  } else {
    code = EqmReject(&in, EQM_ERR_IO,
                     "it does not begin as a FreeSurfer surface of triangles does; mris_convert makes one of others");
  }
  code = EqmBuilderFinish(&builder, code, mesh);
  return code ? code : KeepFooter(&in, mesh);
}

/* Numbers into a file as big-endian numbers of four bytes. */
static void WriteWord(EqmAtomicFile *file, uint32_t word)
{
  const uint32_t swapped = __builtin_bswap32(word);

  EqmAtomicWrite(file, &swapped, sizeof(swapped));
}

static void WriteReal(EqmAtomicFile *file, PetscReal value)
{
  const float single = (float)value;
  uint32_t word;

  memcpy(&word, &single, sizeof(word));
  WriteWord(file, word);
}

/* FreeSurfer's spheres have the radius 100: what makes it of a sphere about the origin, 1 for other surfaces. */
static PetscReal SphereScale(const EqmSerialMesh *mesh)
{
  PetscReal least = PETSC_MAX_REAL, most = 0.0;

  for (size_t i = 0; i < 3 * (size_t)mesh->num_cells; ++i) {
    const PetscReal *const x = mesh->vertices + 3 * (size_t)mesh->cells[i];
    const PetscReal radius = PetscSqrtReal(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);

    least = PetscMin(least, radius);
    most = PetscMax(most, radius);
  }
  return most > 0.0 && most - least <= 5e-4 * most ? 200.0 / (least + most) : 1.0;
}

static PetscErrorCode WriteFooter(EqmAtomicFile *file, const EqmSerialMesh *mesh)
{
  char *text;

  if (!mesh->metadata) return 0;
  EqmTry(PetscMalloc1(2 * MAX_FOOTER + 1, &text));
  (void)EqmMetadataGet(mesh->metadata, footer_key, text, 2 * MAX_FOOTER + 1);
  for (const char *c = text; c[0] && c[1]; c += 2) {
    const char pair[3] = {c[0], c[1], '\0'};
    const unsigned char byte = (unsigned char)strtoul(pair, NULL, 16);

    EqmAtomicWrite(file, &byte, 1);
  }
  return PetscFree(text);
}

/* Write a surface; a sphere about the origin gets the radius 100. See EqmWriter. */
static PetscErrorCode WriteSurface(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                   PetscInt num_fields, char *error, size_t error_length)
{
  PetscReal scale;

  EqmTry(EqmRequireTriangles(mesh, "FreeSurfer", error, error_length));
  scale = SphereScale(mesh);
  EqmAtomicWrite(file, triangle_magic, 3);
  EqmAtomicPrint(file, "created by equimap %s\n\n", EqmVersion());
  WriteWord(file, (uint32_t)mesh->num_vertices);
  WriteWord(file, (uint32_t)mesh->num_cells);
  for (size_t i = 0; i < 3 * (size_t)mesh->num_vertices; ++i) WriteReal(file, scale * mesh->vertices[i]);
  for (size_t i = 0; i < 3 * (size_t)mesh->num_cells; ++i) WriteWord(file, (uint32_t)mesh->cells[i]);
  return WriteFooter(file, mesh);
}

/* Is it a curvature file: magic bytes and a number of values that fits its length? */
static PetscBool RecogniseCurvature(const char *bytes, size_t length)
{
  return length >= 15 && !memcmp(bytes, curvature_magic, 3) &&
                 EqmLoadInteger(bytes + 11, EQM_SCALAR_INT32, PETSC_TRUE) == 1 &&
                 (size_t)EqmLoadInteger(bytes + 3, EQM_SCALAR_UINT32, PETSC_TRUE) == (length - 15) / 4
             ? PETSC_TRUE
             : PETSC_FALSE;
}

static PetscErrorCode ParseCurvature(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error,
                                     size_t error_length)
{
  snprintf(error, error_length,
           "it holds a number per vertex and no surface: give the surface that belongs to it, such as lh.white");
  return EQM_ERR_IO;
}

/* Write the areal distortion around each vertex: the conformal factor, a natural logarithm, to the base 2. See
   EqmWriter. */
static PetscErrorCode WriteCurvature(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                     PetscInt num_fields, char *error, size_t error_length)
{
  const EqmField *factor = NULL;

  EqmTry(EqmRequireTriangles(mesh, "FreeSurfer", error, error_length));
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (!strcmp(fields[f].name, "conformal_factor")) factor = &fields[f];
  }
  if (!factor) {
    snprintf(error, error_length, "a curvature file holds the areal distortion of a map, and this mesh has none");
    return EQM_ERR_USAGE;
  }
  EqmAtomicWrite(file, curvature_magic, 3);
  WriteWord(file, (uint32_t)mesh->num_vertices);
  WriteWord(file, (uint32_t)mesh->num_cells);
  WriteWord(file, 1);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) WriteReal(file, factor->values[i] / M_LN2);
  return 0;
}

EQM_DEFINE_FORMAT(Freesurfer) = {.name = "FreeSurfer surface",
                                 .suffixes = "white pial sphere inflated orig smoothwm midthickness reg nofix",
                                 .recognise = RecogniseSurface,
                                 .parse = ParseSurface,
                                 .write = WriteSurface};
EQM_DEFINE_FORMAT(Curvature) = {.name = "FreeSurfer curvature",
                                .suffixes = "curv",
                                .recognise = RecogniseCurvature,
                                .parse = ParseCurvature,
                                .write = WriteCurvature};
