/* The options of one problem only: each row of the table asks for its own. */
#include "method/method.h"

PetscErrorCode EqmAskCorners(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSettings *const set = &solver->settings;
  PetscInt num_corners = 4;

  PetscFunctionBegin;
  PetscCall(PetscOptionsIntArray("-corners",
                                 "four boundary vertices (input numbers from 0) for (0,0), (1,0), (1,1), (0,1)",
                                 "EqmSolverSetFromOptions", set->corners, &num_corners, &set->has_corners));
  if (set->has_corners && num_corners != 4)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-corners: give four vertex numbers, i,j,k,l; there are %" PetscInt_FMT,
            num_corners);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmAskCenter(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSettings *const set = &solver->settings;

  PetscFunctionBegin;
  PetscCall(PetscOptionsBool("-start_center",
                             "after the first map the Mobius map that brings its mass centre to the sphere's",
                             "EqmSolverSetFromOptions", set->center_start, &set->center_start, NULL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmAskConformal(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  solver->settings.lbfgs_memory = 8; /* the method's own options ask next and show this as their default */
  PetscCall(EqmAskCenter(solver, PetscOptionsObject));
  PetscCall(EqmMoebiusAsk(solver, PetscOptionsObject));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmAskBall(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSettings *const set = &solver->settings;

  PetscFunctionBegin;
  set->lbfgs_memory = 20; /* the methods' own options ask next and show these as their defaults */
  set->lbfgs_line_search = (PetscEnum)EQM_SEARCH_WOLFE;
  PetscCall(PetscOptionsBool("-anisotropic_scaling",
                             "start: turn and scale the solid to fill a cube, axis by axis, before its first map",
                             "EqmSolverSetFromOptions", set->anisotropic_scaling, &set->anisotropic_scaling, NULL));
  PetscCall(PetscOptionsString(
      "-boundary_method",
      "start: the method that maps the surface to the sphere (else the sphere's own; of fixed-point: the same)",
      "EqmSolverSetFromOptions", set->boundary_method, set->boundary_method, sizeof(set->boundary_method), NULL));
  PetscCall(PetscOptionsString("-boundary_start", "start: the first map of the surface to the sphere",
                               "EqmSolverSetFromOptions", set->boundary_start, set->boundary_start,
                               sizeof(set->boundary_start), NULL));
  PetscCall(PetscOptionsInt("-boundary_max_it", "start: so many iterations for the surface (-1: until its map is good)",
                            "EqmSolverSetFromOptions", set->boundary_max_it, &set->boundary_max_it, NULL));
  PetscFunctionReturn(0);
}
