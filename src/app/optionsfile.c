/* Options from a file: PETSc's reader, kept from what it does not survive. */
#include "optionsfile.h"
#include <equimap/base.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { MOST_BYTES = 1 << 20 }; /* of an options file; a name and a value have at most some hundred */

/* Words with which PETSc's reader goes on to further files and options; one that leads back to itself has no end. */
static const char *const further[] = {"options_file", "options_file_yaml", "options_string", "options_string_yaml"};

/* The text of a file on this rank, at most MOST_BYTES + 1 bytes, with a zero behind; `code` 0, or EQM_ERR_IO for what
   is no readable file: a pipe could not be read twice. */
static PetscErrorCode Load(const char *file, char **text, size_t *length, PetscErrorCode *code)
{
  FILE *stream = NULL;
  struct stat status;

  PetscFunctionBegin;
  *length = 0;
  if (!stat(file, &status) && S_ISREG(status.st_mode)) stream = fopen(file, "rb");
  if (stream) *length = (size_t)PetscMin(status.st_size, MOST_BYTES + 1);
  PetscCall(PetscCalloc1(*length + 1, text));
  if (stream) *length = fread(*text, 1, *length, stream);
  *code = !stream || ferror(stream) ? EQM_ERR_IO : 0;
  if (stream) (void)fclose(stream);
  PetscFunctionReturn(0);
}

/* Overwrite the lines that are comments with blanks. */
static void DropComments(char *text)
{
  for (char *line = text; *line; line += line[0] == '\n') {
    const size_t length = strcspn(line, "\n");

    if (line[strspn(line, " \t")] == '#') memset(line, ' ', length);
    line += length;
  }
}

/* Is there a YAML anchor or alias, &name or *name? What begins so in quotes counts, too. Nodes that name each other
   make a small file long, or endless. */
static PetscBool HasAlias(const char *text)
{
  for (const char *c = strpbrk(text, "&*"); c; c = strpbrk(c + 1, "&*")) {
    if (c == text || strchr(" \t\r\n[{,:-?!\"'>|", c[-1])) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static PetscBool HasFurther(const char *text)
{
  for (size_t k = 0; k < sizeof(further) / sizeof(further[0]); k++) {
    for (const char *found = strstr(text, further[k]); found; found = strstr(found + 1, further[k])) {
      if (!strchr("_abcdefghijklmnopqrstuvwxyz0123456789", found[strlen(further[k])])) return PETSC_TRUE;
    }
  }
  return PETSC_FALSE;
}

static PetscBool IsYaml(const char *file)
{
  const char *const dot = strrchr(file, '.');

  return (PetscBool)(dot && (!strcmp(dot, ".yaml") || !strcmp(dot, ".yml")));
}

/* What is wrong with the text of an options file, NULL: nothing that PETSc's reader would not tell. */
static const char *WrongIn(char *text, size_t length, PetscBool is_yaml)
{
  if (length > MOST_BYTES) return "it has more than a million bytes";
  if (strlen(text) < length) return "it is no text";
  DropComments(text);
  if (is_yaml && HasAlias(text)) return "anchors and aliases (&name, *name) are not read";
  if (HasFurther(text)) return "it names another: give -options_file several times on the command line";
  return NULL;
}

/* On rank 0: refuse what PETSc's reader must not be given. */
static PetscErrorCode Refuse(const char *file, char *message, size_t size)
{
  char *text;
  const char *wrong;
  size_t length;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(Load(file, &text, &length, &code));
  if (code) {
    (void)snprintf(message, size, "cannot read the options file '%.1000s'", file);
  } else if ((wrong = WrongIn(text, length, IsYaml(file)))) {
    code = EQM_ERR_USAGE;
    (void)snprintf(message, size, "the options file '%.1000s': %s", file, wrong);
  }
  PetscCall(PetscFree(text));
  PetscFunctionReturn(code);
}

PetscErrorCode EqmOptionsFileInsert(PetscOptions options, const char *file)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) code = Refuse(file, message, sizeof(message));
  PetscCall(EqmAgree(PETSC_COMM_WORLD, code, message));
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  code = PetscOptionsInsertFile(PETSC_COMM_WORLD, options, file, PETSC_TRUE);
  PetscCall(PetscPopErrorHandler());
  if (code)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE,
            "cannot understand the options file '%s': in a .yaml file write lines like max_it: 100, in others lines "
            "like -max_it 100",
            file);
  PetscFunctionReturn(0);
}
