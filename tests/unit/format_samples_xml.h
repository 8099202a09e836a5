/* The samples whose formats are XML; part of format_samples.h. */
#ifndef EQM_TEST_FORMAT_SAMPLES_XML_H
#define EQM_TEST_FORMAT_SAMPLES_XML_H

/* How a VTU array is stored. */
typedef struct {
  const char *name;
  PetscBool appended, base64, packed, ascii;
  int header, big; /* bytes of a length; byte order */
} VtuWay;

/* Lengths and bytes of one array, packed in blocks of at most 40 bytes or plain. */
static void StoreArray(const VtuWay *way, const Sample *data, Sample *header, Sample *stored)
{
  const size_t block = 40, num_blocks = (data->length + block - 1) / block;

  if (!way->packed) {
    PutNumber(stored, way->header, way->big, (double)data->length);
    PutBytes(stored, data->bytes, data->length, 0);
    return;
  }
  PutNumber(header, way->header, way->big, (double)num_blocks);
  PutNumber(header, way->header, way->big, (double)block);
  PutNumber(header, way->header, way->big, (double)(data->length % block));
  for (size_t b = 0; b < num_blocks; ++b) {
    const size_t length = b + 1 < num_blocks ? block : data->length - b * block;
    Bytef packed[256];
    uLongf packed_length = sizeof(packed);

    if (compress(packed, &packed_length, (const Bytef *)data->bytes + b * block, length) != Z_OK) abort();
    PutNumber(header, way->header, way->big, (double)packed_length);
    PutBytes(stored, packed, packed_length, 0);
  }
}

/* One DataArray, its numbers given as text; `appended` collects what comes after the document. */
static void PutVtuArray(Sample *s, const VtuWay *way, const char *name, const char *type, int size, int width,
                        int count, const double *values, Sample *appended)
{
  static Sample data, header, stored;

  data.length = header.length = stored.length = 0;
  Put(s, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"%s\"", type, name, width,
      way->ascii      ? "ascii"
      : way->appended ? "appended"
                      : "binary");
  if (way->ascii) {
    Put(s, ">\n");
    for (int i = 0; i < count; ++i) Put(s, "%.17g ", values[i]);
    Put(s, "\n</DataArray>\n");
    return;
  }
  for (int i = 0; i < count; ++i) PutNumber(&data, size, way->big, values[i]);
  StoreArray(way, &data, &header, &stored);
  if (!way->appended) {
    Put(s, ">\n  ");
    PutBase64(s, &header);
    PutBase64(s, &stored);
    Put(s, "\n</DataArray>\n");
    return;
  }
  Put(s, " offset=\"%zu\"/>\n", appended->length);
  if (way->base64) {
    PutBase64(appended, &header);
    PutBase64(appended, &stored);
  } else {
    PutBytes(appended, header.bytes, header.length, 0);
    PutBytes(appended, stored.bytes, stored.length, 0);
  }
}

/* A piece with the cells first .. last - 1 and all vertices; before them a line, which is passed over. */
static void PutVtuPiece(Sample *s, const VtuWay *way, PetscInt size, PetscBool surface, int num_cells, const int *cells,
                        Sample *appended)
{
  double corners[32], ends[8], types[8];
  const int extra = surface ? 0 : 1;
  int num_corners = 0;

  if (extra) {
    corners[num_corners++] = 0;
    corners[num_corners++] = 1;
    ends[0] = 2;
    types[0] = 3;
  }
  for (int i = 0; i < num_cells; ++i) {
    for (int k = 0; k < size; ++k) corners[num_corners++] = cells[size * i + k];
    ends[i + extra] = num_corners;
    types[i + extra] = size == 3 ? 5 : 10;
  }
  Put(s, "<Piece NumberOfPoints=\"5\" %s=\"%d\">\n<Points>\n", surface ? "NumberOfPolys" : "NumberOfCells",
      num_cells + extra);
  PutVtuArray(s, way, "Points", way->big ? "Float64" : "Float32", way->big ? -8 : -4, 3, 15, sample_vertices, appended);
  Put(s, "</Points>\n<%s>\n", surface ? "Polys" : "Cells");
  PutVtuArray(s, way, "connectivity", way->big ? "Int32" : "Int64", way->big ? 4 : 8, 1, num_corners, corners,
              appended);
  PutVtuArray(s, way, "offsets", "Int64", 8, 1, num_cells + extra, ends, appended);
  if (!surface) PutVtuArray(s, way, "types", "UInt8", 1, 1, num_cells + extra, types, appended);
  Put(s, "</%s>\n</Piece>\n", surface ? "Polys" : "Cells");
}

static void MakeVtu(Sample *samples, int *count, const VtuWay *way, PetscInt size, PetscBool surface)
{
  static Sample appended;
  Sample *s = Begin(samples, count, way->name, surface ? "vtp" : "vtu", size);
  const char *type = surface ? "PolyData" : "UnstructuredGrid";

  appended.length = 0;
  Put(s,
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"%s\" header_type=\"%s\"%s>\n<%s>\n",
      type, way->big ? "BigEndian" : "LittleEndian", way->header == 8 ? "UInt64" : "UInt32",
      way->packed ? " compressor=\"vtkZLibDataCompressor\"" : "", type);
  PutVtuPiece(s, way, size, surface, size == 3 ? 4 : 2, size == 3 ? sample_triangles : sample_tetrahedra, &appended);
  Put(s, "</%s>\n", type);
  if (way->appended) {
    Put(s, "<AppendedData encoding=\"%s\">\n_", way->base64 ? "base64" : "raw");
    PutBytes(s, appended.bytes, appended.length, 0);
    Put(s, "\n</AppendedData>\n");
  }
  Put(s, "</VTKFile>\n");
}

static void MakeAllVtu(Sample *samples, int *count)
{
  static const VtuWay ways[] = {
      {"VTU ASCII", PETSC_FALSE, PETSC_FALSE, PETSC_FALSE, PETSC_TRUE, 4, 0},
      {"VTU base64", PETSC_FALSE, PETSC_TRUE, PETSC_FALSE, PETSC_FALSE, 4, 0},
      {"VTU base64, packed", PETSC_FALSE, PETSC_TRUE, PETSC_TRUE, PETSC_FALSE, 8, 0},
      {"VTU appended raw", PETSC_TRUE, PETSC_FALSE, PETSC_FALSE, PETSC_FALSE, 8, 0},
      {"VTU appended raw, packed", PETSC_TRUE, PETSC_FALSE, PETSC_TRUE, PETSC_FALSE, 4, 0},
      {"VTU appended base64", PETSC_TRUE, PETSC_TRUE, PETSC_FALSE, PETSC_FALSE, 4, 0},
      {"VTU appended base64, packed, big endian", PETSC_TRUE, PETSC_TRUE, PETSC_TRUE, PETSC_FALSE, 8, 1},
  };

  for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); ++i) {
    MakeVtu(samples, count, &ways[i], 3, PETSC_FALSE);
    MakeVtu(samples, count, &ways[i], 4, PETSC_FALSE);
  }
  MakeVtu(samples, count, &ways[0], 3, PETSC_TRUE);
  MakeVtu(samples, count, &ways[3], 3, PETSC_TRUE);
}

/* way: 0 ASCII, 1 base64 in the other byte order, 2 packed and column by column. */
static void PutGiftiArray(Sample *s, int way, const char *intent, const char *type, int size, int rows,
                          const double *values)
{
  static const char *const encoding[] = {"ASCII", "Base64Binary", "GZipBase64Binary"};
  static Sample data, packed;
  uLongf length = SAMPLE_BYTES;

  data.length = packed.length = 0;
  Put(s,
      "<DataArray Intent=\"%s\" DataType=\"%s\" ArrayIndexingOrder=\"%s\" Dimensionality=\"2\" Dim0=\"%d\" Dim1=\"3\" "
      "Encoding=\"%s\" Endian=\"%s\"><Data>",
      intent, type, way == 2 ? "ColumnMajorOrder" : "RowMajorOrder", rows, encoding[way],
      way == 1 ? "BigEndian" : "LittleEndian");
  for (int i = 0; i < 3 * rows; ++i) {
    const double value = values[way == 2 ? 3 * (i % rows) + i / rows : i];
    if (way == 0)
      Put(s, "%.17g ", value);
    else
      PutNumber(&data, size, way == 1, value);
  }
  if (way == 2) {
    if (compress((Bytef *)packed.bytes, &length, (const Bytef *)data.bytes, data.length) != Z_OK) abort();
    packed.length = length;
  }
  if (way) PutBase64(s, way == 2 ? &packed : &data);
  Put(s, "</Data></DataArray>\n");
}

static void MakeGifti(Sample *samples, int *count, int way)
{
  Sample *s = Begin(samples, count, way == 0 ? "GIFTI ASCII" : way == 1 ? "GIFTI base64" : "GIFTI packed", "gii", 3);
  double triangles[12];

  for (int i = 0; i < 12; ++i) triangles[i] = sample_triangles[i];
  Put(s,
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE GIFTI SYSTEM \"gifti.dtd\">\n<GIFTI Version=\"1.0\">\n");
  PutGiftiArray(s, way, "NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", 4, 4, triangles);
  PutGiftiArray(s, way, "NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32", -4, 5, sample_vertices);
  Put(s, "</GIFTI>\n");
}

#endif
