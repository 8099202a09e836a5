#include "giftiarray.h"
#include "beside.h"
#include "encoding.h"

#include <stdlib.h>
#include <string.h>

/* EqmGiftiParseArray - what the attributes of a DataArray say; `width` numbers per row are wanted, 0: any. Not
   collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGiftiParseArray(EqmInput *in, xmlNodePtr node, PetscInt64 width, EqmGiftiArray *array)
{
  static const struct {
    const char *name;
    EqmScalarType type;
  } known[] = {{"NIFTI_TYPE_FLOAT32", EQM_SCALAR_FLOAT32},
               {"NIFTI_TYPE_FLOAT64", EQM_SCALAR_FLOAT64},
               {"NIFTI_TYPE_INT32", EQM_SCALAR_INT32},
               {"NIFTI_TYPE_UINT8", EQM_SCALAR_UINT8}};
  char text[64];

  *array = (EqmGiftiArray){.in = in, .node = node};
  EqmXmlAttribute(node, "DataType", text, sizeof(text));
  for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); ++i) {
    if (!strcmp(text, known[i].name)) array->type = known[i].type;
  }
  if (!array->type) return EqmXmlReject(in, node, "the DataType \"%s\" is not supported", text);
  if (!EqmXmlInteger(node, "Dim1", &array->width)) array->width = 1;
  if (!EqmXmlInteger(node, "Dim0", &array->num_rows) || array->num_rows < 0 || array->num_rows > PETSC_MAX_INT ||
      array->width < 1 || array->width > PETSC_MAX_INT || (width && array->width != width)) {
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
static PetscErrorCode TakeExternal(const EqmGiftiArray *array, size_t num_bytes, char **bytes)
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
static PetscErrorCode DecodeBytes(const EqmGiftiArray *array, const EqmXmlText *text, size_t num_bytes, char **bytes)
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

static PetscErrorCode ConvertBytes(const EqmGiftiArray *array, const char *bytes, PetscReal *reals,
                                   PetscInt64 *integers)
{
  const size_t size = EqmScalarSize(array->type);

  for (PetscInt64 i = 0; i < array->width * array->num_rows; ++i) {
    if (reals) {
      reals[i] = EqmLoadReal(bytes + (size_t)i * size, array->type, array->big_endian);
    } else {
      integers[i] = EqmLoadInteger(bytes + (size_t)i * size, array->type, array->big_endian);
    }
  }
  return 0;
}

/* EqmGiftiReadNumbers - width * num_rows numbers as they follow in the file, into `reals` or else `integers`. Not
   collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGiftiReadNumbers(const EqmGiftiArray *array, PetscReal *reals, PetscInt64 *integers)
{
  xmlNodePtr data = EqmXmlChild(array->node, "Data");
  const size_t num_bytes = (size_t)array->width * (size_t)array->num_rows * EqmScalarSize(array->type);
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
    code = EqmXmlParseNumbers(array->in, data, &text, array->width * array->num_rows, reals, integers);
  } else {
    code = DecodeBytes(array, &text, num_bytes, &bytes);
    if (!code) code = ConvertBytes(array, bytes, reals, integers);
  }
  free(bytes);
  EqmXmlTextReset(&text);
  return code;
}

/* EqmGiftiCheckRoom - however well they are packed, can the file hold the numbers? To be checked before memory is
   allocated for them. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGiftiCheckRoom(const EqmGiftiArray *array)
{
  const EqmInput *const in = array->in;
  const size_t file_bytes = (size_t)(in->end - in->start) + (size_t)(in->beside_end - in->beside);

  if (EqmInflatePlausible(file_bytes, (size_t)array->width * (size_t)array->num_rows)) return 0;
  return EqmXmlReject(array->in, array->node,
                      "the file is too short for the numbers that are announced: it is truncated");
}
