/* The command line: split into the program's words and PETSc's options. */
#include "commandline.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* Options without a value: what follows them on the command line is an argument, not their value. */
static const char *const flags[] = {"-quiet",    "-help",         "-repair", "-dry_run",
                                    "-log_view", "-options_left", "-unique", "-version"};

/* ... except these words, which are taken for values. */
static const char *const truths[] = {"0", "1", "true", "false", "yes", "no", "on", "off"};
#define IS_ONE_OF(word, list) IsOneOf(word, list, sizeof(list) / sizeof((list)[0]))

static PetscBool IsOneOf(const char *word, const char *const list[], size_t length)
{
  for (size_t k = 0; k < length; k++) {
    if (!strcmp(word, list[k])) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* -name or --name; a negative number is none. */
static PetscBool IsOption(const char *word)
{
  const char *const name = word + (word[0] == '-' && word[1] == '-' ? 2 : 1);

  return (PetscBool)(word[0] == '-' && name[0] != '\0' && !strchr("0123456789.-", name[0]));
}

/* Is `word` the value of the option before it? */
static PetscBool IsValue(const char *option, const char *word)
{
  if (!option || !IsOption(option) || !word || IsOption(word)) return PETSC_FALSE;
  if (!strcmp(option, "-log_view")) return (PetscBool)(word[0] == ':' || !strncmp(word, "ascii", 5));
  return (PetscBool)(!IS_ONE_OF(option, flags) || IS_ONE_OF(word, truths));
}

/* Words are copied to a list, options in PETSc's form, a value behind '=' as a word of its own. `joined[k]`: word k
   came so. */
static PetscErrorCode Normalise(int argc, char **argv, int *num_words, char ***words, PetscBool **joined)
{
  int n = 0;

  *words = (char **)calloc(2 * (size_t)argc + 2, sizeof(char *));
  *joined = (PetscBool *)calloc(2 * (size_t)argc + 2, sizeof(PetscBool));
  if (!*words || !*joined) return PETSC_ERR_MEM;
  for (int k = 0; k < argc; k++) {
    const PetscBool is_option = (PetscBool)(k > 0 && IsOption(argv[k]));
    char *const word = strdup(argv[k] + (is_option && argv[k][1] == '-' ? 1 : 0));
    char *const equals = word && is_option ? strchr(word, '=') : NULL;

    if (!word) return PETSC_ERR_MEM;
    if (equals) *equals = '\0';
    for (char *c = word + 1; is_option && *c; c++) {
      if (*c == '-') *c = '_';
    }
    (*words)[n++] = word;
    if (!equals) continue;
    (*joined)[n] = PETSC_TRUE;
    (*words)[n] = strdup(equals + 1);
    if (!(*words)[n++]) return PETSC_ERR_MEM;
  }
  *num_words = n;
  return 0;
}

/* One word that is neither option nor value. */
static void TakeArgument(char *word, EqmCommandLine *line)
{
  if (!line->command) {
    line->command = word;
  } else if (line->num_arguments < (int)(sizeof(line->argument) / sizeof(line->argument[0]))) {
    line->argument[line->num_arguments++] = word;
  }
}

/* `equimap help COMMAND` is `equimap COMMAND --help`. */
static void TakeHelpCommand(EqmCommandLine *line)
{
  if (!line->command || strcmp(line->command, "help")) return;
  line->help = PETSC_TRUE;
  line->command = line->num_arguments ? line->argument[0] : NULL;
  line->num_arguments = 0;
}

PetscErrorCode EqmCommandLineParse(int argc, char **argv, EqmCommandLine *line, int *num_options, char ***options)
{
  int num_words, kept = 1;
  char **words, **list;
  PetscBool *joined;

  if (Normalise(argc, argv, &num_words, &words, &joined)) return PETSC_ERR_MEM;
  list = (char **)calloc((size_t)num_words + 1, sizeof(char *));
  if (!list) return PETSC_ERR_MEM;
  list[0] = words[0];
  for (int k = 1; k < num_words; k++) {
    char *const next = k + 1 < num_words ? words[k + 1] : NULL;
    const PetscBool has_value = (PetscBool)(next && (joined[k + 1] || IsValue(words[k], next)));

    if (!strcmp(words[k], "-help") || !strcmp(words[k], "-h")) {
      line->help = PETSC_TRUE;
      if (next && joined[k + 1]) line->help_format = words[++k];
    } else if (!strcmp(words[k], "-version")) {
      line->version = PETSC_TRUE;
    } else if (!strcmp(words[k], "-options_file") && has_value &&
               line->num_options_files < (int)(sizeof(line->options_file) / sizeof(line->options_file[0]))) {
      line->options_file[line->num_options_files++] = words[++k];
    } else if (!strcmp(words[k], "-history")) {
      line->history = has_value ? words[++k] : "";
    } else if (IsOption(words[k])) {
      list[kept++] = words[k];
      if (has_value) list[kept++] = words[++k];
    } else {
      TakeArgument(words[k], line);
    }
  }
  TakeHelpCommand(line);
  free(joined);
  line->words = words;
  *num_options = kept;
  *options = list;
  return 0;
}

void EqmCommandLineFree(EqmCommandLine *line, char **options)
{
  for (char **word = line->words; word && *word; word++) free(*word);
  free(line->words);
  free(options);
}
