/* COMMAND --help=man, words, json: the options for man, for the shell's completion, for programs. */
#include "catalogue.h"
#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Text in roff: a backslash, a dash, and a dot or a quote at the beginning of a line have a special meaning there. */
static void PrintRoff(const char *text)
{
  for (const char *c = text; *c; c++) {
    const PetscBool begins_line = (PetscBool)(c == text || c[-1] == '\n');

    if (begins_line && (*c == '.' || *c == '\'')) printf("\\&");
    if (*c == '\\') {
      printf("\\e");
    } else if (*c == '-') {
      printf("\\-");
    } else {
      putchar(*c);
    }
  }
}

static void PrintManOption(const EqmOption *option)
{
  const char *const value = EqmOptionValueName(option);

  printf(".TP\n.B ");
  PrintRoff(option->name);
  if (value[0]) printf(" \\fI%s\\fR", value);
  if (option->initial[0]) {
    printf(" \\fR[");
    PrintRoff(option->initial);
    printf("]");
  }
  printf("\n");
  PrintRoff(option->purpose);
  if (option->choices) {
    printf(" (one of ");
    PrintRoff(option->choices);
    printf(")");
  }
  printf("\n");
}

void EqmHelpMan(const EqmCatalogue *catalogue, const char *command, const char *usage, const char *purpose)
{
  printf(".TH EQUIMAP\\-%s 1 \"\" \"equimap %s\" \"equimap\"\n.SH NAME\nequimap\\-%s \\- ", command, EqmVersion(),
         command);
  PrintRoff(purpose);
  printf("\n.SH SYNOPSIS\n.B equimap %s\n", command);
  PrintRoff(usage);
  printf("\n[\\-options]\n");
  if (catalogue->notes) {
    printf(".SH DESCRIPTION\n.nf\n");
    PrintRoff(catalogue->notes + strspn(catalogue->notes, "\n"));
    printf(".fi\n");
  }
  printf(".SH OPTIONS\nThe default stands in brackets. \\-\\-name=value is \\-name value.\n");
  for (int s = 0; s < catalogue->num_sections; s++) {
    printf(".SS ");
    PrintRoff(catalogue->section[s]);
    printf("\n");
    for (int k = 0; k < catalogue->num_options; k++) {
      if (catalogue->option[k].section == s) PrintManOption(&catalogue->option[k]);
    }
  }
  printf(".SH SEE ALSO\n.BR equimap (1)\n");
}

/* The names that a purpose like "the first map: harmonic, tutte" ends with, if it is of that form; else "". */
static const char *NamesIn(const EqmOption *option)
{
  const char *const colon = strchr(option->purpose, ':'), *const names = colon ? colon + 1 : "";

  if (option->kind != EQM_OPTION_TEXT || !strchr(names, ',')) return "";
  for (const char *c = names + strspn(names, " "); *c; c++) {
    if (*c == ' ' && c[-1] != ',') return "";
  }
  return names;
}

/* One line per option, "COMMAND -name KIND CHOICES": what completion needs. */
void EqmHelpWords(const EqmCatalogue *catalogue, const char *command)
{
  for (int k = 0; k < catalogue->num_options; k++) {
    const EqmOption *const o = &catalogue->option[k];
    const char *const value = EqmOptionValueName(o);

    printf("%s %s %s", command, o->name, value[0] ? value : "FLAG");
    if (o->choices) printf(" %s", o->choices);
    for (const char *c = NamesIn(o); *c; c++) {
      if (*c != ',') putchar(*c);
    }
    printf("\n");
  }
}

static cJSON *OptionJson(const EqmOption *option)
{
  static const char *const kinds[EQM_NUM_OPTION_KINDS] = {"flag",   "integer",  "real", "text",
                                                          "choice", "integers", "reals"};
  cJSON *const object = cJSON_CreateObject();

  cJSON_AddStringToObject(object, "name", option->name + 1);
  cJSON_AddStringToObject(object, "kind", kinds[option->kind]);
  cJSON_AddStringToObject(object, "default", option->initial);
  cJSON_AddStringToObject(object, "purpose", option->purpose);
  if (option->choices) {
    cJSON *const choices = cJSON_AddArrayToObject(object, "choices");
    for (const char *word = option->choices; *word; word += strspn(word, " ")) {
      char text[64];
      const int length = (int)strcspn(word, " ");
      (void)snprintf(text, sizeof(text), "%.*s", length, word);
      cJSON_AddItemToArray(choices, cJSON_CreateString(text));
      word += length;
    }
  }
  return object;
}

PetscErrorCode EqmHelpJson(const EqmCatalogue *catalogue, const char *command, const char *usage, const char *purpose)
{
  cJSON *const root = cJSON_CreateObject(), *sections;
  char *text;

  PetscFunctionBegin;
  cJSON_AddStringToObject(root, "equimap", EqmVersion());
  cJSON_AddStringToObject(root, "command", command);
  cJSON_AddStringToObject(root, "usage", usage);
  cJSON_AddStringToObject(root, "purpose", purpose);
  cJSON_AddStringToObject(root, "notes", catalogue->notes ? catalogue->notes : "");
  sections = cJSON_AddArrayToObject(root, "sections");
  for (int s = 0; s < catalogue->num_sections; s++) {
    cJSON *const section = cJSON_CreateObject();
    cJSON *options;

    cJSON_AddItemToArray(sections, section);
    cJSON_AddStringToObject(section, "title", catalogue->section[s]);
    options = cJSON_AddArrayToObject(section, "options");
    for (int k = 0; k < catalogue->num_options; k++) {
      if (catalogue->option[k].section == s) cJSON_AddItemToArray(options, OptionJson(&catalogue->option[k]));
    }
  }
  text = cJSON_Print(root);
  cJSON_Delete(root);
  PetscCheck(text, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for the list of options");
  printf("%s\n", text);
  free(text);
  PetscFunctionReturn(0);
}
