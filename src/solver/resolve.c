/* How settings without a value get that of the formulation, and what does not go together. */
#include "solver/attempt.h"
#include <string.h>

PetscErrorCode EqmSolverCheckSettings(EqmSolver solver)
{
  const MPI_Comm comm = solver->comm;
  const EqmSolverSettings *const set = &solver->settings;

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
  if (!(set->balance_energy > 0.) && set->balance_energy != -1.)
    EqmFail(comm, EQM_ERR_USAGE, "-balance_energy %.6g: give more than 0; 1e-5 to 1e-3 are useful",
            (double)set->balance_energy);
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

PetscErrorCode EqmSolverCreateMethod(EqmSolver solver, const EqmMethodDefaults *defaults,
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

PetscErrorCode EqmSolverFindMethod(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(FindObjective(solver));
  PetscCall(EqmFormulationFindMethod(solver->comm, solver->formulation, MethodName(solver), &solver->defaults));
  PetscCall(EqmSolverCreateMethod(solver, &solver->defaults, PetscOptionsObject, &solver->method));
  PetscFunctionReturn(0);
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
  PetscCall(EqmSolverCheckSettings(solver));
  PetscCall(EqmBalanceBegin(solver));
  if (!solver->method)
    PetscCall(EqmSolverFindMethod(solver, NULL));
  else
    PetscCall(FindObjective(solver));
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
