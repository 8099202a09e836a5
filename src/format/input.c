#include "input.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* EqmInputOpen - put the cursor at the beginning of `bytes` (NULL: there are none); messages will go to `error`. Not
   collective. */
void EqmInputOpen(EqmInput *in, const char *bytes, size_t length, char *error, size_t error_length)
{
  in->start = in->cursor = bytes ? bytes : "";
  in->end = in->start + (bytes ? length : 0);
  in->beside = in->beside_end = NULL;
  in->behind = 0;
  in->binary = PETSC_FALSE;
  in->error = error;
  in->error_length = error_length;
  if (error_length) error[0] = '\0';
}

/* Lines end with \n, \r\n or, in files from old machines, \r alone. */
static PetscInt64 LineOf(const EqmInput *in, const char *position)
{
  PetscInt64 line = 1;

  for (const char *c = in->start; c < position; ++c) {
    if (*c == '\n' || (*c == '\r' && (c + 1 == in->end || c[1] != '\n'))) ++line;
  }
  return line;
}

static void Describe(EqmInput *in, const char *position, const char *format, va_list arguments)
{
  int used = 0;

  if (!position) { /* the message has no position */
  } else if (in->binary) {
    used = snprintf(in->error, in->error_length, "byte %lld: ", (long long)(position - in->start));
  } else {
    used = snprintf(in->error, in->error_length, "line %lld: ", (long long)LineOf(in, position));
  }
  if (used < 0 || (size_t)used >= in->error_length) return;
  vsnprintf(in->error + used, in->error_length - (size_t)used, format, arguments);
}

/* EqmReject - say what is wrong at the cursor. Not collective. Returns `code`, quietly. */
PetscErrorCode EqmReject(EqmInput *in, PetscErrorCode code, const char *format, ...)
{
  va_list arguments;

  va_start(arguments, format);
  Describe(in, in->cursor, format, arguments);
  va_end(arguments);
  return code;
}

/* EqmRejectAt - say what is wrong at `position`, or (NULL) without a position. Not collective. Returns
 * `code`, quietly. */
PetscErrorCode EqmRejectAt(EqmInput *in, const char *position, PetscErrorCode code, const char *format, ...)
{
  va_list arguments;

  va_start(arguments, format);
  Describe(in, position, format, arguments);
  va_end(arguments);
  return code;
}

/* EqmSkipMark - move over the three bytes that some editors put before UTF-8 text. Not collective. */
void EqmSkipMark(EqmInput *in)
{
  if (in->cursor == in->start && EqmRemaining(in) >= 3 && !memcmp(in->cursor, "\357\273\277", 3)) in->cursor += 3;
}

/* EqmSkipSpace - move over blanks, line ends and comments that begin with `comment` (0: there are none). Not
 * collective. */
void EqmSkipSpace(EqmInput *in, char comment)
{
  while (in->cursor < in->end) {
    if (EqmIsSpace(*in->cursor)) {
      ++in->cursor;
    } else if (comment && *in->cursor == comment) {
      EqmSkipLine(in);
    } else {
      return;
    }
  }
}

/* EqmSkipLine - move to the beginning of the next line, or to the end. Not collective. */
void EqmSkipLine(EqmInput *in)
{
  while (in->cursor < in->end && *in->cursor != '\n' && *in->cursor != '\r') ++in->cursor;
  if (in->cursor < in->end && *in->cursor == '\r') ++in->cursor;
  if (in->cursor < in->end && *in->cursor == '\n') ++in->cursor;
}

/* EqmReadReal - read a number of this line that blanks or the line's end follow. Not collective. Returns PETSC_FALSE,
   and leaves the cursor where the number should be, if there is none. */
PetscBool EqmReadReal(EqmInput *in, PetscReal *value)
{
  const char *next;

  EqmSkipBlanks(in);
  next = EqmParseReal(in->cursor, in->end, value);
  if (!next || (next < in->end && !EqmIsSpace(*next))) return PETSC_FALSE;
  in->cursor = next;
  return PETSC_TRUE;
}

/* EqmReadInteger - read a whole number of this line that blanks or the line's end follow. Not collective. Returns
   PETSC_FALSE, and leaves the cursor where the number should be, if there is none. */
PetscBool EqmReadInteger(EqmInput *in, PetscInt64 *value)
{
  const char *next;

  EqmSkipBlanks(in);
  next = EqmParseInteger(in->cursor, in->end, value);
  if (!next || (next < in->end && !EqmIsSpace(*next))) return PETSC_FALSE;
  in->cursor = next;
  return PETSC_TRUE;
}

/* EqmReadWord - read up to the next blank or line end. Not collective. Returns the word's length, 0 at the line's end;
   the word lies in the file's bytes and has no terminating zero. */
size_t EqmReadWord(EqmInput *in, const char **word)
{
  EqmSkipBlanks(in);
  *word = in->cursor;
  while (in->cursor < in->end && !EqmIsSpace(*in->cursor)) ++in->cursor;
  return (size_t)(in->cursor - *word);
}

/* EqmWordIs - compare a word with a keyword, upper and lower case alike. Not collective. */
PetscBool EqmWordIs(const char *word, size_t length, const char *keyword)
{
  return strlen(keyword) == length && !strncasecmp(word, keyword, length) ? PETSC_TRUE : PETSC_FALSE;
}

/* EqmReadKeyword - read a word if it is this one, upper and lower case alike; otherwise stay. Not collective. */
PetscBool EqmReadKeyword(EqmInput *in, const char *keyword)
{
  const char *before = in->cursor, *word;
  size_t length = EqmReadWord(in, &word);

  if (EqmWordIs(word, length, keyword)) return PETSC_TRUE;
  in->cursor = before;
  return PETSC_FALSE;
}

/* EqmTakeBytes - move over `count` bytes of `what`. Not collective. Errors: EQM_ERR_IO (quiet) if the file ends before.
 */
PetscErrorCode EqmTakeBytes(EqmInput *in, size_t count, const char *what, const char **bytes)
{
  if (count > EqmRemaining(in)) {
    return EqmReject(in, EQM_ERR_IO, "the file ends inside the %s (%zu bytes are missing): it is truncated", what,
                     count - EqmRemaining(in));
  }
  *bytes = in->cursor;
  in->cursor += count;
  return 0;
}

/* EqmReadCount - read the number of `what`, each of which takes at least `bytes_each` bytes of the file, and refuse one
   that the rest of the file cannot hold, before memory is allocated for it. Not collective. Errors: EQM_ERR_IO (quiet).
 */
PetscErrorCode EqmReadCount(EqmInput *in, const char *what, size_t bytes_each, PetscInt64 *count)
{
  const char *before = in->cursor;

  if (!EqmReadInteger(in, count) || *count < 0) {
    return EqmReject(in, EQM_ERR_IO, "the number of %s is missing or is not a whole number", what);
  }
  if ((size_t)*count > (EqmRemaining(in) + in->behind) / bytes_each + 1) {
    return EqmRejectAt(in, before, EQM_ERR_IO,
                       "%lld %s are announced, but the file is too short for them: it is truncated", (long long)*count,
                       what);
  }
  return 0;
}
