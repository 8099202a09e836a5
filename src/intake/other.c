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

PetscErrorCode EqmIntakeCut(const EqmIntakeOptions *options, const EqmIntake *intake, EqmComponents *components)
{
  const EqmPrepareOptions prepare = EqmIntakePrepareOptions(options);

  PetscFunctionBegin;
  PetscCall(EqmComponentsCreate(intake->given, &prepare, components));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIntakePiece(const EqmIntakeOptions *options, const EqmComponents *components, PetscInt number,
                              EqmIntake *piece, PetscBool *can, char *reason, size_t length)
{
  const EqmPrepareOptions prepare = EqmIntakePrepareOptions(options);
  PetscBool fatal;
  char *end;

  PetscFunctionBegin;
  *piece = (EqmIntake){.components = components, .piece = number};
  PetscCall(EqmComponentsTake(components, number, &piece->given, &piece->begun));
  piece->mapped = piece->given;
  PetscCall(EqmIntakePrepareRest(&prepare, &piece->begun, piece));
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
  EqmPrepareOptions prepare = EqmIntakePrepareOptions(options);
  PetscBool fatal;

  PetscFunctionBegin;
  prepare.keeps_cells = PETSC_TRUE;
  *whole = (EqmIntake){.given = intake->given,
                       .mapped = intake->given,
                       .components = intake->components,
                       .piece = intake->piece};
  if (intake->components)
    PetscCall(EqmIntakePrepareRest(&prepare, &intake->begun, whole));
  else
    PetscCall(EqmIntakePrepare(&prepare, whole));
  PetscCall(EqmIntakeDiagnose(options->target, PETSC_FALSE, whole, &fatal, text, sizeof(text)));
  *can = (PetscBool)!fatal;
  PetscFunctionReturn(0);
}
