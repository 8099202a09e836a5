/* The options of a solver: defaults, names, help; and how settings without a value get that of the formulation. */
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
                                  .stagnation = 5,
                                  .inner_steps = -1,
                                  .checkpoint_every = -1};
  PetscCall(EqmStartOptionsDefault(&settings->start));
  PetscCall(EqmNormaliseSettingsDefault(&settings->normalise));
  PetscFunctionReturn(0);
}

static PetscErrorCode Check(MPI_Comm comm, const EqmSolverSettings *set)
{
  PetscFunctionBegin;
  if (set->max_it < -1) EqmFail(comm, EQM_ERR_USAGE, "-max_it %" PetscInt_FMT ": give 0 or more", set->max_it);
  if (set->energy_atol < 0.)
    EqmFail(comm, EQM_ERR_USAGE, "-energy_atol %.6g: give 0 or more", (double)set->energy_atol);
  if (set->wall_time < 0.)
    EqmFail(comm, EQM_ERR_USAGE, "-wall_time %.6g: give a number of seconds, 0 for no limit", (double)set->wall_time);
  if (set->checkpoint_every < -1)
    EqmFail(comm, EQM_ERR_USAGE, "-checkpoint_every %" PetscInt_FMT ": give 1 or more, 0 or -1", set->checkpoint_every);
  if (set->balance < 0. && set->balance != -1.)
    EqmFail(comm, EQM_ERR_USAGE, "-balance %.6g: give 0 or more; .001 to .1 are useful", (double)set->balance);
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

/* Create a method with the formulation's settings, then read its options. */
static PetscErrorCode CreateMethod(EqmSolver solver, const EqmMethodDefaults *defaults,
                                   PetscOptionItems *PetscOptionsObject, EqmMethod *method)
{
  PetscBool is_lm;

  PetscFunctionBegin;
  PetscCall(EqmMethodCreate(solver->comm, defaults->method, method));
  if (defaults->configure) PetscCall(defaults->configure(*method));
  PetscCall(PetscStrcmp(defaults->method, "lm", &is_lm));
  if (is_lm && solver->settings.inner_steps >= 0) PetscCall(EqmLmSetInnerSteps(*method, solver->settings.inner_steps));
  if (PetscOptionsObject) PetscCall(EqmMethodSetFromOptions(*method, PetscOptionsObject));
  PetscFunctionReturn(0);
}

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
      PetscCall(CreateMethod(solver, &f->methods[k], PetscOptionsObject, &method));
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

/* The formulation's objective, or the one that the user wants. */
static PetscErrorCode FindObjective(EqmSolver solver)
{
  const EqmSolverSettings *const set = &solver->settings;
  const PetscBool planar = (PetscBool)(solver->formulation->starts == EQM_STARTS_PLANE);

  PetscFunctionBegin;
  solver->objective = solver->formulation->objective;
  if (!set->objective[0]) PetscFunctionReturn(0);
  PetscCall(EqmObjectiveFind(solver->comm, set->objective, &solver->objective));
  if (solver->objective->planar_only && !planar)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-objective %s is for the disk and the square", set->objective);
  PetscFunctionReturn(0);
}

/* The default method for another objective than the target's own: one that minimises any objective. */
static const char *MethodName(EqmSolver solver)
{
  const char *const name = solver->settings.method;

  return solver->objective != solver->formulation->objective && !strcmp(name, "auto") ? "lbfgs" : name;
}

/* Check that the method can minimise the chosen objective. */
static PetscErrorCode CheckObjective(EqmSolver solver)
{
  const EqmSolverSettings *const set = &solver->settings;
  const EqmMethod method = solver->method;
  const EqmObjective *const objective = solver->objective;

  PetscFunctionBegin;
  if (objective != solver->formulation->objective && !method->takes_terms)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-method %s does not minimise -objective %s; take lbfgs, ncg or rgd",
            solver->defaults.name, objective->name);
  if (method->needs_ratios && !objective->of_ratios)
    EqmFail(solver->comm, EQM_ERR_USAGE,
            "-method %s squares how far ratios are from one, which -objective %s does not ask for; take lbfgs, ncg or "
            "rgd",
            solver->defaults.name, objective->name);
  if (method->needs_hessian && !objective->set_hessian)
    EqmFail(solver->comm, EQM_ERR_USAGE,
            "-method %s needs second derivatives, which -objective %s does not have; take lbfgs, ncg or rgd",
            solver->defaults.name, objective->name);
  if (set->balance > 0. && !solver->formulation->takes_balance)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-balance is not for this target: it weighs angles against areas");
  if (set->balance > 0. && !method->takes_terms)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-balance is not for -method %s; take lm, lbfgs, ncg or rgd",
            solver->defaults.name);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverResolveSettings(EqmSolver solver)
{
  EqmSolverSettings *const set = &solver->settings;
  const EqmFormulation *const formulation = solver->formulation;

  PetscFunctionBegin;
  PetscCall(Check(solver->comm, set));
  PetscCall(FindObjective(solver));
  if (!solver->method) {
    PetscCall(EqmFormulationFindMethod(solver->comm, formulation, MethodName(solver), &solver->defaults));
    PetscCall(CreateMethod(solver, &solver->defaults, NULL, &solver->method));
  }
  if (!set->start.name[0]) PetscCall(PetscStrncpy(set->start.name, solver->defaults.start, sizeof(set->start.name)));
  if (set->max_it < 0) set->max_it = solver->defaults.max_it;
  if (set->ratio_tol < 0.) set->ratio_tol = set->energy_rtol == 0. ? 0. : solver->defaults.ratio_tol;
  if (set->energy_rtol < 0.) set->energy_rtol = solver->defaults.energy_rtol;
  if (set->gradient_tol < 0.) set->gradient_tol = solver->defaults.gradient_tol;
  PetscCall(CheckObjective(solver));
  if (!set->restart[0]) PetscCall(EqmStartRequireFile(solver->comm, set->start.name));
  PetscCall(EqmStartFind(solver->comm, formulation->starts, formulation->domain, set->start.name, &solver->start));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverCheckLandmarkSupport(EqmSolver solver)
{
  const PetscBool held =
      (PetscBool)(!strcmp(solver->defaults.method, "fixed-point") && strcmp(solver->formulation->domain, "disk"));

  PetscFunctionBegin;
  if (held)
    EqmFail(solver->comm, EQM_ERR_USAGE,
            "-method fixed-point draws landmarks together on the disk only (000 (49)); take lm, lbfgs, ncg or rgd");
  if (!solver->method->takes_landmarks && !solver->method->takes_terms)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-method %s cannot draw landmarks together; take lm, or lbfgs, ncg or rgd",
            solver->defaults.name);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverRequireLandmarks(EqmSolver solver)
{
  PetscFunctionBegin;
  PetscCall(EqmSolverResolveSettings(solver));
  PetscCall(EqmSolverCheckLandmarkSupport(solver));
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
  PetscCall(FindObjective(solver));
  PetscCall(EqmFormulationFindMethod(solver->comm, solver->formulation, MethodName(solver), &solver->defaults));
  PetscCall(CreateMethod(solver, &solver->defaults, PetscOptionsObject, &solver->method));
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
  PetscCall(Check(solver->comm, &solver->settings));
  if (one) PetscCall(EqmSolverResolveSettings(solver)); /* else the formulation depends on the mesh */
  PetscFunctionReturn(0);
}
