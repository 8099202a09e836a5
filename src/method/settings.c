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
                            .gradient_tol = 0.,
                            .balance = -1.,
                            .stagnation = 5,
                            .ncg_guard = PETSC_TRUE,
                            .lbfgs_refresh = 25,
                            .lbfgs_memory = 10};
  PetscFunctionReturn(0);
}

static PetscErrorCode Check(MPI_Comm comm, const EqmSettings *set)
{
  PetscFunctionBegin;
  if (set->max_it < -1) EqmFail(comm, EQM_ERR_USAGE, "-max_it %" PetscInt_FMT ": give 0 or more", set->max_it);
  if (set->wall_time < 0.)
    EqmFail(comm, EQM_ERR_USAGE, "-wall_time %g: give a number of seconds, 0 for no limit", (double)set->wall_time);
  if (set->balance < 0. && set->balance != -1.)
    EqmFail(comm, EQM_ERR_USAGE, "-balance %g: give 0 or more; .001 to .1 are useful", (double)set->balance);
  PetscFunctionReturn(0);
}

/* Ask the options database, with help. */
static PetscErrorCode Ask(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSettings *const set = &solver->settings;
  char methods[EQM_MESSAGE_MAX], starts[EQM_MESSAGE_MAX];
  PetscInt num_corners = 4;
  static const EqmMethod *const with_options[] = {&EqmMethodNcg, &EqmMethodLbfgs, &EqmMethodRgd};

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(methods, "the iteration: ", sizeof(methods)));
  PetscCall(EqmMethodNames(methods + 15, sizeof(methods) - 15));
  PetscCall(PetscStrncpy(starts, "the first map: ", sizeof(starts)));
  PetscCall(EqmStartNames(solver->target, starts + 15, sizeof(starts) - 15));
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
  PetscCall(PetscOptionsReal("-gradient_tol", "converged when the gradient's norm is no larger than this",
                             "EqmSolverSetFromOptions", set->gradient_tol, &set->gradient_tol, NULL));
  PetscCall(PetscOptionsReal("-wall_time",
                             "stop after so many seconds since the program's start, map written (0: no limit)",
                             "EqmSolverSetFromOptions", set->wall_time, &set->wall_time, NULL));
  PetscCall(PetscOptionsReal("-balance",
                             "weight of the angle energy beside the area energy; .01 gives one nearly unique, smoother "
                             "map (-1: the method's own, 0: none)",
                             "EqmSolverSetFromOptions", set->balance, &set->balance, NULL));
  PetscCall(PetscOptionsIntArray("-corners",
                                 "square: four boundary vertices (input numbers from 0) for (0,0), (1,0), (1,1), (0,1)",
                                 "EqmSolverSetFromOptions", set->corners, &num_corners, &set->has_corners));
  if (set->has_corners && num_corners != 4)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-corners: give four vertex numbers, i,j,k,l; there are %" PetscInt_FMT,
            num_corners);
  PetscCall(PetscOptionsBool("-quiet", "no progress", "EqmSolverSetFromOptions", set->quiet, &set->quiet, NULL));
  for (size_t k = 0; k < sizeof(with_options) / sizeof(with_options[0]); k++)
    PetscCall(with_options[k]->options(solver, PetscOptionsObject));
  PetscFunctionReturn(0);
}

/* The method's own start unless one was named; a method that cannot do the target is refused. */
static PetscErrorCode ChooseStart(EqmSolver solver)
{
  EqmSettings *const set = &solver->settings;
  const char *start = solver->method->default_start;
  PetscBool sphere;

  PetscFunctionBegin;
  PetscCall(PetscStrcmp(solver->target, "sphere", &sphere));
  if (sphere) start = solver->method->sphere_start;
  if (!start)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-method %s is not for the %s", solver->method->name, solver->target);
  if (sphere && set->balance > 0.) EqmFail(solver->comm, EQM_ERR_USAGE, "-balance is for the disk and the square");
  if (!set->start[0]) PetscCall(PetscStrncpy(set->start, start, sizeof(set->start)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetFromOptions(EqmSolver solver)
{
  EqmSettings *const set = &solver->settings;

  PetscFunctionBegin;
  PetscOptionsBegin(solver->comm, NULL, "Map", NULL);
  PetscCall(Ask(solver, PetscOptionsObject));
  PetscOptionsEnd();
  PetscCall(Check(solver->comm, set));
  PetscCall(EqmMethodFind(set->method, &solver->method));
  PetscCall(ChooseStart(solver));
  PetscCall(EqmStartFind(solver->target, set->start));
  if (set->max_it < 0) set->max_it = solver->method->default_max_it;
  if (set->ratio_tol < 0.) set->ratio_tol = set->energy_rtol == 0. ? 0. : solver->method->default_ratio_tol;
  if (set->energy_rtol < 0.) set->energy_rtol = solver->method->default_energy_rtol;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverHelp(MPI_Comm comm, const char *target)
{
  struct _p_EqmSolver solver = {.comm = comm};

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(solver.target, target, sizeof(solver.target)));
  PetscCall(EqmSettingsDefault(&solver.settings));
  PetscCall(EqmSolverSetFromOptions(&solver));
  PetscFunctionReturn(0);
}
