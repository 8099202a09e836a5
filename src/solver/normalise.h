/* Which of the angle-preserving maps of a closed surface, which are unique up to Moebius maps, a run ends with. */
#ifndef EQM_NORMALISE_H
#define EQM_NORMALISE_H

#include <equimap/solver.h>
#include "problem/problem.h"

typedef struct {
  PetscEnum moebius; /* -moebius */
  PetscBool has_fix, align_rigid, intrinsic;
  PetscInt fix[3];
  PetscReal fix_points[9];
  char align[PETSC_MAX_PATH_LEN];
} EqmNormaliseSettings;

PETSC_INTERN PetscErrorCode EqmNormaliseSettingsDefault(EqmNormaliseSettings *set);
/* Read the options; `mesh` (NULL: not known yet) tells whether they are possible. Errors: EQM_ERR_USAGE. Collective. */
PETSC_INTERN PetscErrorCode EqmNormaliseSetFromOptions(MPI_Comm comm, EqmMesh mesh, EqmNormaliseSettings *set,
                                                       PetscOptionItems *PetscOptionsObject);
/* The Moebius map that makes an angle-preserving map of a closed surface unique. Collective. */
PETSC_INTERN PetscErrorCode EqmConformalFinish(EqmSolver solver);
/* The Moebius map after which the normalised authalic energy is least (moebius_area.c). Collective. */
PETSC_INTERN PetscErrorCode EqmMoebiusLeastArea(EqmProblem problem, EqmPlace *place);

#endif
