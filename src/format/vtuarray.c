#include "vtuarray.h"
#include "encoding.h"

#include <stdlib.h>
#include <string.h>

/* Bytes of an array as they are stored, raw or as base64 text. */
typedef struct {
  const EqmVtuEncoding *encoding;
  xmlNodePtr node;
  EqmXmlText text;      /* of an inline array */
  const char *stored;   /* where the array begins, */
  size_t stored_length; /* and what it may extend over */
  PetscBool base64;
  char *decoded; /* base64 only */
} Source;

/* One array: its numbers' bytes, whichever way they came. */
typedef struct {
  EqmScalarType type;
  const char *bytes;
  char *unpacked; /* compressed arrays only */
} Content;

static PetscErrorCode ParseType(const EqmVtuEncoding *encoding, xmlNodePtr node, EqmScalarType *type)
{
  static const char *const name[] = {"",       "Int8",  "UInt8",  "Int16",   "UInt16", "Int32",
                                     "UInt32", "Int64", "UInt64", "Float32", "Float64"};
  char text[16];

  EqmXmlAttribute(node, "type", text, sizeof(text));
  for (int i = EQM_SCALAR_INT8; i <= EQM_SCALAR_FLOAT64; ++i) {
    if (!strcmp(text, name[i])) {
      *type = (EqmScalarType)i;
      return 0;
    }
  }
  return EqmXmlReject(encoding->in, node, "unknown type \"%s\"; known are Int8 to UInt64, Float32 and Float64", text);
}

/* Where the bytes of an array that is not ASCII begin. */
static PetscErrorCode LocateBytes(Source *source, const char *format)
{
  const EqmVtuEncoding *encoding = source->encoding;
  PetscInt64 offset;

  if (!strcmp(format, "binary")) {
    source->stored = source->text.text;
    source->stored_length = source->text.length;
    source->base64 = PETSC_TRUE;
    return 0;
  }
  if (strcmp(format, "appended")) {
    return EqmXmlReject(encoding->in, source->node, "unknown format \"%s\"; known are ascii, binary and appended",
                        format);
  }
  if (!encoding->appended) {
    return EqmXmlReject(encoding->in, source->node, "its data is said to be appended, but no AppendedData follows");
  }
  if (!EqmXmlInteger(source->node, "offset", &offset) || offset < 0 || (size_t)offset > encoding->appended_length) {
    return EqmXmlReject(encoding->in, source->node, "its offset lies outside the file: the file is truncated");
  }
  source->stored = encoding->appended + offset;
  source->stored_length = encoding->appended_length - (size_t)offset;
  source->base64 = encoding->appended_base64;
  return 0;
}

/* The first `count` bytes of the array. */
static PetscErrorCode Fetch(Source *source, size_t count, const char **bytes)
{
  const size_t available = source->base64 ? source->stored_length / 4 * 3 : source->stored_length;

  if (count > available) {
    return EqmXmlReject(source->encoding->in, source->node,
                        "%zu bytes of data are announced and %zu are there: the file is "
                        "truncated",
                        count, available);
  }
  *bytes = source->stored;
  if (!source->base64) return 0;
  free(source->decoded);
  source->decoded = malloc(count + 1);
  if (!source->decoded) return PETSC_ERR_MEM;
  *bytes = source->decoded;
  if (EqmBase64Decode(source->stored, source->stored_length, source->decoded, count) == count) return 0;
  return EqmXmlReject(source->encoding->in, source->node, "its base64 text is damaged or truncated");
}

static PetscErrorCode FetchHeader(Source *source, size_t num_words, size_t index, size_t *word)
{
  const size_t size = EqmScalarSize(source->encoding->header);
  const char *bytes;
  PetscInt64 value;

  if (num_words > source->stored_length / size)
    return EqmXmlReject(source->encoding->in, source->node, "truncated data");
  EqmTry(Fetch(source, num_words * size, &bytes));
  value = EqmLoadInteger(bytes + index * size, source->encoding->header, source->encoding->big_endian);
  if (value < 0) return EqmXmlReject(source->encoding->in, source->node, "impossible length of the data");
  *word = (size_t)value;
  return 0;
}

/* A length, then the data. */
static PetscErrorCode FetchPlain(Source *source, size_t num_bytes, Content *content)
{
  const size_t header = EqmScalarSize(source->encoding->header);
  size_t length;

  EqmTry(FetchHeader(source, 1, 0, &length));
  if (length < num_bytes) {
    return EqmXmlReject(source->encoding->in, source->node, "it has %zu bytes and needs %zu", length, num_bytes);
  }
  EqmTry(Fetch(source, header + num_bytes, &content->bytes));
  content->bytes += header;
  return 0;
}

/* Unpack the blocks one after the other. `sizes` are the packed lengths, as the file has them. */
static PetscErrorCode UnpackBlocks(const Source *source, const char *sizes, size_t num_blocks, size_t block_bytes,
                                   size_t num_bytes, char *unpacked)
{
  const EqmScalarType header = source->encoding->header;
  const char *packed = sizes + num_blocks * EqmScalarSize(header);

  for (size_t b = 0; b < num_blocks; ++b) {
    const size_t length =
        (size_t)EqmLoadInteger(sizes + b * EqmScalarSize(header), header, source->encoding->big_endian);
    const size_t done = b * block_bytes;

    if (!EqmInflate(packed, length, unpacked + done, b + 1 < num_blocks ? block_bytes : num_bytes - done)) {
      return EqmXmlReject(source->encoding->in, source->node, "its compressed block %zu is damaged", b);
    }
    packed += length;
  }
  return 0;
}

/* Sum of the packed lengths, no more than is stored. */
static PetscErrorCode SumLengths(const Source *source, const char *sizes, size_t num_blocks, size_t *sum)
{
  const EqmScalarType header = source->encoding->header;

  *sum = 0;
  for (size_t b = 0; b < num_blocks; ++b) {
    const PetscInt64 length = EqmLoadInteger(sizes + b * EqmScalarSize(header), header, source->encoding->big_endian);

    if (length < 0 || (size_t)length > source->stored_length - *sum) {
      return EqmXmlReject(source->encoding->in, source->node, "its compressed data is damaged or truncated");
    }
    *sum += (size_t)length;
  }
  return 0;
}

/* Number of blocks, bytes of a block, bytes of the last block if it is shorter, packed length of each; then the blocks.
 */
static PetscErrorCode FetchCompressed(Source *source, size_t num_bytes, Content *content)
{
  const size_t word = EqmScalarSize(source->encoding->header);
  const char *bytes;
  size_t num_blocks, block_bytes, last_bytes, packed;

  EqmTry(FetchHeader(source, 1, 0, &num_blocks));
  EqmTry(FetchHeader(source, 3, 1, &block_bytes));
  EqmTry(FetchHeader(source, 3, 2, &last_bytes));
  if (!num_blocks || num_blocks > source->stored_length / word ||
      (num_blocks > 1 && block_bytes > num_bytes / (num_blocks - 1)) ||
      (num_blocks - 1) * block_bytes + (last_bytes ? last_bytes : block_bytes) != num_bytes) {
    return EqmXmlReject(source->encoding->in, source->node,
                        "its compressed blocks do not make up the %zu bytes it needs", num_bytes);
  }
  EqmTry(Fetch(source, (3 + num_blocks) * word, &bytes));
  EqmTry(SumLengths(source, bytes + 3 * word, num_blocks, &packed));
  EqmTry(Fetch(source, (3 + num_blocks) * word + packed, &bytes));
  if (!EqmInflatePlausible(packed, num_bytes)) {
    return EqmXmlReject(source->encoding->in, source->node, "%zu bytes cannot be packed into %zu", num_bytes, packed);
  }
  content->unpacked = malloc(num_bytes + 1);
  if (!content->unpacked) return PETSC_ERR_MEM;
  content->bytes = content->unpacked;
  return UnpackBlocks(source, bytes + 3 * word, num_blocks, block_bytes, num_bytes, content->unpacked);
}

static void Convert(const EqmVtuEncoding *encoding, const Content *content, PetscInt64 count, PetscReal *reals,
                    PetscInt64 *integers)
{
  const size_t size = EqmScalarSize(content->type);

  for (PetscInt64 i = 0; i < count; ++i) {
    const char *bytes = content->bytes + (size_t)i * size;

    if (reals) {
      reals[i] = EqmLoadReal(bytes, content->type, encoding->big_endian);
    } else {
      integers[i] = EqmLoadInteger(bytes, content->type, encoding->big_endian);
    }
  }
}

static PetscErrorCode ReadBinary(Source *source, const char *format, PetscInt64 count, PetscReal *reals,
                                 PetscInt64 *integers)
{
  Content content = {EQM_SCALAR_NONE, NULL, NULL};
  PetscErrorCode code = ParseType(source->encoding, source->node, &content.type);
  const size_t num_bytes = (size_t)count * EqmScalarSize(content.type);

  if (!code) code = LocateBytes(source, format);
  if (!code && num_bytes) {
    code = source->encoding->compressed ? FetchCompressed(source, num_bytes, &content)
                                        : FetchPlain(source, num_bytes, &content);
    if (!code) Convert(source->encoding, &content, count, reals, integers);
  }
  free(content.unpacked);
  free(source->decoded);
  return code;
}

/* EqmVtuCheckRoom - can the file hold so many numbers at all, however well they are packed? To be asked before memory
   is taken for them. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmVtuCheckRoom(const EqmVtuEncoding *encoding, xmlNodePtr node, PetscInt64 count)
{
  if (count >= 0 && (size_t)count <= (encoding->compressed ? 1032 : 1) * encoding->file_bytes) return 0;
  return EqmXmlReject(encoding->in, node,
                      "%lld numbers are announced, but the file is too short for them: it is truncated",
                      (long long)count);
}

/* Numbers of which the other ranks read theirs. */
static PetscErrorCode ReadRange(const EqmVtuEncoding *encoding, xmlNodePtr node, EqmVtuRange range, PetscReal *reals,
                                PetscInt64 *integers)
{
  Content content;
  char *bytes;
  PetscErrorCode code;

  EqmTry(ParseType(encoding, node, &content.type));
  EqmTry(EqmVtuCheckRoom(encoding, node, range.total));
  code = EqmVtuLoadRange(encoding, node, EqmScalarSize(content.type), range, &bytes);
  content.bytes = bytes;
  if (!code) Convert(encoding, &content, range.count, reals, integers);
  EqmTry(PetscFree(bytes));
  return code;
}

static PetscErrorCode ReadArray(const EqmVtuEncoding *encoding, xmlNodePtr node, EqmVtuRange range, PetscReal *reals,
                                PetscInt64 *integers)
{
  Source source = {.encoding = encoding, .node = node};
  PetscErrorCode code;
  char format[16];

  if (encoding->file) return ReadRange(encoding, node, range, reals, integers);
  EqmXmlAttribute(node, "format", format, sizeof(format));
  EqmXmlGetText(node, &source.text);
  code = strcmp(format, "ascii") ? ReadBinary(&source, format, range.total, reals, integers)
                                 : EqmXmlParseNumbers(encoding->in, node, &source.text, range.total, reals, integers);
  EqmXmlTextReset(&source.text);
  return code;
}

/* EqmVtuShare - the numbers of an array of that many rows, `width` each, that are to be read here. Not collective. */
EqmVtuRange EqmVtuShare(const EqmVtuEncoding *encoding, PetscInt64 num_rows, PetscInt64 width)
{
  EqmVtuRange range = {width * num_rows, 0, width * num_rows};

  if (encoding->file) {
    EqmPartFileShare(encoding->file, num_rows, &range.first, &range.count);
    range.first *= width;
    range.count *= width;
  }
  return range;
}

/* EqmVtuReadReals - numbers of a DataArray; where it is in memory, all. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmVtuReadReals(const EqmVtuEncoding *encoding, xmlNodePtr node, EqmVtuRange range, PetscReal *values)
{
  return ReadArray(encoding, node, range, values, NULL);
}

/* EqmVtuReadIntegers - whole numbers of a DataArray, into memory that is taken here and freed by the caller, also after
   a failure; where it is in memory, all. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmVtuReadIntegers(const EqmVtuEncoding *encoding, xmlNodePtr node, EqmVtuRange range,
                                  PetscInt64 **values)
{
  EqmTry(EqmVtuCheckRoom(encoding, node, range.total));
  EqmTry(PetscMalloc1(range.count + 1, values));
  return ReadArray(encoding, node, range, NULL, *values);
}
