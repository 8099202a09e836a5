/* GIFTI surfaces of the neurosciences: a point set and triangles, ASCII, base64, compressed base64, or in binary files
   beside. */
#define _GNU_SOURCE
#include "beside.h"
#include "mesh/mesh_private.h"
#include "builder.h"
#include "giftiarray.h"
#include "metadata.h"
#include "writers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An element GIFTI near the beginning. Not collective. */
static PetscBool RecogniseGifti(const char *bytes, size_t length)
{
  return memmem(bytes, PetscMin(length, 4096), "<GIFTI", 6) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode ParsePoints(EqmInput *in, xmlNodePtr node, EqmBuilder *builder)
{
  EqmGiftiArray array;
  PetscReal *x, *numbers;
  PetscErrorCode code;

  if (builder->num_vertices) return EqmXmlReject(in, node, "a second point set: split the file");
  EqmTry(EqmGiftiParseArray(in, node, 3, &array));
  EqmTry(EqmGiftiCheckRoom(&array));
  EqmTry(EqmBuilderAddVertices(builder, (size_t)array.num_rows, &x));
  EqmTry(PetscMalloc1(3 * array.num_rows + 1, &numbers));
  code = EqmGiftiReadNumbers(&array, numbers, NULL);
  for (PetscInt64 i = 0; !code && i < 3 * array.num_rows; ++i) x[i] = numbers[EqmGiftiIndex(&array, i / 3, i % 3)];
  EqmTry(PetscFree(numbers));
  return code;
}

static PetscErrorCode AddTriangles(const EqmGiftiArray *array, const PetscInt64 *numbers, EqmBuilder *builder)
{
  for (PetscInt64 i = 0; i < array->num_rows; ++i) {
    const PetscInt64 corners[3] = {numbers[EqmGiftiIndex(array, i, 0)], numbers[EqmGiftiIndex(array, i, 1)],
                                   numbers[EqmGiftiIndex(array, i, 2)]};

    EqmTry(EqmBuilderAddFace(builder, NULL, (PetscInt64)builder->num_vertices, 3, corners));
  }
  return 0;
}

static PetscErrorCode ParseTriangles(EqmInput *in, xmlNodePtr node, EqmBuilder *builder)
{
  EqmGiftiArray array;
  PetscInt64 *numbers;
  PetscErrorCode code;

  EqmTry(EqmGiftiParseArray(in, node, 3, &array));
  EqmTry(EqmGiftiCheckRoom(&array));
  EqmTry(PetscMalloc1(3 * array.num_rows + 1, &numbers));
  code = EqmGiftiReadNumbers(&array, NULL, numbers);
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

/* An entry of an array's metadata, cut to `length`; "" if there is none. */
static void GetMetaData(xmlNodePtr array, const char *key, char *value, size_t length)
{
  char name[64];

  value[0] = '\0';
  for (xmlNodePtr md = EqmXmlChild(EqmXmlChild(array, "MetaData"), "MD"); md; md = EqmXmlNext(md, "MD")) {
    GetChildText(md, "Name", name, sizeof(name));
    if (!strcmp(name, key)) GetChildText(md, "Value", value, length);
  }
}

/* One array beside points and triangles: a field, if it has a row per vertex; left out if it cannot be read. */
static PetscErrorCode ParseField(EqmInput *in, xmlNodePtr node, const char *intent, EqmBuilder *builder)
{
  EqmGiftiArray array;
  char name[EQM_FIELD_NAME];
  PetscReal *values, *numbers;
  PetscErrorCode code;

  if (EqmGiftiParseArray(in, node, 0, &array) || array.num_rows != (PetscInt64)builder->num_vertices) return 0;
  if (array.width > 64 || EqmGiftiCheckRoom(&array)) return 0;
  GetMetaData(node, "Name", name, sizeof(name));
  if (!name[0]) snprintf(name, sizeof(name), "%s", strncmp(intent, "NIFTI_INTENT_", 13) ? intent : intent + 13);
  EqmTry(EqmBuilderAddField(builder, name, strlen(name), PETSC_FALSE, array.width, (size_t)array.num_rows, &values));
  if (!values) return 0;
  EqmTry(PetscMalloc1(array.width * array.num_rows + 1, &numbers));
  code = EqmGiftiReadNumbers(&array, numbers, NULL);
  for (PetscInt64 i = 0; !code && i < array.width * array.num_rows; ++i)
    values[i] = numbers[EqmGiftiIndex(&array, i / array.width, i % array.width)];
  EqmTry(PetscFree(numbers));
  return code ? EqmBuilderDropField(builder) : 0;
}

/* The arrays of all other intents. */
static PetscErrorCode ParseFields(EqmInput *in, xmlNodePtr root, EqmBuilder *builder)
{
  char intent[64];

  for (xmlNodePtr node = EqmXmlChild(root, "DataArray"); node; node = EqmXmlNext(node, "DataArray")) {
    EqmXmlAttribute(node, "Intent", intent, sizeof(intent));
    if (strcmp(intent, "NIFTI_INTENT_POINTSET") && strcmp(intent, "NIFTI_INTENT_TRIANGLE"))
      EqmTry(ParseField(in, node, intent, builder));
  }
  return 0;
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
  if (!code) code = ParseFields(in, root, builder);
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
                            .load = LoadGifti,
                            .vertex_fields = PETSC_TRUE};
