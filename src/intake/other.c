/* The same mesh prepared in other ways: piece by piece; without splitting cells. */
#include "intake/intake_private.h"
#include "mesh/soup_private.h"
#include <string.h>

PetscErrorCode EqmIntakeReadGiven(MPI_Comm comm, const EqmIntakeOptions *options, EqmLedger ledger, EqmIntake *intake)
{
  EqmSoup plain;

  PetscFunctionBegin;
  PetscCall(EqmIntakeBegin(comm, options, ledger, intake, &plain));
  if (plain != intake->given) PetscCall(EqmSoupDestroy(&plain));
  PetscFunctionReturn(0);
}

/* Prepare the mesh that was read anew, and diagnose what comes out. Collective. */
static PetscErrorCode PrepareAnew(const char *target, const EqmPrepareOptions *prepare, const EqmIntake *intake,
                                  EqmIntake *other, PetscBool *can, char *text, size_t length)
{
  PetscBool fatal;

  PetscFunctionBegin;
  *other = (EqmIntake){.given = intake->given, .mapped = intake->given};
  PetscCall(EqmIntakePrepare(prepare, other));
  PetscCall(EqmIntakeDiagnose(target, PETSC_FALSE, other, &fatal, text, length));
  *can = (PetscBool)!fatal;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIntakePiece(const EqmIntakeOptions *options, const EqmIntake *intake, EqmIntake *piece,
                              PetscInt *num_pieces, PetscBool *can, char *reason, size_t length)
{
  EqmPrepareOptions prepare = EqmIntakePrepareOptions(options);
  char *end;

  PetscFunctionBegin;
  prepare.each_piece = PETSC_TRUE;
  PetscCall(PrepareAnew(options->target, &prepare, intake, piece, can, reason, length));
  *num_pieces = 1;
  for (PetscInt s = 0; s < piece->preparation.num_steps; s++) {
    if (!strcmp(piece->preparation.step[s].step, "largest"))
      *num_pieces = (PetscInt)piece->preparation.step[s].count + 1;
  }
  end = strchr(reason, '\n');
  if (end) *end = '\0';
  if (!strncmp(reason, "error: ", 7)) memmove(reason, reason + 7, strlen(reason + 7) + 1);
  PetscFunctionReturn(0);
}

/* EqmIntakeWithoutSplits - the same mesh, prepared in the same way but for the cells that a repair has split.

   Collective. whole - shares `given` with `intake`; free its preparation with EqmPreparationReset. can - it can be
   mapped as it is: splits may serve the method alone. */
PetscErrorCode EqmIntakeWithoutSplits(const EqmIntakeOptions *options, const EqmIntake *intake, EqmIntake *whole,
                                      PetscBool *can)
{
  char text[4 * EQM_MESSAGE_MAX];
  EqmPrepareOptions prepare = EqmIntakePrepareOptions(options);

  PetscFunctionBegin;
  prepare.keeps_cells = PETSC_TRUE;
  PetscCall(PrepareAnew(options->target, &prepare, intake, whole, can, text, sizeof(text)));
  PetscFunctionReturn(0);
}
