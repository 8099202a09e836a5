/* COMMAND --help: what PETSc says of each option, in the house's layout. */
#include "app.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { MARGIN = 96, INDENT = 6, LONGEST = 4096 };

/* Print words with line breaks, every line behind INDENT blanks. */
static void PrintWrapped(const char *text, int length)
{
  int column = 0;

  for (int k = 0; k < length;) {
    int word = 0;

    while (k + word < length && text[k + word] != ' ') word++;
    if (column == 0 || column + 1 + word > MARGIN) {
      printf("%s%*s", column ? "\n" : "", INDENT, "");
      column = INDENT;
    } else {
      printf(" ");
      column++;
    }
    printf("%.*s", word, text + k);
    column += word;
    k += word;
    while (k < length && text[k] == ' ') k++;
  }
  printf("\n");
}

/* What an option does, ": purpose (page)" and a newline or not; the name of a manual page is left out. */
static void PrintPurpose(const char *text)
{
  const char *const begin = text + strspn(text, ">: "), *end = begin + strcspn(begin, "\n");
  const char *const page = strrchr(begin, '(');

  if (page && !memchr(page, ' ', (size_t)(end - page))) end = page;
  while (end > begin && end[-1] == ' ') end--;
  PrintWrapped(begin, (int)(end - begin));
}

/* "  -name <now X : formerly Y>: purpose (page)": name and present value X on a line, the purpose beneath. A list of
   numbers comes in pieces, "  -name <3", ",5", ">: purpose (page)", and is not shown. */
static void PrintOption(const char *text)
{
  const char *const open = strchr(text, '<'), *const close = strchr(text, '>');
  const char *value = open ? open + 1 : NULL, *end = close;
  int name = (int)strcspn(text, "<\n");

  while (name > 0 && (text[name - 1] == ' ' || text[name - 1] == ':')) name--;
  printf("%.*s", name, text);
  if (open && close) {
    if (!strncmp(value, "now ", 4)) value += 4;
    if (strstr(value, " : ") && strstr(value, " : ") < close) end = strstr(value, " : ");
    if (end > value) printf(" [%.*s]", (int)(end - value), value);
    printf("\n");
    PrintPurpose(close);
  }
}

/* EqmHelpPrintf - PETSc's way of printing help, to be put in the place of PetscHelpPrintf: each option's name and
   present value, and beneath it what it does.

   Collective in spirit: rank 0 of `comm` prints. */
PetscErrorCode EqmHelpPrintf(MPI_Comm comm, const char format[], ...)
{
  static const char rule[] = "----------------------------------------\n";
  char text[LONGEST], *choices;
  PetscMPIInt rank;
  va_list arguments;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank) PetscFunctionReturn(0);
  va_start(arguments, format);
  PetscCall(PetscVSNPrintf(text, sizeof(text), format, NULL, arguments));
  va_end(arguments);
  choices = strstr(text, " (choose one of)");
  if (!strncmp(text, rule, strlen(rule))) {
    printf("\n%s", text + strlen(rule));
  } else if (!strncmp(text, "  -", 3)) {
    if (choices) *choices = '\0';
    PrintOption(text);
    if (choices) printf("%*s", INDENT - 1, ""); /* the choices come next, each behind a blank */
  } else if (text[0] == '>') {
    printf("\n");
    PrintPurpose(text);
  } else if (!strncmp(text, " (", 2)) {
    printf("\n"); /* the end of the choices */
  } else if (text[0] != ',') {
    printf("%s", text);
  }
  PetscFunctionReturn(0);
}
