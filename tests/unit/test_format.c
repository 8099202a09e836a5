/* Every format is read as it was written, and every kind of bad file has an error of its own. */
#include <errno.h>
#include "mesh/soup_private.h"
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>
#include <equimap/soup.h>
#include "base/atomicfile.h"
#include "format/format.h"
#include "format/input.h"
#include "format_samples.h"
#include "support/checks.h"

/* Errors are expected here: their code is enough, nothing is printed. */
static PetscErrorCode Expected(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                               PetscErrorType type, const char *message, void *context)
{
  if (type == PETSC_ERROR_INITIAL) snprintf((char *)context, EQM_MESSAGE_MAX, "%s", message);
  return code;
}

/* A folder that all ranks know, made by rank 0. */
static char folder[128];

static const char *PathOf(const char *name)
{
  static char path[4][256];
  static int next;

  next = (next + 1) % 4;
  snprintf(path[next], sizeof(path[next]), "%s/%s", folder, name);
  return path[next];
}

static void WriteBytes(const char *path, const char *bytes, size_t length)
{
  int rank;
  FILE *file;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0) {
    file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, length, file) != length || fclose(file)) MPI_Abort(PETSC_COMM_WORLD, 1);
  }
  MPI_Barrier(PETSC_COMM_WORLD);
}

/* The slabs of a soup hold just these vertices and cells. */
static PetscBool SoupIs(EqmSoup soup, PetscInt num_vertices, const double *vertices, PetscInt cell_size,
                        PetscInt num_cells, const int *cells)
{
  if (soup->num_vertices != num_vertices || soup->num_cells != num_cells || soup->cell_size != cell_size)
    return PETSC_FALSE;
  for (PetscInt i = 3 * soup->vertex_start; i < 3 * soup->vertex_end; ++i) {
    if (memcmp(&soup->vertices[i - 3 * soup->vertex_start], &vertices[i], sizeof(double))) return PETSC_FALSE;
  }
  for (PetscInt i = cell_size * soup->cell_start; i < cell_size * soup->cell_end; ++i) {
    if (soup->cells[i - cell_size * soup->cell_start] != cells[i]) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

static void TestSamples(const char *message)
{
  Sample *samples = malloc(MAX_SAMPLES * sizeof(*samples));
  const int count = MakeSamples(samples);
  char name[32];

  for (int i = 0; i < count; ++i) {
    const Sample *s = &samples[i];
    PetscInt64 first_checksum = 0;

    for (int wrong_suffix = 0; wrong_suffix < 2; ++wrong_suffix) {
      EqmSoup soup = NULL;
      PetscErrorCode code;

      snprintf(name, sizeof(name), "sample.%s", wrong_suffix ? "xyz" : s->suffix);
      WriteBytes(PathOf(name), s->bytes, s->length);
      code = EqmSoupRead(PETSC_COMM_WORLD, PathOf(name), &soup);
      CHECK(!code, "%s (sample %d, .%s): %s", s->name, i, name, message);
      if (code) continue;
      CHECK(SoupIs(soup, 5, sample_vertices, s->cell_size, s->cell_size == 3 ? 4 : 2,
                   s->cell_size == 3 ? sample_triangles : sample_tetrahedra),
            "%s (sample %d): another mesh came back", s->name, i);
      if (!wrong_suffix) first_checksum = soup->checksum;
      CHECK(soup->checksum == first_checksum, "%s: the checksum changes", s->name);
      EqmSoupDestroy(&soup);
    }
  }
  free(samples);
}

/* Doubles that need all their digits. */
static const double hard_vertices[15] = {0.1,
                                         1.0 / 3,
                                         -0.0,
                                         1e-300,
                                         4.9406564584124654e-324,
                                         1.7976931348623157e308,
                                         M_PI,
                                         -1e22,
                                         1 + 1e-15,
                                         123456789.123456789,
                                         5e-7,
                                         9007199254740993.0,
                                         2.2250738585072011e-308,
                                         0.3,
                                         1e23};

static EqmSoup HardSoup(PetscInt cell_size)
{
  const PetscInt num_cells = cell_size == 3 ? 4 : 2;
  EqmSerialMesh mesh = {.num_vertices = 5, .num_cells = num_cells, .cell_size = cell_size};
  EqmSoup soup = NULL;
  int rank;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0) {
    if (PetscMalloc1(15, &mesh.vertices) || PetscMalloc1(cell_size * num_cells, &mesh.cells))
      MPI_Abort(PETSC_COMM_WORLD, 1);
    memcpy(mesh.vertices, hard_vertices, sizeof(hard_vertices));
    for (PetscInt i = 0; i < cell_size * num_cells; ++i)
      mesh.cells[i] = (cell_size == 3 ? sample_triangles : sample_tetrahedra)[i];
  }
  if (EqmSoupCreateFromRoot(PETSC_COMM_WORLD, rank ? NULL : &mesh, "hard", &soup)) MPI_Abort(PETSC_COMM_WORLD, 1);
  return soup;
}

static void TestWriters(const char *message)
{
  static const struct {
    const char *suffix;
    PetscBool solid, exact; /* holds tetrahedra, brings back the same bits */
  } kind[] = {{"obj", PETSC_FALSE, PETSC_TRUE},    {"off", PETSC_FALSE, PETSC_TRUE}, {"ply", PETSC_FALSE, PETSC_TRUE},
              {"vtu", PETSC_TRUE, PETSC_TRUE},     {"msh", PETSC_TRUE, PETSC_TRUE},  {"h5", PETSC_TRUE, PETSC_TRUE},
              {"vtk", PETSC_TRUE, PETSC_TRUE},     {"mesh", PETSC_TRUE, PETSC_TRUE}, {"meshb", PETSC_TRUE, PETSC_TRUE},
              {"node", PETSC_TRUE, PETSC_TRUE},    {"ele", PETSC_TRUE, PETSC_TRUE},  {"gii", PETSC_FALSE, PETSC_FALSE},
              {"white", PETSC_FALSE, PETSC_FALSE}, {"stl", PETSC_FALSE, PETSC_FALSE}};

  for (PetscInt size = 3; size <= 4; ++size) {
    EqmSoup soup = HardSoup(size);

    for (size_t i = 0; i < sizeof(kind) / sizeof(kind[0]); ++i) {
      const PetscBool solid = kind[i].solid, exact = kind[i].exact;
      EqmSoup back = NULL;
      char name[32];
      PetscErrorCode code;

      snprintf(name, sizeof(name), "out%d.%s", (int)size, kind[i].suffix);
      code = EqmSoupWrite(soup, PathOf(name));
      CHECK(code == (size == 4 && !solid ? EQM_ERR_USAGE : 0), "writing %s: code %d: %s", name, code,
            code ? message : "");
      if (code || size == 4 || !exact) CHECK(code || !access(PathOf(name), R_OK), "%s is not there", name);
      if (code) continue;
      code = EqmSoupRead(PETSC_COMM_WORLD, PathOf(name), &back);
      CHECK(!code, "reading %s back: %s", name, message);
      if (code) continue;
      CHECK(!exact || SoupIs(back, 5, hard_vertices, size, size == 3 ? 4 : 2,
                             size == 3 ? sample_triangles : sample_tetrahedra),
            "%s: another mesh came back", name);
      CHECK(!exact || back->checksum == soup->checksum, "%s: another checksum came back", name);
      CHECK(back->num_cells == soup->num_cells, "%s: %d cells came back", name, (int)back->num_cells);
      EqmSoupDestroy(&back);
    }
    EqmSoupDestroy(&soup);
  }
}

static void TestFields(void)
{
  const PetscReal on_vertices[10] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 0.1}, on_cells[4] = {0.25, -1, 1e300, 3};
  const EqmField fields[] = {{"a & b", PETSC_FALSE, 2, on_vertices}, {"ratio", PETSC_TRUE, 1, on_cells}};
  PetscReal vertices[15];
  PetscInt cells[12];
  EqmSerialMesh mesh = {.num_vertices = 5, .num_cells = 4, .cell_size = 3, .vertices = vertices, .cells = cells},
                back = {0};
  char error[EQM_MESSAGE_MAX] = "", *bytes;
  static const char *const names[] = {"f.vtu", "f.ply", "f.gii", "f.obj", "f.vtk", "f.mesh", "f.msh"};
  size_t length;
  int rank;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank) return;
  for (int i = 0; i < 15; ++i) vertices[i] = sample_vertices[i];
  for (int i = 0; i < 12; ++i) cells[i] = sample_triangles[i];
  for (int i = 0; i < 7; ++i) {
    PetscErrorCode code = EqmFormatWriteSerial(PathOf(names[i]), &mesh, fields, 2, error, sizeof(error));

    CHECK(!code, "%s with fields: %s", names[i], error);
    if (code) continue;
    code = EqmFormatLoadBytes(PathOf(names[i]), &bytes, &length, error, sizeof(error));
    CHECK(!code, "%s", error);
    if (!code) code = EqmFormatOfSuffix(names[i])->parse(bytes, length, &back, error, sizeof(error));
    free(bytes);
    CHECK(!code && back.num_vertices == 5 && !memcmp(back.vertices, vertices, sizeof(vertices)), "%s: %s", names[i],
          error);
    EqmSerialMeshReset(&back);
  }
}

typedef struct {
  const char *name;
  PetscErrorCode code;
  const char *says; /* part of the message */
  const char *text;
} BadFile;

static const BadFile bad_files[] = {
    {"empty.obj", EQM_ERR_IO, "empty", ""},
    {"garbage.bin", EQM_ERR_IO, "known mesh format", "\1\2\3\4\5\6 nothing of ours"},
    {"garbage.obj", EQM_ERR_IO, "line 1", "\1\2\3\4\5\6"},
    {"prose.obj", EQM_ERR_IO, "not an OBJ file", "Dear reader,\nthis is a letter.\n"},
    {"points.obj", EQM_ERR_MESH, "no triangles", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"},
    {"range.obj", EQM_ERR_IO, "line 4: vertex index 99 is out of range 1..3",
     "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\nf 1 2 3\n"},
    {"huge.obj", EQM_ERR_IO, "out of range", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999\n"},
    {"zero.obj", EQM_ERR_IO, "line 4: vertex index 0 is out of range", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"},
    {"negative.obj", EQM_ERR_IO, "line 4: vertex index -4", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n"},
    {"short.obj", EQM_ERR_IO, "line 2", "v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n"},
    {"word.obj", EQM_ERR_IO, "line 2", "v 0 0 0\nv 1 zero 0\nv 0 1 0\nf 1 2 3\n"},
    {"edge.obj", EQM_ERR_IO, "2 corners", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n"},
    {"truncated.off", EQM_ERR_IO, "truncated", "OFF\n3 1 0\n0 0 0\n1 0 0\n"},
    {"liar.off", EQM_ERR_IO, "too short", "OFF\n1000000000000 1 0\n0 0 0\n"},
    {"range.off", EQM_ERR_IO, "line 6: vertex index 3 is out of range 0..2",
     "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"},
    {"corner.off", EQM_ERR_IO, "vertex index 4 is out of range 0..3",
     "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 4\n"},
    {"points.off", EQM_ERR_MESH, "no triangles", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"},
    {"binary.off", EQM_ERR_IO, "binary", "OFF BINARY\n"},
    {"four.off", EQM_ERR_IO, "OFF file begins", "4OFF\n3 1 0\n"},
    {"noend.ply", EQM_ERR_IO, "end_header", "ply\nformat ascii 1.0\nelement vertex 3\n"},
    {"noxyz.ply", EQM_ERR_IO, "x, y and z",
     "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"},
    {"liar.ply", EQM_ERR_IO, "too short",
     "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float "
     "z\nend_header\n0 0 0\n"},
    {"points.ply", EQM_ERR_MESH, "no triangles",
     "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 "
     "0\n"},
    {"nothing.ply", EQM_ERR_MESH, "no triangles",
     "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\n"
     "property list uchar int vertex_indices\nend_header\n"},
    {"truncated.stl", EQM_ERR_IO, "truncated", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"},
    {"none.stl", EQM_ERR_MESH, "no triangles", "solid a\nendsolid a\n"},
    {"garbage.stl", EQM_ERR_IO, "truncated", "this is no solid"},
    {"quads.msh", EQM_ERR_MESH, "type 16",
     "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n1\n1 "
     "16 0 1 2 3 4 1 2 3 4\n$EndElements\n"},
    {"second.msh", EQM_ERR_MESH, "type 11 with 10 nodes",
     "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 11 0 1 1 1 1 1 1 1 1 1 "
     "1\n$EndElements\n"},
    {"version.msh", EQM_ERR_IO, "version", "$MeshFormat\n1 0 8\n$EndMeshFormat\n"},
    {"node.msh", EQM_ERR_IO, "node 7",
     "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n2 1 0 0\n$EndNodes\n$Elements\n1\n1 2 0 1 2 "
     "7\n$EndElements\n"},
    {"twice.msh", EQM_ERR_IO, "two nodes",
     "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n1 0 1 0\n$EndNodes\n"},
    {"truncated.msh", EQM_ERR_IO, "truncated", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n"},
    {"truncated.vtu", EQM_ERR_IO, "XML",
     "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>"},
    {"image.vtu", EQM_ERR_IO, "ImageData", "<VTKFile type=\"ImageData\"><ImageData></ImageData></VTKFile>"},
    {"laughs.vtu", EQM_ERR_IO, "entities", "<!DOCTYPE a [<!ENTITY b \"c\">]>\n<VTKFile type=\"&b;\"></VTKFile>"},
    {"none.vtu", EQM_ERR_MESH, "no triangles",
     "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"0\" "
     "NumberOfCells=\"0\"/></UnstructuredGrid></VTKFile>"},
    {"garbage.vtk", EQM_ERR_IO, "ASCII or BINARY", "# vtk DataFile Version 3.0\ntitle\nNEITHER\n"},
    {"none.vtk", EQM_ERR_MESH, "no triangles",
     "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\n"},
    {"second.vtk", EQM_ERR_MESH, "VTK type 22",
     "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n0 0 0 1 0 0 1 1 0\nCELLS 1 "
     "7\n6 0 1 2 0 1 2\nCELL_TYPES 1\n22\n"},
    {"word.mesh", EQM_ERR_IO, "begins with MeshVersionFormatted", "MFEM mesh v1.0\n"},
    {"none.mesh", EQM_ERR_MESH, "no triangles", "MeshVersionFormatted 1\nDimension 3\nVertices 1\n0 0 0 0\nEnd\n"},
    {"truncated.mesh", EQM_ERR_IO, "line 4: vertex 1 of 2 needs 3 coordinates: the file is truncated",
     "MeshVersionFormatted 1\nDimension 3\nVertices 2\n0 0 0 0"},
    {"noend.mesh", EQM_ERR_IO, "End is missing", "MeshVersionFormatted 1\nDimension 3\nVertices 1\n0 0 0 0\n"},
    {"liar.mesh", EQM_ERR_IO, "too short", "MeshVersionFormatted 1\nDimension 3\nVertices 1000000000000\n0 0 0 0\n"},
    {"order.mesh", EQM_ERR_IO, "before the section Vertices",
     "MeshVersionFormatted 1\nDimension 3\nTriangles 1\n1 2 3 0\nEnd\n"},
    {"range.mesh", EQM_ERR_IO, "line 6: Triangles: vertex number 4 is out of range 1..3",
     "MeshVersionFormatted 1 Dimension 3\nVertices 3\n0 0 0 0\n1 0 0 0\n0 1 0 0 Triangles 1\n1 2 4 0\nEnd\n"},
    {"space.mesh", EQM_ERR_IO, "dimension 4", "MeshVersionFormatted 1\nDimension 4\nEnd\n"},
    {"bricks.mesh", EQM_ERR_MESH, "line 4: 1 Hexahedra",
     "MeshVersionFormatted 1\nDimension 3\nVertices 1 0 0 0 0\nHexahedra 1\n1 1 1 1 1 1 1 1 0\nEnd\n"},
    {"fake.meshb", EQM_ERR_IO, "begins with 1", "\1\2\3\4 and so on"},
    {"lonely.node", EQM_ERR_IO, "lonely.ele", "3 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"},
    {"lonely.tetgen", EQM_ERR_IO, "no .ele file", "3 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"},
    {"range.tetgen", EQM_ERR_IO, "line 2: .ele: vertex number 3 is out of range 0..2",
     "3 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n\f1 3 0\n1 0 1 3\n"},
    {"gap.tetgen", EQM_ERR_IO, "line 3: vertex number 3", "2 3 0 0\n1 0 0 0\n3 1 0 0\n\f1 3 0\n1 1 1 2\n"},
    {"truncated.tetgen", EQM_ERR_IO, "cell 1 of 2 is missing: the file is truncated",
     "3 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n\f2 3 0\n0 0 1 2\n"},
    {"liar.tetgen", EQM_ERR_IO, "too short", "1000000000 3 0 0\n0 0 0 0\n\f"},
    {"second.tetgen", EQM_ERR_MESH, "cells have 10 vertices", "1 3 0 0\n1 0 0 0\n\f1 10 0\n1 1 1 1 1 1 1 1 1 1 1\n"},
    {"none.gii", EQM_ERR_MESH, "no triangles", "<GIFTI Version=\"1.0\"></GIFTI>"},
    {"quads.white", EQM_ERR_IO, "mris_convert", "\377\377\375 quadrangles"},
    {"short.white", EQM_ERR_IO, "truncated", "\377\377\376made\n\n\1\1\1\1\1\1\1\1"},
    {"fake.h5", EQM_ERR_IO, "HDF5", "\211HDF\r\n\032\n and nothing more"},
};

static void TestBadFiles(char *message)
{
  EqmSoup soup = NULL;
  PetscErrorCode code;

  for (size_t i = 0; i < sizeof(bad_files) / sizeof(bad_files[0]); ++i) {
    const BadFile *bad = &bad_files[i];

    WriteBytes(PathOf(bad->name), bad->text, strlen(bad->text));
    message[0] = '\0';
    code = EqmSoupRead(PETSC_COMM_WORLD, PathOf(bad->name), &soup);
    CHECK(code == bad->code, "%s: code %d instead of %d: %s", bad->name, code, bad->code, message);
    CHECK(strstr(message, bad->says) && strstr(message, bad->name), "%s: the message does not say \"%s\": %s",
          bad->name, bad->says, message);
    CHECK(!soup, "%s: a soup beside an error", bad->name);
  }
  CHECK(EqmSoupRead(PETSC_COMM_WORLD, PathOf("missing.obj"), &soup) == EQM_ERR_IO, "a missing file");
  CHECK(EqmSoupRead(PETSC_COMM_WORLD, folder, &soup) == EQM_ERR_IO, "a folder instead of a file");
}

/* Entities are refused in every encoding; a document type without declarations is not. */
static void TestEntities(char *message)
{
  static const char laughs[] = "<?xml version=\"1.0\" encoding=\"UTF-16\"?>\n<!DOCTYPE a [<!ENTITY b \"ha\">]>\n"
                               "<VTKFile type=\"UnstructuredGrid\">&b;</VTKFile>\n";
  static const char typed[] = "<?xml version=\"1.0\"?>\n<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/gifti.dtd\">\n"
                              "<GIFTI Version=\"1.0\"></GIFTI>\n";
  char wide[2 * sizeof(laughs)] = "\377\376";
  EqmSoup soup = NULL;
  PetscErrorCode code;

  for (size_t i = 0; i + 1 < sizeof(laughs); ++i) {
    wide[2 + 2 * i] = laughs[i];
    wide[3 + 2 * i] = '\0';
  }
  WriteBytes(PathOf("wide.vtu"), wide, 2 * sizeof(laughs));
  message[0] = '\0';
  code = EqmSoupRead(PETSC_COMM_WORLD, PathOf("wide.vtu"), &soup);
  CHECK(code == EQM_ERR_IO && strstr(message, "entities") && !soup, "wide.vtu: code %d, %s", (int)code, message);
  WriteBytes(PathOf("typed.gii"), typed, sizeof(typed) - 1);
  code = EqmSoupRead(PETSC_COMM_WORLD, PathOf("typed.gii"), &soup);
  CHECK(code == EQM_ERR_MESH && strstr(message, "no triangles"), "typed.gii: code %d, %s", (int)code, message);
}

/* GIFTI's arrays in a binary file beside; one that is missing, too short or in another folder is refused. */
static void TestExternal(char *message)
{
  static const char text[] =
      "<GIFTI Version=\"1.0\"><DataArray Intent=\"NIFTI_INTENT_POINTSET\" DataType=\"NIFTI_TYPE_FLOAT32\" Dim0=\"5\" "
      "Dim1=\"3\" Encoding=\"ExternalFileBinary\" Endian=\"LittleEndian\" ExternalFileName=\"%s\" "
      "ExternalFileOffset=\"3\"/><DataArray Intent=\"NIFTI_INTENT_TRIANGLE\" DataType=\"NIFTI_TYPE_INT32\" Dim0=\"4\" "
      "Dim1=\"3\" Encoding=\"ExternalFileBinary\" Endian=\"LittleEndian\" ExternalFileName=\"%s\" "
      "ExternalFileOffset=\"%d\"/></GIFTI>";
  static const struct {
    const char *name;
    int offset;
    const char *says;
  } wrong[] = {{"none.dat", 63, "none.dat"}, {"data.dat", 64, "too short"}, {"../data.dat", 63, "beside"}};
  char bytes[2048], data[111] = "abc";
  EqmSoup soup = NULL;
  PetscErrorCode code;

  for (int i = 0; i < 15; ++i) {
    const float single = (float)sample_vertices[i];

    memcpy(data + 3 + 4 * i, &single, 4);
  }
  for (int i = 0; i < 12; ++i) memcpy(data + 63 + 4 * i, &sample_triangles[i], 4);
  WriteBytes(PathOf("data.dat"), data, sizeof(data));
  snprintf(bytes, sizeof(bytes), text, "data.dat", "data.dat", 63);
  WriteBytes(PathOf("external.gii"), bytes, strlen(bytes));
  code = EqmSoupRead(PETSC_COMM_WORLD, PathOf("external.gii"), &soup);
  CHECK(!code, "external.gii: %s", message);
  CHECK(code || SoupIs(soup, 5, sample_vertices, 3, 4, sample_triangles), "external.gii: another mesh");
  EqmSoupDestroy(&soup);
  for (int i = 0; i < 3; ++i) {
    snprintf(bytes, sizeof(bytes), text, "data.dat", wrong[i].name, wrong[i].offset);
    WriteBytes(PathOf("external.gii"), bytes, strlen(bytes));
    message[0] = '\0';
    code = EqmSoupRead(PETSC_COMM_WORLD, PathOf("external.gii"), &soup);
    CHECK(code == EQM_ERR_IO && strstr(message, wrong[i].says), "%s: code %d: %s", wrong[i].name, (int)code, message);
  }
}

/* Not a number is for the diagnosis to report, not for the reader. */
static void TestNotFinite(const char *message)
{
  static const char text[] = "v nan 0 0\nv 1 -inf 0\nv 0 1e999 NaN\nf 1 2 3\n";
  EqmSoup soup = NULL;
  PetscErrorCode code;

  WriteBytes(PathOf("nan.obj"), text, strlen(text));
  code = EqmSoupRead(PETSC_COMM_WORLD, PathOf("nan.obj"), &soup);
  CHECK(!code, "NaN in an OBJ file: %s", message);
  if (code) return;
  if (soup->vertex_start == 0 && soup->vertex_end > 0) CHECK(isnan(soup->vertices[0]), "nan is not NaN");
  EqmSoupDestroy(&soup);
}

/* The numbers are those of strtod, whatever their digits. */
static void TestNumbers(void)
{
  static const char *const text[] = {"0",
                                     "-0",
                                     ".5",
                                     "5.",
                                     "1e5",
                                     "1E+05",
                                     "1e-5",
                                     "+3.25",
                                     "9007199254740993",
                                     "1e400",
                                     "1e-400",
                                     "123456789012345678901234567890",
                                     "0.000000000000000000000000000000000000000000001234567890123456789",
                                     "2.2250738585072011e-308",
                                     "179769313486231580793728971405301e276",
                                     "8.5e-27",
                                     "1.7976931348623159e308",
                                     "72057594037927945",
                                     "9223372036854775808.0000000000000000000000000000001"};
  uint64_t state = 1;
  char number[64];
  PetscReal value;

  for (size_t i = 0; i < sizeof(text) / sizeof(text[0]); ++i) {
    const double exact = strtod(text[i], NULL);
    const char *end = EqmParseReal(text[i], text[i] + strlen(text[i]), &value);

    CHECK(end == text[i] + strlen(text[i]) && !memcmp(&exact, &value, sizeof(exact)), "%s is read as %.17g", text[i],
          value);
  }
  for (int i = 0; i < 200000; ++i) {
    static const char *const formats[] = {"%.17g", "%.16g", "%.9f", "%.6e", "%.20g", "%g"};
    double exact;

    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    if (i % 2)
      memcpy(&exact, &state, sizeof(exact)); /* any double */
    else
      exact = (double)(int64_t)state * 0x1p-63; /* coordinates as they come */
    if (!isfinite(exact) || (i % 2 && i % 6 == 2)) continue;
    snprintf(number, sizeof(number), i % 2 ? "%.17g" : formats[i / 2 % 6], exact);
    exact = strtod(number, NULL);
    CHECK(EqmParseReal(number, number + strlen(number), &value) == number + strlen(number) &&
              !memcmp(&exact, &value, sizeof(exact)),
          "%s is read as %.17g", number, value);
  }
}

/* The checksum is that of all bytes in input order, whoever holds them. */
static void TestChecksum(void)
{
  EqmSoup soup = HardSoup(4), again = NULL;
  int64_t cells[8];
  uLong checksum = crc32(0, (const Bytef *)hard_vertices, sizeof(hard_vertices));
  EqmSerialMesh mesh = {0};
  int rank;

  for (int i = 0; i < 8; ++i) cells[i] = sample_tetrahedra[i];
  checksum = crc32(checksum, (const Bytef *)cells, sizeof(cells));
  CHECK(soup->checksum == (PetscInt64)checksum, "the checksum is %llx", (long long)soup->checksum);
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  CHECK(!EqmSoupGather(soup, &mesh), "gathering");
  CHECK(rank ? !mesh.vertices : mesh.num_vertices == 5 && !memcmp(mesh.vertices, hard_vertices, sizeof(hard_vertices)),
        "gathered vertices");
  CHECK(!EqmSoupCreateFromRoot(PETSC_COMM_WORLD, &mesh, "again", &again) && again->checksum == soup->checksum,
        "dealing again");
  EqmSerialMeshReset(&mesh);
  EqmSoupDestroy(&again);
  EqmSoupDestroy(&soup);
}

/* Nothing half-written stays, and what was there survives. */
static void TestFailingWrites(char *message)
{
  EqmSoup soup = HardSoup(3), back = NULL;
  EqmAtomicFile file;
  char error[EQM_MESSAGE_MAX];
  int rank;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  CHECK(EqmSoupWrite(soup, PathOf("a.unknown")) == EQM_ERR_USAGE && strstr(message, ".obj"), "unknown suffix: %s",
        message);
  CHECK(EqmSoupWrite(soup, PathOf("nowhere/a.obj")) == EQM_ERR_IO, "a folder that is not there");
  CHECK(EqmSoupWrite(soup, PathOf("nowhere/a.h5")) == EQM_ERR_IO, "a folder that is not there, HDF5");
  if (rank == 0) CHECK(!symlink("/dev/full", PathOf("full.obj")), "a link to a full device");
  MPI_Barrier(PETSC_COMM_WORLD);
  message[0] = '\0';
  CHECK(EqmSoupWrite(soup, PathOf("full.obj")) == EQM_ERR_IO && strstr(message, strerror(ENOSPC)), "a full device: %s",
        message);
  CHECK(!EqmSoupWrite(soup, PathOf("kept.off")), "writing");
  if (rank == 0) {
    CHECK(!EqmAtomicOpen(PathOf("kept.off"), &file, error, sizeof(error)), "%s", error);
    EqmAtomicPrint(&file, "OFF\n");
    EqmAtomicAbort(&file);
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  CHECK(!EqmSoupRead(PETSC_COMM_WORLD, PathOf("kept.off"), &back) && back->checksum == soup->checksum,
        "an aborted write left traces");
  EqmSoupDestroy(&back);
  EqmSoupDestroy(&soup);
  if (rank == 0) {
    char command[256];

    snprintf(command, sizeof(command), "ls %s | grep -q tmp", folder);
    CHECK(system(command) != 0, "a temporary file stayed");
  }
}

static void TestDensity(char *message)
{
  static const struct {
    PetscErrorCode code;
    const char *says, *text;
  } tables[] = {{0, "", "cell,density\n0,0.5\n1,1e-3\r\n2, 7 \n3,\"2\"\n\n"},
                {0, "", "density\n0.5\n1e-3\n7\n2"},
                {EQM_ERR_MESH, "3 values", "density\n0.5\n1\n7\n"},
                {EQM_ERR_MESH, "more than 4", "density\n0.5\n1\n7\n1\n1\n"},
                {EQM_ERR_MESH, "line 3", "density\n0.5\n-1\n7\n1\n"},
                {EQM_ERR_MESH, "line 3", "density\n0.5\nnan\n7\n1\n"},
                {EQM_ERR_MESH, "line 2", "density\ninf\n1\n7\n1\n"},
                {EQM_ERR_IO, "line 4", "density\n0.5\n1\nx\n1\n"},
                {EQM_ERR_IO, "header", "0.5\n1\n7\n1\n"}};
  const PetscReal right[4] = {0.5, 1e-3, 7, 2};
  EqmSoup soup = HardSoup(3);

  for (size_t i = 0; i < sizeof(tables) / sizeof(tables[0]); ++i) {
    PetscErrorCode code;

    WriteBytes(PathOf("density.csv"), tables[i].text, strlen(tables[i].text));
    message[0] = '\0';
    code = EqmSoupReadDensity(soup, PathOf("density.csv"));
    CHECK(code == tables[i].code && strstr(message, tables[i].says), "density %zu: code %d: %s", i, code, message);
    for (PetscInt k = soup->cell_start; k < soup->cell_end; ++k) {
      CHECK(soup->density[k - soup->cell_start] == right[k], "density %zu, cell %d: %g", i, (int)k,
            soup->density[k - soup->cell_start]);
    }
  }
  CHECK(EqmSoupReadDensity(soup, PathOf("missing.csv")) == EQM_ERR_IO, "a missing density");
  CHECK(EqmSoupReadDensity(soup, PathOf("out3.h5")) == EQM_ERR_IO && strstr(message, "density"),
        "an HDF5 file without a density: %s", message);
  EqmSoupDestroy(&soup);
}

int main(int argc, char **argv)
{
  char message[EQM_MESSAGE_MAX] = "";
  int rank;

  if (EqmInitialize(&argc, &argv) || PetscPushErrorHandler(Expected, message)) return 1;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  snprintf(folder, sizeof(folder), "%s/equimap-format-XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  if (rank == 0 && !mkdtemp(folder)) MPI_Abort(PETSC_COMM_WORLD, 1);
  if (MPI_Bcast(folder, sizeof(folder), MPI_CHAR, 0, PETSC_COMM_WORLD)) return 1;
  TestSamples(message);
  TestWriters(message);
  TestFields();
  TestBadFiles(message);
  TestEntities(message);
  TestExternal(message);
  TestNotFinite(message);
  TestNumbers();
  TestChecksum();
  TestFailingWrites(message);
  TestDensity(message);
  MPI_Barrier(PETSC_COMM_WORLD);
  if (rank == 0) {
    char command[256];

    snprintf(command, sizeof(command), "rm -r '%s'", folder);
    CHECK(system(command) == 0);
  }
  return PetscPopErrorHandler() || EqmFinalize();
}
