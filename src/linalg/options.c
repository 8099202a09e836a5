/* The options of linear solvers: which there are, and which of them a run inside another one takes over. */
#include "linalg/linalg.h"

const char *const EqmSolverKinds[] = {"auto",  "cholmod",   "multifrontal",  "substructure", "mumps", "multigrid",
                                      "petsc", "hierarchy", "EqmSolverKind", "EQM_SOLVER_",  NULL};
const char *const EqmPrecisions[] = {"auto", "single", "double", "EqmPrecision", "EQM_PRECISION_", NULL};

/* Smaller ones are done sooner on one rank. */
enum { SHARED_FRONT = 4000 };

PetscErrorCode EqmLinearGetSharedFront(MPI_Comm comm, PetscInt *unknowns)
{
  PetscFunctionBegin;
  *unknowns = SHARED_FRONT;
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-linear_shared_front", unknowns, NULL));
  if (*unknowns < 0)
    EqmFail(comm, EQM_ERR_USAGE, "-linear_shared_front %" PetscInt_FMT ": give a number of unknowns, 0 or more",
            *unknowns);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLinearHelpOptions(PetscOptionItems *PetscOptionsObject)
{
  PetscEnum kind = (PetscEnum)EQM_SOLVER_AUTO, precision = (PetscEnum)EQM_PRECISION_AUTO;
  PetscReal limit = 0.;
  PetscInt shared_front = SHARED_FRONT, gather = EQM_MOST_ON_ONE_RANK;

  PetscFunctionBegin;
  PetscCall(PetscOptionsEnum("-linear_solver",
                             "what solves with matrices; multifrontal and cholmod are for one rank, substructure and "
                             "mumps for several; hierarchy: of lm's matrices on surfaces, by multigrid on coarser "
                             "meshes; petsc: by -linear_ksp_type, -linear_pc_type, ...",
                             "EqmLinearCreate", EqmSolverKinds, kind, &kind, NULL));
  PetscCall(PetscOptionsInt("-linear_shared_front",
                            "dense fronts of more unknowns are shared between ranks, with substructure and ScaLAPACK",
                            "EqmLinearCreate", shared_front, &shared_front, NULL));
  PetscCall(PetscOptionsEnum("-linear_precision",
                             "how multifrontal and substructure keep factors that only serve to find steps: single "
                             "takes half the memory, and less time; auto: single from 10,000 unknowns on",
                             "EqmLinearCreate", EqmPrecisions, precision, &precision, NULL));
  PetscCall(PetscOptionsInt("-linear_gather",
                            "rows of a system that is not symmetric which one rank of several may factor alone",
                            "EqmLuCreate", gather, &gather, NULL));
  PetscCall(
      PetscOptionsReal("-memory_limit",
                       "at most so many GiB per rank for factors; beyond, -linear_solver auto iterates (0: most of "
                       "what is free)",
                       "EqmLinearCreate", limit, &limit, NULL));
  if (!(limit >= 0.))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-memory_limit %.6g: give a number of GiB, 0 for what is free",
            (double)limit);
  PetscFunctionReturn(0);
}

/* Does an option steer the solvers? */
static PetscErrorCode SteersSolvers(const char *name, PetscBool *steers)
{
  static const char *const names[] = {"-memory_limit"};

  PetscFunctionBegin;
  PetscCall(PetscStrbeginswith(name, "-multigrid_", steers));
  if (!*steers) PetscCall(PetscStrbeginswith(name, "-linear_", steers));
  for (size_t k = 0; k < sizeof(names) / sizeof(names[0]) && !*steers; k++)
    PetscCall(PetscStrcmp(name, names[k], steers));
  PetscFunctionReturn(0);
}

/* Copy the entries of the present database, or only those that steer solvers, to another one. */
static PetscErrorCode CopyOptions(PetscBool only_solvers, PetscOptions options)
{
  char *all, *word;
  PetscToken token;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  PetscCall(PetscTokenCreate(all, ' ', &token));
  PetscCall(PetscTokenFind(token, &word));
  while (word) {
    char *const name = word;
    PetscBool is_name, taken = PETSC_TRUE;
    PetscCall(PetscTokenFind(token, &word));
    PetscCall(PetscOptionsValidKey(name, &is_name)); /* else a value, or a part of one with spaces in it */
    if (is_name && only_solvers) PetscCall(SteersSolvers(name, &taken));
    if (!is_name || !taken) continue;
    PetscCall(PetscOptionsValidKey(word, &is_name));
    PetscCall(PetscOptionsSetValue(options, name, word && !is_name ? word : NULL));
  }
  PetscCall(PetscTokenDestroy(&token));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLinearPassOptions(PetscOptions options)
{
  PetscFunctionBegin;
  PetscCall(CopyOptions(PETSC_TRUE, options));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmOptionsPushDefaults(const char *const defaults[][2], PetscInt count, PetscOptions *options)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsCreate(options));
  PetscCall(CopyOptions(PETSC_FALSE, *options));
  for (PetscInt k = 0; k < count; k++) {
    PetscBool given;
    PetscCall(PetscOptionsHasName(NULL, NULL, defaults[k][0], &given));
    if (!given) PetscCall(PetscOptionsSetValue(*options, defaults[k][0], defaults[k][1]));
  }
  PetscCall(PetscOptionsPush(*options));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmOptionsPopDefaults(PetscOptions *options)
{
  char *all, *word;
  PetscToken token;

  PetscFunctionBegin;
  PetscCall(PetscOptionsPop());
  PetscCall(PetscOptionsGetAll(NULL, &all));
  PetscCall(PetscTokenCreate(all, ' ', &token));
  PetscCall(PetscTokenFind(token, &word));
  while (word) {
    PetscBool used = PETSC_FALSE;
    PetscCall(PetscOptionsValidKey(word, &used));
    if (used) PetscCall(PetscOptionsUsed(*options, word + 1, &used));
    if (used) PetscCall(PetscOptionsHasName(NULL, NULL, word, &used)); /* that is how PETSc is told */
    PetscCall(PetscTokenFind(token, &word));
  }
  PetscCall(PetscTokenDestroy(&token));
  PetscCall(PetscFree(all));
  PetscCall(PetscOptionsDestroy(options));
  PetscFunctionReturn(0);
}
