/* The small surface once more, in the ways of files that have strips, texture points or parameters. */

static void MakeTextured(Sample *samples, int *count)
{
  Sample *s = Begin(samples, count, "OBJ with texture points", "obj", 3);

  PutVertexLines(s, "v ", "\n");
  Put(s, "vt 0 0\nvt 1 0 0\nvt .5\n");
  for (int i = 0; i < 12; i += 3) {
    Put(s, "f %d/1 %d/2/9 %d/-1//\n", sample_triangles[i] + 1, sample_triangles[i + 1] + 1,
        sample_triangles[i + 2] + 1);
  }
  s = Begin(samples, count, "PLY with texture points", "ply", 3);
  Put(s, "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
         "property float s\nproperty float t\nelement face 4\nproperty list uchar int vertex_indices\n"
         "property list uchar float texcoord\nend_header\n");
  PutVertexLines(s, "", " .25 .5\n");
  for (int i = 0; i < 12; i += 3) {
    Put(s, "3 %d %d %d 6 0 0 1 0 .5 .5\n", sample_triangles[i], sample_triangles[i + 1], sample_triangles[i + 2]);
  }
}

/* Strips of one triangle, of which every second one is closed by a -1; and one that begins with a repeated vertex. */
static void MakeStrips(Sample *samples, int *count)
{
  Sample *s = Begin(samples, count, "PLY with strips", "ply", 3);

  Put(s, "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
         "element tristrips 2\nproperty list int int vertex_indices\nend_header\n");
  PutVertexLines(s, "", "\n");
  Put(s, "9 0 1 2 -1 0 2 3 -1 -1\n10 0 0 0 3 4 -1 0 4 1 -1\n");
  s = Begin(samples, count, "VTK with strips", "vtk", 3);
  Put(s, "# vtk DataFile Version 3.0\nstrips\nASCII\nDATASET POLYDATA\nPOINTS 5 float\n");
  PutVertexLines(s, "", "\n");
  Put(s, "TRIANGLE_STRIPS 4 16\n3 0 1 2\n3 0 2 3\n3 0 3 4\n3 0 4 1\n");
}

/* Version 2.2 with the parameters of nodes, and version 4.0. */
static void MakeOtherGmsh(Sample *samples, int *count, int binary)
{
  Sample *s = Begin(samples, count, binary ? "MSH 2.2 binary, parameters" : "MSH 2.2 ASCII, parameters", "msh", 3);

  for (int version = 2; version <= 4; version += 2) {
    if (version == 4) s = Begin(samples, count, binary ? "MSH 4.0 binary" : "MSH 4.0 ASCII", "msh", 3);
    Put(s, "$MeshFormat\n%s %d 8\n", version == 2 ? "2.2" : "4.0", binary);
    if (binary) PutNumber(s, 4, 0, 1);
    Put(s, "%s$EndMeshFormat\n%s\n%s", binary ? "\n" : "", version == 2 ? "$ParametricNodes" : "$Nodes",
        version == 2 ? "5\n" : "");
    if (version == 4) PutGmsh4Numbers(s, binary, 0, "88", 1, 5);
    if (version == 4) PutGmsh4Numbers(s, binary, 0, "4448", 1, 2, 1, 5);
    for (int i = 0; i < 5; ++i) {
      const double *const x = sample_vertices + 3 * i;
      const int dimension = version == 2 ? i % 4 : 2;

      if (binary) PutNumber(s, 4, 0, Tag(i));
      for (int k = 0; binary && k < 3; ++k) PutNumber(s, -8, 0, x[k]);
      if (!binary) Put(s, "%d %.17g %.17g %.17g", Tag(i), x[0], x[1], x[2]);
      if (binary && version == 2) PutGmsh4Numbers(s, binary, 0, "44", dimension, 1);
      if (!binary && version == 2) Put(s, " %d 1", dimension);
      for (int k = 0; binary && dimension < 3 && k < dimension; ++k) PutNumber(s, -8, 0, .5);
      if (!binary) Put(s, "%s\n", dimension == 2 ? " .5 .5" : dimension == 1 ? " .5" : "");
    }
    Put(s, "%s%s\n$Elements\n%s", binary ? "\n" : "", version == 2 ? "$EndParametricNodes" : "$EndNodes",
        version == 2 ? "4\n" : "");
    if (version == 4) PutGmsh4Numbers(s, binary, 0, "88", 1, 4);
    if (version == 4) PutGmsh4Numbers(s, binary, 0, "4448", 1, 2, 2, 4);
    if (version == 2 && binary) PutGmsh4Numbers(s, binary, 0, "444", 2, 4, 0);
    for (int i = 0; i < 4; ++i) {
      const int *const cell = sample_triangles + 3 * i;

      if (binary) PutNumber(s, 4, 0, i + 1);
      if (!binary) Put(s, "%d %s", i + 1, version == 2 ? "2 0 " : "");
      PutGmsh4Numbers(s, binary, 0, "444", Tag(cell[0]), Tag(cell[1]), Tag(cell[2]));
    }
    Put(s, "%s$EndElements\n", binary ? "\n" : "");
  }
}

static void MakeFreesurfer(Sample *samples, int *count)
{
  Sample *s = Begin(samples, count, "FreeSurfer", "white", 3);

  PutBytes(s, "\377\377\376", 3, 0);
  Put(s, "created by hand\n\n");
  PutNumber(s, 4, 1, 5);
  PutNumber(s, 4, 1, 4);
  PutVertices(s, -4, 1);
  for (int i = 0; i < 12; ++i) PutNumber(s, 4, 1, sample_triangles[i]);
  for (int i = 0; i < 3; ++i) PutNumber(s, 4, 1, i == 0 ? 2 : i == 2 ? 20 : 0);
  Put(s, "valid = 1  # volume info valid\nfilename = vol.mgz\n");
}

static void MakeAllFaces(Sample *samples, int *count)
{
  MakeTextured(samples, count);
  MakeStrips(samples, count);
  MakeFreesurfer(samples, count);
  MakeOtherGmsh(samples, count, 0);
  MakeOtherGmsh(samples, count, 1);
}
