/* The options that a command reads, collected from PETSc's output under -help. */
#include "catalogue.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* PETSc passes its help text to a function without a context argument: this is its context. */
static EqmCatalogue *open_catalogue;

enum { LONGEST = 4096 };

static PetscErrorCode Append(char **text, const char *more, size_t length)
{
  const size_t old = *text ? strlen(*text) : 0;

  PetscFunctionBegin;
  PetscCall(PetscRealloc(old + length + 1, text));
  memcpy(*text + old, more, length);
  (*text)[old + length] = '\0';
  PetscFunctionReturn(0);
}

static PetscErrorCode AddSection(const char *title, size_t length)
{
  EqmCatalogue *const c = open_catalogue;

  PetscFunctionBegin;
  for (int s = 0; s < c->num_sections; s++) {
    if (strlen(c->section[s]) == length && !strncmp(c->section[s], title, length)) PetscFunctionReturn(0);
  }
  PetscCall(PetscRealloc(sizeof(*c->section) * (size_t)(c->num_sections + 1), &c->section));
  PetscCall(PetscStrncpy(c->section[c->num_sections++], title, PetscMin(length + 1, sizeof(*c->section))));
  PetscFunctionReturn(0);
}

/* The text behind the value, ": purpose (page)" and a newline or not; the name of a manual page is left out. */
static PetscErrorCode TakePurpose(const char *text, EqmOption *option)
{
  const char *const begin = text + strspn(text, ">: "), *end = begin + strcspn(begin, "\n");
  const char *page = end;

  PetscFunctionBegin;
  while (page > begin && *page != '(') page--;
  if (page > begin && !memchr(page, ' ', (size_t)(end - page))) end = page;
  while (end > begin && end[-1] == ' ') end--;
  PetscCall(Append(&option->purpose, begin, (size_t)(end - begin)));
  PetscFunctionReturn(0);
}

/* Of "<now VALUE : formerly VALUE>", "<VALUE : VALUE>": the second, which is the default. */
static void TakeInitial(const char *open, const char *close, EqmOption *option)
{
  const char *value = strstr(open, " : ");
  size_t length;

  value = value && value < close ? value + 3 : open + 1;
  if (!strncmp(value, "formerly ", 9)) value += 9;
  length = (size_t)(close - value);
  if (length >= sizeof(option->initial)) length = sizeof(option->initial) - 1;
  memcpy(option->initial, value, length);
  option->initial[length] = '\0';
}

static EqmOptionKind KindOf(const char *format, PetscBool is_list, const char *initial)
{
  const char *const value = strchr(format, '<');
  const PetscBool is_real = (PetscBool)(value && !strncmp(value + strcspn(value, "%"), "%g", 2));

  if (is_list) return is_real ? EQM_OPTION_REALS : EQM_OPTION_INTS;
  if (strstr(format, "(choose one of)")) return EQM_OPTION_CHOICE;
  if (!value || !strcmp(initial, "TRUE") || !strcmp(initial, "FALSE")) return EQM_OPTION_FLAG;
  if (is_real) return EQM_OPTION_REAL;
  return strchr(value, 'd') && !strstr(value, "now %s") ? EQM_OPTION_INT : EQM_OPTION_TEXT;
}

/* "  -name <now X : formerly Y>: purpose (page)"; a list of numbers comes in pieces, "  -name <3", ",5", ">: purpose".
   An option that is read again keeps its first position and text. */
static PetscErrorCode AddOption(const char *format, const char *text)
{
  EqmCatalogue *const c = open_catalogue;
  const char *const open = strchr(text, '<'), *const close = open ? strchr(open, '>') : NULL;
  const size_t length = strcspn(text + 2, " <:\n");
  EqmOption *option;

  PetscFunctionBegin;
  if (c->num_sections == 0) PetscCall(AddSection("Options", 7));
  PetscCall(PetscRealloc(sizeof(EqmOption) * (size_t)(c->num_options + 1), &c->option));
  option = &c->option[c->num_options++];
  memset(option, 0, sizeof(*option));
  option->section = c->num_sections - 1;
  PetscCall(PetscStrncpy(option->name, text + 2, PetscMin(length + 1, sizeof(option->name))));
  if (open && close) TakeInitial(open, close, option);
  option->kind = KindOf(format, (PetscBool)(open && !close), option->initial);
  if (option->kind == EQM_OPTION_CHOICE) {
    PetscCall(TakePurpose(close + 1, option));
    option->purpose[strcspn(option->purpose, "(")] = '\0'; /* "(choose one of)" */
    for (size_t n = strlen(option->purpose); n > 0 && option->purpose[n - 1] == ' '; n--) option->purpose[n - 1] = '\0';
  } else if (!open || close) {
    PetscCall(TakePurpose(close ? close + 1 : strchr(text, ':'), option));
  }
  PetscFunctionReturn(0);
}

/* Replaces PetscHelpPrintf. All ranks record the same. */
static PetscErrorCode Note(MPI_Comm comm, const char format[], ...)
{
  static const char rule[] = "----------------------------------------\n";
  EqmCatalogue *const c = open_catalogue;
  EqmOption *const last = c->num_options ? &c->option[c->num_options - 1] : NULL;
  char text[LONGEST];
  va_list arguments;
  PetscErrorCode error;

  PetscFunctionBegin;
  va_start(arguments, format);
  error = PetscVSNPrintf(text, sizeof(text), format, NULL, arguments);
  va_end(arguments);
  PetscCall(error);
  if (!strncmp(text, rule, strlen(rule))) {
    PetscCall(AddSection(text + strlen(rule), strcspn(text + strlen(rule), ":\n")));
  } else if (!strncmp(text, "  -", 3)) {
    PetscCall(AddOption(format, text));
  } else if (last && text[0] == '>') {
    PetscCall(TakePurpose(text, last));
  } else if (last && last->kind == EQM_OPTION_CHOICE && text[0] == ' ' && text[1] != '(') {
    PetscCall(Append(&last->choices, text + (last->choices ? 0 : 1), strlen(text) - (last->choices ? 0 : 1)));
  }
  PetscFunctionReturn(0);
}

/* Replaces PetscVFPrintf, through which PetscPrintf prints on rank 0. */
static PetscErrorCode NotePrinted(FILE *stream, const char format[], va_list arguments)
{
  char text[LONGEST];

  PetscFunctionBegin;
  PetscCall(PetscVSNPrintf(text, sizeof(text), format, NULL, arguments));
  PetscCall(Append(&open_catalogue->notes, text, strlen(text)));
  PetscFunctionReturn(0);
}

/* List options that were read twice once, in their first position. */
static PetscErrorCode DropRepeated(EqmCatalogue *catalogue)
{
  int kept = 0;

  PetscFunctionBegin;
  for (int k = 0; k < catalogue->num_options; k++) {
    int earlier = 0;

    while (earlier < kept && strcmp(catalogue->option[earlier].name, catalogue->option[k].name)) earlier++;
    if (earlier == kept) {
      catalogue->option[kept++] = catalogue->option[k];
    } else {
      PetscCall(PetscFree(catalogue->option[k].purpose));
      PetscCall(PetscFree(catalogue->option[k].choices));
    }
  }
  catalogue->num_options = kept;
  PetscFunctionReturn(0);
}

/* The options that main reads before any command does. */
static PetscErrorCode AddProgramOptions(void)
{
  static const char format[] = "  -%s <now %s : formerly %s>: %s (%s)\n";

  PetscFunctionBegin;
  PetscCall(AddSection("Program", 7));
  PetscCall(Note(PETSC_COMM_WORLD, format, "options_file", "", "",
                 "read options from this file, YAML if its name ends in .yaml or .yml; the command line wins", "main"));
  PetscCall(Note(PETSC_COMM_WORLD, format, "log_view", "", "",
                 "end with PETSc's profile of the run; :FILE writes it to a file, :FILE.xml:ascii_xml as XML", "main"));
  PetscCall(Note(PETSC_COMM_WORLD, format, "help", "FALSE", "FALSE",
                 "list the options, and stop; --help=man, json and words are other forms of the list", "main"));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCatalogueCreate(EqmCommand run, const EqmCommandLine *line, EqmCatalogue *catalogue)
{
  PetscErrorCode (*const help)(MPI_Comm, const char[], ...) = PetscHelpPrintf;
  PetscErrorCode (*const print)(FILE *, const char[], va_list) = PetscVFPrintf;
  EqmCommandLine asking = *line;
  EqmStatus status;
  PetscOptions empty;

  PetscFunctionBegin;
  memset(catalogue, 0, sizeof(*catalogue));
  asking.help = PETSC_TRUE;
  open_catalogue = catalogue;
  PetscCall(PetscOptionsCreate(&empty));
  PetscCall(PetscOptionsPush(empty));
  PetscCall(PetscOptionsSetValue(NULL, "-help", NULL));
  PetscHelpPrintf = Note;
  PetscVFPrintf = NotePrinted;
  PetscCall(run(&asking, &status));
  PetscCall(AddProgramOptions());
  PetscHelpPrintf = help;
  PetscVFPrintf = print;
  PetscCall(PetscOptionsPop());
  PetscCall(PetscOptionsDestroy(&empty));
  open_catalogue = NULL;
  PetscCall(DropRepeated(catalogue));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCatalogueDestroy(EqmCatalogue *catalogue)
{
  PetscFunctionBegin;
  for (int k = 0; k < catalogue->num_options; k++) {
    PetscCall(PetscFree(catalogue->option[k].purpose));
    PetscCall(PetscFree(catalogue->option[k].choices));
  }
  PetscCall(PetscFree(catalogue->option));
  PetscCall(PetscFree(catalogue->section));
  PetscCall(PetscFree(catalogue->notes));
  PetscFunctionReturn(0);
}

const char *EqmOptionValueName(const EqmOption *option)
{
  static const char *const names[EQM_NUM_OPTION_KINDS] = {"", "N", "X", "NAME", "NAME", "N,N,...", "X,X,..."};
  static const char *const of_files[] = {"file", "CSV", "JSON", ".h5", ".png", "format", "checkpoint", "the map of"};

  if (!strcmp(option->name, "-log_view")) return "[:FILE]";
  for (size_t k = 0; k < sizeof(of_files) / sizeof(of_files[0]) && option->kind == EQM_OPTION_TEXT; k++) {
    if (strstr(option->purpose, of_files[k])) return "FILE";
  }
  return names[option->kind];
}
