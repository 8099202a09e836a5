/* Steps of reading a mesh that is to be mapped; private to this folder. */
#ifndef EQM_INTAKE_PRIVATE_H
#define EQM_INTAKE_PRIVATE_H

#include "intake/intake.h"

/* Begin: the mesh as the file has it, with its density, and then with noise; `plain` is the one without, to be
   destroyed where it is another. Collective. */
PETSC_INTERN PetscErrorCode EqmIntakeBegin(MPI_Comm comm, const EqmIntakeOptions *options, EqmLedger ledger,
                                           EqmIntake *intake, EqmSoup *plain);
/* The options of a preparation for the target. Not collective. */
PETSC_INTERN EqmPrepareOptions EqmIntakePrepareOptions(const EqmIntakeOptions *options);
/* Prepare a copy of the input; if nothing changes, the input itself is mapped. Collective. */
PETSC_INTERN PetscErrorCode EqmIntakePrepare(const EqmPrepareOptions *options, EqmIntake *intake);
/* The same for a piece, on which the steps that all pieces have in common have been run: `begun`. Collective. */
PETSC_INTERN PetscErrorCode EqmIntakePrepareRest(const EqmPrepareOptions *options, const EqmPreparation *begun,
                                                 EqmIntake *intake);
/* Diagnose the mesh: topology, target (the named one or that of the topology), defects. Collective. */
PETSC_INTERN PetscErrorCode EqmIntakeDiagnose(const char *wanted, PetscBool with_places, EqmIntake *intake,
                                              PetscBool *fatal, char *text, size_t length);

/* Prefix of a report: the name of the mesh, if there are two. */
#define EQM_OF_PART(part) (part) ? (part) : "", (part) ? ": " : ""
/* ---- told.c: print the lines of a text that begin with `head`. Collective. */
PETSC_INTERN PetscErrorCode EqmPrintLinesWith(MPI_Comm comm, const char *part, const char *head, const char *text);

#endif
