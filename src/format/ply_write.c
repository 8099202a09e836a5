/* PLY, binary little endian, or text where the name ends in .text.ply, with fields as properties. Texture coordinates
   become s and t (floats), u and v (doubles) of the vertices, or, where there are seams, a list texcoord of the faces,
   as MeshLab has it. */
#include "writers.h"
#include "input.h"
#include "scalar.h"
#include "stream.h"

#include <string.h>

/* Where numbers go, and in which form. */
typedef struct {
  EqmAtomicFile *file;
  PetscBool text;
} Sink;

static Sink SinkOf(EqmAtomicFile *file)
{
  static const char ending[] = ".text.ply";
  const size_t length = strlen(file->path), wanted = sizeof(ending) - 1;

  return (Sink){file, length > wanted && !strcmp(file->path + length - wanted, ending) ? PETSC_TRUE : PETSC_FALSE};
}

static void PutDouble(Sink to, double value)
{
  if (to.text)
    EqmAtomicPrint(to.file, "%.17g ", value);
  else
    EqmAtomicWrite(to.file, &value, sizeof(value));
}

static void PutFloat(Sink to, float value)
{
  if (to.text)
    EqmAtomicPrint(to.file, "%.9g ", (double)value);
  else
    EqmAtomicWrite(to.file, &value, sizeof(value));
}

static void PutByte(Sink to, unsigned char value)
{
  if (to.text)
    EqmAtomicPrint(to.file, "%d ", (int)value);
  else
    EqmAtomicWrite(to.file, &value, 1);
}

static void PutInteger(Sink to, int32_t value)
{
  if (to.text)
    EqmAtomicPrint(to.file, "%d ", (int)value);
  else
    EqmAtomicWrite(to.file, &value, sizeof(value));
}

static void EndRow(Sink to)
{
  if (to.text) EqmAtomicPrint(to.file, "\n");
}

/* Colours are bytes, or the programs that show them do not take them for colours. */
static PetscBool IsColour(const EqmField *field)
{
  static const char *const names[] = {"red", "green", "blue", "alpha", "diffuse_red", "diffuse_green", "diffuse_blue"};

  for (size_t k = 0; k < sizeof(names) / sizeof(names[0]); ++k) {
    if (field->width == 1 && !strcmp(field->name, names[k])) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static unsigned char ToByte(PetscReal value)
{
  return value >= 255.0 ? 255 : value > 0.0 ? (unsigned char)(value + 0.5) : 0;
}

/* Names may not have blanks in PLY. */
static void PrintFieldHeader(EqmAtomicFile *file, const EqmField *field)
{
  for (PetscInt k = 0; k < field->width; ++k) {
    EqmAtomicPrint(file, IsColour(field) ? "property uchar " : "property double ");
    for (const char *c = field->name; *c; ++c) EqmAtomicWrite(file, EqmIsSpace(*c) ? "_" : c, 1);
    if (field->width > 1) EqmAtomicPrint(file, "_%d", (int)k);
    EqmAtomicPrint(file, "\n");
  }
}

/* The field that MeshLab shall colour by, which it does by the name of quality: the ratio of a map. NULL: none. */
static const EqmField *FindQuality(const EqmField *fields, PetscInt num_fields, PetscBool on_cells)
{
  const EqmField *found = NULL;

  for (PetscInt f = 0; f < num_fields; ++f) {
    if (fields[f].on_cells != on_cells) continue;
    if (!strcmp(fields[f].name, "quality")) return NULL;
    if (fields[f].width == 1 && !strcmp(fields[f].name, on_cells ? "ratio" : "vertex_ratio")) found = &fields[f];
  }
  return found;
}

static void WriteFields(Sink to, EqmMeshStream *stream, PetscBool on_cells, PetscInt row)
{
  const EqmField *const quality = FindQuality(stream->fields, stream->num_fields, on_cells);

  for (PetscInt f = 0; f < stream->num_fields; ++f) {
    const EqmField *const field = &stream->fields[f];
    const PetscReal *values;

    if (field->on_cells != on_cells) continue;
    values = EqmStreamField(stream, f, row);
    for (PetscInt k = 0; k < field->width; ++k) {
      if (IsColour(field))
        PutByte(to, ToByte(values[k]));
      else
        PutDouble(to, values[k]);
    }
  }
  if (quality) PutFloat(to, (float)*EqmStreamField(stream, EqmStreamIndexOf(stream, quality), row));
}

typedef enum { TEXTURE_NONE, TEXTURE_OF_VERTICES, TEXTURE_OF_CORNERS } Texture;

static void PrintFieldHeaders(EqmAtomicFile *file, const EqmField *fields, PetscInt num_fields, PetscBool on_cells)
{
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (fields[f].on_cells == on_cells) PrintFieldHeader(file, &fields[f]);
  }
  if (FindQuality(fields, num_fields, on_cells)) EqmAtomicPrint(file, "property float quality\n");
}

static void PrintHeader(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields, PetscInt num_fields,
                        Texture texture)
{
  EqmAtomicPrint(file, "ply\nformat %s 1.0\ncomment equimap %s\nelement vertex %lld\n",
                 SinkOf(file).text ? "ascii" : "binary_little_endian", EqmVersion(), (long long)mesh->num_vertices);
  EqmAtomicPrint(file, "property double x\nproperty double y\nproperty double z\n");
  if (texture == TEXTURE_OF_VERTICES) /* MeshLab takes floats by the one name, and no others; doubles for all digits */
    EqmAtomicPrint(file, "property float s\nproperty float t\nproperty double u\nproperty double v\n");
  PrintFieldHeaders(file, fields, num_fields, PETSC_FALSE);
  EqmAtomicPrint(file, "element face %lld\nproperty list uchar int vertex_indices\n", (long long)mesh->num_cells);
  if (texture == TEXTURE_OF_CORNERS) EqmAtomicPrint(file, "property list uchar float texcoord\n");
  PrintFieldHeaders(file, fields, num_fields, PETSC_TRUE);
  EqmAtomicPrint(file, "end_header\n");
}

static void WriteVertex(Sink to, const PetscReal x[3], const PetscReal *uv)
{
  for (size_t k = 0; k < 3; ++k) PutDouble(to, x[k]);
  for (size_t k = 0; k < 2 && uv; ++k) PutFloat(to, (float)uv[k]);
  for (size_t k = 0; k < 2 && uv; ++k) PutDouble(to, uv[k]);
}

/* uv - of the three corners, or NULL. */
static void WriteFace(Sink to, const PetscInt corner[3], const PetscReal *uv)
{
  PutByte(to, 3);
  for (size_t k = 0; k < 3; ++k) PutInteger(to, (int32_t)corner[k]);
  if (!uv) return;
  PutByte(to, 6);
  for (size_t k = 0; k < 6; ++k) PutFloat(to, (float)uv[k]);
}

/* EqmWritePly - write a PLY file. See EqmStreamWriter. */
PetscErrorCode EqmWritePly(EqmAtomicFile *file, EqmMeshStream *stream, char *error, size_t error_length)
{
  const EqmSerialMesh *const mesh = &stream->mesh;
  const Sink to = SinkOf(file);
  const Texture texture = !stream->has_texture    ? TEXTURE_NONE
                          : stream->num_more == 0 ? TEXTURE_OF_VERTICES
                                                  : TEXTURE_OF_CORNERS;

  EqmTry(EqmRequireTriangles(mesh, "PLY", error, error_length));
  PrintHeader(file, mesh, stream->fields, stream->num_fields, texture);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    WriteVertex(to, EqmStreamVertex(stream, i), texture == TEXTURE_OF_VERTICES ? EqmStreamPoint(stream, i) : NULL);
    WriteFields(to, stream, PETSC_FALSE, i);
    EndRow(to);
  }
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    const PetscReal *const uv =
        texture == TEXTURE_OF_CORNERS ? EqmColumnRow(&stream->columns[EQM_COLUMN_TEXTURE], i) : NULL;

    WriteFace(to, EqmStreamCell(stream, i), uv);
    WriteFields(to, stream, PETSC_TRUE, i);
    EndRow(to);
  }
  return 0;
}
