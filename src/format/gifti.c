/* GIFTI surfaces of the neurosciences: a point set and triangles, ASCII, base64, compressed base64, or in binary files
   beside. */
#define _GNU_SOURCE
#include "beside.h"
#include "mesh/mesh_private.h"
#include "builder.h"
#include "encoding.h"
#include "metadata.h"
#include "writers.h"
#include "xml.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An element GIFTI near the beginning. Not collective. */
static PetscBool RecogniseGifti(const char *bytes, size_t length)
{
  return memmem(bytes, PetscMin(length, 4096), "<GIFTI", 6) ? PETSC_TRUE : PETSC_FALSE;
}

/* One DataArray. */
typedef struct {
  EqmInput *in;
  xmlNodePtr node;
  EqmScalarType type;
  PetscInt64 num_rows;
  PetscBool big_endian, column_major;
  char encoding[32];
} Array;

static PetscErrorCode ParseArray(EqmInput *in, xmlNodePtr node, Array *array)
{
  static const struct {
    const char *name;
    EqmScalarType type;
  } known[] = {{"NIFTI_TYPE_FLOAT32", EQM_SCALAR_FLOAT32},
               {"NIFTI_TYPE_FLOAT64", EQM_SCALAR_FLOAT64},
               {"NIFTI_TYPE_INT32", EQM_SCALAR_INT32},
               {"NIFTI_TYPE_UINT8", EQM_SCALAR_UINT8}};
  char text[64];
  PetscInt64 width;

  *array = (Array){.in = in, .node = node};
  EqmXmlAttribute(node, "DataType", text, sizeof(text));
  for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); ++i) {
    if (!strcmp(text, known[i].name)) array->type = known[i].type;
  }
  if (!array->type) return EqmXmlReject(in, node, "the DataType \"%s\" is not supported", text);
  if (!EqmXmlInteger(node, "Dim0", &array->num_rows) || array->num_rows < 0 || array->num_rows > PETSC_MAX_INT ||
      !EqmXmlInteger(node, "Dim1", &width) || width != 3) {
    return EqmXmlReject(in, node, "points and triangles need Dim0 (their number) and Dim1=\"3\"");
  }
  EqmXmlAttribute(node, "Endian", text, sizeof(text));
  array->big_endian = strcmp(text, "BigEndian") ? PETSC_FALSE : PETSC_TRUE;
  EqmXmlAttribute(node, "ArrayIndexingOrder", text, sizeof(text));
  array->column_major = strcmp(text, "ColumnMajorOrder") ? PETSC_FALSE : PETSC_TRUE;
  EqmXmlAttribute(node, "Encoding", array->encoding, sizeof(array->encoding));
  return 0;
}

/* The bytes of an array that lies in a file beside, at an offset; freed by the caller. */
static PetscErrorCode TakeExternal(const Array *array, size_t num_bytes, char **bytes)
{
  const EqmInput *const in = array->in;
  char name[256];
  PetscInt64 offset = 0;
  const char *content;
  size_t length;

  EqmXmlAttribute(array->node, "ExternalFileName", name, sizeof(name));
  (void)EqmXmlInteger(array->node, "ExternalFileOffset", &offset);
  if (!EqmBesideFind(in->beside, in->beside_end, name, &content, &length))
    return EqmXmlReject(array->in, array->node, "the file \"%s\" that holds its data is not beside it", name);
  if (offset < 0 || (size_t)offset > length || num_bytes > length - (size_t)offset)
    return EqmXmlReject(array->in, array->node, "the file \"%s\" is too short for its data", name);
  *bytes = malloc(num_bytes + 1);
  if (!*bytes) return PETSC_ERR_MEM;
  memcpy(*bytes, content + offset, num_bytes);
  return 0;
}

/* The bytes of base64 text, unpacked where they are compressed; freed by the caller, also after a failure. */
static PetscErrorCode DecodeBytes(const Array *array, const EqmXmlText *text, size_t num_bytes, char **bytes)
{
  const size_t most = text->length / 4 * 3 + 3;
  PetscBool packed = strcmp(array->encoding, "GZipBase64Binary") ? PETSC_FALSE : PETSC_TRUE, fine;
  size_t length;
  char *decoded;

  if (!packed && strcmp(array->encoding, "Base64Binary")) {
    return EqmXmlReject(array->in, array->node, "the Encoding \"%s\" is not supported", array->encoding);
  }
  if (packed ? !EqmInflatePlausible(most, num_bytes) : num_bytes > most) {
    return EqmXmlReject(array->in, array->node,
                        "its data is too short for the numbers that are announced: it is truncated");
  }
  *bytes = malloc(num_bytes + 1);
  decoded = malloc(most);
  if (!*bytes || !decoded) {
    free(decoded);
    return PETSC_ERR_MEM;
  }
  length = EqmBase64Decode(text->text, text->length, decoded, most);
  fine = packed ? EqmInflate(decoded, length, *bytes, num_bytes) : length == num_bytes ? PETSC_TRUE : PETSC_FALSE;
  if (fine && !packed) memcpy(*bytes, decoded, num_bytes);
  free(decoded);
  return fine ? 0 : EqmXmlReject(array->in, array->node, "its data is damaged or truncated");
}

static PetscErrorCode ConvertBytes(const Array *array, const char *bytes, PetscReal *reals, PetscInt64 *integers)
{
  const size_t size = EqmScalarSize(array->type);

  for (PetscInt64 i = 0; i < 3 * array->num_rows; ++i) {
    if (reals) {
      reals[i] = EqmLoadReal(bytes + (size_t)i * size, array->type, array->big_endian);
    } else {
      integers[i] = EqmLoadInteger(bytes + (size_t)i * size, array->type, array->big_endian);
    }
  }
  return 0;
}

/* 3 * num_rows numbers as they follow in the file, into `reals` or else `integers`. */
static PetscErrorCode ReadNumbers(const Array *array, PetscReal *reals, PetscInt64 *integers)
{
  xmlNodePtr data = EqmXmlChild(array->node, "Data");
  const size_t num_bytes = 3 * (size_t)array->num_rows * EqmScalarSize(array->type);
  EqmXmlText text;
  char *bytes = NULL;
  PetscErrorCode code;

  if (!strcmp(array->encoding, "ExternalFileBinary")) {
    code = TakeExternal(array, num_bytes, &bytes);
    if (!code) code = ConvertBytes(array, bytes, reals, integers);
    free(bytes);
    return code;
  }
  if (!data) return EqmXmlReject(array->in, array->node, "it has no Data");
  EqmXmlGetText(data, &text);
  if (!strcmp(array->encoding, "ASCII")) {
    code = EqmXmlParseNumbers(array->in, data, &text, 3 * array->num_rows, reals, integers);
  } else {
    code = DecodeBytes(array, &text, num_bytes, &bytes);
    if (!code) code = ConvertBytes(array, bytes, reals, integers);
  }
  free(bytes);
  EqmXmlTextReset(&text);
  return code;
}

/* Index of entry k of row i among the numbers of the file. */
static inline size_t IndexOf(const Array *array, PetscInt64 i, PetscInt64 k)
{
  return (size_t)(array->column_major ? k * array->num_rows + i : 3 * i + k);
}

/* However well they are packed, can the file hold the numbers? To be checked before memory is allocated for them. */
static PetscErrorCode CheckRoom(const Array *array)
{
  const EqmInput *const in = array->in;
  const size_t file_bytes = (size_t)(in->end - in->start) + (size_t)(in->beside_end - in->beside);

  if (EqmInflatePlausible(file_bytes, 3 * (size_t)array->num_rows)) return 0;
  return EqmXmlReject(array->in, array->node,
                      "the file is too short for the numbers that are announced: it is truncated");
}

static PetscErrorCode ParsePoints(EqmInput *in, xmlNodePtr node, EqmBuilder *builder)
{
  Array array;
  PetscReal *x, *numbers;
  PetscErrorCode code;

  if (builder->num_vertices) return EqmXmlReject(in, node, "a second point set: split the file");
  EqmTry(ParseArray(in, node, &array));
  EqmTry(CheckRoom(&array));
  EqmTry(EqmBuilderAddVertices(builder, (size_t)array.num_rows, &x));
  EqmTry(PetscMalloc1(3 * array.num_rows + 1, &numbers));
  code = ReadNumbers(&array, numbers, NULL);
  for (PetscInt64 i = 0; !code && i < 3 * array.num_rows; ++i) x[i] = numbers[IndexOf(&array, i / 3, i % 3)];
  EqmTry(PetscFree(numbers));
  return code;
}

static PetscErrorCode AddTriangles(const Array *array, const PetscInt64 *numbers, EqmBuilder *builder)
{
  for (PetscInt64 i = 0; i < array->num_rows; ++i) {
    const PetscInt64 corners[3] = {numbers[IndexOf(array, i, 0)], numbers[IndexOf(array, i, 1)],
                                   numbers[IndexOf(array, i, 2)]};

    EqmTry(EqmBuilderAddFace(builder, NULL, (PetscInt64)builder->num_vertices, 3, corners));
  }
  return 0;
}

static PetscErrorCode ParseTriangles(EqmInput *in, xmlNodePtr node, EqmBuilder *builder)
{
  Array array;
  PetscInt64 *numbers;
  PetscErrorCode code;

  EqmTry(ParseArray(in, node, &array));
  EqmTry(CheckRoom(&array));
  EqmTry(PetscMalloc1(3 * array.num_rows + 1, &numbers));
  code = ReadNumbers(&array, NULL, numbers);
  if (!code) code = AddTriangles(&array, numbers, builder);
  EqmTry(PetscFree(numbers));
  return code;
}

/* The arrays of one intent; points must be there before triangles name them, whatever the order in the file. */
static PetscErrorCode ParseArrays(EqmInput *in, xmlNodePtr root, const char *intent,
                                  PetscErrorCode (*parse)(EqmInput *, xmlNodePtr, EqmBuilder *), EqmBuilder *builder)
{
  char found[64];

  for (xmlNodePtr node = EqmXmlChild(root, "DataArray"); node; node = EqmXmlNext(node, "DataArray")) {
    EqmXmlAttribute(node, "Intent", found, sizeof(found));
    if (!strcmp(found, intent)) EqmTry(parse(in, node, builder));
  }
  return 0;
}

/* The text of a child element, cut to `length`. */
static void GetChildText(xmlNodePtr parent, const char *name, char *value, size_t length)
{
  xmlNodePtr child = EqmXmlChild(parent, name);
  xmlChar *text = child ? xmlNodeGetContent(child) : NULL;

  snprintf(value, length, "%s", text ? (const char *)text : "");
  if (text) xmlFree(text);
}

/* Anatomical structure and coordinate system of the point set, for the files that the mesh goes into. */
static PetscErrorCode KeepMetadata(xmlNodePtr root, char **metadata)
{
  static const char *const space[] = {"DataSpace", "TransformedSpace", "MatrixData"};
  xmlNodePtr node = EqmXmlChild(root, "DataArray");
  char intent[64], name[64], value[1024];

  for (; node; node = EqmXmlNext(node, "DataArray")) {
    EqmXmlAttribute(node, "Intent", intent, sizeof(intent));
    if (!strcmp(intent, "NIFTI_INTENT_POINTSET")) break;
  }
  if (!node) return 0;
  for (xmlNodePtr md = EqmXmlChild(EqmXmlChild(node, "MetaData"), "MD"); md; md = EqmXmlNext(md, "MD")) {
    GetChildText(md, "Name", name, sizeof(name));
    GetChildText(md, "Value", value, sizeof(value));
    if (name[0]) EqmTry(EqmMetadataAdd(metadata, name, value));
  }
  for (int i = 0; i < 3; ++i) {
    GetChildText(EqmXmlChild(node, "CoordinateSystemTransformMatrix"), space[i], value, sizeof(value));
    EqmTry(EqmMetadataAdd(metadata, space[i], value));
  }
  return 0;
}

static PetscErrorCode ParseMesh(EqmInput *in, EqmBuilder *builder, char **metadata)
{
  xmlDocPtr document;
  PetscErrorCode code = EqmXmlParse(in, in->start, EqmRemaining(in), &document);
  xmlNodePtr root = document ? xmlDocGetRootElement(document) : NULL;

  if (!code && !EqmXmlIs(root, "GIFTI")) code = EqmReject(in, EQM_ERR_IO, "a GIFTI file has the root element GIFTI");
  if (!code) code = ParseArrays(in, root, "NIFTI_INTENT_POINTSET", ParsePoints, builder);
  if (!code) code = ParseArrays(in, root, "NIFTI_INTENT_TRIANGLE", ParseTriangles, builder);
  if (!code) code = KeepMetadata(root, metadata);
  if (document) xmlFreeDoc(document);
  return code;
}

/* Read a GIFTI file. See EqmParser. */
static PetscErrorCode ParseGifti(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error,
                                 size_t error_length)
{
  EqmInput in;
  EqmBuilder builder;
  char *metadata = NULL;
  PetscErrorCode code;

  EqmInputOpen(&in, bytes, length, error, error_length);
  in.end = EqmBesideSplit(bytes, length, &in.beside, &in.beside_end);
  EqmBuilderOpen(&builder, &in);
  code = EqmBuilderFinish(&builder, ParseMesh(&in, &builder, &metadata), mesh);
  if (code)
    EqmTry(PetscFree(metadata));
  else
    mesh->metadata = metadata;
  return code;
}

/* Add the files beside that arrays name. See EqmLoader. */
static PetscErrorCode LoadGifti(const char *file, char **bytes, size_t *length, char *error, size_t error_length)
{
  return EqmBesideLoad(file, "ExternalFileName=\"", bytes, length, error, error_length);
}

EQM_DEFINE_FORMAT(Gifti) = {.name = "GIFTI",
                            .suffixes = "gii",
                            .recognise = RecogniseGifti,
                            .parse = ParseGifti,
                            .write = EqmWriteGifti,
                            .load = LoadGifti};
