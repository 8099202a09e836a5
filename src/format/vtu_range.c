/* Some numbers of an array of a VTU file, without the rest of it: raw bytes, base64 text, or blocks that zlib has
   packed. What deviates in the slightest is left to the reader of the whole array. */
#include "encoding.h"
#include "vtuarray.h"

#include <string.h>
#include <zlib.h>

/* Where an array is in the file. */
typedef struct {
  const EqmPartFile *file;
  PetscInt64 begin, end;
  PetscBool base64, big_endian;
  EqmScalarType word; /* of the lengths before the data */
} Stored;

static PetscErrorCode Locate(const EqmVtuEncoding *encoding, xmlNodePtr node, Stored *stored)
{
  char format[16], place[64];
  const char *next, *end;
  PetscInt64 offset, length;
  EqmXmlText text;

  *stored = (Stored){.file = encoding->file, .big_endian = encoding->big_endian, .word = encoding->header};
  EqmXmlAttribute(node, "format", format, sizeof(format));
  if (!strcmp(format, "appended")) {
    if (!encoding->appended_in_file || !EqmXmlInteger(node, "offset", &offset) || offset < 0) return EQM_ERR_IO;
    if (offset > encoding->file->length - encoding->appended_in_file) return EQM_ERR_IO;
    stored->begin = encoding->appended_in_file + offset;
    stored->end = encoding->file->length;
    stored->base64 = encoding->appended_base64;
    return 0;
  }
  if (strcmp(format, "binary")) return EQM_ERR_IO;
  EqmXmlGetText(node, &text);
  snprintf(place, sizeof(place), "%s", text.text);
  EqmXmlTextReset(&text);
  next = place[0] == '@' ? EqmParseInteger(place + 1, end = place + strlen(place), &stored->begin) : NULL;
  if (!next || *next != ' ' || EqmParseInteger(next + 1, end, &length) != end) return EQM_ERR_IO;
  stored->end = stored->begin + length;
  stored->base64 = PETSC_TRUE;
  return 0;
}

/* Bytes [first, first + count) of what is stored from `from` on; PetscFree them, also after a failure. */
static PetscErrorCode Load(const Stored *stored, PetscInt64 from, PetscInt64 first, PetscInt64 count, char **bytes)
{
  const PetscInt64 skipped = first % 3, wanted = skipped + count, num_chars = (wanted + 2) / 3 * 4;
  PetscErrorCode code = EQM_ERR_IO;
  EqmFilePart part;

  *bytes = NULL;
  if (first < 0 || count < 0 || first > stored->file->length || count > stored->file->length) return EQM_ERR_IO;
  if (!stored->base64) {
    if (first + count > stored->end - from) return EQM_ERR_IO;
    EqmTry(EqmPartFileBytes(stored->file, from + first, count, &part));
    *bytes = part.bytes;
    return part.bytes ? 0 : EQM_ERR_IO;
  }
  from += first / 3 * 4;
  if (num_chars > stored->end - from) return EQM_ERR_IO;
  EqmTry(EqmPartFileBytes(stored->file, from, num_chars, &part));
  EqmTry(PetscMalloc1((size_t)wanted + 1, bytes));
  /* groups that end early would move all that follows */
  if (part.bytes && (num_chars < 4 || !memchr(part.bytes, '=', (size_t)num_chars - 4)) &&
      EqmBase64Decode(part.bytes, part.length, *bytes, (size_t)wanted) == (size_t)wanted) {
    memmove(*bytes, *bytes + skipped, (size_t)count);
    code = 0;
  }
  EqmTry(PetscFree(part.bytes));
  return code;
}

/* The `num` words before the data; PetscFree them, also after a failure. */
static PetscErrorCode LoadWords(const Stored *stored, PetscInt64 num, PetscInt64 **words)
{
  const PetscInt64 size = (PetscInt64)EqmScalarSize(stored->word);
  char *bytes;
  PetscErrorCode code;

  *words = NULL;
  if (num > (stored->end - stored->begin) / size) return EQM_ERR_IO;
  code = Load(stored, stored->begin, 0, num * size, &bytes);
  if (!code) EqmTry(PetscMalloc1((size_t)num, words));
  for (PetscInt64 k = 0; k < num && !code; ++k) {
    (*words)[k] = EqmLoadInteger(bytes + k * size, stored->word, stored->big_endian);
    if ((*words)[k] < 0) code = EQM_ERR_IO;
  }
  EqmTry(PetscFree(bytes));
  return code;
}

/* Where the data begin behind `num` words, in one text with them or, after padding, in one of their own. */
static PetscErrorCode FindData(const Stored *stored, PetscInt64 num, PetscInt64 *from, PetscInt64 *skipped)
{
  const PetscInt64 size = num * (PetscInt64)EqmScalarSize(stored->word), num_chars = (size + 2) / 3 * 4;
  EqmFilePart part;

  *from = stored->begin;
  *skipped = size;
  if (!stored->base64) return 0;
  EqmTry(EqmPartFileBytes(stored->file, stored->begin, num_chars, &part));
  if (!part.bytes) return EQM_ERR_IO;
  if (part.bytes[num_chars - 1] == '=') {
    *from = stored->begin + num_chars;
    *skipped = 0;
  }
  return PetscFree(part.bytes);
}

/* A length, then the data. */
static PetscErrorCode LoadPlain(const Stored *stored, PetscInt64 size, EqmVtuRange range, char **bytes)
{
  PetscInt64 *length, from, skipped;
  PetscErrorCode code = LoadWords(stored, 1, &length);

  if (!code && length[0] < size * range.total) code = EQM_ERR_IO;
  EqmTry(PetscFree(length));
  if (!code) code = FindData(stored, 1, &from, &skipped);
  return code ? code : Load(stored, from, skipped + size * range.first, size * range.count, bytes);
}

/* Unpack the bytes [first, first + count) of a block of `block_bytes`, which must be all that it holds where they are
   its last ones. */
static PetscErrorCode Unpack(const char *packed, PetscInt64 length, PetscInt64 first, PetscInt64 count,
                             PetscInt64 block_bytes, char *bytes)
{
  z_stream stream = {.next_in = (Bytef *)(uintptr_t)packed, .avail_in = (uInt)length};
  Bytef unused[4096];
  int outcome = Z_OK;

  if (length > UINT32_MAX || inflateInit(&stream) != Z_OK) return EQM_ERR_IO;
  for (PetscInt64 done = 0, room; outcome == Z_OK; done += room - stream.avail_out) {
    const PetscBool before = done < first ? PETSC_TRUE : PETSC_FALSE;

    if (done >= first + count && first + count < block_bytes) break;
    room = before ? first - done : first + count - done;
    if (before || !room) room = PetscMin(before ? room : 1, (PetscInt64)sizeof(unused));
    room = PetscMin(room, 1 << 30);
    stream.next_out = before || done >= first + count ? unused : (Bytef *)bytes + (done - first);
    stream.avail_out = (uInt)room;
    outcome = inflate(&stream, Z_NO_FLUSH);
    if (outcome == Z_STREAM_END && done + room - stream.avail_out != block_bytes) outcome = Z_DATA_ERROR;
    if (done >= block_bytes && stream.avail_out < room) outcome = Z_DATA_ERROR; /* it holds more */
  }
  (void)inflateEnd(&stream);
  return outcome == Z_OK || outcome == Z_STREAM_END ? 0 : EQM_ERR_IO;
}

/* Number of blocks, bytes of a block, of the last one if it is shorter, packed length of each. */
static PetscErrorCode LoadBlockTable(const Stored *stored, PetscInt64 num_bytes, PetscInt64 **table)
{
  PetscInt64 num, sum = 0, *head;
  PetscErrorCode code = LoadWords(stored, 3, &head);
  const PetscInt64 most = stored->end - stored->begin;

  num = code ? 0 : head[0];
  if (!code && (!num || num > most || (num > 1 && head[1] > num_bytes / (num - 1)) ||
                (num - 1) * head[1] + (head[2] ? head[2] : head[1]) != num_bytes))
    code = EQM_ERR_IO;
  EqmTry(PetscFree(head));
  *table = NULL;
  if (!code) code = LoadWords(stored, 3 + num, table);
  for (PetscInt64 b = 0; b < num && !code; ++b) {
    if ((*table)[3 + b] > most - sum) code = EQM_ERR_IO;
    sum += (*table)[3 + b];
  }
  return code || EqmInflatePlausible((size_t)sum, (size_t)num_bytes) ? code : EQM_ERR_IO;
}

/* The blocks that hold the range, one at a time. */
static PetscErrorCode LoadBlocks(const Stored *stored, const PetscInt64 *table, PetscInt64 num_bytes, PetscInt64 first,
                                 PetscInt64 count, char *bytes)
{
  PetscInt64 from, at, packed_at = 0;
  PetscErrorCode code = FindData(stored, 3 + table[0], &from, &at);

  for (PetscInt64 b = 0; b < table[0] && !code; packed_at += table[3 + b++]) {
    const PetscInt64 begin = b * table[1], length = b + 1 < table[0] ? table[1] : num_bytes - begin;
    const PetscInt64 low = PetscMax(first, begin), high = PetscMin(first + count, begin + length);
    char *packed;

    if (low >= high) continue;
    code = Load(stored, from, at + packed_at, table[3 + b], &packed);
    if (!code) code = Unpack(packed, table[3 + b], low - begin, high - low, length, bytes + (low - first));
    EqmTry(PetscFree(packed));
  }
  return code;
}

static PetscErrorCode LoadPacked(const Stored *stored, PetscInt64 size, EqmVtuRange range, char **bytes)
{
  PetscInt64 *table;
  PetscErrorCode code = LoadBlockTable(stored, size * range.total, &table);

  if (!code) EqmTry(PetscMalloc1((size_t)(size * range.count) + 1, bytes));
  if (!code) code = LoadBlocks(stored, table, size * range.total, size * range.first, size * range.count, *bytes);
  EqmTry(PetscFree(table));
  return code;
}

PetscErrorCode EqmVtuLoadRange(const EqmVtuEncoding *encoding, xmlNodePtr node, size_t size, EqmVtuRange range,
                               char **bytes)
{
  Stored stored;

  *bytes = NULL;
  if (range.first < 0 || range.count < 0 || range.first > range.total - range.count) return EQM_ERR_IO;
  EqmTry(Locate(encoding, node, &stored));
  if (!range.total) return 0;
  return (encoding->compressed ? LoadPacked : LoadPlain)(&stored, (PetscInt64)size, range, bytes);
}
