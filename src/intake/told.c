/* What a user is told about the mesh before a run. */
#include "intake/intake_private.h"
#include <string.h>

/* Print the lines of a text that begin with `head`. Collective. */
PetscErrorCode EqmPrintLinesWith(MPI_Comm comm, const char *part, const char *head, const char *text)
{
  PetscFunctionBegin;
  for (const char *line = text; line && *line;) {
    const char *const end = strchr(line, '\n');
    const int width = (int)(end ? end - line : (ptrdiff_t)strlen(line));

    if (!strncmp(line, head, strlen(head))) PetscCall(PetscPrintf(comm, "%s%s%.*s\n", EQM_OF_PART(part), width, line));
    line = end ? end + 1 : NULL;
  }
  PetscFunctionReturn(0);
}

/* The changes of a repair, in one line; `part` as in EqmIntakeOptions. Collective. */
PetscErrorCode EqmPrintRepair(MPI_Comm comm, const char *part, const EqmRepair *repair)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(comm,
                        "%s%srepair: %" PetscInt64_FMT " twins and %" PetscInt64_FMT
                        " cells with a repeated vertex removed, %" PetscInt64_FMT " cells turned, %" PetscInt64_FMT
                        " cells split with %" PetscInt64_FMT " new vertices\n",
                        EQM_OF_PART(part), repair->duplicate_cells_removed, repair->degenerate_cells_removed,
                        repair->cells_flipped, repair->cells_split, repair->vertices_added));
  PetscFunctionReturn(0);
}

/* The steps of a preparation, a line each. Collective. */
PetscErrorCode EqmPrintPreparation(MPI_Comm comm, const char *part, const EqmPreparation *preparation)
{
  PetscFunctionBegin;
  for (PetscInt s = 0; s < preparation->num_steps; s++) {
    const EqmPreparedStep *const step = &preparation->step[s];

    if (!strcmp(step->step, "repair")) continue; /* has a line of its own, also where it changed nothing */
    PetscCall(PetscPrintf(comm, "%s%sprepared: %s: %s\n", EQM_OF_PART(part), step->step, step->what));
  }
  PetscFunctionReturn(0);
}
