/* One small surface and one small solid, as files of every format and variant that is read. */
#ifndef EQM_TEST_FORMAT_SAMPLES_H
#define EQM_TEST_FORMAT_SAMPLES_H

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>
#include <equimap/soup.h>

#define SAMPLE_BYTES 8192
#define MAX_SAMPLES  96

typedef struct {
  const char *name, *suffix;
  PetscInt cell_size;
  size_t length;
  char bytes[SAMPLE_BYTES];
} Sample;

/* Coordinates that single precision holds, used in the order in which they first appear. */
static const double sample_vertices[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0.5, -1.25, 0, 3, 0, -1, 1e10};
static const int sample_triangles[12] = {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1};
static const int sample_tetrahedra[8] = {0, 1, 2, 3, 0, 2, 1, 4};

static void Put(Sample *s, const char *format, ...)
{
  va_list arguments;

  va_start(arguments, format);
  s->length += (size_t)vsnprintf(s->bytes + s->length, SAMPLE_BYTES - s->length, format, arguments);
  va_end(arguments);
  if (s->length >= SAMPLE_BYTES) abort();
}

static void PutBytes(Sample *s, const void *bytes, size_t count, int swap)
{
  if (s->length + count > SAMPLE_BYTES) abort();
  for (size_t i = 0; i < count; ++i) s->bytes[s->length++] = ((const char *)bytes)[swap ? count - 1 - i : i];
}

/* A number of `size` bytes: an integer, or (negative size) a floating-point number. */
static void PutNumber(Sample *s, int size, int swap, double value)
{
  const int64_t integer = (int64_t)value;
  const float single = (float)value;

  if (size > 0) {
    const uint64_t bits = (uint64_t)integer;
    PutBytes(s, &bits, (size_t)size, swap); /* little endian: the low bytes come first */
  } else if (size == -4) {
    PutBytes(s, &single, 4, swap);
  } else {
    PutBytes(s, &value, 8, swap);
  }
}

static void PutVertices(Sample *s, int size, int swap)
{
  for (int i = 0; i < 15; ++i) PutNumber(s, size, swap, sample_vertices[i]);
}

static void PutVertexLines(Sample *s, const char *before, const char *after)
{
  for (int i = 0; i < 5; ++i) {
    const double *x = sample_vertices + 3 * i;
    Put(s, "%s%.17g %.17g %.17g%s", before, x[0], x[1], x[2], after);
  }
}

static void PutBase64(Sample *s, const Sample *data)
{
  static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

  for (size_t i = 0; i < data->length; i += 3) {
    const size_t left = data->length - i;
    unsigned group = 0;

    for (size_t k = 0; k < 3; ++k) group = group << 8 | (k < left ? (unsigned char)data->bytes[i + k] : 0);
    Put(s, "%c%c%c%c", digit[group >> 18], digit[group >> 12 & 63], left > 1 ? digit[group >> 6 & 63] : '=',
        left > 2 ? digit[group & 63] : '=');
  }
}

static Sample *Begin(Sample *samples, int *count, const char *name, const char *suffix, PetscInt cell_size)
{
  Sample *s = &samples[(*count)++];

  if (*count > MAX_SAMPLES) abort();
  *s = (Sample){.name = name, .suffix = suffix, .cell_size = cell_size};
  return s;
}

static void MakeObj(Sample *samples, int *count)
{
  Sample *s = Begin(samples, count, "OBJ", "obj", 3);

  PutVertexLines(s, "v ", "\n");
  for (int i = 0; i < 4; ++i) {
    const int *t = sample_triangles + 3 * i;
    Put(s, "f %d %d %d\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  s = Begin(samples, count, "OBJ with everything", "obj", 3);
  Put(s, "\357\273\277# comment\r\nmtllib a.mtl\r\no thing\r\nf 1/2/3 2//4 3/1\r\n");
  PutVertexLines(s, "  v\t", " 0.5 0.5 0.5\r\n");
  Put(s, "vn 0 0 1\r\nvt 0 0\r\ns off\r\nusemtl x\r\nf -5 -3 \\\r\n -2\r\nl 1 2\r\nf 1 4 5 # comment\r\nf 1 5 2");
}

static void MakeOff(Sample *samples, int *count)
{
  Sample *s = Begin(samples, count, "OFF", "off", 3);

  Put(s, "OFF\n5 4 0\n");
  PutVertexLines(s, "", "\n");
  for (int i = 0; i < 4; ++i)
    Put(s, "3 %d %d %d\n", sample_triangles[3 * i], sample_triangles[3 * i + 1], sample_triangles[3 * i + 2]);
  s = Begin(samples, count, "COFF with comments", "off", 3);
  Put(s, "# made by hand\nCOFF 5 4 # counts\n\n");
  PutVertexLines(s, "", " 255 0 0 255\n# x\n");
  for (int i = 0; i < 4; ++i)
    Put(s, "3 %d %d %d 0 0 1\n", sample_triangles[3 * i], sample_triangles[3 * i + 1], sample_triangles[3 * i + 2]);
}

static void MakePlyAscii(Sample *samples, int *count)
{
  Sample *s = Begin(samples, count, "PLY ASCII", "ply", 3);

  Put(s,
      "ply\nformat ascii 1.0\ncomment hello\nelement vertex 5\nproperty float x\nproperty double y\nproperty float z\n"
      "property uchar red\nelement face 4\nproperty uchar group\nproperty list uchar int vertex_index\n"
      "element edge 1\nproperty int vertex1\nproperty list int float weights\nend_header\n");
  PutVertexLines(s, "", " 255\n");
  for (int i = 0; i < 4; ++i)
    Put(s, "7 3 %d %d %d\n", sample_triangles[3 * i], sample_triangles[3 * i + 1], sample_triangles[3 * i + 2]);
  Put(s, "4 2 0.5 0.25\n");
}

static void MakePlyBinary(Sample *samples, int *count, int big, int real, int count_size, int index_size)
{
  static const char *const integer[] = {"", "uchar", "ushort", "", "int", "", "", "", "int64"};
  Sample *s = Begin(samples, count, big ? "PLY big endian" : "PLY little endian", "ply", 3);
  const char *type = real == -4 ? "float" : "double";

  Put(s,
      "ply\r\nformat binary_%s_endian 1.0\r\nelement camera 1\r\nproperty short id\r\nproperty list uchar double f\r\n",
      big ? "big" : "little");
  Put(s, "element face 4\r\nproperty list %s %s vertex_indices\r\n", integer[count_size], integer[index_size]);
  Put(s,
      "element vertex 5\r\nproperty %s x\r\nproperty %s y\r\nproperty %s z\r\nproperty list uint int "
      "none\r\nend_header\r\n",
      type, type, type);
  PutNumber(s, 2, big, 7);
  PutNumber(s, 1, big, 2);
  PutNumber(s, -8, big, 0.5);
  PutNumber(s, -8, big, 0.5);
  for (int i = 0; i < 4; ++i) {
    PutNumber(s, count_size, big, 3);
    for (int k = 0; k < 3; ++k) PutNumber(s, index_size, big, sample_triangles[3 * i + k]);
  }
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; k < 3; ++k) PutNumber(s, real, big, sample_vertices[3 * i + k]);
    PutNumber(s, 4, big, 0);
  }
}

static void MakeStl(Sample *samples, int *count)
{
  Sample *s = Begin(samples, count, "STL ASCII", "stl", 3), *b;

  Put(s, "solid thing\n");
  b = Begin(samples, count, "STL binary", "stl", 3);
  Put(b, "solid, but binary%63s", "");
  PutNumber(b, 4, 0, 4);
  for (int i = 0; i < 4; ++i) {
    Put(s, " facet normal 0 0 1\n  outer loop\n");
    for (int k = 0; k < 3; ++k) PutNumber(b, -4, 0, 0);
    for (int k = 0; k < 3; ++k) {
      const double *x = sample_vertices + 3 * sample_triangles[3 * i + k];
      Put(s, "   vertex %g %g %g\n", x[0], x[1], x[2]);
      for (int j = 0; j < 3; ++j) PutNumber(b, -4, 0, x[j]);
    }
    Put(s, "  endloop\n endfacet\n");
    PutNumber(b, 2, 0, 0);
  }
  Put(s, "endsolid thing\n");
}

/* Tags 10, 20, ... in disorder, to be found and not to be computed. */
static int Tag(int vertex)
{
  static const int tag[5] = {10, 7, 30, 1000, 3};

  return tag[vertex];
}

/* Version 2.2, with a point, a line and (for tetrahedra) a triangle beside the cells. */
static void MakeGmsh2(Sample *samples, int *count, int binary, int big, PetscInt size)
{
  Sample *s = Begin(samples, count, binary ? "MSH 2.2 binary" : "MSH 2.2 ASCII", "msh", size);
  const int *cells = size == 3 ? sample_triangles : sample_tetrahedra, num_cells = size == 3 ? 4 : 2;

  Put(s, "$MeshFormat\n2.2 %d 8\n", binary);
  if (binary) {
    PutNumber(s, 4, big, 1);
    Put(s, "\n");
  }
  Put(s, "$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"skin\"\n$EndPhysicalNames\n$Nodes\n5\n");
  for (int i = 0; i < 5; ++i) {
    const double *x = sample_vertices + 3 * i;
    if (!binary) {
      Put(s, "%d %.17g %.17g %.17g\n", Tag(i), x[0], x[1], x[2]);
      continue;
    }
    PutNumber(s, 4, big, Tag(i));
    for (int k = 0; k < 3; ++k) PutNumber(s, -8, big, x[k]);
  }
  Put(s, "$EndNodes\n$Elements\n%d\n", num_cells + (size == 4 ? 2 : 1));
  if (!binary) {
    Put(s, "1 15 2 0 1 %d\n", Tag(0));
    if (size == 4) Put(s, "2 2 2 0 1 %d %d %d\n", Tag(0), Tag(1), Tag(2));
  } else {
    const int point[] = {15, 1, 2, 1, 0, 1, 10}, triangle[] = {2, 1, 2, 2, 0, 1, 10, 7, 30};
    for (int k = 0; k < 7; ++k) PutNumber(s, 4, big, point[k]);
    for (int k = 0; size == 4 && k < 9; ++k) PutNumber(s, 4, big, triangle[k]);
    PutNumber(s, 4, big, size == 3 ? 2 : 4);
    PutNumber(s, 4, big, num_cells);
    PutNumber(s, 4, big, 2);
  }
  for (int i = 0; i < num_cells; ++i) {
    if (!binary) Put(s, "%d %d 2 0 1", i + 3, size == 3 ? 2 : 4);
    for (int k = 0; binary && k < 3; ++k) PutNumber(s, 4, big, i + 3);
    for (int k = 0; k < size; ++k) {
      if (!binary)
        Put(s, " %d", Tag(cells[size * i + k]));
      else
        PutNumber(s, 4, big, Tag(cells[size * i + k]));
    }
    if (!binary) Put(s, "\n");
  }
  Put(s, "$EndElements\n");
}

static void PutGmsh4Numbers(Sample *s, int binary, int big, const char *sizes, ...)
{
  va_list arguments;

  va_start(arguments, sizes);
  for (const char *c = sizes; *c; ++c) {
    const int value = va_arg(arguments, int);
    if (binary)
      PutNumber(s, *c - '0', big, value);
    else
      Put(s, "%d%c", value, c[1] ? ' ' : '\n');
  }
  va_end(arguments);
}

/* Version 4.1: nodes in two blocks, the second with a parameter each; elements in two blocks. */
static void MakeGmsh4(Sample *samples, int *count, int binary, int big, PetscInt size)
{
  Sample *s = Begin(samples, count, binary ? "MSH 4.1 binary" : "MSH 4.1 ASCII", "msh", size);
  const int *cells = size == 3 ? sample_triangles : sample_tetrahedra, num_cells = size == 3 ? 4 : 2;

  Put(s, "$MeshFormat\n4.1 %d 8\n", binary);
  if (binary) {
    PutNumber(s, 4, big, 1);
    Put(s, "\n");
  }
  Put(s, "$EndMeshFormat\n$Nodes\n");
  PutGmsh4Numbers(s, binary, big, "8888", 2, 5, 3, 1000);
  for (int block = 0; block < 2; ++block) {
    const int from = block ? 3 : 0, to = block ? 5 : 3;
    PutGmsh4Numbers(s, binary, big, "4448", block ? 1 : 2, 1, block, to - from);
    for (int i = from; i < to; ++i) PutGmsh4Numbers(s, binary, big, "8", Tag(i));
    for (int i = from; i < to; ++i) {
      const double *x = sample_vertices + 3 * i;
      for (int k = 0; binary && k < 3; ++k) PutNumber(s, -8, big, x[k]);
      if (binary && block) PutNumber(s, -8, big, 0.5);
      if (!binary) Put(s, "%.17g %.17g %.17g%s\n", x[0], x[1], x[2], block ? " 0.5" : "");
    }
  }
  Put(s, "%s$EndNodes\n$Elements\n", binary ? "\n" : "");
  PutGmsh4Numbers(s, binary, big, "8888", 2, num_cells + 1, 1, num_cells + 1);
  PutGmsh4Numbers(s, binary, big, "4448", 0, 1, 15, 1);
  PutGmsh4Numbers(s, binary, big, "88", 1, Tag(0));
  PutGmsh4Numbers(s, binary, big, "4448", size - 1, 1, size == 3 ? 2 : 4, num_cells);
  for (int i = 0; i < num_cells; ++i) {
    const int *cell = cells + size * i;
    PutGmsh4Numbers(s, binary, big, size == 3 ? "8888" : "88888", i + 2, Tag(cell[0]), Tag(cell[1]), Tag(cell[2]),
                    Tag(cell[size - 1]));
  }
  Put(s, "%s$EndElements\n", binary ? "\n" : "");
}

/* Polygons or cells, in the way of version 5 or as before. */
static void PutVtkCells(Sample *s, int binary, int version, PetscInt size, int num_cells, const int *cells)
{
  if (version == 5) {
    Put(s, "%s %d %d\nOFFSETS vtktypeint64\n", size == 3 ? "POLYGONS" : "CELLS", num_cells + 1, num_cells * (int)size);
    for (int i = 0; i <= num_cells; ++i) {
      if (binary)
        PutNumber(s, 8, 1, i * (int)size);
      else
        Put(s, "%d ", i * (int)size);
    }
    Put(s, "\nCONNECTIVITY vtktypeint64\n");
    for (int i = 0; i < num_cells * size; ++i) {
      if (binary)
        PutNumber(s, 8, 1, cells[i]);
      else
        Put(s, "%d ", cells[i]);
    }
  } else {
    Put(s, "%s %d %d\n", size == 3 ? "POLYGONS" : "CELLS", num_cells, num_cells * (int)(size + 1));
    for (int i = 0; i < num_cells; ++i) {
      if (binary)
        PutNumber(s, 4, 1, (double)size);
      else
        Put(s, "%d ", (int)size);
      for (int k = 0; k < size; ++k) {
        if (binary)
          PutNumber(s, 4, 1, cells[size * i + k]);
        else
          Put(s, "%d ", cells[size * i + k]);
      }
    }
  }
}

static void MakeVtk(Sample *samples, int *count, int binary, int version, PetscInt size)
{
  Sample *s = Begin(samples, count, binary ? "VTK binary" : "VTK ASCII", "vtk", size);
  const int *cells = size == 3 ? sample_triangles : sample_tetrahedra, num_cells = size == 3 ? 4 : 2;

  Put(s, "# vtk DataFile Version %d.%d\na title\n%s\nDATASET %s\n", version, version == 5 ? 1 : 0,
      binary ? "BINARY" : "ASCII", size == 3 ? "POLYDATA" : "UNSTRUCTURED_GRID");
  Put(s, "FIELD FieldData 1\nTIME 1 1 int\n%sPOINTS 5 float\n", binary ? "\1\2\3\4\n" : "7\n");
  if (binary)
    PutVertices(s, -4, 1);
  else
    PutVertexLines(s, "", "\n");
  Put(s, "\nMETADATA\nINFORMATION 0\n\n");
  if (size == 3 && version < 5) {
    Put(s, "LINES 1 3\n");
    for (int k = 0; k < 3; ++k) {
      if (binary)
        PutNumber(s, 4, 1, k ? k : 2);
      else
        Put(s, "%d ", k ? k : 2);
    }
    Put(s, "\n");
  }
  PutVtkCells(s, binary, version, size, num_cells, cells);
  if (size == 4) {
    Put(s, "\nCELL_TYPES 2\n");
    for (int i = 0; i < 2; ++i) {
      if (binary)
        PutNumber(s, 4, 1, 10);
      else
        Put(s, "10\n");
    }
  }
  Put(s, "\nCELL_DATA %d\nSCALARS a int\nLOOKUP_TABLE default\n1 2", num_cells);
}

#include "format_samples_xml.h"
#include "format_samples_medit.h"
#include "format_samples_faces.h"

/* Fill `samples` (MAX_SAMPLES) and return how many there are. */
static int MakeSamples(Sample *samples)
{
  int count = 0;

  MakeObj(samples, &count);
  MakeOff(samples, &count);
  MakePlyAscii(samples, &count);
  MakePlyBinary(samples, &count, 0, -8, 1, 4);
  MakePlyBinary(samples, &count, 1, -4, 2, 1);
  MakePlyBinary(samples, &count, 1, -8, 4, 8);
  MakeStl(samples, &count);
  for (PetscInt size = 3; size <= 4; ++size) {
    for (int way = 0; way < 3; ++way) { /* ASCII, little and big endian */
      MakeGmsh2(samples, &count, way > 0, way == 2, size);
      MakeGmsh4(samples, &count, way > 0, way == 2, size);
    }
    for (int binary = 0; binary < 2; ++binary) {
      MakeVtk(samples, &count, binary, 3, size);
      MakeVtk(samples, &count, binary, 5, size);
    }
  }
  MakeAllVtu(samples, &count);
  MakeAllMedit(samples, &count);
  MakeAllFaces(samples, &count);
  for (int way = 0; way < 3; ++way) MakeGifti(samples, &count, way);
  return count;
}

#endif
