/* GIFTI: a surface of two arrays, points and triangles, and beside it a file with a shape per vertex field, since
   Connectome Workbench takes no surface with more. The format has single precision only. */
#include "encoding.h"
#include "writers.h"
#include "input.h"
#include "gifti.h"
#include "metadata.h"
#include "scalar.h"
#include "xml.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <libxml/xmlwriter.h>
#include <zlib.h>

/* An XML document that goes into an atomic file; the first failure of libxml2 is kept. */
typedef struct {
  xmlTextWriterPtr xml;
  xmlOutputBufferPtr out;
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

static void MetaDataEntry(Document *document, const char *name, const char *value)
{
  Begin(document, "MD");
  Text(document, "Name", name);
  Text(document, "Value", value);
  End(document);
}

/* Of the points: structure and type, and the space that they are in, unknown and unchanged unless the input said it. */
static void PointMetaData(Document *document, const EqmSerialMesh *mesh)
{
  static const char *const key[] = {"DataSpace", "TransformedSpace", "MatrixData"};
  static const char *const fallback[] = {"NIFTI_XFORM_UNKNOWN", "NIFTI_XFORM_UNKNOWN",
                                         "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"};
  char value[1024];

  Begin(document, "MetaData");
  if (EqmGiftiStructure(mesh, document->file->path, value, sizeof(value)))
    MetaDataEntry(document, "AnatomicalStructurePrimary", value);
  if (EqmMetadataGet(mesh->metadata, "AnatomicalStructureSecondary", value, sizeof(value)))
    MetaDataEntry(document, "AnatomicalStructureSecondary", value);
  MetaDataEntry(document, "GeometricType", EqmGiftiGeometricType(mesh, value, sizeof(value)));
  End(document);
  Begin(document, "CoordinateSystemTransformMatrix");
  for (int i = 0; i < 3; ++i)
    Text(document, key[i], EqmMetadataGet(mesh->metadata, key[i], value, sizeof(value)) ? value : fallback[i]);
  End(document);
}

static void NameMetaData(Document *document, const char *name)
{
  Begin(document, "MetaData");
  if (name) MetaDataEntry(document, "Name", name);
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

/* One array: 4-byte numbers, `width` per row; `points` is the mesh that they are the points of, or NULL. */
static PetscErrorCode DataArray(Document *document, const char *intent, const char *type, const char *name,
                                PetscInt num_rows, PetscInt width, const void *values, const EqmSerialMesh *points)
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
  if (points)
    PointMetaData(document, points);
  else
    NameMetaData(document, name);
  EqmTry(Data(document, values, 4 * (size_t)num_rows * (size_t)width));
  End(document);
  return 0;
}

static PetscErrorCode PointArray(Document *document, const EqmSerialMesh *mesh)
{
  const size_t count = 3 * (size_t)mesh->num_vertices;
  float *single;
  PetscErrorCode code;

  EqmTry(PetscMalloc1(count + 1, &single));
  for (size_t i = 0; i < count; ++i) single[i] = (float)mesh->vertices[i];
  code = DataArray(document, "NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32", NULL, mesh->num_vertices, 3, single, mesh);
  EqmTry(PetscFree(single));
  return code;
}

/* One component of a field. The conformal factor, a natural logarithm, is written to the base 2, as the areal
   distortion that Workbench computes. */
static PetscErrorCode ShapeArray(Document *document, const EqmSerialMesh *mesh, const EqmField *field,
                                 PetscInt component)
{
  const size_t count = (size_t)mesh->num_vertices, width = (size_t)field->width;
  const PetscBool is_factor = strcmp(field->name, "conformal_factor") ? PETSC_FALSE : PETSC_TRUE;
  const PetscReal unit = is_factor ? M_LN2 : 1.0;
  char name[128];
  float *single;
  PetscErrorCode code;

  snprintf(name, sizeof(name), width > 1 ? "%s_%d" : "%s", is_factor ? "areal_distortion_log2" : field->name,
           (int)component);
  EqmTry(PetscMalloc1(count + 1, &single));
  for (size_t i = 0; i < count; ++i) single[i] = (float)(field->values[width * i + (size_t)component] / unit);
  code = DataArray(document, "NIFTI_INTENT_SHAPE", "NIFTI_TYPE_FLOAT32", name, mesh->num_vertices, 1, single, NULL);
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
  code = DataArray(document, "NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", NULL, mesh->num_cells, 3, corners, NULL);
  EqmTry(PetscFree(corners));
  return code;
}

/* Files of shapes are called so. */
static PetscBool IsShapeFile(const char *path)
{
  const size_t length = strlen(path);

  return length > 10 && (!strcasecmp(path + length - 10, ".shape.gii") || !strcasecmp(path + length - 9, ".func.gii"))
             ? PETSC_TRUE
             : PETSC_FALSE;
}

static PetscInt CountShapes(const EqmField *fields, PetscInt num_fields)
{
  PetscInt count = 0;

  for (PetscInt f = 0; f < num_fields; ++f) count += fields[f].on_cells ? 0 : fields[f].width;
  return count;
}

/* A surface (no fields), or shapes. */
static PetscErrorCode WriteDocument(Document *document, const EqmSerialMesh *mesh, const EqmField *fields,
                                    PetscInt num_fields)
{
  const PetscInt num_shapes = CountShapes(fields, num_fields);
  char value[128];

  Note(document, xmlTextWriterSetIndent(document->xml, 1));
  Note(document, xmlTextWriterStartDocument(document->xml, NULL, "UTF-8", NULL));
  Begin(document, "GIFTI");
  Attribute(document, "Version", "1.0");
  snprintf(value, sizeof(value), "%d", num_shapes ? (int)num_shapes : 2);
  Attribute(document, "NumberOfDataArrays", value);
  Begin(document, "MetaData");
  if (num_shapes && EqmGiftiStructure(mesh, document->file->path, value, sizeof(value)))
    MetaDataEntry(document, "AnatomicalStructurePrimary", value);
  End(document);
  Begin(document, "LabelTable");
  End(document);
  if (!num_shapes) {
    EqmTry(PointArray(document, mesh));
    EqmTry(TriangleArray(document, mesh));
  }
  for (PetscInt f = 0; f < num_fields; ++f) {
    for (PetscInt k = 0; k < fields[f].width && !fields[f].on_cells; ++k)
      EqmTry(ShapeArray(document, mesh, &fields[f], k));
  }
  Note(document, EqmXmlEndDocument(document->xml, document->out));
  return 0;
}

static PetscErrorCode WriteFile(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                PetscInt num_fields, char *error, size_t error_length)
{
  Document document = {.file = file};
  PetscErrorCode code;

  EqmXmlQuiet();
  document.out = xmlOutputBufferCreateIO(WriteToFile, NULL, file, NULL);
  if (document.out) document.xml = xmlNewTextWriter(document.out);
  if (!document.xml) return PETSC_ERR_MEM;
  code = WriteDocument(&document, mesh, fields, num_fields);
  xmlFreeTextWriter(document.xml);
  if (code || !document.failed) return code;
  snprintf(error, error_length, "cannot make the XML of a GIFTI file");
  return EQM_ERR_IO;
}

/* NAME.shape.gii beside NAME.surf.gii or NAME.gii. */
static PetscErrorCode WriteShapesBeside(const char *path, const EqmSerialMesh *mesh, const EqmField *fields,
                                        PetscInt num_fields, char *error, size_t error_length)
{
  char name[PETSC_MAX_PATH_LEN];
  const char *const dot = strrchr(path, '.');
  size_t stem = dot ? (size_t)(dot - path) : strlen(path);
  EqmAtomicFile beside;
  PetscErrorCode code;

  if (stem > 5 && !strncasecmp(path + stem - 5, ".surf", 5)) stem -= 5;
  if (snprintf(name, sizeof(name), "%.*s.shape.gii", (int)stem, path) >= (int)sizeof(name)) {
    snprintf(error, error_length, "its name is too long");
    return EQM_ERR_USAGE;
  }
  EqmTry(EqmAtomicOpen(name, &beside, error, error_length));
  code = WriteFile(&beside, mesh, fields, num_fields, error, error_length);
  if (!code) return EqmAtomicCommit(&beside, error, error_length);
  EqmAtomicAbort(&beside);
  return code;
}

/* EqmWriteGifti - write a GIFTI surface in single precision, and its fields on vertices, if there are any, as shapes
   into a file beside it, NAME.shape.gii for NAME.surf.gii; a file that is itself called .shape.gii or .func.gii gets
   the shapes alone. See EqmWriter. */
PetscErrorCode EqmWriteGifti(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                             PetscInt num_fields, char *error, size_t error_length)
{
  const PetscBool has_shapes = CountShapes(fields, num_fields) > 0 ? PETSC_TRUE : PETSC_FALSE;

  EqmTry(EqmRequireTriangles(mesh, "GIFTI", error, error_length));
  if (IsShapeFile(file->path)) {
    if (has_shapes) return WriteFile(file, mesh, fields, num_fields, error, error_length);
    snprintf(error, error_length,
             "a file of shapes holds fields on vertices, and there are none; call a surface .surf.gii");
    return EQM_ERR_USAGE;
  }
  if (has_shapes) EqmTry(WriteShapesBeside(file->path, mesh, fields, num_fields, error, error_length));
  return WriteFile(file, mesh, NULL, 0, error, error_length);
}
