#include "encoding.h"

#include <stdint.h>
#include <string.h>
#include <stdlib.h>
#include <zlib.h>

/* EqmBase64Length - characters that `num_bytes` bytes become, padding included. Not collective. */
size_t EqmBase64Length(size_t num_bytes)
{
  return (num_bytes + 2) / 3 * 4;
}

static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

enum { NOT_BASE64 = -1, WHITE_SPACE = -2 };

/* What each character stands for. */
static void MakeValues(signed char value[256])
{
  memset(value, NOT_BASE64, 256);
  for (int i = 0; i < 64; ++i) value[(unsigned char)digits[i]] = (signed char)i;
  value[' '] = value['\n'] = value['\r'] = value['\t'] = WHITE_SPACE;
}

/* EqmBase64Decode - decode until `max_bytes` bytes are there, the text ends or something else than base64 comes. Not
   collective. White space is skipped; padding ends a group, not the text, because some programs encode a header and its
   data separately and put them side by side. Returns the number of bytes. */
size_t EqmBase64Decode(const char *text, size_t length, char *bytes, size_t max_bytes)
{
  signed char values[256];
  size_t count = 0;
  uint32_t group = 0;
  int length_of_group = 0, padding = 0;

  MakeValues(values);
  for (size_t i = 0; i < length && count < max_bytes; ++i) {
    int value = values[(unsigned char)text[i]];

    if (value == WHITE_SPACE) continue;
    if (text[i] == '=' && length_of_group >= 2) {
      value = 0;
      ++padding;
    } else if (value < 0 || padding) {
      break;
    }
    group = group << 6 | (uint32_t)value;
    if (++length_of_group < 4) continue;
    for (int k = 0; k < 3 - padding && count < max_bytes; ++k) bytes[count++] = (char)(group >> (16 - 8 * k));
    group = 0;
    length_of_group = padding = 0;
  }
  return count;
}

/* EqmBase64Open - begin a base64 text in a file. Not collective. EqmBase64Close must follow. */
void EqmBase64Open(EqmBase64Writer *writer, EqmAtomicFile *file)
{
  writer->file = file;
  writer->num_kept = 0;
}

static void Flush(EqmBase64Writer *writer)
{
  const size_t count = writer->num_kept;
  char text[4 * 1024];
  size_t used = 0;

  for (size_t i = 0; i < count; i += 3) {
    const size_t left = count - i;
    uint32_t group = (uint32_t)(unsigned char)writer->kept[i] << 16;

    if (left > 1) group |= (uint32_t)(unsigned char)writer->kept[i + 1] << 8;
    if (left > 2) group |= (uint32_t)(unsigned char)writer->kept[i + 2];
    text[used++] = digits[group >> 18];
    text[used++] = digits[group >> 12 & 63];
    text[used++] = left > 1 ? digits[group >> 6 & 63] : '=';
    text[used++] = left > 2 ? digits[group & 63] : '=';
  }
  EqmAtomicWrite(writer->file, text, used);
  writer->num_kept = 0;
}

/* EqmBase64Write - append bytes. Not collective. */
void EqmBase64Write(EqmBase64Writer *writer, const void *bytes, size_t num_bytes)
{
  const char *next = bytes;

  while (num_bytes) {
    size_t part = PetscMin(num_bytes, sizeof(writer->kept) - writer->num_kept);

    memcpy(writer->kept + writer->num_kept, next, part);
    writer->num_kept += part;
    next += part;
    num_bytes -= part;
    if (writer->num_kept == sizeof(writer->kept)) Flush(writer);
  }
}

/* EqmBase64Close - write what waits, with padding. Not collective. */
void EqmBase64Close(EqmBase64Writer *writer)
{
  Flush(writer);
}

/* EqmInflate - unpack a zlib stream that must hold exactly `num_bytes` bytes. Not collective. */
PetscBool EqmInflate(const char *packed, size_t length, char *bytes, size_t num_bytes)
{
  uLongf unpacked = (uLongf)num_bytes;

  return uncompress((Bytef *)bytes, &unpacked, (const Bytef *)packed, (uLong)length) == Z_OK && unpacked == num_bytes
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* EqmInflatePlausible - can a zlib stream of this length hold so many bytes? Deflate packs 1032 to 1 at best. To be
   checked before memory is allocated for what a header announces. Not collective. */
PetscBool EqmInflatePlausible(size_t packed_length, size_t num_bytes)
{
  return num_bytes / 1032 <= packed_length ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool EqmIsGzip(const char *bytes, size_t length)
{
  return length > 18 && (unsigned char)bytes[0] == 0x1f && (unsigned char)bytes[1] == 0x8b ? PETSC_TRUE : PETSC_FALSE;
}

/* Unpack member after member into *unpacked, which grows. */
static PetscBool UnpackMembers(z_stream *stream, char **unpacked, size_t *capacity, size_t *count)
{
  int outcome = Z_OK;

  while (stream->avail_in || outcome == Z_OK) {
    if (*count == *capacity) {
      char *const larger = realloc(*unpacked, 2 * *capacity);

      if (!larger) return PETSC_FALSE;
      *unpacked = larger;
      *capacity *= 2;
    }
    stream->next_out = (Bytef *)*unpacked + *count;
    stream->avail_out = (uInt)PetscMin(*capacity - *count, (size_t)1 << 30);
    const uInt room = stream->avail_out;

    outcome = inflate(stream, Z_NO_FLUSH);
    *count += room - stream->avail_out;
    if (outcome == Z_STREAM_END && stream->avail_in && inflateReset(stream) == Z_OK) outcome = Z_OK;
    if (outcome == Z_STREAM_END) return PETSC_TRUE;
    if (outcome != Z_OK) return PETSC_FALSE;
  }
  return PETSC_FALSE;
}

/* EqmGunzip - replace the bytes of a gzip file, of several members perhaps, by what they hold. PETSC_FALSE: damaged,
   cut short, of more than 4 GB packed, or there is no memory; then they are as before. Not collective. */
PetscBool EqmGunzip(char **bytes, size_t *length)
{
  const int gzip = 16 + MAX_WBITS;
  size_t capacity = 4 * *length + 4096, count = 0;
  char *unpacked = malloc(capacity);
  z_stream stream = {.next_in = (Bytef *)*bytes, .avail_in = (uInt)*length};
  PetscBool fine = PETSC_FALSE;

  if (unpacked && *length <= UINT32_MAX && inflateInit2(&stream, gzip) == Z_OK) {
    fine = UnpackMembers(&stream, &unpacked, &capacity, &count);
    (void)inflateEnd(&stream);
  }
  if (!fine) {
    free(unpacked);
    return PETSC_FALSE;
  }
  free(*bytes);
  *bytes = unpacked;
  *length = count;
  return PETSC_TRUE;
}
