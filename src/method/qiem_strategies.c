/* How the quasi-implicit Euler method chooses its time steps, and when it starts again (004 section 5). */
#include "method/qiem.h"
#include <string.h>

enum { MOST_STEPS_IN_PHASE1 = 10, MOST_CUTS = 3, MOST_SHRINKS = 10 };
static const PetscReal collapsed = .5, near_enough = .1; /* epsilon_2 and epsilon_3 of S1.a and S1.c */

/* Is the strategy among those that -qiem_phase1 or -qiem_phase2 lists? */
static PetscBool Uses(const char *strategies, char letter)
{
  return (PetscBool)(strchr(strategies, letter) != NULL);
}

/* Back to the first map of the phase, with the given first time step, unless the present one is shorter already. */
static PetscErrorCode Restart(EqmMethod method, EqmIterate iterate, PetscReal dt0)
{
  EqmQiem *const q = method->data;

  PetscFunctionBegin;
  q->dt0 = dt0;
  q->dt = PetscMin(q->dt, dt0);
  q->steps = q->cuts = 0;
  q->change = -1.;
  q->restarts++;
  PetscCall(EqmPlaceCopy(method->problem->domain, &q->start, &iterate->place));
  PetscCall(EqmFlowEnergy(method->problem, &iterate->place, &q->energy));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmQiemJudgePhase1(EqmMethod method, EqmIterate iterate, PetscReal energy, EqmQiemVerdict *verdict)
{
  EqmQiem *const q = method->data;
  const char *const strategies = q->phase1;

  PetscFunctionBegin;
  *verdict = EQM_QIEM_AGAIN;
  if (Uses(strategies, 'a') && energy < collapsed) {
    PetscCall(Restart(method, iterate, .5 * q->dt));
  } else if (Uses(strategies, 'b') && !(energy <= q->energy) && q->dt > 1.) {
    q->dt = PetscMax(1., .5 * q->dt);
  } else {
    *verdict = EQM_QIEM_TAKE;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmQiemAfterPhase1(EqmMethod method, EqmIterate iterate, PetscReal change)
{
  EqmQiem *const q = method->data;

  PetscFunctionBegin;
  if (PetscAbsReal(change) < near_enough) {
    q->phase = 2;
    q->dt = q->dt0;
    q->steps = q->restarts = 0;
    q->change = -1.;
    PetscCall(EqmPlaceCopy(method->problem->domain, &iterate->place, &q->start));
  } else if (Uses(q->phase1, 'c') && q->steps > MOST_STEPS_IN_PHASE1 && q->dt != q->dt0) {
    PetscCall(Restart(method, iterate, q->dt));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmQiemJudgePhase2(EqmMethod method, EqmIterate iterate, PetscReal energy, EqmQiemVerdict *verdict)
{
  EqmQiem *const q = method->data;

  PetscFunctionBegin;
  *verdict = EQM_QIEM_AGAIN;
  if (Uses(q->phase2, 'a') && !(energy - q->energy < q->rise)) {
    q->dt *= .5;
    if (Uses(q->phase2, 'b') && ++q->cuts >= MOST_CUTS) PetscCall(Restart(method, iterate, q->dt0 / q->factor));
  } else if (Uses(q->phase2, 'c') && q->change > 0. && PetscAbsReal(energy - q->energy) >= 10. * q->change &&
             q->shrinks++ < MOST_SHRINKS) {
    q->dt /= q->factor;
  } else {
    *verdict = EQM_QIEM_TAKE;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmQiemAfterPhase2(EqmMethod method, EqmIterate iterate, PetscReal change)
{
  EqmQiem *const q = method->data;

  PetscFunctionBegin;
  if (Uses(q->phase2, 'c') && q->change > 0.) q->dt = PetscMin(q->most_dt, q->dt * q->factor);
  q->change = PetscAbsReal(change);
  q->cuts = q->shrinks = 0;
  PetscCall(EqmFlowJudge(method, change, &q->ended));
  PetscFunctionReturn(0);
}
