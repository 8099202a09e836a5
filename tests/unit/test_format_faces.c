/* Faces of more than three corners become triangles, the same ones in every format; texture coordinates go with the
   corners. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "format/format.h"
#include "format/polygon.h"
#include "support/checks.h"

/* A square of side 1 with a kite at its right: the kite's shorter diagonal joins its corners 1 and 3. */
#define POINTS "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 .5 0\n"
static const int wanted[12] = {0, 1, 2, 0, 2, 3, 1, 4, 2, 1, 4, 2};

static const struct {
  const char *name, *text;
  int num_cells, num_polygons;
} surface[] = {
    {"quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 4 .5 0\nf 1 2 3 4\nf 2 5 3\n", 3, 1},
    {"late.obj", "f 1 2 3 4\nf 2 5 3\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 4 .5 0\n", 3, 1},
    {"quad.off", "OFF 5 2 0\n" POINTS "4 0 1 2 3\n3 1 4 2\n", 3, 1},
    {"quad.ply",
     "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
     "property list uchar int vertex_indices\nend_header\n" POINTS "4 0 1 2 3\n3 1 4 2\n",
     3, 1},
    {"quad.vtk",
     "# vtk DataFile Version 3.0\nquads\nASCII\nDATASET POLYDATA\nPOINTS 5 float\n" POINTS
     "POLYGONS 2 9\n4 0 1 2 3\n3 1 4 2\n",
     3, 1},
    {"pixel.vtk",
     "# vtk DataFile Version 3.0\nquads\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n" POINTS
     "CELLS 2 9\n4 0 1 3 2\n3 1 4 2\nCELL_TYPES 2\n8\n5\n",
     3, 1},
    {"quad.vtu",
     "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"5\" NumberOfCells=\"2\"><Points>"
     "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" POINTS "</DataArray></Points><Cells>"
     "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3 1 4 2</DataArray>"
     "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4 7</DataArray>"
     "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">9 7</DataArray></Cells></Piece></UnstructuredGrid>"
     "</VTKFile>",
     3, 1},
    {"strip.vtp",
     "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"5\" NumberOfPolys=\"2\" "
     "NumberOfStrips=\"1\"><Points>"
     "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" POINTS "</DataArray></Points><Polys>"
     "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 0 2 3</DataArray>"
     "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6</DataArray></Polys><Strips>"
     "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">1 4 2</DataArray>"
     "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray></Strips></Piece></PolyData></VTKFile>",
     3, 0},
    {"quad.msh",
     "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 4 .5 0\n$EndNodes\n"
     "$Elements\n2\n1 3 0 1 2 3 4\n2 2 0 2 5 3\n$EndElements\n",
     3, 1},
    {"quad.mesh",
     "MeshVersionFormatted 1\nDimension 2\nVertices 5\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 .5 0\nQuadrilaterals 1\n1 2 3 4 "
     "0\n"
     "Triangles 1\n2 5 3 0\nEnd\n",
     3, 1},
};

static PetscErrorCode Parse(const char *name, const char *text, EqmSerialMesh *mesh)
{
  char error[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code;

  memset(mesh, 0, sizeof(*mesh));
  code = EqmFormatOfSuffix(name)->parse(text, strlen(text), mesh, error, sizeof(error));
  CHECK(!code, "%s: code %d: %s", name, (int)code, error);
  return code;
}

static void TestFormats(void)
{
  for (size_t i = 0; i < sizeof(surface) / sizeof(surface[0]); ++i) {
    EqmSerialMesh mesh;
    char note[64] = "";

    if (Parse(surface[i].name, surface[i].text, &mesh)) continue;
    CHECK(mesh.num_cells == surface[i].num_cells && mesh.cell_size == 3, "%s: %d cells", surface[i].name,
          (int)mesh.num_cells);
    for (int k = 0; k < 3 * surface[i].num_cells && k < 3 * mesh.num_cells; ++k)
      CHECK(mesh.cells[k] == wanted[k], "%s: corner %d is %d", surface[i].name, k, (int)mesh.cells[k]);
    if (surface[i].num_polygons) snprintf(note, sizeof(note), "%d faces of more", surface[i].num_polygons);
    CHECK(strstr(mesh.note, note) == mesh.note && !mesh.note[0] == !note[0], "%s: note \"%s\"", surface[i].name,
          mesh.note);
    CHECK(EqmSerialMeshReset(&mesh) == 0);
  }
}

static double Cross(const double *a, const double *b, const double *c)
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* The triangles of a simple polygon in the plane run as it does and have its area. */
static void TestPolygon(const char *name, int n, const double *p)
{
  PetscInt cut[3 * EQM_MAX_POLYGON];
  double area = 0, sum = 0;

  EqmPolygonTriangulate(n, p, cut);
  for (int i = 1; i + 1 < n; ++i) area += Cross(p, p + 3 * (size_t)i, p + 3 * (size_t)(i + 1));
  for (int t = 0; t < n - 2; ++t) {
    const double one = Cross(p + 3 * cut[3 * t], p + 3 * cut[3 * t + 1], p + 3 * cut[3 * t + 2]);

    CHECK(one * area >= 0, "%s: triangle %d is turned", name, t);
    sum += one;
  }
  CHECK(fabs(sum - area) <= 1e-12 * fabs(area), "%s: area %g instead of %g", name, sum, area);
}

static void TestPolygons(void)
{
  static const double kite[12] = {0, 0, 0, 1, -.2, 0, 4, 0, 0, 1, .2, 0};
  static const double arrow[12] = {0, 0, 0, 4, 1, 0, 1, 0, 0, 4, -1, 0};
  static const double comb[36] = {0, 0, 0, 6, 0, 0, 6, 3, 0, 5, 3, 0, 5, 1, 0, 4, 1, 0,
                                  4, 3, 0, 2, 3, 0, 2, 1, 0, 1, 1, 0, 1, 3, 0, 0, 3, 0};
  double spiral[3 * 200], star[3 * EQM_MAX_POLYGON];
  PetscInt cut[6];

  EqmPolygonTriangulate(4, kite, cut);
  CHECK(cut[0] == 1 && cut[1] == 2 && cut[2] == 3, "a kite is cut along its shorter diagonal, not at %d %d %d",
        (int)cut[0], (int)cut[1], (int)cut[2]);
  TestPolygon("kite", 4, kite);
  TestPolygon("arrow", 4, arrow);
  TestPolygon("comb", 12, comb);
  for (int i = 0; i < 200; ++i) { /* out and back in */
    const int inner = i >= 100, step = inner ? 199 - i : i;
    const double radius = 1 + .05 * step + (inner ? -.2 : 0);

    spiral[3 * i] = radius * cos(.2 * step);
    spiral[3 * i + 1] = radius * sin(.2 * step);
    spiral[3 * i + 2] = 0;
  }
  TestPolygon("spiral", 200, spiral);
  for (int i = 0; i < EQM_MAX_POLYGON; ++i) {
    star[3 * i] = (i % 2 ? 1 : 2) * cos(2 * M_PI * i / EQM_MAX_POLYGON);
    star[3 * i + 1] = (i % 2 ? 1 : 2) * sin(2 * M_PI * i / EQM_MAX_POLYGON);
    star[3 * i + 2] = 0;
  }
  TestPolygon("star", EQM_MAX_POLYGON, star);
}

/* Texture coordinates stay with their corners, whether they belong to vertices, to corners or to corners of a quad. */
static void TestTexture(void)
{
  static const struct {
    const char *name, *text;
    double uv[12];
  } file[] = {
      {"seam.obj",
       "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt .1 0\nvt .1 .2\nvt 0 .2\nvt .5 0\nf 1/1 2/2 3/3\nf 1/5 3/-3 "
       "4/-2\n",
       {0, 0, .1, 0, .1, .2, .5, 0, .1, .2, 0, .2}},
      {"quad.obj",
       "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt .1 0\nvt .1 .2\nvt 0 .2\nf 1/1 2/2 3/3 4/4\n",
       {0, 0, .1, 0, .1, .2, 0, 0, .1, .2, 0, .2}},
      {"vertex.ply",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float "
       "u\n"
       "property float v\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
       "0 0 0 0 0\n1 0 0 .1 0\n1 1 0 .1 .2\n0 1 0 0 .2\n4 0 1 2 3\n",
       {0, 0, .1, 0, .1, .2, 0, 0, .1, .2, 0, .2}},
      {"corner.ply",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
       "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
       "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 8 0 0 .1 0 .1 .2 0 .2\n",
       {0, 0, .1, 0, .1, .2, 0, 0, .1, .2, 0, .2}},
  };
  EqmSerialMesh mesh;

  for (size_t i = 0; i < sizeof(file) / sizeof(file[0]); ++i) {
    if (Parse(file[i].name, file[i].text, &mesh)) continue;
    CHECK(mesh.texture && mesh.num_cells == 2, "%s: no texture", file[i].name);
    for (int k = 0; mesh.texture && k < 12; ++k)
      CHECK(mesh.texture[k] == file[i].uv[k], "%s: texture %d is %g", file[i].name, k, mesh.texture[k]);
    CHECK(EqmSerialMeshReset(&mesh) == 0);
  }
  /* one corner without a texture point, or one that is not there: no texture */
  if (!Parse("half.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/1 2/1 3\n", &mesh)) {
    CHECK(!mesh.texture, "half a texture");
    CHECK(EqmSerialMeshReset(&mesh) == 0);
  }
  if (!Parse("range.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/1 2/1 3/2\n", &mesh)) {
    CHECK(!mesh.texture, "a texture out of range");
    CHECK(EqmSerialMeshReset(&mesh) == 0);
  }
}

int main(int argc, char **argv)
{
  if (EqmInitialize(&argc, &argv)) return 1;
  TestFormats();
  TestPolygons();
  TestTexture();
  return EqmFinalize() ? 1 : 0;
}
