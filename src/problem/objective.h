/* The energies: the sums that a map is judged by, and, for the methods of descent, what they minimise and the metric
   that suits it. */
#ifndef EQM_OBJECTIVE_H
#define EQM_OBJECTIVE_H

#include "problem/problem.h"
#include "energy/curvature.h"

struct EqmObjective {
  const char *name;
  PetscBool planar_only; /* for maps to the disk and the square */
  /* Totals from place and image: areas or volumes, folds, the energy. Collective. */
  PetscErrorCode (*sum)(EqmProblem, EqmIterate);
  PetscReal poor_energy; /* a stagnating map with more than this, per target measure, is no success; 0: any may be */
  /* Value at a place and, unless NULL, gradient in degrees of freedom; `image` returns the measures of the image cells.
     The iterate is the map that a step is tried from. EqmProblemEvaluate, which calls it, counts. Collective. */
  PetscErrorCode (*evaluate)(EqmProblem, EqmIterate, const EqmPlace *place, PetscReal *image, PetscReal *value,
                             Vec gradient);
  /* Set a cell's part of the Hessian at the iterate, in the degrees of freedom of its corners; what couples all cells
     (a total) may be left out. NULL: only methods that need no second derivatives. Not collective. */
  void (*set_hessian)(EqmProblem, EqmIterate, PetscInt cell, const EqmCellDerivatives *derivatives, PetscReal *matrix);
  PetscBool of_ratios; /* it is least where all ratios are one: residuals of ratios (residual.h) may stand for it */
  /* A scalar Laplacian close to the Hessian at a place, coordinate by coordinate: edge weights and a mass per local
     cell, which `with_mass` says are to be used. Not collective. */
  PetscErrorCode (*metric)(EqmProblem, const EqmPlace *place, PetscReal *weights, PetscReal *mass,
                           PetscBool *with_mass);
  PetscBool fixed_metric;  /* it does not depend on the map: one factorisation will do */
  PetscReal inverse_scale; /* the inverse Hessian is about this times the inverse metric times the target's measure */
  /* The largest t in (0, 1] for which no cell of the iterate folds on the way along t times `direction`; NULL: there is
     no such limit. Collective. */
  PetscErrorCode (*longest_step)(EqmProblem, EqmIterate, Vec direction, PetscReal *t);
};

PETSC_INTERN const EqmObjective EqmObjectiveAuthalic, EqmObjectiveConformal, EqmObjectiveSymmetricDirichlet;

/* Make an objective known; it must outlive the program's use of it (objectives.c). Not collective. */
PETSC_EXTERN PetscErrorCode EqmObjectiveRegister(const EqmObjective *objective);
/* Errors: EQM_ERR_USAGE (no such objective). Collective. */
PETSC_INTERN PetscErrorCode EqmObjectiveFind(MPI_Comm comm, const char *name, const EqmObjective **objective);

/* Totals of the areas or volumes: the normalised authalic or isovolumetric energy. Collective. */
PETSC_INTERN PetscErrorCode EqmSumMeasures(EqmProblem problem, EqmIterate iterate);

#endif
