/* The options of linear solvers: which there are, and which of them a run inside another one takes over. */
#include "linalg/linalg.h"

PetscErrorCode EqmLinearAskOptions(PetscOptionItems *PetscOptionsObject)
{
  PetscEnum kind = (PetscEnum)EQM_SOLVER_AUTO;
  PetscReal limit = 0.;

  PetscFunctionBegin;
  PetscCall(PetscOptionsEnum("-linear_solver",
                             "what solves with matrices; substructure and mumps are for several ranks, cholmod for one",
                             "EqmLinearCreate", EqmSolverKinds, kind, &kind, NULL));
  PetscCall(
      PetscOptionsReal("-memory_limit",
                       "at most so many GiB per rank for factors; beyond, -linear_solver auto iterates (0: most of "
                       "what is free)",
                       "EqmLinearCreate", limit, &limit, NULL));
  if (!(limit >= 0.))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-memory_limit %g: give a number of GiB, 0 for what is free",
            (double)limit);
  PetscFunctionReturn(0);
}

/* Does an option steer the solvers? */
static PetscErrorCode SteersSolvers(const char *name, PetscBool *steers)
{
  static const char *const names[] = {"-linear_solver", "-memory_limit"};

  PetscFunctionBegin;
  PetscCall(PetscStrbeginswith(name, "-multigrid_", steers));
  for (size_t k = 0; k < sizeof(names) / sizeof(names[0]) && !*steers; k++)
    PetscCall(PetscStrcmp(name, names[k], steers));
  PetscFunctionReturn(0);
}

/* For a run inside another one that has an options database of its own: what the present database says of solvers goes
   to `options`. Not collective. */
PetscErrorCode EqmLinearPassOptions(PetscOptions options)
{
  char *all, *word;
  PetscToken token;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  PetscCall(PetscTokenCreate(all, ' ', &token));
  PetscCall(PetscTokenFind(token, &word));
  while (word) {
    char *const name = word;
    PetscBool is_name, taken;
    PetscCall(PetscTokenFind(token, &word));
    PetscCall(SteersSolvers(name, &taken));
    if (!taken) continue; /* nor is a value of another option one of these names */
    PetscCall(PetscOptionsValidKey(word, &is_name));
    PetscCall(PetscOptionsSetValue(options, name, word && !is_name ? word : NULL));
  }
  PetscCall(PetscTokenDestroy(&token));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(0);
}
