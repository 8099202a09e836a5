/* GIFTI: point set, triangles and a shape per vertex field. The format knows single precision only, and its readers
   take nothing else. */
#include "encoding.h"
#include "writers.h"
#include "input.h"
#include "scalar.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <libxml/xmlwriter.h>
#include <zlib.h>

/* An XML document that goes into an atomic file; the first failure of libxml2 is kept. */
typedef struct {
  xmlTextWriterPtr xml;
  EqmAtomicFile *file;
  PetscBool failed;
} Document;

static int WriteToFile(void *context, const char *bytes, int count)
{
  EqmAtomicWrite(context, bytes, (size_t)count);
  return count;
}

static void Note(Document *document, int result)
{
  if (result < 0) document->failed = PETSC_TRUE;
}

static void Begin(Document *document, const char *element)
{
  Note(document, xmlTextWriterStartElement(document->xml, BAD_CAST element));
}

static void End(Document *document)
{
  Note(document, xmlTextWriterEndElement(document->xml));
}

static void Attribute(Document *document, const char *name, const char *value)
{
  Note(document, xmlTextWriterWriteAttribute(document->xml, BAD_CAST name, BAD_CAST value));
}

static void Text(Document *document, const char *element, const char *text)
{
  Note(document, xmlTextWriterWriteElement(document->xml, BAD_CAST element, BAD_CAST text));
}

static void MetaData(Document *document, const char *name)
{
  Begin(document, "MetaData");
  if (name) {
    Begin(document, "MD");
    Text(document, "Name", "Name");
    Text(document, "Value", name);
    End(document);
  }
  End(document);
}

/* Readers expect points to say in which space they are: an unknown one, unchanged. */
static void Space(Document *document)
{
  Begin(document, "CoordinateSystemTransformMatrix");
  Text(document, "DataSpace", "NIFTI_XFORM_UNKNOWN");
  Text(document, "TransformedSpace", "NIFTI_XFORM_UNKNOWN");
  Text(document, "MatrixData", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  End(document);
}

/* Pack bytes and put them into the file as base64, past libxml2's buffer, which is flushed before. */
static PetscErrorCode Data(Document *document, const void *bytes, size_t num_bytes)
{
  uLongf packed_bytes = compressBound((uLong)num_bytes);
  Bytef *packed = malloc(packed_bytes);
  EqmBase64Writer writer;

  if (!packed) return PETSC_ERR_MEM;
  if (compress(packed, &packed_bytes, bytes, (uLong)num_bytes) != Z_OK) document->failed = PETSC_TRUE;
  Begin(document, "Data");
  Note(document, xmlTextWriterWriteString(document->xml, BAD_CAST ""));
  Note(document, xmlTextWriterFlush(document->xml));
  EqmBase64Open(&writer, document->file);
  EqmBase64Write(&writer, packed, packed_bytes);
  EqmBase64Close(&writer);
  End(document);
  free(packed);
  return 0;
}

/* One array: 4-byte numbers, `width` per row. */
static PetscErrorCode DataArray(Document *document, const char *intent, const char *type, const char *name,
                                PetscInt num_rows, PetscInt width, const void *values)
{
  char number[32];

  Begin(document, "DataArray");
  Attribute(document, "Intent", intent);
  Attribute(document, "DataType", type);
  Attribute(document, "ArrayIndexingOrder", "RowMajorOrder");
  Attribute(document, "Dimensionality", width > 1 ? "2" : "1");
  snprintf(number, sizeof(number), "%lld", (long long)num_rows);
  Attribute(document, "Dim0", number);
  snprintf(number, sizeof(number), "%lld", (long long)width);
  if (width > 1) Attribute(document, "Dim1", number);
  Attribute(document, "Encoding", "GZipBase64Binary");
  Attribute(document, "Endian", "LittleEndian");
  Attribute(document, "ExternalFileName", "");
  Attribute(document, "ExternalFileOffset", "");
  MetaData(document, name);
  if (!strcmp(intent, "NIFTI_INTENT_POINTSET")) Space(document);
  EqmTry(Data(document, values, 4 * (size_t)num_rows * (size_t)width));
  End(document);
  return 0;
}

static PetscErrorCode RealArray(Document *document, const char *intent, const char *name, PetscInt num_rows,
                                PetscInt width, const PetscReal *values)
{
  const size_t count = (size_t)num_rows * (size_t)width;
  float *single;
  PetscErrorCode code;

  EqmTry(PetscMalloc1(count + 1, &single));
  for (size_t i = 0; i < count; ++i) single[i] = (float)values[i];
  code = DataArray(document, intent, "NIFTI_TYPE_FLOAT32", name, num_rows, width, single);
  EqmTry(PetscFree(single));
  return code;
}

static PetscErrorCode TriangleArray(Document *document, const EqmSerialMesh *mesh)
{
  const size_t count = 3 * (size_t)mesh->num_cells;
  int32_t *corners;
  PetscErrorCode code;

  EqmTry(PetscMalloc1(count + 1, &corners));
  for (size_t i = 0; i < count; ++i) corners[i] = (int32_t)mesh->cells[i];
  code = DataArray(document, "NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", NULL, mesh->num_cells, 3, corners);
  EqmTry(PetscFree(corners));
  return code;
}

static PetscErrorCode WriteArrays(Document *document, const EqmSerialMesh *mesh, const EqmField *fields,
                                  PetscInt num_fields)
{
  EqmTry(RealArray(document, "NIFTI_INTENT_POINTSET", NULL, mesh->num_vertices, 3, mesh->vertices));
  EqmTry(TriangleArray(document, mesh));
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (fields[f].on_cells) continue; /* GIFTI knows data on vertices only */
    EqmTry(RealArray(document, "NIFTI_INTENT_SHAPE", fields[f].name, mesh->num_vertices, fields[f].width,
                     fields[f].values));
  }
  return 0;
}

static PetscErrorCode WriteDocument(Document *document, const EqmSerialMesh *mesh, const EqmField *fields,
                                    PetscInt num_fields)
{
  PetscInt num_arrays = 2;
  char number[16];

  for (PetscInt f = 0; f < num_fields; ++f) num_arrays += fields[f].on_cells ? 0 : 1;
  snprintf(number, sizeof(number), "%d", (int)num_arrays);
  Note(document, xmlTextWriterSetIndent(document->xml, 1));
  Note(document, xmlTextWriterStartDocument(document->xml, NULL, "UTF-8", NULL));
  Begin(document, "GIFTI");
  Attribute(document, "Version", "1.0");
  Attribute(document, "NumberOfDataArrays", number);
  MetaData(document, NULL);
  Begin(document, "LabelTable");
  End(document);
  EqmTry(WriteArrays(document, mesh, fields, num_fields));
  Note(document, xmlTextWriterEndDocument(document->xml));
  return 0;
}

/* EqmWriteGifti - write a GIFTI file in single precision, fields on vertices as shapes. See EqmWriter. */
PetscErrorCode EqmWriteGifti(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                             PetscInt num_fields, char *error, size_t error_length)
{
  xmlOutputBufferPtr buffer;
  Document document = {NULL, file, PETSC_FALSE};
  PetscErrorCode code;

  EqmTry(EqmRequireTriangles(mesh, "GIFTI", error, error_length));
  buffer = xmlOutputBufferCreateIO(WriteToFile, NULL, file, NULL);
  document.xml = buffer ? xmlNewTextWriter(buffer) : NULL;
  if (!document.xml) return PETSC_ERR_MEM;
  code = WriteDocument(&document, mesh, fields, num_fields);
  xmlFreeTextWriter(document.xml);
  if (code || !document.failed) return code;
  snprintf(error, error_length, "cannot make the XML of a GIFTI file");
  return EQM_ERR_IO;
}
