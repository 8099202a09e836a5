/* The two phases of the quasi-implicit Euler method (004 Algorithm 5.1) and the strategies that choose their time steps
   (004 section 5, S1.a to S2.c). */
#ifndef EQM_QIEM_H
#define EQM_QIEM_H

#include "method/flow.h"

typedef struct {
  EqmFlowSettings flow;
  char phase1[8], phase2[8]; /* letters of the strategies in use */
  PetscReal factor, rise;    /* alpha and epsilon */
  EqmGeneral matrix;
  EqmUnknowns unknowns;
  PetscInt phase, steps, cuts, shrinks, restarts;
  PetscReal dt, dt0, most_dt; /* present, first of this attempt, largest of phase II */
  PetscReal energy, change;   /* of the present map, and by the last step; change < 0: no step yet */
  PetscReal factored;         /* phase I: the time step that the factor belongs to */
  PetscBool ended;
  EqmPlace start, trial;
  const PetscReal *weights;
  PetscReal *columns;
} EqmQiem;

/* Accept a trial, or repeat the step with other parameters. */
typedef enum { EQM_QIEM_TAKE, EQM_QIEM_AGAIN } EqmQiemVerdict;

/* S1.a: a map that collapses to a point; S1.b: an energy that does not fall. Collective. */
PETSC_INTERN PetscErrorCode EqmQiemJudgePhase1(EqmMethod method, EqmIterate iterate, PetscReal energy,
                                               EqmQiemVerdict *verdict);
/* The end of phase I, or S1.c: a restart when it takes too long, unless the restart would repeat the same steps.
 * Collective. */
PETSC_INTERN PetscErrorCode EqmQiemAfterPhase1(EqmMethod method, EqmIterate iterate, PetscReal change);
/* S2.a: halve the step where the energy rises; S2.b: after three halvings restart with a smaller first step; S2.c: a
 * shorter step where the energy changed ten times as much as before, a limited number of times: the change before may
 * have been negligible. Collective. */
PETSC_INTERN PetscErrorCode EqmQiemJudgePhase2(EqmMethod method, EqmIterate iterate, PetscReal energy,
                                               EqmQiemVerdict *verdict);
/* The other half of S2.c, a longer step next time; convergence. Collective. */
PETSC_INTERN PetscErrorCode EqmQiemAfterPhase2(EqmMethod method, EqmIterate iterate, PetscReal change);

#endif
