#include "method/flow.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

PetscErrorCode EqmFlowLaplacian(EqmProblem problem, const EqmPlace *place, PetscReal *af, PetscReal *normal)
{
  const PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetAngleWeights(problem, &weights));
  PetscCall(EqmLaplacianApply(problem->mesh, weights, 3, place->x, af));
  for (PetscInt v = 0; v < problem->mesh->num_owned && normal; v++) normal[v] = EqmDot3(af + 3 * v, place->x + 3 * v);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowSpeed(EqmProblem problem, const EqmPlace *place, PetscReal *speed)
{
  const PetscInt n = problem->mesh->num_owned;
  PetscReal *af, *normal, sum = 0.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * n, &af, n, &normal));
  PetscCall(EqmFlowLaplacian(problem, place, af, normal));
  for (PetscInt k = 0; k < 3 * n; k++) sum += PetscSqr(af[k] - normal[k / 3] * place->x[k]);
  PetscCall(PetscFree2(af, normal));
  PetscCall(MPIU_Allreduce(&sum, speed, 1, MPIU_REAL, MPIU_SUM, problem->comm));
  *speed = PetscSqrtReal(*speed);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowNormalise(EqmProblem problem, PetscBool moebius, EqmPlace *place)
{
  PetscReal center[3] = {0., 0., 0.}, offset;
  const PetscReal *mass;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetVertexMass(problem, &mass));
  if (!moebius) PetscCall(EqmPlaceMassCenter(problem->domain, mass, place, center));
  PetscCall(EqmPlaceOntoSphere(problem->domain, center, place));
  if (moebius) PetscCall(EqmPlaceCenter(problem->domain, mass, place, &offset));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowEnergy(EqmProblem problem, const EqmPlace *place, PetscReal *energy)
{
  const PetscReal *weights;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetAngleWeights(problem, &weights));
  PetscCall(EqmLaplacianEnergy(problem->mesh, weights, 3, place->x, energy));
  PetscCall(EqmLedgerGetWork(problem->mesh->ledger, &work));
  work->evaluations++;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowChange(EqmProblem problem, const EqmPlace *from, const EqmPlace *to, PetscReal *change)
{
  PetscReal sum = 0.;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * problem->mesh->num_owned; k++) sum += PetscSqr(to->x[k] - from->x[k]);
  PetscCall(MPIU_Allreduce(&sum, change, 1, MPIU_REAL, MPIU_SUM, problem->comm));
  *change = PetscSqrtReal(*change / problem->mesh->num_vertices);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowAccept(EqmProblem problem, EqmIterate iterate, const EqmPlace *place, PetscReal time_step)
{
  PetscFunctionBegin;
  if (place->x != iterate->place.x) {
    PetscCall(EqmFlowChange(problem, &iterate->place, place, &iterate->figures.change));
    PetscCall(EqmPlaceCopy(problem->domain, place, &iterate->place));
  }
  PetscCall(EqmIterateUpdate(problem, iterate));
  PetscCall(EqmFlowSpeed(problem, &iterate->place, &iterate->gradient_norm));
  iterate->objective = iterate->totals.energy;
  iterate->step_length = time_step;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowSetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  EqmFlowSettings *const set = method->data;

  PetscFunctionBegin;
  PetscCall(PetscOptionsReal("-flow_step",
                             "Euler methods: the first time step (0: 004 Algorithm 5.1's; explicit: nine tenths of the "
                             "stability limit; implicit: 5)",
                             "EqmSolverSetFromOptions", set->step, &set->step, NULL));
  PetscCall(PetscOptionsReal("-flow_tol", "Euler methods: converged when the energy changes by less in a step",
                             "EqmSolverSetFromOptions", set->tol, &set->tol, NULL));
  PetscCall(PetscOptionsBool(
      "-flow_moebius",
      "Euler methods: centre by a Mobius map instead of projecting f - c after each step (qiem: of phase II)",
      "EqmSolverSetFromOptions", set->moebius, &set->moebius, NULL));
  if (set->step < 0.) EqmFail(method->comm, EQM_ERR_USAGE, "-flow_step %.6g: give 0 or more", (double)set->step);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowJudge(EqmMethod method, PetscReal change, PetscBool *ended)
{
  const EqmFlowSettings *const set = method->data;

  PetscFunctionBegin;
  *ended = (PetscBool)(PetscAbsReal(change) < set->tol);
  if (*ended) {
    PetscCall(PetscSNPrintf(method->message, sizeof(method->message), "the energy changed by less than %.6g in a step",
                            (double)set->tol));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlowState(EqmMethod method, EqmState state, PetscReal *time_step, PetscBool *ended)
{
  PetscFunctionBegin;
  PetscCall(EqmStateReal(state, "time_step", time_step));
  PetscCall(EqmStateBool(state, "ended", ended));
  if (EqmStateIsLoading(state) && *ended) PetscCall(EqmFlowJudge(method, 0., ended)); /* sets the message again */
  PetscFunctionReturn(0);
}
