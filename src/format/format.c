/* The list of mesh formats, and searches in it. */
#include "format.h"
#include "formats.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#define DECLARE(id) PETSC_INTERN const EqmFormat EqmFormat##id;
#define ADDRESS(id) &EqmFormat##id,

EQM_FORMAT_LIST(DECLARE)

static const EqmFormat *const formats[] = {EQM_FORMAT_LIST(ADDRESS)};

enum { NUM_FORMATS = sizeof(formats) / sizeof(formats[0]) };

/* EqmFormatAt - a row of the list, or NULL outside it. Not collective. */
const EqmFormat *EqmFormatAt(int row)
{
  return row >= 0 && row < NUM_FORMATS ? formats[row] : NULL;
}

/* EqmFormatRowOfContent - the format that a file's first bytes show; -1: none. Not collective. */
int EqmFormatRowOfContent(const char *bytes, size_t length)
{
  for (int i = 0; i < NUM_FORMATS; ++i) {
    if (formats[i]->recognise && formats[i]->recognise(bytes, length)) return i;
  }
  return -1;
}

/* Is `suffix` one of the words of `list`, in upper or lower case? */
static PetscBool IsListed(const char *list, const char *suffix, size_t length)
{
  for (const char *word = list; *word; word += strcspn(word, " "), word += strspn(word, " ")) {
    if (strcspn(word, " ") == length && !strncasecmp(word, suffix, length)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* EqmFormatRowOfSuffix - the format that a file's name shows; -1: none. Not collective. */
int EqmFormatRowOfSuffix(const char *file)
{
  const char *dot = strrchr(file, '.');

  if (!dot || strchr(dot, '/')) return -1;
  for (int i = 0; i < NUM_FORMATS; ++i) {
    if (IsListed(formats[i]->suffixes, dot + 1, strlen(dot + 1))) return i;
  }
  return -1;
}

/* EqmFormatOfContent - the format that a file's first bytes show, or NULL. Not collective. */
const EqmFormat *EqmFormatOfContent(const char *bytes, size_t length)
{
  return EqmFormatAt(EqmFormatRowOfContent(bytes, length));
}

/* EqmFormatOfSuffix - the format that a file's name shows, or NULL. Not collective. */
const EqmFormat *EqmFormatOfSuffix(const char *file)
{
  return EqmFormatAt(EqmFormatRowOfSuffix(file));
}

PetscBool EqmFormatIsWritable(const EqmFormat *format)
{
  return format->write || format->write_stream || format->write_parallel ? PETSC_TRUE : PETSC_FALSE;
}

/* EqmFormatListSuffixes - ".ply .vtu ..." of the formats that can be written, or read, for messages. Not collective. */
void EqmFormatListSuffixes(PetscBool writable, char *text, size_t length)
{
  size_t used = 0;

  if (length) text[0] = '\0';
  for (int i = 0; i < NUM_FORMATS; ++i) {
    const PetscBool can = writable ? EqmFormatIsWritable(formats[i]) : formats[i]->parse || formats[i]->read_parallel;
    const size_t left = used < length ? length - used : 0;

    if (can)
      used += (size_t)snprintf(text + used, left, "%s.%.*s", used ? " " : "", (int)strcspn(formats[i]->suffixes, " "),
                               formats[i]->suffixes);
    if (used >= length) return;
  }
}
