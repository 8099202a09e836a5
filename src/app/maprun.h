/* One run of a map command on one mesh, and which of two runs the user gets. */
#ifndef EQM_MAPRUN_H
#define EQM_MAPRUN_H

#include <equimap.h>
#include "base/stop.h"
#include "intake/intake.h"

/* A mesh, its solver, and what was found. */
typedef struct {
  EqmMesh mesh;
  EqmSolver solver;
  EqmMap found, map; /* of the mesh that was mapped; of the file's mesh: the same where nothing was mended */
} EqmMapRun;

/* Solve on the mesh that `input` maps. Collective. Errors: those of the solver. */
PETSC_INTERN PetscErrorCode EqmMapRunSolve(const char *command, const EqmIntake *input, const EqmStopFile *stop_file,
                                           EqmLedger ledger, EqmMapRun *run);
/* Where the repair of `input` has split cells: minimise what the user gets, on the file's own cells; from the start, as
   without a repair, and if that ends with folds from the map that `run` has found. The best map of these cells stays
   in `run`.
   `whole` - what that run has worked on; to be reset after `run` is destroyed. Collective. */
PETSC_INTERN PetscErrorCode EqmMapRunWithoutSplits(const char *command, const EqmIntakeOptions *options,
                                                   const EqmIntake *input, const EqmStopFile *stop_file,
                                                   EqmLedger ledger, EqmMapRun *run, EqmIntake *whole);
/* 001 Table 4, for the map that was found: so many of the smallest eigenvalues of the Hessian called "energy" or
   "appendix-b", into the map and printed. Collective. */
PETSC_INTERN PetscErrorCode EqmMapTakeEigenvalues(PetscInt wanted, const char *hessian, EqmLedger ledger,
                                                  EqmSolver solver, EqmMap map);
/* Print the result table: the map of the file's mesh, and that of the prepared mesh if there is one (else NULL).
   `ended`: say how the run came to its end, which the lines before have not said, or of another run. `written`: the
   names of the files. Collective. */
PETSC_INTERN PetscErrorCode EqmMapPrintResult(PetscBool ended, const char *written, EqmMap map, EqmMap prepared);
/* Collective. */
PETSC_INTERN PetscErrorCode EqmMapRunDestroy(EqmMapRun *run);

#endif
