/* Text files that every rank reads a part of: the same mesh, with all that belongs to it, as one rank reads alone,
   wherever the parts are cut; and files that are not as they should be are left to the reader on one rank. */
#include "support/testing.h"
#include "format/format.h"
#include "mesh/soup_private.h"
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char file[256];

/* A text that grows, with line ends of one kind. */
typedef struct {
  char bytes[1 << 17];
  size_t length;
  const char *end;
} Text;

static void Line(Text *text, const char *format, ...) PETSC_ATTRIBUTE_FORMAT(2, 3);
static void Line(Text *text, const char *format, ...)
{
  va_list arguments;

  va_start(arguments, format);
  text->length += (size_t)vsnprintf(text->bytes + text->length, sizeof(text->bytes) - text->length, format, arguments);
  va_end(arguments);
  text->length += (size_t)snprintf(text->bytes + text->length, sizeof(text->bytes) - text->length, "%s", text->end);
}

static PetscErrorCode WriteText(const Text *text)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) {
    FILE *const stream = fopen(file, "wb");
    CHECK(stream && fwrite(text->bytes, 1, text->length, stream) == text->length && !fclose(stream), "cannot write %s",
          file);
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(0);
}

/* Is the file understood in parts? */
static PetscErrorCode ReadsInParts(PetscBool *understood)
{
  EqmFilePart part;
  EqmSerialMesh mesh = {0};

  PetscFunctionBegin;
  PetscCall(EqmFilePartRead(PETSC_COMM_WORLD, file, &part, understood));
  CHECK(*understood, "no parts of %s", file);
  PetscCall(EqmFormatOfSuffix(file)->parse_part(PETSC_COMM_WORLD, &part, &mesh, understood));
  free(part.bytes);
  PetscCall(EqmSerialMeshReset(&mesh));
  PetscFunctionReturn(0);
}

/* A rank without rows may have no array. */
static PetscBool IsSame(const void *a, const void *b, size_t bytes)
{
  return bytes == 0 || !memcmp(a, b, bytes) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode CheckSame(EqmSoup alone, EqmSoup together)
{
  const PetscInt v = together->vertex_start, c = together->cell_start;
  const size_t num_vertices = (size_t)(together->vertex_end - v), num_cells = (size_t)(together->cell_end - c);

  PetscFunctionBegin;
  CHECK(together->num_vertices == alone->num_vertices && together->num_cells == alone->num_cells,
        "%d vertices, %d cells; alone %d, %d", (int)together->num_vertices, (int)together->num_cells,
        (int)alone->num_vertices, (int)alone->num_cells);
  CHECK(IsSame(together->vertices, alone->vertices + 3 * v, 3 * num_vertices * sizeof(PetscReal)), "other vertices");
  CHECK(IsSame(together->cells, alone->cells + 3 * c, 3 * num_cells * sizeof(PetscInt)), "other triangles");
  CHECK(together->checksum == alone->checksum, "another checksum");
  CHECK(!strcmp(together->note, alone->note), "'%s', alone '%s'", together->note, alone->note);
  CHECK(!strcmp(together->left, alone->left), "left out '%s', alone '%s'", together->left, alone->left);
  CHECK(!together->metadata == !alone->metadata && (!alone->metadata || !strcmp(together->metadata, alone->metadata)),
        "'%s', alone '%s'", together->metadata, alone->metadata);
  CHECK(together->num_fields == alone->num_fields, "%d fields, alone %d", (int)together->num_fields,
        (int)alone->num_fields);
  for (PetscInt f = 0; f < alone->num_fields; f++) {
    const EqmMeshField *const a = &alone->fields[f], *const b = &together->fields[f];
    CHECK(!strcmp(a->name, b->name) && a->width == b->width && a->on_cells && b->on_cells, "field %s, alone %s",
          b->name, a->name);
    CHECK(IsSame(b->values, a->values + a->width * c, num_cells * (size_t)a->width * sizeof(PetscReal)),
          "other values of %s", a->name);
  }
  PetscFunctionReturn(0);
}

/* Every rank reads the file alone, too. */
static PetscErrorCode CheckRead(const Text *text, PetscInt num_fields)
{
  EqmSoup alone, together;
  PetscBool understood;

  PetscFunctionBegin;
  PetscCall(WriteText(text));
  PetscCall(ReadsInParts(&understood));
  CHECK(understood, "a good file is not understood in parts");
  PetscCall(EqmSoupRead(PETSC_COMM_SELF, file, &alone));
  PetscCall(EqmSoupRead(PETSC_COMM_WORLD, file, &together));
  CHECK(alone->num_fields == num_fields, "%d fields instead of %d", (int)alone->num_fields, (int)num_fields);
  PetscCall(CheckSame(alone, together));
  PetscCall(EqmSoupDestroy(&alone));
  PetscCall(EqmSoupDestroy(&together));
  PetscFunctionReturn(0);
}

enum { QUADS = 1, TEXTURE = 2, GROUPS = 4, BACKWARDS = 8, MIXED = 16, NUMBERS = 32 };

static void Face(Text *text, int kinds, int num, const int *corner, const char *rest)
{
  char line[200];
  int used = snprintf(line, sizeof(line), "f");

  for (int k = 0; k < num; k++) {
    used += snprintf(line + used, sizeof(line) - (size_t)used,
                     kinds & TEXTURE ? " %d/%d"
                     : k             ? " %d"
                                     : " %d//1",
                     corner[k], corner[k]);
  }
  Line(text, "%s%s", line, rest);
}

/* Rows of squares, `MIXED`: each row's faces directly behind its vertices; with lines that say nothing. */
static void MakeObj(Text *text, PetscInt n, int kinds, const char *end)
{
  *text = (Text){.end = end};
  Line(text, "# made \\");
  Line(text, "mtllib none.mtl");
  for (PetscInt j = 0, passes = kinds & MIXED ? 1 : 2; j < passes * n; j++) {
    const PetscInt row = j % n;
    for (PetscInt i = 0; i < n && j < n; i++) {
      Line(text, i % 3 ? "v %.17g %g %g" : "  v  %.17g\t%g %g ", (double)i / 3., (double)row, .01 * (double)(i * row));
      if (kinds & TEXTURE)
        Line(text, i % 5 ? "vt %g %g" : "vt %g %g 0", (double)i / (double)n, (double)row / (double)n);
      if (i % 4 == 0) Line(text, "vn 0 0 1");
    }
    if (row == 2) Line(text, "usemtl paint");
    if (row % 4 == 1) Line(text, "%s", "");
    if (kinds & GROUPS && row % 3 == 1) Line(text, row % 2 ? "g part %d" : "o part %d", (int)(row / 2 % 4));
    if (kinds & NUMBERS && row % 2 == 1) Line(text, "g group_%d", (int)(row < 8 ? row : row / 2));
    for (PetscInt i = 0; i + 1 < n && row > 0 && (kinds & MIXED || j >= n); i++) {
      const PetscInt last = kinds & MIXED ? (row + 1) * n : n * n, shift = kinds & BACKWARDS ? -last - 1 : 0;
      const int a = (int)((row - 1) * n + i + 1 + shift), b = a + 1, c = b + (int)n, d = a + (int)n;
      if (kinds & QUADS && i % 2 == 0) {
        Face(text, kinds, 3, (const int[]){a, b, c}, " \\");
        Line(text, kinds & TEXTURE ? "  %d/%d" : "  %d", d, d);
      } else if (kinds & QUADS) {
        Face(text, kinds, 4, (const int[]){a, b, c, d}, " # a face");
      } else {
        Face(text, kinds, 3, (const int[]){a, b, c}, "");
      }
    }
  }
}

/* The reader on one rank says what is wrong, with the line; here it is the same code on all. */
static PetscErrorCode CheckRefused(const Text *text, PetscErrorCode code)
{
  EqmSoup soup;
  PetscBool understood;

  PetscFunctionBegin;
  PetscCall(WriteText(text));
  PetscCall(ReadsInParts(&understood));
  CHECK(!understood, "a bad file is understood in parts");
  CHECK_FAILS(code, EqmSoupRead(PETSC_COMM_WORLD, file, &soup));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestObj(Text *text)
{
  static const char *const ends[] = {"\n", "\r\n", "\r"};
  static const struct {
    int kinds;
    PetscInt num_fields;
  } cases[] = {{0, 0},
               {BACKWARDS, 0},
               {QUADS | MIXED, 1},
               {TEXTURE | BACKWARDS | MIXED, 1},
               {GROUPS, 1},
               {QUADS | TEXTURE | GROUPS | NUMBERS | MIXED | BACKWARDS, 3},
               {QUADS | TEXTURE | NUMBERS | BACKWARDS, 3}};

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(cases); k++) {
    for (PetscInt n = 2; n <= 23; n += 7) {
      MakeObj(text, n, cases[k].kinds, ends[((size_t)n + k) % 3]);
      PetscCall(CheckRead(text, cases[k].num_fields));
    }
  }
  MakeObj(text, 9, 0, "\n");
  Line(text, "f 1 2 82");
  PetscCall(CheckRefused(text, EQM_ERR_IO));
  MakeObj(text, 9, BACKWARDS, "\n");
  Line(text, "f -1 -2 -82");
  PetscCall(CheckRefused(text, EQM_ERR_IO));
  MakeObj(text, 9, 0, "\n");
  memcpy(strstr(text->bytes + text->length / 2, "f "), "v ", 2); /* counts as a vertex, and is none */
  text->bytes[text->length / 2 + 200] = '?';
  PetscCall(CheckRefused(text, EQM_ERR_IO));
  *text = (Text){.end = "\n"};
  for (int k = 0; k < 50; k++) Line(text, "v %d 0 0", k);
  PetscCall(CheckRefused(text, EQM_ERR_MESH));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  char folder[200];
  PetscMPIInt rank;
  Text *text;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  snprintf(folder, sizeof(folder), "%s/equimap-parts-XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  if (rank == 0) CHECK(mkdtemp(folder), "no folder %s", folder);
  PetscCallMPI(MPI_Bcast(folder, sizeof(folder), MPI_CHAR, 0, PETSC_COMM_WORLD));
  snprintf(file, sizeof(file), "%s/mesh.obj", folder);
  PetscCall(PetscMalloc1(1, &text));
  PetscCall(TestObj(text));
  PetscCall(PetscFree(text));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  if (rank == 0) CHECK(!unlink(file) && !rmdir(folder), "cannot remove %s", folder);
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
