/* Files of options, in PETSc's form and as YAML: they are inserted or refused, and so are the values that they give. */
#define _GNU_SOURCE
#include "fuzz.h"
#include <unistd.h>
#include <equimap/base.h>
#include "app/catalogue.h"
#include "app/optionsfile.h"

#define OPTION(the_kind, the_name, the_choices)                                                                        \
  {                                                                                                                    \
    .kind = (the_kind), .name = the_name, .choices = (char[]){the_choices}, .purpose = (char[])                        \
    {                                                                                                                  \
      "to try"                                                                                                         \
    }                                                                                                                  \
  }

/* One of every kind. */
static EqmOption option[] = {OPTION(EQM_OPTION_FLAG, "-quiet", ""),
                             OPTION(EQM_OPTION_INT, "-max_it", ""),
                             OPTION(EQM_OPTION_REAL, "-balance", ""),
                             OPTION(EQM_OPTION_TEXT, "-o", ""),
                             OPTION(EQM_OPTION_CHOICE, "-method", "lm newton lbfgs ncg"),
                             OPTION(EQM_OPTION_INTS, "-fix", ""),
                             OPTION(EQM_OPTION_REALS, "-fix_points", "")};

static void Try(const char *file)
{
  static struct _EqmCatalogue catalogue = {.num_options = sizeof(option) / sizeof(option[0]), .option = option};
  const EqmCommandLine line = {.catalogue = &catalogue};
  PetscOptions options;
  PetscErrorCode code;

  CLAIM(!PetscOptionsCreate(&options) && !PetscOptionsPush(options));
  code = EqmOptionsFileInsert(options, file);
  CLAIM(!code || code == EQM_ERR_USAGE);
  if (!code) {
    code = EqmCheckOptionValues(&line);
    CLAIM(!code || code == EQM_ERR_USAGE);
  }
  CLAIM(!PetscOptionsPop() && !PetscOptionsDestroy(&options));
}

/* PETSc's reader leaves files open that it refuses: whatever has been opened behind the file in memory is closed. */
void EqmFuzzOptions(const char *name, const uint8_t *bytes, size_t length)
{
  const char *const plain = EqmFuzzFile("options", bytes, length);
  const int next = dup(STDIN_FILENO);

  CLAIM(next >= 0);
  Try(plain);
  Try(EqmFuzzFile("options.yaml", bytes, length));
  CLAIM(!close_range((unsigned int)next, ~0u, 0));
}
