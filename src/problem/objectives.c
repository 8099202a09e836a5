/* Objectives by name. */
#include "problem/objective.h"

enum { MAX_OBJECTIVES = 32 };
static const EqmObjective *objectives[MAX_OBJECTIVES] = {&EqmObjectiveAuthalic, &EqmObjectiveConformal,
                                                         &EqmObjectiveSymmetricDirichlet};

PetscErrorCode EqmObjectiveRegister(const EqmObjective *objective)
{
  PetscInt k = 0;

  PetscFunctionBegin;
  while (k < MAX_OBJECTIVES && objectives[k]) k++;
  PetscCheck(k < MAX_OBJECTIVES, PETSC_COMM_SELF, PETSC_ERR_SUP, "no room for more than %d objectives", MAX_OBJECTIVES);
  objectives[k] = objective;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmObjectiveFind(MPI_Comm comm, const char *name, const EqmObjective **objective)
{
  char names[EQM_MESSAGE_MAX] = "";

  PetscFunctionBegin;
  for (PetscInt k = 0; k < MAX_OBJECTIVES && objectives[k]; k++) {
    PetscBool same;
    PetscCall(PetscStrcmp(objectives[k]->name, name, &same));
    *objective = objectives[k];
    if (same) PetscFunctionReturn(0);
    PetscCall(PetscStrlcat(names, k ? ", " : "", sizeof(names)));
    PetscCall(PetscStrlcat(names, objectives[k]->name, sizeof(names)));
  }
  EqmFail(comm, EQM_ERR_USAGE, "-objective %s: there is no such objective; choose one of %s", name, names);
}
