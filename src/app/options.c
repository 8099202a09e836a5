/* Options that nobody asked for are mistakes, and a mistake is said before the work starts, not after. */
#include "app.h"
#include <string.h>

/* PETSc's own options are read when its objects are made, later than ours: these prefixes are let through. */
static const char *const petsc_prefixes[] = {"log_",       "malloc",   "info",        "options_",     "ksp_",
                                             "pc_",        "mat_",     "vec_",        "sf_",          "mg_",
                                             "error",      "on_error", "fp_",         "start",        "stop_for",
                                             "debug",      "no_",      "check",       "get_",         "viewer_",
                                             "nox",        "display",  "hypre_",      "gamg_",        "coarse_",
                                             "multigrid_", "unfold_",  "saws",        "skip_petscrc", "shared_tmp",
                                             "threads",    "help",     "hessian_eps_"};

static PetscBool IsPetscs(const char *name)
{
  for (size_t k = 0; k < sizeof(petsc_prefixes) / sizeof(petsc_prefixes[0]); k++) {
    if (!strncmp(name, petsc_prefixes[k], strlen(petsc_prefixes[k])) && strcmp(name, "start")) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

PetscErrorCode EqmRejectUnknownOptions(const EqmCommandLine *line)
{
  PetscInt num_left;
  char **names, **values, unknown[EQM_MESSAGE_MAX] = "";
  PetscInt count = 0;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &num_left, &names, &values));
  for (PetscInt k = 0; k < num_left; k++) {
    if (IsPetscs(names[k])) continue;
    PetscCall(PetscStrlcat(unknown, count++ ? ", -" : "-", sizeof(unknown)));
    PetscCall(PetscStrlcat(unknown, names[k], sizeof(unknown)));
  }
  PetscCall(PetscOptionsLeftRestore(NULL, &num_left, &names, &values));
  if (count) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "unknown option%s %s; equimap %s --help lists the options of this command",
            count > 1 ? "s" : "", unknown, line->command);
  }
  PetscFunctionReturn(0);
}
