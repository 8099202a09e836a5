/* The heat flow of harmonic maps to the sphere, df/dt = -(A f - <A f, f> f), which the Euler methods follow (004 (7)).
   A is the mesh's cotangent Laplacian; time has no unit, as A has none. */
#ifndef EQM_FLOW_H
#define EQM_FLOW_H

#include "method/method.h"

/* Settings of the three methods; the first member of their data. */
typedef struct {
  PetscReal step, tol; /* -flow_step, -flow_tol */
  PetscBool moebius;   /* -flow_moebius */
} EqmFlowSettings;

/* Default of -flow_tol. */
#define EQM_FLOW_TOL 1e-9

/* (A f)_i per owned vertex, and unless NULL <A f, f>_i = (A f)_i . f_i (004 Definition 3.1). Not collective. */
PETSC_INTERN PetscErrorCode EqmFlowLaplacian(EqmProblem problem, const EqmPlace *place, PetscReal *af,
                                             PetscReal *normal);
/* Norm of the flow's velocity. Collective. */
PETSC_INTERN PetscErrorCode EqmFlowSpeed(EqmProblem problem, const EqmPlace *place, PetscReal *speed);
/* Subtract the mass centre and go back to the sphere (004 Algorithm 5.1, lines 9 and 10), or instead go back and centre
   by a Mobius map. Collective. */
PETSC_INTERN PetscErrorCode EqmFlowNormalise(EqmProblem problem, PetscBool moebius, EqmPlace *place);
/* The Dirichlet energy. Counts an evaluation. Collective. */
PETSC_INTERN PetscErrorCode EqmFlowEnergy(EqmProblem problem, const EqmPlace *place, PetscReal *energy);
/* `place` becomes the present map, reached by a time step. Collective. */
PETSC_INTERN PetscErrorCode EqmFlowAccept(EqmProblem problem, EqmIterate iterate, const EqmPlace *place,
                                          PetscReal time_step);
/* ||to - from||_F in the scale of 004 (11), in which ||f||_F is one. Collective. */
PETSC_INTERN PetscErrorCode EqmFlowChange(EqmProblem problem, const EqmPlace *from, const EqmPlace *to,
                                          PetscReal *change);
/* The options -flow_*, which the three methods share. Collective. */
PETSC_INTERN PetscErrorCode EqmFlowSetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject);
/* For the `state` of the three methods: the time step, and whether the method has converged. Collective. */
PETSC_INTERN PetscErrorCode EqmFlowState(EqmMethod method, EqmState state, PetscReal *time_step, PetscBool *ended);
/* Has the energy changed by less than -flow_tol? Then the method has converged and the message says so. Not collective.
 */
PETSC_INTERN PetscErrorCode EqmFlowJudge(EqmMethod method, PetscReal change, PetscBool *ended);

/* ---- the system of an implicit Euler step (src/method/euler_implicit.c) */
typedef struct {
  EqmProblem problem;
  const PetscReal *weights; /* of EqmProblemGetAngleWeights */
  const EqmPlace *place;    /* the unknown f' */
  PetscReal dt;
} EqmImplicitStep;
/* F(f') = f' - f + dt (A f' - <A f', f'> f') for the step from f (004 (8)); 3 per owned vertex. Not collective. */
PETSC_INTERN PetscErrorCode EqmImplicitResidual(const EqmImplicitStep *step, const EqmPlace *from, PetscReal *residual);
/* A cell's part of dF/df' less the identity (004 Appendix): an EqmCellMatrix whose context is an EqmImplicitStep. */
PETSC_INTERN void EqmImplicitCell(void *context, PetscInt cell, PetscReal *matrix);

#endif
