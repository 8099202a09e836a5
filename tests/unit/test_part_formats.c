/* Formats that every rank reads a part of, as other programs and as this one write them: the same mesh, with all that
   belongs to it, as one rank reads alone. */
#include "support/parts.h"
#include "mesh/fields.h"

/* A row of a face with a number before it and a list behind it. */
static void PlyFace(Text *text, PetscBool ascii, int num, const int *corner, int num_marks)
{
  const unsigned char flags = (unsigned char)corner[0], count = (unsigned char)num, marks = (unsigned char)num_marks;
  const short mark = 17;

  if (ascii) {
    char line[120];
    int used = snprintf(line, sizeof(line), "%d %d", flags, num);

    for (int k = 0; k < num; k++) used += snprintf(line + used, sizeof(line) - (size_t)used, " %d", corner[k]);
    used += snprintf(line + used, sizeof(line) - (size_t)used, " %d", num_marks);
    for (int k = 0; k < num_marks; k++) used += snprintf(line + used, sizeof(line) - (size_t)used, " %d", mark);
    Line(text, "%s", line);
    return;
  }
  Bytes(text, &flags, 1);
  Bytes(text, &count, 1);
  Bytes(text, corner, (size_t)num * sizeof(int));
  Bytes(text, &marks, 1);
  for (int k = 0; k < num_marks; k++) Bytes(text, &mark, sizeof(mark));
}

/* Faces of three and four corners, and fields; in bytes, where a row begins nobody can say beforehand. */
static void MakePly(Text *text, PetscInt n, PetscBool ascii)
{
  *text = (Text){.end = "\n"};
  Line(text, "ply");
  Line(text, "format %s 1.0", ascii ? "ascii" : "binary_little_endian");
  Line(text, "element vertex %d", (int)(n * n));
  Line(text, "property double x\nproperty double y\nproperty double z\nproperty uchar red");
  Line(text, "element face %d", (int)((n - 1) * (n - 1) + (n - 1) * ((n - 1) / 2)));
  Line(text, "property uchar flags\nproperty list uchar int vertex_indices\nproperty list uchar short marks");
  Line(text, "end_header");
  for (PetscInt i = 0; i < n * n; i++) {
    const double x[3] = {(double)(i % n) / 3., (double)(i / n), .1 * (double)i};
    const unsigned char red = (unsigned char)(i % 200);

    if (ascii) Line(text, i % 7 ? "%.17g %.17g %.17g %d" : "%.17g\t%.17g  %.17g %d \n", x[0], x[1], x[2], red);
    if (!ascii) Bytes(text, x, sizeof(x));
    if (!ascii) Bytes(text, &red, 1);
  }
  for (PetscInt i = 0; i < (n - 1) * (n - 1); i++) {
    const int a = (int)(i / (n - 1) * n + i % (n - 1)), b = a + 1, c = b + (int)n, d = a + (int)n;

    if (i % (n - 1) % 2 == 0) {
      PlyFace(text, ascii, 4, (const int[]){a, b, c, d}, (int)(i % 3));
    } else {
      PlyFace(text, ascii, 3, (const int[]){a, b, c}, 2);
      PlyFace(text, ascii, 3, (const int[]){a, c, d}, 0);
    }
  }
}

static PetscErrorCode TestPly(Text *text)
{
  PetscFunctionBegin;
  Name("ply");
  for (PetscInt n = 3; n <= 23; n += 10) {
    MakePly(text, n, PETSC_TRUE);
    PetscCall(CheckRead(text, 3));
    MakePly(text, n, PETSC_FALSE);
    PetscCall(CheckRead(text, 3));
  }
  text->length -= 5;
  PetscCall(CheckRefused(text, EQM_ERR_IO));
  MakePly(text, 9, PETSC_TRUE);
  text->length -= 12;
  PetscCall(CheckRefused(text, EQM_ERR_IO));
  *text = (Text){.end = "\n"};
  Line(text, "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z");
  Line(text, "element face 1\nproperty list uchar int vertex_indices\nend_header\n0\n1\n2\n3\n3 0 1 2");
  PetscCall(CheckRefused(text, EQM_ERR_IO)); /* as many lines as rows, of too few bytes */
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(0);
}

/* A section must begin on a line of its own. */
static PetscErrorCode TestMsh(Text *text)
{
  PetscFunctionBegin;
  Name("msh");
  for (int joined = 0; joined < 2; joined++) {
    *text = (Text){.end = "\n"};
    Line(text, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"skin\"");
    Line(text, joined ? "$EndPhysicalNames$Nodes\n3" : "$EndPhysicalNames\n$Nodes\n3");
    Line(text, "1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n1 2 2 1 1 1 2 3\n$EndElements");
    PetscCall(joined ? CheckRefused(text, EQM_ERR_IO) : CheckRead(text, 1));
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD)); /* before the file changes */
  PetscFunctionReturn(0);
}

/* What the writers make of surfaces with groups, textures without and with seams, and fields. */
static PetscErrorCode TestWritten(Text *text)
{
  static const int kinds[] = {0, TEXTURE, TEXTURE | GROUPS | MIXED | QUADS};
  static const char *const suffixes[] = {"ply", "text.ply", "stl", "vtu", "msh", "off", "mesh", "meshb"};

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(kinds); k++) {
    EqmSoup soup;

    MakeObjText(text, 19, kinds[k], "\n");
    if (kinds[k] & GROUPS) memcpy(strstr(text->bytes + text->length / 2, "f "), "f 1/2", 5); /* a seam */
    Name("obj");
    PetscCall(WriteFile(file, text->bytes, text->length));
    PetscCall(EqmSoupRead(PETSC_COMM_WORLD, file, &soup));
    for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(suffixes); f++) {
      Name(suffixes[f]);
      PetscCall(EqmSoupWrite(soup, file));
      PetscCall(CheckFile(-1));
    }
    PetscCall(EqmSoupDestroy(&soup));
  }
  PetscFunctionReturn(0);
}

/* Medit's text and bytes: of solids, as this program writes them; and with words in the way and rows that do not keep
   to lines, which are read in parts where no part ends within one. */
static PetscErrorCode TestMedit(Text *text)
{
  static const char *const suffixes[] = {"mesh", "meshb"};
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "blob", 3000, 1, &soup));
  for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(suffixes); f++) {
    Name(suffixes[f]);
    PetscCall(EqmSoupWrite(soup, file));
    PetscCall(CheckFile(-1));
  }
  PetscCall(EqmSoupDestroy(&soup));
  Name("mesh");
  *text = (Text){.end = "\n"};
  Line(text, "# made\nMeshVersionFormatted 2 Dimension\n\n2\nVertices 400");
  for (int v = 0; v < 400; v++) Line(text, v % 3 ? "%d %d 0" : "%d # nan 7\n%d\n 1", v / 20, v % 20);
  Line(text, "Dimension 3\nCorners\n4\n1 2 3 nan\nNormals 1 End.5 0\nTrianglesP2 0\nQuadrilaterals\n# so many:\n361");
  for (int v = 0; v < 380; v++) {
    if (v % 20 < 19) Line(text, "%d %d %d %d %d", v + 1, v + 21, v + 22, v + 2, v % 7);
  }
  Line(text, "tRiangles 1 1 2 22 9\nEnd\nTriangles 8");
  PetscCall(WriteFile(file, text->bytes, text->length));
  PetscCall(EqmSoupRead(PETSC_COMM_WORLD, file, &soup));
  CHECK(soup->num_vertices == 400 && soup->num_cells == 2 * 361 + 1, "%d cells", (int)soup->num_cells);
  PetscCall(EqmSoupDestroy(&soup));
  PetscCall(CheckRead(text, 2));
  text->bytes[strstr(text->bytes, "381 ") - text->bytes] = '9'; /* a corner that is not there */
  PetscCall(CheckRefused(text, EQM_ERR_IO));
  PetscFunctionReturn(0);
}

/* Are the bytes of two files the same? On rank 0. */
static PetscBool AreEqual(const char *a, const char *b)
{
  FILE *const one = fopen(a, "rb"), *const other = fopen(b, "rb");
  int c = 0, d = 0;

  CHECK(one && other, "cannot read %s and %s", a, b);
  while (c == d && c != EOF) {
    c = getc(one);
    d = getc(other);
  }
  fclose(one);
  fclose(other);
  return c == d ? PETSC_TRUE : PETSC_FALSE;
}

/* A surface; with_texture - with texture points, of which some vertices have two: seams. */
static PetscErrorCode MakeHills(MPI_Comm comm, PetscBool with_texture, EqmSoup *soup)
{
  const EqmMeshField kind = {.name = EQM_FIELD_TEXTURE, .on_cells = PETSC_TRUE, .width = 6};
  PetscReal *uv;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(comm, "hills", 60000, 1, soup));
  if (!with_texture) PetscFunctionReturn(0);
  const PetscInt num = 3 * ((*soup)->cell_end - (*soup)->cell_start);

  PetscCall(EqmMeshFieldsAdd(&(*soup)->num_fields, &(*soup)->fields, &kind, (size_t)num / 3, &uv));
  for (PetscInt k = 0; k < num; k++) {
    uv[2 * k] = (PetscReal)(*soup)->cells[k] / (*soup)->num_vertices;
    uv[2 * k + 1] = (PetscReal)(((*soup)->cell_start + k / 3) % 101 == 0);
  }
  PetscFunctionReturn(0);
}

/* Rank 0 writes what the others send, in blocks, as it writes what it has alone. */
static PetscErrorCode TestBlocks(PetscBool with_texture, size_t num_suffixes, const char *const *suffixes)
{
  char alone[300];
  EqmSoup together, whole;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(MakeHills(PETSC_COMM_WORLD, with_texture, &together));
  for (size_t f = 0; f < num_suffixes; f++) {
    Name(suffixes[f]);
    snprintf(alone, sizeof(alone), "%s/alone.%s", folder, suffixes[f]);
    PetscCall(EqmSoupWrite(together, file));
    if (rank) continue;
    PetscCall(MakeHills(PETSC_COMM_SELF, with_texture, &whole));
    PetscCall(EqmSoupWrite(whole, alone));
    PetscCall(EqmSoupDestroy(&whole));
    CHECK(AreEqual(file, alone), "%s is another file on several ranks", suffixes[f]);
    CHECK(!unlink(alone), "cannot remove %s", alone);
  }
  PetscCall(EqmSoupDestroy(&together));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  static const char *const suffixes[] = {"obj", "ply", "text.ply", "stl", "vtu", "msh", "off", "mesh", "meshb"};
  Text *text;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(MakeFolder());
  PetscCall(PetscMalloc1(1, &text));
  PetscCall(TestPly(text));
  PetscCall(TestMsh(text));
  PetscCall(TestWritten(text));
  PetscCall(TestMedit(text));
  PetscCall(TestBlocks(PETSC_FALSE, 5, (const char *const[]){"ply", "stl", "vtu", "msh", "off"}));
  PetscCall(TestBlocks(PETSC_TRUE, 2, (const char *const[]){"obj", "ply"}));
  PetscCall(PetscFree(text));
  PetscCall(RemoveFolder(PETSC_STATIC_ARRAY_LENGTH(suffixes), suffixes));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
