/* The values of options, checked before the work: errors name the option. */
#include "base/nearest.h"
#include "base/quiet.h"
#include "catalogue.h"
#include <string.h>
#include <strings.h>

enum { LONGEST = 4096 };

/* Can PETSc parse the value? Its own message, which does not name the option, is not shown. */
static PetscErrorCode IsUnderstood(const char *value, EqmOptionKind kind, PetscBool *fits)
{
  char message[EQM_MESSAGE_MAX];
  PetscErrorCode error;
  PetscInt whole;
  PetscReal real = 0.;
  PetscBool truth;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  if (kind == EQM_OPTION_INT || kind == EQM_OPTION_INTS) {
    error = PetscOptionsStringToInt(value, &whole);
  } else if (kind == EQM_OPTION_FLAG) {
    error = PetscOptionsStringToBool(value, &truth);
  } else {
    error = PetscOptionsStringToReal(value, &real);
  }
  PetscCall(PetscPopErrorHandler());
  *fits = (PetscBool)(!error && PetscIsNormalReal(PetscAbsReal(real) + 1.));
  PetscFunctionReturn(0);
}

/* Numbers with commas; of whole ones also PETSc's ranges, 3-7. */
static PetscErrorCode CheckList(const EqmOption *option, const char *value, PetscBool *fits)
{
  char **words;
  int num;

  PetscFunctionBegin;
  PetscCall(PetscStrToArray(value, ',', &num, &words));
  *fits = (PetscBool)(num > 0);
  for (int k = 0; k < num && *fits; k++) {
    char *const dash = option->kind == EQM_OPTION_INTS ? strpbrk(words[k] + (words[k][0] == '-'), "-:") : NULL;
    if (dash) *dash = '\0';
    PetscCall(IsUnderstood(words[k], option->kind, fits));
  }
  PetscCall(PetscStrToArrayDestroy(num, words));
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckChoice(const EqmOption *option, const char *value)
{
  char **words, hint[128];
  int num;
  PetscBool fits = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscStrToArray(option->choices, ' ', &num, &words));
  for (int k = 0; k < num; k++) fits = (PetscBool)(fits || !strcasecmp(words[k], value));
  PetscCall(EqmDidYouMean(value, option->choices, hint, sizeof(hint)));
  PetscCall(PetscStrToArrayDestroy(num, words));
  if (!fits)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "%s %s: choose one of %s%s", option->name, value, option->choices, hint);
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckValue(const EqmOption *option, const char *value)
{
  static const char *const wanted[EQM_NUM_OPTION_KINDS] = {
      [EQM_OPTION_FLAG] = "give true or false, or no value (file names come before the options)",
      [EQM_OPTION_INT] = "give a whole number",
      [EQM_OPTION_REAL] = "give a finite number",
      [EQM_OPTION_INTS] = "give whole numbers with commas between",
      [EQM_OPTION_REALS] = "give finite numbers with commas between"};
  PetscBool fits = PETSC_TRUE;

  PetscFunctionBegin;
  if (!value[0]) {
    if (option->kind == EQM_OPTION_FLAG) PetscFunctionReturn(0);
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "%s needs a value, %s %s: %s", option->name, option->name,
            EqmOptionValueName(option), option->purpose);
  }
  if (option->kind == EQM_OPTION_CHOICE) {
    PetscCall(CheckChoice(option, value));
  } else if (option->kind == EQM_OPTION_INTS || option->kind == EQM_OPTION_REALS) {
    PetscCall(CheckList(option, value, &fits));
  } else if (option->kind != EQM_OPTION_TEXT) {
    PetscCall(IsUnderstood(value, option->kind, &fits));
  }
  if (!fits) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "%s %s: %s", option->name, value, wanted[option->kind]);
  PetscFunctionReturn(0);
}

/* An output name must not be that of a folder. Rank 0 checks. */
static PetscErrorCode CheckFolder(const EqmOption *option, const char *value)
{
  static const char *const written[] = {"-o",       "-uv",        "-summary",
                                        "-history", "-histogram", "-ratio_histogram",
                                        "-cells",   "-vertices",  "-checkpoint"};
  PetscBool is_written = PETSC_FALSE, is_folder = PETSC_FALSE;
  PetscMPIInt rank;
  char **names, message[EQM_MESSAGE_MAX] = "";
  int num;

  PetscFunctionBegin;
  for (size_t k = 0; k < sizeof(written) / sizeof(written[0]); k++)
    is_written = (PetscBool)(is_written || !strcmp(option->name, written[k]));
  if (!is_written) PetscFunctionReturn(0);
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(PetscStrToArray(value, ',', &num, &names));
  for (int k = 0; k < num && rank == 0 && !is_folder; k++) {
    PetscCall(PetscTestDirectory(names[k], 'r', &is_folder));
    if (is_folder)
      PetscCall(
          PetscSNPrintf(message, sizeof(message), "%s %s is a folder: name a file in it", option->name, names[k]));
  }
  PetscCall(PetscStrToArrayDestroy(num, names));
  PetscCall(EqmAgree(PETSC_COMM_WORLD, is_folder ? EQM_ERR_USAGE : 0, message));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCheckOptionValues(const EqmCommandLine *line)
{
  PetscFunctionBegin;
  for (int k = 0; k < line->catalogue->num_options; k++) {
    const EqmOption *const option = &line->catalogue->option[k];
    char value[LONGEST] = "";
    PetscBool given;

    if (!strcmp(option->name, "-log_view") || !strcmp(option->name, "-help")) continue; /* checked by PETSc */
    PetscCall(PetscOptionsGetString(NULL, NULL, option->name, value, sizeof(value), &given));
    if (!given) continue;
    PetscCall(CheckValue(option, value));
    PetscCall(CheckFolder(option, value));
  }
  PetscFunctionReturn(0);
}
