/* A file's bytes in memory and a cursor over them: what all parsers read from.

   Parsers run on one rank and never raise a PETSc error for what a file says: they return EQM_ERR_IO or EQM_ERR_MESH
   with a sentence (what, where, what to do), so that the caller can clean up and let all ranks agree. EqmReject makes
   both; EqmTry hands them on. */
#ifndef EQM_FORMAT_INPUT_H
#define EQM_FORMAT_INPUT_H

#include <equimap/base.h>

typedef struct {
  const char *start, *cursor, *end;
  const char *beside, *beside_end; /* contents of other files that the file names, or NULL */
  size_t behind;                   /* bytes of the file behind `end`, where this is its beginning */
  PetscBool binary;                /* positions in messages are bytes, not lines */
  char *error;                     /* where EqmReject writes */
  size_t error_length;
} EqmInput;

/* Hand a quiet failure on. */
#define EqmTry(...)                                                                                                    \
  do {                                                                                                                 \
    PetscErrorCode eqm_try_code_ = (__VA_ARGS__);                                                                      \
    if (eqm_try_code_) return eqm_try_code_;                                                                           \
  } while (0)

PETSC_INTERN void EqmInputOpen(EqmInput *in, const char *bytes, size_t length, char *error, size_t error_length);
PETSC_INTERN PetscErrorCode EqmReject(EqmInput *in, PetscErrorCode code, const char *format, ...)
    PETSC_ATTRIBUTE_FORMAT(3, 4);
PETSC_INTERN PetscErrorCode EqmRejectAt(EqmInput *in, const char *position, PetscErrorCode code, const char *format,
                                        ...) PETSC_ATTRIBUTE_FORMAT(4, 5);

/* Numbers at the beginning of [text, end): the end of the number, or NULL if there is none. */
PETSC_INTERN const char *EqmParseReal(const char *text, const char *end, PetscReal *value);
PETSC_INTERN const char *EqmParseInteger(const char *text, const char *end, PetscInt64 *value);

PETSC_INTERN void EqmSkipMark(EqmInput *in);
PETSC_INTERN void EqmSkipSpace(EqmInput *in, char comment);
PETSC_INTERN void EqmSkipLine(EqmInput *in);
PETSC_INTERN PetscBool EqmReadReal(EqmInput *in, PetscReal *value);
PETSC_INTERN PetscBool EqmReadInteger(EqmInput *in, PetscInt64 *value);
PETSC_INTERN size_t EqmReadWord(EqmInput *in, const char **word);
PETSC_INTERN PetscBool EqmReadKeyword(EqmInput *in, const char *keyword);
PETSC_INTERN PetscBool EqmWordIs(const char *word, size_t length, const char *keyword);
PETSC_INTERN PetscErrorCode EqmTakeBytes(EqmInput *in, size_t count, const char *what, const char **bytes);
PETSC_INTERN PetscErrorCode EqmReadCount(EqmInput *in, const char *what, size_t bytes_each, PetscInt64 *count);

static inline size_t EqmRemaining(const EqmInput *in)
{
  return (size_t)(in->end - in->cursor);
}

static inline PetscBool EqmIsBlank(char c)
{
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' ? PETSC_TRUE : PETSC_FALSE;
}

static inline PetscBool EqmIsSpace(char c)
{
  return EqmIsBlank(c) || c == '\n' || c == '\r' ? PETSC_TRUE : PETSC_FALSE;
}

/* Move over blanks, not over the end of the line. */
static inline void EqmSkipBlanks(EqmInput *in)
{
  while (in->cursor < in->end && EqmIsBlank(*in->cursor)) ++in->cursor;
}

/* Is nothing left of this line? Moves over blanks. */
static inline PetscBool EqmAtLineEnd(EqmInput *in)
{
  EqmSkipBlanks(in);
  return in->cursor == in->end || *in->cursor == '\n' || *in->cursor == '\r' ? PETSC_TRUE : PETSC_FALSE;
}

#endif
