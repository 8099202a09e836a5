/* equimap register A B -o OUT: a measure-preserving correspondence between two surfaces or two solids. */
#include "app.h"
#include "base/stop.h"
#include "store/output.h"

typedef struct {
  char output[PETSC_MAX_PATH_LEN], summary[PETSC_MAX_PATH_LEN], history[PETSC_MAX_PATH_LEN],
      checkpoint[PETSC_MAX_PATH_LEN];
  PetscBool has_output, has_summary, has_history, has_checkpoint, has_restart, dry_run;
} RegisterOptions;

static const char manual[] =
    "\n"
    "A and B are meshes, or results of equimap that hold a map (.h5): both disk-type surfaces, both\n"
    "closed surfaces of genus 0, or both solid balls. What is no result is mapped first. B may be the\n"
    "word target: then A is mapped to the unit disk or sphere with its landmarks at given points of it.\n";

static PetscErrorCode ReadOptions(RegisterOptions *options)
{
  PetscFunctionBegin;
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "Files", NULL);
  PetscCall(PetscOptionsString("-o",
                               "where the correspondence goes: .h5 (everything, with an .xmf for ParaView), or a mesh "
                               "format: A's cells with their vertices on B; several with commas",
                               NULL, "", options->output, sizeof(options->output), &options->has_output));
  PetscCall(PetscOptionsString("-summary", "write the run's figures as JSON", NULL, "", options->summary,
                               sizeof(options->summary), &options->has_summary));
  PetscCall(PetscOptionsString("-history", "write a row per iteration of the last minimisation for A as CSV", NULL, "",
                               options->history, sizeof(options->history), &options->has_history));
  PetscCall(EqmLayoutHelpOptions(PetscOptionsObject));
  PetscCall(PetscOptionsBool("-dry_run", "look at options, meshes and outputs, say whether a run would begin, and stop",
                             NULL, options->dry_run, &options->dry_run, NULL));
  PetscOptionsEnd();
  PetscCall(PetscOptionsGetString(NULL, NULL, "-checkpoint", options->checkpoint, sizeof(options->checkpoint),
                                  &options->has_checkpoint)); /* the solver lists these */
  PetscCall(PetscOptionsHasName(NULL, NULL, "-restart", &options->has_restart));
  PetscFunctionReturn(0);
}

/* Check before the run what would fail after it. */
static PetscErrorCode CheckArguments(const EqmCommandLine *line, const RegisterOptions *options)
{
  PetscFunctionBegin;
  if (line->num_arguments != 2 && !(line->num_arguments == 0 && options->has_restart))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE,
            "register wants two meshes or results, %d given; usage: equimap register A B -o OUT.h5",
            line->num_arguments);
  if (!options->has_output) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "no output named; add -o OUT.h5");
  PetscCall(EqmMapCheckWritable(PETSC_COMM_WORLD, options->output));
  for (int k = 0; k < 2; k++) {
    const char *const mesh = line->num_arguments ? line->argument[k] : "";
    PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->output));
    if (options->has_summary) PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->summary));
    if (options->has_history) PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->history));
    if (options->has_checkpoint) PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->checkpoint));
  }
  if (!options->has_checkpoint) PetscFunctionReturn(0);
  PetscCall(EqmSweepOutput(PETSC_COMM_WORLD, options->output));
  if (options->has_summary) PetscCall(EqmSweepOutput(PETSC_COMM_WORLD, options->summary));
  if (options->has_history) PetscCall(EqmSweepOutput(PETSC_COMM_WORLD, options->history));
  PetscFunctionReturn(0);
}

/* A run that was stopped has a checkpoint, but no result. */
static PetscErrorCode Write(const RegisterOptions *options, EqmLedger ledger, EqmRegistration registration)
{
  EqmStatus status;
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(EqmRegistrationGetMap(registration, &map));
  PetscCall(EqmMapGetStatus(map, &status, NULL));
  PetscCall(EqmMapSetCost(map, ledger));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_WRITE));
  if (status != EQM_STATUS_STOPPED) {
    PetscCall(EqmMapWrite(map, options->output));
    PetscCall(EqmRegistrationWriteFrames(registration, options->output));
  }
  if (options->has_history) PetscCall(EqmMapWriteHistory(map, options->history));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_WRITE));
  PetscCall(EqmMapSetCost(map, ledger));
  if (options->has_summary) PetscCall(EqmMapWriteSummary(map, options->summary));
  PetscFunctionReturn(0);
}

/* Print the result table. */
static PetscErrorCode View(const RegisterOptions *options, EqmRegistration registration)
{
  const EqmMapCost *cost;
  EqmStatus status;
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(EqmRegistrationView(registration));
  PetscCall(EqmRegistrationGetMap(registration, &map));
  PetscCall(EqmMapGetStatus(map, &status, NULL));
  if (status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  PetscCall(EqmMapGetCost(map, &cost));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  seconds       %.2f\n  memory        %.0f MB in all\n  written       %s\n",
                        (double)cost->total_seconds, 1e-6 * (double)cost->memory_total, options->output));
  PetscFunctionReturn(0);
}

/* Solve, write, print. */
static PetscErrorCode Run(const RegisterOptions *options, EqmLedger ledger, EqmRegistration registration,
                          EqmStatus *status)
{
  PetscFunctionBegin;
  PetscCall(EqmRegistrationSolve(registration));
  PetscCall(EqmRegistrationGetStatus(registration, status, NULL));
  PetscCall(Write(options, ledger, registration));
  PetscCall(View(options, registration));
  PetscFunctionReturn(0);
}

/* Run `equimap register`. Collective on PETSC_COMM_WORLD. Errors: EQM_ERR_USAGE, and those of EqmRegistrationRead and
   EqmMapWrite. */
PetscErrorCode EqmCommandRegister(const EqmCommandLine *line, EqmStatus *status)
{
  RegisterOptions options = {0};
  EqmLedger ledger;
  EqmRegistration registration;

  PetscFunctionBegin;
  if (line->help) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s", manual));
  PetscCall(ReadOptions(&options));
  PetscCall(EqmRegistrationHelp(PETSC_COMM_WORLD)); /* reads every option, to find the unknown ones */
  if (line->help) PetscFunctionReturn(0);
  PetscCall(EqmRejectUnknownOptions(line));
  PetscCall(CheckArguments(line, &options));
  PetscCall(EqmStopCatchSignals(PETSC_COMM_WORLD));
  PetscCall(EqmLedgerCreate(PETSC_COMM_WORLD, &ledger));
  PetscCall(EqmRegistrationCreate(PETSC_COMM_WORLD, ledger, &registration));
  PetscCall(EqmRegistrationSetFromOptions(registration));
  PetscCall(EqmRegistrationRead(registration, line->argument[0], line->argument[1])); /* NULL where not named */
  if (options.dry_run) {
    PetscCall(EqmRegistrationViewInput(registration));
  } else {
    PetscCall(Run(&options, ledger, registration, status));
  }
  PetscCall(EqmRegistrationDestroy(&registration));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscFunctionReturn(0);
}
