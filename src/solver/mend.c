/* The energy of a map to the ball carries the volume A of the image: E = A Var(ratios). Where many cells hang on the
   boundary alone the variance cannot become small, and E falls without end if the boundary draws together in a cap of
   the sphere: the cells between the cap's chords keep their orientation, their volumes vanish, and so does E. That is
   no map of the solid to the ball; the boundary triangles on the lens' lower side are turned over. */
#include "solver/mend.h"
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"
#include "unfold/unfold.h"

/* Polyhedra in the sphere with n vertices hold at most about 1 - 4.7 / n of the ball (an icosahedron .605, an
   octahedron .318, a tetrahedron .123): a map with less than half of this is collapsed. */
static PetscReal LeastVolume(EqmSolver solver)
{
  const PetscReal most = 1. - 4.7 / (PetscReal)solver->mesh->num_boundary_vertices;

  return .5 * PetscMax(.12, most) * solver->problem->domain->target_measure;
}

static PetscErrorCode CountFolds(EqmSolver solver, PetscInt64 *folds)
{
  PetscInt64 on_boundary = 0;

  PetscFunctionBegin;
  if (solver->mesh->cell_size == 4)
    PetscCall(EqmImageBoundaryFolds(solver->problem->domain, &solver->iterate->place, &on_boundary));
  *folds = solver->iterate->totals.folds + on_boundary;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverHasCollapsed(EqmSolver solver, PetscBool *collapsed)
{
  PetscInt64 folds;

  PetscFunctionBegin;
  *collapsed = PETSC_FALSE;
  if (solver->mesh->cell_size == 3 || solver->problem->unfolding != EQM_UNFOLD_AUTO ||
      solver->iterate->totals.total >= LeastVolume(solver))
    PetscFunctionReturn(0);
  PetscCall(CountFolds(solver, &folds));
  *collapsed = (PetscBool)(folds > solver->iterate->totals.folds);
  PetscFunctionReturn(0);
}

/* How folds are mended; NULL: not at all. */
static EqmUnfold FindUnfold(EqmSolver solver)
{
  const EqmUnfolding how = solver->problem->unfolding;

  if (how == EQM_UNFOLD_PAPER) return solver->formulation->unfold_as_printed;
  return how == EQM_UNFOLD_AUTO ? solver->formulation->unfold : NULL;
}

static PetscErrorCode Unfold(EqmSolver solver, const char *when)
{
  const EqmUnfold unfold = FindUnfold(solver);
  EqmIterate const iterate = solver->iterate;

  PetscFunctionBegin;
  PetscCall(unfold(solver->problem, iterate, &iterate->unfolded_from, &iterate->unfolded_to));
  PetscCall(EqmIterateUpdate(solver->problem, iterate));
  PetscCall(EqmSolverNotifyUnfolded(solver, when));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverBeginAgain(EqmSolver solver)
{
  PetscFunctionBegin;
  PetscCall(EqmProblemNotify(solver->problem,
                             "the boundary has collapsed, the image has %.2g of the ball's volume: once more from the "
                             "start, held by a barrier\n",
                             (double)(solver->iterate->totals.total / solver->problem->domain->target_measure)));
  PetscCall(EqmSolverMakeFirstMap(solver));
  PetscCall(EqmIterateUpdate(solver->problem, solver->iterate));
  PetscCall(Unfold(solver, "at the start"));
  solver->iterate->number++;
  solver->begun_again = solver->num_history;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverMend(EqmSolver solver, const char *when, PetscBool *unfolded)
{
  PetscBool stop = PETSC_FALSE;
  PetscInt64 folds;

  PetscFunctionBegin;
  *unfolded = PETSC_FALSE;
  if (!FindUnfold(solver)) PetscFunctionReturn(0);
  PetscCall(CountFolds(solver, &folds));
  if (folds == 0) PetscFunctionReturn(0);
  PetscCall(EqmCheckpointStopRequested(solver, &stop));
  if (stop) PetscFunctionReturn(0);
  PetscCall(EqmPhaseBegin(solver->mesh->ledger, EQM_PHASE_MINIMISE));
  PetscCall(Unfold(solver, when));
  PetscCall(EqmPhaseEnd(solver->mesh->ledger, EQM_PHASE_MINIMISE));
  *unfolded = PETSC_TRUE;
  PetscFunctionReturn(0);
}
