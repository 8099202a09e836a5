/* COMMAND --help: the options in sections, as plain text. */
#include "catalogue.h"
#include <stdio.h>
#include <string.h>

enum { MARGIN = 96, INDENT = 6 };

/* Print words with line breaks, every line behind INDENT blanks. */
static void PrintWrapped(const char *text)
{
  int column = 0;

  while (*text) {
    const int word = (int)strcspn(text, " ");

    if (column == 0 || column + 1 + word > MARGIN) {
      printf("%s%*s", column ? "\n" : "", INDENT, "");
      column = INDENT;
    } else {
      printf(" ");
      column++;
    }
    printf("%.*s", word, text);
    column += word;
    text += word + strspn(text + word, " ");
  }
  printf("\n");
}

int EqmOptionGroup(const EqmOption *option, const char **purpose)
{
  const int word = (int)strcspn(option->purpose, ": ");

  if (purpose) *purpose = option->purpose;
  if (word == 0 || option->purpose[word] != ':' || option->purpose[word + 1] != ' ') return 0;
  if (strncmp(option->name + 1, option->purpose, (size_t)word) || option->name[1 + word] != '_') return 0;
  if (purpose) *purpose = option->purpose + word + 2;
  return word;
}

static void PrintOption(const EqmOption *option)
{
  const char *const value = EqmOptionValueName(option), *purpose;

  (void)EqmOptionGroup(option, &purpose);
  printf("  %s%s%s", option->name, value[0] ? " " : "", value);
  if (option->initial[0]) printf(" [%s]", option->initial);
  printf("\n");
  PrintWrapped(purpose);
  if (option->choices) PrintWrapped(option->choices);
}

/* Options of one method, which begin with its name, come under a heading of their own, behind the others. */
static void PrintSection(const EqmCatalogue *catalogue, int section)
{
  const EqmOption *const end = catalogue->option + catalogue->num_options, *title = NULL;

  for (const EqmOption *o = catalogue->option; o < end; o++) {
    if (o->section != section || EqmOptionGroup(o, NULL)) continue;
    if (!title) printf("\n%s:\n", catalogue->section[section]);
    title = o;
    PrintOption(o);
  }
  for (const EqmOption *o = catalogue->option; o < end; o++) {
    const int word = o->section == section ? EqmOptionGroup(o, NULL) : 0;
    const EqmOption *earlier = catalogue->option;

    if (!word) continue;
    while (earlier < o && (earlier->section != section || EqmOptionGroup(earlier, NULL) != word ||
                           strncmp(earlier->name, o->name, (size_t)word + 1)))
      earlier++;
    if (earlier < o) continue; /* printed with the first of its group */
    printf("\n%s, %.*s:\n", catalogue->section[section], word, o->purpose);
    for (const EqmOption *member = o; member < end; member++) {
      if (member->section == section && EqmOptionGroup(member, NULL) == word &&
          !strncmp(member->name, o->name, (size_t)word + 1))
        PrintOption(member);
    }
  }
}

/* Does the line continue the paragraph before it? */
static PetscBool GoesOn(const char *line)
{
  return (PetscBool)(*line && !strchr(" \n", *line) && strncmp(line, "usage:", 6));
}

/* The command's notes beside its options. A paragraph that begins with too long a line is wrapped again. */
void EqmHelpNotes(const EqmCatalogue *catalogue)
{
  const char *text = catalogue->notes ? catalogue->notes : "";

  while (*text) {
    int length = (int)strcspn(text, "\n"), column = 0;
    const PetscBool is_long = (PetscBool)(length > MARGIN + 3);

    while (is_long && text[length] && GoesOn(text + length + 1)) length += 1 + (int)strcspn(text + length + 1, "\n");
    if (!is_long) printf("%.*s", length, text);
    for (int k = 0, word; is_long && k < length; k += word + 1) {
      word = (int)strcspn(text + k, " \n");
      if (column && column + 1 + word > MARGIN) column = printf("\n") - 1;
      column += printf("%s%.*s", column ? " " : "", word, text + k);
    }
    printf("\n");
    text += length;
    if (*text) text++;
  }
}

void EqmHelpText(const EqmCatalogue *catalogue)
{
  EqmHelpNotes(catalogue);
  for (int s = 0; s < catalogue->num_sections; s++) PrintSection(catalogue, s);
  fflush(stdout);
}
