#include "method/flow.h"
#include "geometry/simplex.h"

PetscErrorCode EqmFlowLaplacian(EqmSolver solver, const EqmPlace *place, PetscReal *af, PetscReal *normal)
{
  const PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(EqmAngleWeights(solver, &weights));
  PetscCall(EqmLaplacianApply(solver->mesh, weights, 3, place->x, af));
  for (PetscInt v = 0; v < solver->mesh->num_owned && normal; v++) normal[v] = EqmDot3(af + 3 * v, place->x + 3 * v);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowSpeed(EqmSolver solver, const EqmPlace *place, PetscReal *speed)
{
  const PetscInt n = solver->mesh->num_owned;
  PetscReal *af, *normal, sum = 0.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * n, &af, n, &normal));
  PetscCall(EqmFlowLaplacian(solver, place, af, normal));
  for (PetscInt k = 0; k < 3 * n; k++) sum += PetscSqr(af[k] - normal[k / 3] * place->x[k]);
  PetscCall(PetscFree2(af, normal));
  PetscCall(MPIU_Allreduce(&sum, speed, 1, MPIU_REAL, MPIU_SUM, solver->comm));
  *speed = PetscSqrtReal(*speed);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowNormalise(EqmSolver solver, PetscBool moebius, EqmPlace *place)
{
  PetscReal center[3] = {0., 0., 0.}, offset;
  const PetscReal *mass;

  PetscFunctionBegin;
  PetscCall(EqmVertexMass(solver, &mass));
  if (!moebius) PetscCall(EqmPlaceMassCenter(solver->domain, mass, place, center));
  PetscCall(EqmPlaceOntoSphere(solver->domain, center, place));
  if (moebius) PetscCall(EqmPlaceCenter(solver->domain, mass, place, &offset));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowEnergy(EqmSolver solver, const EqmPlace *place, PetscReal *energy)
{
  const PetscReal *weights;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmAngleWeights(solver, &weights));
  PetscCall(EqmLaplacianEnergy(solver->mesh, weights, 3, place->x, energy));
  PetscCall(EqmLedgerGetWork(solver->mesh->ledger, &work));
  work->evaluations++;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowAccept(EqmSolver solver, const EqmPlace *place, PetscReal time_step)
{
  PetscFunctionBegin;
  if (place->x != solver->place.x) PetscCall(EqmPlaceCopy(solver->domain, place, &solver->place));
  PetscCall(EqmSolverLook(solver));
  PetscCall(EqmFlowSpeed(solver, &solver->place, &solver->gradient_norm));
  solver->objective = solver->totals.energy;
  solver->step_length = time_step;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowOptions(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSettings *const set = &solver->settings;

  PetscFunctionBegin;
  PetscCall(PetscOptionsReal("-flow_step",
                             "Euler methods: the first time step (0: 004 Algorithm 5.1's; explicit: nine tenths of the "
                             "stability limit; implicit: 5)",
                             "EqmSolverSetFromOptions", set->flow_step, &set->flow_step, NULL));
  PetscCall(PetscOptionsReal("-flow_tol", "Euler methods: converged when the energy changes by less in a step",
                             "EqmSolverSetFromOptions", set->flow_tol, &set->flow_tol, NULL));
  PetscCall(PetscOptionsBool(
      "-flow_moebius",
      "Euler methods: centre by a Mobius map instead of projecting f - c after each step (qiem: of phase II)",
      "EqmSolverSetFromOptions", set->flow_moebius, &set->flow_moebius, NULL));
  if (set->flow_step < 0.)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-flow_step %g: give 0 or more", (double)set->flow_step);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowJudge(EqmSolver solver, PetscReal change, PetscBool *ended)
{
  PetscFunctionBegin;
  *ended = (PetscBool)(PetscAbsReal(change) < solver->settings.flow_tol);
  if (*ended) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message), "the energy changed by less than %g in a step",
                            (double)solver->settings.flow_tol));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowState(EqmSolver solver, EqmState state, PetscReal *time_step, PetscBool *ended)
{
  PetscFunctionBegin;
  PetscCall(EqmStateReal(state, "time_step", time_step));
  PetscCall(EqmStateBool(state, "ended", ended));
  if (EqmStateIsLoading(state) && *ended) PetscCall(EqmFlowJudge(solver, 0., ended)); /* says so again */
  PetscFunctionReturn(0);
}
