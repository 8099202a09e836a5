/* The same mesh prepared in other ways: piece by piece; without splitting cells. */
#include "intake/intake_private.h"
#include "mesh/soup_private.h"
#include <string.h>

PetscErrorCode EqmIntakeReadGiven(MPI_Comm comm, const EqmIntakeOptions *options, EqmLedger ledger, EqmIntake *intake)
{
  EqmSoup plain;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(intake, sizeof(*intake)));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_READ));
  PetscCall(EqmIntakeReadSoup(comm, options, intake, &plain));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_READ));
  intake->mapped = intake->given;
  if (!options->quiet && plain->note[0]) PetscCall(PetscPrintf(comm, "note: %s: %s\n", plain->file, plain->note));
  if (plain != intake->given) PetscCall(EqmSoupDestroy(&plain));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIntakePiece(const EqmIntakeOptions *options, const EqmIntake *intake, EqmIntake *piece,
                              PetscInt *num_pieces, PetscBool *can, char *reason, size_t length)
{
  EqmPrepareOptions prepare = options->prepare;
  PetscBool fatal;
  char *end;

  PetscFunctionBegin;
  *piece = (EqmIntake){.given = intake->given, .mapped = intake->given};
  prepare.repair = options->repair;
  prepare.target = options->target;
  prepare.each_piece = PETSC_TRUE;
  PetscCall(EqmIntakePrepare(&prepare, piece));
  *num_pieces = 1;
  for (PetscInt s = 0; s < piece->preparation.num_steps; s++) {
    if (!strcmp(piece->preparation.step[s].step, "largest"))
      *num_pieces = (PetscInt)piece->preparation.step[s].count + 1;
  }
  PetscCall(EqmIntakeDiagnose(options->target, PETSC_FALSE, piece, &fatal, reason, length));
  *can = (PetscBool)!fatal;
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
  EqmPrepareOptions prepare = options->prepare;
  PetscBool fatal;

  PetscFunctionBegin;
  *whole = (EqmIntake){.given = intake->given, .mapped = intake->given};
  prepare.repair = options->repair;
  prepare.target = options->target;
  prepare.keeps_cells = PETSC_TRUE;
  PetscCall(EqmIntakePrepare(&prepare, whole));
  PetscCall(EqmIntakeDiagnose(options->target, PETSC_FALSE, whole, &fatal, text, sizeof(text)));
  *can = (PetscBool)!fatal;
  PetscFunctionReturn(0);
}
