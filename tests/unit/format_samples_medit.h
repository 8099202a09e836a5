/* Samples of Medit's and TetGen's formats; part of format_samples.h. */

static void MakeMedit(Sample *samples, int *count, PetscInt size)
{
  Sample *s = Begin(samples, count, "Medit", "mesh", size);
  const int *cells = size == 3 ? sample_triangles : sample_tetrahedra, num_cells = size == 3 ? 4 : 2;

  Put(s, "\n# by hand\nMeshVersionFormatted\n1\nDimension 3 # of space\n");
  Put(s, "RequiredVertices\n2\n1\n2\nNormals 1\n0.5 -1e-3 nan.5\nVertices 5\n");
  PutVertexLines(s, "", " 7\n");
  Put(s, "Edges 1\n1 2 0\n");
  if (size == 4) Put(s, "Quadrilaterals\n1\n1 2 3 4 0\nTriangles 1 1 2 3 9\n");
  Put(s, "%s\n# cells\n%d\n", size == 3 ? "Triangles" : "tetrahedra", num_cells);
  for (int i = 0; i < num_cells; ++i) {
    for (PetscInt k = 0; k < size; ++k) Put(s, "%d%s", cells[size * i + k] + 1, k == 1 ? "\n" : " ");
    Put(s, "%d\n", i);
  }
  Put(s, "Hexahedra 0\nEnd\nwhat follows is not read");
}

/* A block of a keyword, whose bytes are known beforehand. */
static void PutMeshbHead(Sample *s, int version, int big, int code, int number, size_t num_bytes)
{
  const int place_size = version < 3 ? 4 : 8, number_size = version < 4 ? 4 : 8;

  PutNumber(s, 4, big, code);
  PutNumber(s, place_size, big,
            (double)(s->length + (size_t)place_size + (size_t)(code == 3 ? 4 : number_size) + num_bytes));
  PutNumber(s, code == 3 ? 4 : number_size, big, number);
}

static void MakeMeshb(Sample *samples, int *count, int version, int big, PetscInt size)
{
  Sample *s = Begin(samples, count, big ? "meshb, big endian" : "meshb", "meshb", size);
  const int *cells = size == 3 ? sample_triangles : sample_tetrahedra, num_cells = size == 3 ? 4 : 2;
  const int real = version == 1 ? 4 : 8, number = version == 4 ? 8 : 4;

  PutNumber(s, 4, big, 1);
  PutNumber(s, 4, big, version);
  PutMeshbHead(s, version, big, 3, 3, 0);
  PutMeshbHead(s, version, big, 4, 5, 5 * (size_t)(3 * real + number));
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; k < 3; ++k) PutNumber(s, -real, big, sample_vertices[3 * i + k]);
    PutNumber(s, number, big, i);
  }
  PutMeshbHead(s, version, big, 13, 2, 2 * (size_t)number); /* corners, to be passed over */
  for (int i = 0; i < 2; ++i) PutNumber(s, number, big, i + 1);
  PutMeshbHead(s, version, big, size == 3 ? 6 : 8, num_cells, (size_t)(num_cells * (size + 1) * number));
  for (int i = 0; i < num_cells; ++i) {
    for (PetscInt k = 0; k < size; ++k) PutNumber(s, number, big, cells[size * i + k] + 1);
    PutNumber(s, number, big, 0);
  }
  PutNumber(s, 4, big, 54);
}

/* Both files, one behind the other, as the parser takes them. */
static void MakeTetgen(Sample *samples, int *count, int first, PetscInt size)
{
  Sample *s = Begin(samples, count, first ? "TetGen from 1" : "TetGen from 0", "tetgen", size);
  const int *cells = size == 3 ? sample_triangles : sample_tetrahedra, num_cells = size == 3 ? 4 : 2;

  Put(s, "# a comment\n\n5 3%s\n", first ? "  1 1  # attribute, marker" : "");
  for (int i = 0; i < 5; ++i) {
    const double *x = sample_vertices + 3 * i;
    Put(s, "  %d  %.17g %.17g %.17g%s\n", i + first, x[0], x[1], x[2], first ? "  0.25 -1 # vertex" : "");
  }
  Put(s, "# end\n\f%d %d %d\n", num_cells, (int)size, first);
  for (int i = 0; i < num_cells; ++i) {
    Put(s, "%d", i + first);
    for (PetscInt k = 0; k < size; ++k) Put(s, " %d", cells[size * i + k] + first);
    Put(s, first ? " 3\n" : "\n");
  }
}

static void MakeAllMedit(Sample *samples, int *count)
{
  for (PetscInt size = 3; size <= 4; ++size) {
    MakeMedit(samples, count, size);
    for (int first = 0; first < 2; ++first) MakeTetgen(samples, count, first, size);
    for (int version = 1; version <= 4; ++version) MakeMeshb(samples, count, version, version % 2 == size % 2, size);
  }
}
