/* The options of a solver: defaults, names, help. */
#include "method/method.h"

/* The house's defaults; -1 where the method decides. Not collective. */
PetscErrorCode EqmSettingsDefault(EqmSettings *settings)
{
  PetscFunctionBegin;
  *settings = (EqmSettings){.method = "auto",
                            .max_it = -1,
                            .start_steps = -1,
                            .energy_rtol = -1.,
                            .ratio_tol = -1.,
                            .gradient_tol = -1.,
                            .balance = -1.,
                            .stagnation = 5,
                            .checkpoint_every = -1,
                            .lm_inner = 100,
                            .ncg_guard = PETSC_TRUE,
                            .anisotropic_scaling = PETSC_TRUE,
                            .boundary_max_it = -1,
                            .lbfgs_refresh = 10,
                            .lbfgs_memory = 10,
                            .flow_tol = 1e-9,
                            .qiem_phase1 = "abc",
                            .qiem_phase2 = "abc",
                            .qiem_factor = 1.05,
                            .qiem_rise = .05};
  PetscFunctionReturn(0);
}

static PetscErrorCode Check(MPI_Comm comm, const EqmSettings *set)
{
  PetscFunctionBegin;
  if (set->max_it < -1) EqmFail(comm, EQM_ERR_USAGE, "-max_it %" PetscInt_FMT ": give 0 or more", set->max_it);
  if (set->wall_time < 0.)
    EqmFail(comm, EQM_ERR_USAGE, "-wall_time %g: give a number of seconds, 0 for no limit", (double)set->wall_time);
  if (set->checkpoint_every < -1)
    EqmFail(comm, EQM_ERR_USAGE, "-checkpoint_every %" PetscInt_FMT ": give 1 or more, 0 or -1", set->checkpoint_every);
  if (set->balance < 0. && set->balance != -1.)
    EqmFail(comm, EQM_ERR_USAGE, "-balance %g: give 0 or more; .001 to .1 are useful", (double)set->balance);
  PetscFunctionReturn(0);
}

/* Those of long runs. */
static PetscErrorCode AskCheckpoints(EqmSettings *set, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(
      PetscOptionsReal("-wall_time",
                       "stop after so many seconds since the program's start: with -checkpoint before the time is "
                       "over and to be continued, else with the map so far (0: no limit)",
                       "EqmSolverSetFromOptions", set->wall_time, &set->wall_time, NULL));
  PetscCall(
      PetscOptionsString("-checkpoint",
                         "keep the state of the run in this file (HDF5; the one before is FILE.previous): now and "
                         "then, and before stopping at -wall_time, on the signals USR1 and TERM, or when a file "
                         "STOP appears beside it",
                         "EqmSolverSetFromOptions", set->checkpoint, set->checkpoint, sizeof(set->checkpoint), NULL));
  PetscCall(PetscOptionsInt("-checkpoint_every",
                            "write the checkpoint every so many iterations (-1: as often as takes 3 % of the time, 0: "
                            "only when the run stops)",
                            "EqmSolverSetFromOptions", set->checkpoint_every, &set->checkpoint_every, NULL));
  PetscCall(PetscOptionsString("-restart", "go on from this checkpoint, or from the one before it if it is damaged",
                               "EqmSolverSetFromOptions", set->restart, set->restart, sizeof(set->restart), NULL));
  PetscFunctionReturn(0);
}

/* Ask the options database, with help. */
static PetscErrorCode Ask(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSettings *const set = &solver->settings;
  char methods[EQM_MESSAGE_MAX], starts[EQM_MESSAGE_MAX];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(methods, "the iteration: ", sizeof(methods)));
  PetscCall(EqmProblemMethodNames(solver->target, methods + 15, sizeof(methods) - 15));
  PetscCall(PetscStrncpy(starts, "the first map: ", sizeof(starts)));
  PetscCall(EqmStartNames(solver->problem->starts, starts + 15, sizeof(starts) - 15));
  PetscCall(PetscOptionsString("-method", methods, "EqmSolverSetFromOptions", set->method, set->method,
                               sizeof(set->method), NULL));
  PetscCall(PetscOptionsString("-start", starts, "EqmSolverSetFromOptions", set->start, set->start, sizeof(set->start),
                               NULL));
  PetscCall(PetscOptionsInt("-start_steps", "fixed-point steps after the first map (-1: as the start has it)",
                            "EqmSolverSetFromOptions", set->start_steps, &set->start_steps, NULL));
  PetscCall(PetscOptionsInt("-max_it", "at most so many iterations (-1: the method's own)", "EqmSolverSetFromOptions",
                            set->max_it, &set->max_it, NULL));
  PetscCall(PetscOptionsInt("-max_factorizations", "at most so many coupled factorisations (0: no limit)",
                            "EqmSolverSetFromOptions", set->max_factorizations, &set->max_factorizations, NULL));
  PetscCall(PetscOptionsReal("-energy_rtol",
                             "converged when the objective falls by less than this share per iteration, over some "
                             "iterations (-1: the method's own, 0: never)",
                             "EqmSolverSetFromOptions", set->energy_rtol, &set->energy_rtol, NULL));
  PetscCall(
      PetscOptionsReal("-ratio_tol",
                       "converged when the root mean square of ratio - 1 is no larger than this (-1: the method's own, "
                       "none with -energy_rtol 0; 0: never)",
                       "EqmSolverSetFromOptions", set->ratio_tol, &set->ratio_tol, NULL));
  PetscCall(PetscOptionsReal("-energy_target", "converged when the energy is no larger than this (0: off)",
                             "EqmSolverSetFromOptions", set->energy_target, &set->energy_target, NULL));
  PetscCall(
      PetscOptionsReal("-gradient_tol",
                       "converged when the gradient's norm is no larger than this (-1: the method's own, 0: never)",
                       "EqmSolverSetFromOptions", set->gradient_tol, &set->gradient_tol, NULL));
  PetscCall(PetscOptionsReal("-balance",
                             "weight of the angle energy beside the area energy; .01 gives one nearly unique, smoother "
                             "map (-1: the method's own, 0: none)",
                             "EqmSolverSetFromOptions", set->balance, &set->balance, NULL));
  PetscCall(EqmLinearAskOptions(PetscOptionsObject));
  PetscCall(AskCheckpoints(set, PetscOptionsObject));
  PetscCall(PetscOptionsBool("-quiet", "no progress", "EqmSolverSetFromOptions", set->quiet, &set->quiet, NULL));
  PetscCall(EqmProblemAskOptions(solver, PetscOptionsObject));
  PetscFunctionReturn(0);
}

/* What the settings leave open is taken as the problem offers it with the method. */
static PetscErrorCode TakeOffer(EqmSolver solver, const EqmOffer *offer)
{
  EqmSettings *const set = &solver->settings;

  PetscFunctionBegin;
  solver->method = offer->method;
  if (!set->start[0]) PetscCall(PetscStrncpy(set->start, offer->start, sizeof(set->start)));
  if (set->max_it < 0) set->max_it = offer->max_it;
  if (set->ratio_tol < 0.) set->ratio_tol = set->energy_rtol == 0. ? 0. : offer->ratio_tol;
  if (set->energy_rtol < 0.) set->energy_rtol = offer->energy_rtol;
  if (set->gradient_tol < 0.) set->gradient_tol = offer->gradient_tol;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetFromOptions(EqmSolver solver)
{
  EqmSettings *const set = &solver->settings;
  const EqmOffer *offer;

  PetscFunctionBegin;
  PetscOptionsBegin(solver->comm, NULL, "Map", NULL);
  PetscCall(Ask(solver, PetscOptionsObject));
  PetscOptionsEnd();
  PetscCall(Check(solver->comm, set));
  if (!solver->mesh && !EqmProblemIsSettled(solver->target)) PetscFunctionReturn(0); /* the mesh will tell */
  if (set->balance > 0. && !solver->problem->takes_balance)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-balance is not for the %s", solver->problem->place);
  PetscCall(EqmProblemFindOffer(solver->comm, solver->problem, set->method, &offer));
  PetscCall(TakeOffer(solver, offer));
  PetscCall(EqmStartFind(solver->problem, set->start));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverHelp(MPI_Comm comm, const char *target)
{
  struct _p_EqmSolver solver = {.comm = comm};

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(solver.target, target, sizeof(solver.target)));
  PetscCall(EqmSettingsDefault(&solver.settings));
  PetscCall(EqmProblemFind(comm, target, NULL, &solver.problem));
  PetscCall(EqmSolverSetFromOptions(&solver));
  PetscFunctionReturn(0);
}
