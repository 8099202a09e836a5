/* The options of a solver: defaults, names, help. */
#include "solver/solver_private.h"
#include "solver/inner.h"
#include <string.h>

/* -1: the method's default. Not collective. */
PetscErrorCode EqmSolverSettingsDefault(EqmSolverSettings *settings)
{
  PetscFunctionBegin;
  *settings = (EqmSolverSettings){.method = "auto",
                                  .max_it = -1,
                                  .energy_rtol = -1.,
                                  .ratio_tol = -1.,
                                  .gradient_tol = -1.,
                                  .balance = -1.,
                                  .balance_energy = -1.,
                                  .stagnation = 5,
                                  .inner_steps = -1,
                                  .checkpoint_every = -1};
  PetscCall(EqmStartOptionsDefault(&settings->start));
  PetscCall(EqmNormaliseSettingsDefault(&settings->normalise));
  PetscFunctionReturn(0);
}

/* ---- the groups of options */

/* Options of a whole run, which may have several solvers. */
static PetscErrorCode ReadRunOptions(EqmSolverSettings *set, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(EqmLinearHelpOptions(PetscOptionsObject));
  PetscCall(PetscOptionsBool("-quiet", "no progress", "EqmSolverSetFromOptions", set->quiet, &set->quiet, NULL));
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
  PetscCall(PetscOptionsString("-restart",
                               "go on from this checkpoint, or from the one before it if it is damaged; auto: -resume",
                               "EqmSolverSetFromOptions", set->restart, set->restart, sizeof(set->restart), NULL));
  PetscFunctionReturn(0);
}

/* When to stop. */
static PetscErrorCode ReadTolerances(EqmSolverSettings *set, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsInt("-max_it", "at most so many iterations (-1: the method's own)", "EqmSolverSetFromOptions",
                            set->max_it, &set->max_it, NULL));
  PetscCall(PetscOptionsInt("-max_factorizations", "at most so many coupled factorisations (0: no limit)",
                            "EqmSolverSetFromOptions", set->max_factorizations, &set->max_factorizations, NULL));
  PetscCall(PetscOptionsReal("-energy_rtol",
                             "converged when the objective falls by less than this share per iteration, over some "
                             "iterations (-1: the method's own, 0: never)",
                             "EqmSolverSetFromOptions", set->energy_rtol, &set->energy_rtol, NULL));
  PetscCall(PetscOptionsReal("-energy_atol",
                             "converged when the objective falls by no more than this in an iteration, the epsilon of "
                             "the papers' algorithms (0: off)",
                             "EqmSolverSetFromOptions", set->energy_atol, &set->energy_atol, NULL));
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
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadCorners(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSolverSettings *const set = &solver->settings;
  PetscInt num_corners = 4;
  PetscBool given;

  PetscFunctionBegin;
  PetscCall(PetscOptionsIntArray("-corners",
                                 "four boundary vertices (input numbers from 0) for (0,0), (1,0), (1,1), (0,1)",
                                 "EqmSolverSetFromOptions", set->corners, &num_corners, &given));
  if (given && num_corners != 4)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-corners: give four vertex numbers, i,j,k,l; there are %" PetscInt_FMT,
            num_corners);
  if (given) set->has_corners = PETSC_TRUE;
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadCommon(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  static const char *const unfoldings[] = {"auto", "paper", "none"}; /* as EqmUnfolding */
  EqmSolverSettings *const set = &solver->settings;
  char methods[EQM_MESSAGE_MAX] = "the iteration: ";
  PetscBool monitor = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(EqmFormulationMethodNames(solver->target, NULL, methods + 15, sizeof(methods) - 15));
  PetscCall(PetscOptionsString("-method", methods, "EqmSolverSetFromOptions", set->method, set->method,
                               sizeof(set->method), NULL));
  PetscCall(PetscOptionsString("-objective",
                               "what is minimised: authalic, symmetric-dirichlet (disk, square); else the target's own",
                               "EqmSolverSetFromOptions", set->objective, set->objective, sizeof(set->objective),
                               NULL));
  PetscCall(EqmStartSetFromOptions(solver->formulation->starts, &set->start, PetscOptionsObject));
  PetscCall(ReadTolerances(set, PetscOptionsObject));
  PetscCall(PetscOptionsReal("-balance",
                             "weight of the angle energy beside the area energy; .01 gives one nearly unique, smoother "
                             "map (-1: the method's own, 0: none)",
                             "EqmSolverSetFromOptions", set->balance, &set->balance, NULL));
  PetscCall(
      PetscOptionsReal("-balance_energy",
                       "the least shear with an area energy of no more than this: -balance (.1 if not given) falls "
                       "until the map has it (-1: -balance stays)",
                       "EqmSolverSetFromOptions", set->balance_energy, &set->balance_energy, NULL));
  if (!solver->prefix[0]) { /* once per run, not per inner solver */
    PetscCall(ReadRunOptions(set, PetscOptionsObject));
    PetscCall(PetscOptionsBool("-monitor", "show progress; equimap itself always does, unless -quiet",
                               "EqmSolverMonitorText", monitor, &monitor, NULL));
  }
  if (monitor && !solver->monitor) PetscCall(EqmSolverSetMonitor(solver, EqmSolverMonitorText, NULL));
  PetscCall(PetscOptionsEList("-unfold",
                              "what is done about folds: auto, all that this program can; paper, the correction of 001 "
                              "section 6.2 once (sphere; elsewhere the papers have none); none",
                              "EqmSolverSetFromOptions", unfoldings, 3, unfoldings[set->unfolding], &set->unfolding,
                              NULL));
  if (!strcmp(solver->formulation->domain, "square")) PetscCall(ReadCorners(solver, PetscOptionsObject));
  if (!strcmp(solver->target, "disk"))
    PetscCall(
        PetscOptionsString("-boundary_angles",
                           "hold the boundary: a CSV file with a line per boundary vertex, its number (from 0) and "
                           "its angle in radians, after a header",
                           "EqmSolverSetFromOptions", set->boundary_angles, set->boundary_angles,
                           sizeof(set->boundary_angles), NULL));
  PetscFunctionReturn(0);
}

/* ---- methods */

/* Read the options of all methods for the target once, so that they are known and listed by -help. */
static PetscErrorCode ListMethodOptions(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  const EqmMethodDefaults *seen[64];
  PetscInt num_seen = 0;

  PetscFunctionBegin;
  for (const EqmFormulation *f = EqmFormulationNext(solver->target, NULL); f;
       f = EqmFormulationNext(solver->target, f)) {
    for (PetscInt k = 0; k < f->num_methods; k++) {
      EqmMethod method;
      PetscInt s = 0;
      while (s < num_seen && strcmp(seen[s]->name, f->methods[k].name)) s++;
      if (s < num_seen) continue;
      seen[num_seen++] = &f->methods[k];
      PetscCall(EqmSolverCreateMethod(solver, &f->methods[k], PetscOptionsObject, &method));
      PetscCall(EqmMethodDestroy(&method));
    }
  }
  PetscFunctionReturn(0);
}

/* The first maps of other formulations of the target. */
static PetscErrorCode ListOtherStarts(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmStartOptions start;

  PetscFunctionBegin;
  for (const EqmFormulation *f = EqmFormulationNext(solver->target, solver->formulation); f;
       f = EqmFormulationNext(solver->target, f)) {
    PetscCall(EqmStartOptionsDefault(&start));
    PetscCall(EqmStartSetFromOptions(f->starts, &start, PetscOptionsObject));
  }
  PetscFunctionReturn(0);
}

/* The options of the solver's own formulation and method. */
static PetscErrorCode ReadOwn(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSolverSettings *const set = &solver->settings;

  PetscFunctionBegin;
  PetscCall(ReadCommon(solver, PetscOptionsObject));
  for (const EqmFormulation *f = EqmFormulationNext(solver->target, NULL); f; /* refused where they have no meaning */
       f = EqmFormulationNext(solver->target, f)) {
    if (f->finish)
      PetscCall(EqmNormaliseSetFromOptions(solver->comm, solver->mesh, &set->normalise, PetscOptionsObject));
  }
  if (!solver->mesh) PetscFunctionReturn(0);
  PetscCall(EqmMethodDestroy(&solver->method));
  PetscCall(EqmSolverFindMethod(solver, PetscOptionsObject));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetFromOptions(EqmSolver solver)
{
  PetscFunctionBegin;
  PetscCheck(!solver->is_set_up, solver->comm, PETSC_ERR_ORDER, "%s comes before EqmSolverSetUp and EqmSolverSolve",
             PETSC_FUNCTION_NAME);
  PetscOptionsBegin(solver->comm, solver->prefix, solver->prefix[0] ? "Map of the boundary to the sphere" : "Map",
                    NULL);
  PetscCall(ReadOwn(solver, PetscOptionsObject));
  PetscOptionsEnd();
  PetscCall(EqmSolverResolveSettings(solver));
  PetscFunctionReturn(0);
}

/* Without a mesh: read every option of the target, and report errors that do not depend on the mesh. */
PetscErrorCode EqmSolverListOptions(EqmSolver solver)
{
  const PetscBool one = (PetscBool)!EqmFormulationNext(solver->target, solver->formulation);

  PetscFunctionBegin;
  PetscOptionsBegin(solver->comm, solver->prefix, solver->prefix[0] ? "Map of the boundary to the sphere" : "Map",
                    NULL);
  PetscCall(ReadOwn(solver, PetscOptionsObject));
  PetscCall(ListOtherStarts(solver, PetscOptionsObject));
  PetscCall(ListMethodOptions(solver, PetscOptionsObject));
  PetscOptionsEnd();
  PetscCall(EqmSolverCheckSettings(solver));
  if (one) PetscCall(EqmSolverResolveSettings(solver)); /* else the formulation depends on the mesh */
  PetscFunctionReturn(0);
}
