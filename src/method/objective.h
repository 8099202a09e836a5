/* The energies of the table of problems: the sums that a map is judged by, and, for the methods of descent, what they
   minimise and the metric that suits it. */
#ifndef EQM_OBJECTIVE_H
#define EQM_OBJECTIVE_H

#include <equimap/solver.h>

typedef struct {
  /* Totals from place and image: areas or volumes, folds, the energy. Collective. */
  PetscErrorCode (*sum)(EqmSolver);
  PetscReal poor_energy; /* a stagnating map with more than this, per target measure, is no success; 0: any may be */
  /* Value at a place and, unless NULL, gradient in degrees of freedom; `image` returns the measures of the image cells.
     Counts an evaluation. Collective. */
  PetscErrorCode (*evaluate)(EqmSolver, const EqmPlace *place, PetscReal *image, PetscReal *value, Vec gradient);
  /* A scalar Laplacian close to the Hessian at the present map, coordinate by coordinate: edge weights and a mass per
     local cell, which `with_mass` says are to be used. Not collective. */
  PetscErrorCode (*metric)(EqmSolver, PetscReal *weights, PetscReal *mass, PetscBool *with_mass);
  PetscBool fixed_metric;  /* it does not depend on the map: one factorisation will do */
  PetscReal inverse_scale; /* the inverse Hessian is about this times the inverse metric times the target's measure */
  /* The largest t in (0, 1] for which no cell folds on the way along t times `direction`; NULL: do not ask. Collective.
   */
  PetscErrorCode (*longest_step)(EqmSolver, Vec direction, PetscReal *t);
} EqmObjective;

PETSC_INTERN const EqmObjective EqmObjectiveAuthalic, EqmObjectiveConformal;

/* Totals of the areas or volumes: the normalised authalic or isovolumetric energy. Collective. */
PETSC_INTERN PetscErrorCode EqmSumMeasures(EqmSolver solver);

/* ---- angles (src/method/conformal.c) */
/* Cotangent weights of the mesh, 3 per local cell; made at the first need and kept. Collective. */
PETSC_INTERN PetscErrorCode EqmAngleWeights(EqmSolver solver, const PetscReal **weights);
/* Lumped weights of the vertices, which add up to one; made at the first need and kept. Collective. */
PETSC_INTERN PetscErrorCode EqmVertexMass(EqmSolver solver, const PetscReal **mass);

/* The Mobius map that brings the mass centre of a map to the sphere to the sphere's own, 004 Definition 2.3
   (src/method/normalise.c). Collective. */
PETSC_INTERN PetscErrorCode EqmMoebiusCenter(EqmSolver solver);
/* The Mobius map after which the normalised authalic energy is least (src/method/moebius_area.c). Collective. */
PETSC_INTERN PetscErrorCode EqmMoebiusLeastArea(EqmSolver solver, EqmPlace *place);
/* The Mobius map that makes an angle-preserving map of a closed surface unique (src/method/normalise.c). Collective. */
PETSC_INTERN PetscErrorCode EqmConformalFinish(EqmSolver solver);
/* Options for it. Collective. */
PETSC_INTERN PetscErrorCode EqmMoebiusAsk(EqmSolver solver, PetscOptionItems *PetscOptionsObject);

#endif
