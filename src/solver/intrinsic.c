/* Conformal maps of closed surfaces that fold, or that have cells too small for the arithmetic: computed again on the
   intrinsic Delaunay triangulation (docs/methods.md, Thin limbs). */
#include "solver/solver_private.h"
#include "solver/mend.h"
#include "base/quiet.h"
#include "domain/domain_private.h"
#include <string.h>

/* Set the solver's map to one of another mesh with the same vertices: normalised, and unfolded if necessary. */
static PetscErrorCode SetImages(EqmSolver solver, EqmProblem other, EqmIterate found, EqmSoup flipped)
{
  const EqmSoup soup = solver->mesh->soup;
  const EqmProblem problem = solver->problem;
  const EqmIterate iterate = solver->iterate;
  PetscBool unfolded;
  PetscReal *slab;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * (soup->vertex_end - soup->vertex_start), &slab));
  PetscCall(EqmMeshVerticesToInput(other->mesh, flipped, 3, found->place.x, slab));
  PetscCall(EqmMeshVerticesFromInput(solver->mesh, soup, 3, slab, iterate->place.x));
  PetscCall(PetscFree(slab));
  PetscCall(EqmPlaceMakeFrames(problem->domain, &iterate->place));
  PetscCall(solver->formulation->finish(solver));
  PetscCall(EqmIterateUpdate(problem, iterate));
  PetscCall(EqmSolverMend(solver, "of what is left", &unfolded));
  PetscFunctionReturn(0);
}

/* Accept the new map if it folds no more than the old one, which has folds or did not converge. */
static PetscErrorCode AcceptIfBetter(EqmSolver solver, EqmProblem other, EqmIterate found, EqmSoup flipped)
{
  const EqmIterate iterate = solver->iterate;
  const EqmDomain domain = solver->problem->domain;
  const PetscInt64 folds = iterate->totals.folds;
  EqmPlace before;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(domain, &before));
  PetscCall(EqmPlaceCopy(domain, &iterate->place, &before));
  PetscCall(SetImages(solver, other, found, flipped));
  if (iterate->totals.folds > folds) {
    PetscCall(EqmPlaceCopy(domain, &before, &iterate->place));
    PetscCall(EqmIterateUpdate(solver->problem, iterate));
  } else if (iterate->totals.folds == 0) {
    solver->status = EQM_STATUS_CONVERGED;
    PetscCall(
        PetscStrncpy(solver->message, "harmonic on the intrinsic Delaunay triangulation", sizeof(solver->message)));
  }
  PetscCall(EqmPlaceDestroy(&before));
  PetscFunctionReturn(0);
}

/* A first map of the flipped mesh, if its cells allow one: the solver has a map already. Collective. */
static PetscErrorCode StartFlipped(EqmProblem problem, EqmIterate found, PetscBool *made)
{
  char message[EQM_MESSAGE_MAX] = "";
  EqmStartOptions options;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(EqmStartOptionsDefault(&options));
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmStartRun(&EqmStartSphereResolved, problem, found, &options);
  PetscCall(PetscPopErrorHandler());
  PetscCheck(!error || error == EQM_ERR_MESH, problem->comm, error, "%s", message);
  *made = (PetscBool)!error;
  if (error) PetscCall(EqmProblemNotify(problem, "no map there: %s\n", message));
  PetscFunctionReturn(0);
}

/* The map of the flipped mesh. Two of its triangles may have the same corners, so folds are not counted there. */
static PetscErrorCode SolveFlipped(EqmSolver solver, EqmSoup flipped)
{
  const EqmLedger ledger = solver->mesh->ledger;
  EqmMesh mesh;
  EqmDomain domain;
  EqmProblem problem;
  EqmIterate found;
  PetscBool made;

  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(EqmMeshCreate(flipped, ledger, &mesh));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_START));
  PetscCall(EqmDomainCreateSphere(mesh, &domain));
  PetscCall(EqmProblemCreate(domain, solver->problem->objective, &problem));
  PetscCall(EqmIterateCreate(problem, &found));
  PetscCall(StartFlipped(problem, found, &made));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_START));
  if (made) PetscCall(AcceptIfBetter(solver, problem, found, flipped));
  PetscCall(EqmIterateDestroy(&found));
  PetscCall(EqmProblemDestroy(&problem));
  PetscCall(EqmMeshDestroy(&mesh));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverStraighten(EqmSolver solver)
{
  const PetscBool can = (PetscBool)(!strcmp(solver->target, "conformal") && solver->problem->domain->curved_image &&
                                    solver->status != EQM_STATUS_STOPPED && solver->settings.normalise.intrinsic &&
                                    !strcmp(solver->defaults.name, solver->formulation->methods[0].name));
  const EqmIterate iterate = solver->iterate;
  EqmSoup flipped;
  PetscInt64 flips;
  PetscReal smallest;

  PetscFunctionBegin;
  if (!can) PetscFunctionReturn(0);
  PetscCall(EqmSphereSmallestImage(solver->problem, &iterate->place, &smallest));
  const PetscBool jammed = (PetscBool)(solver->checkpoints.finished && solver->status == EQM_STATUS_NOT_CONVERGED);
  if (iterate->totals.folds == 0 && !jammed && smallest >= EqmSmallestImage) PetscFunctionReturn(0);
  PetscCall(EqmSoupFlip(solver->mesh->soup, &flipped, &flips));
  PetscCall(EqmProblemNotify(solver->problem,
                             "%" PetscInt64_FMT " folds, smallest image triangle %.1e: once more on the intrinsic "
                             "Delaunay triangulation, %" PetscInt64_FMT " edges flipped\n",
                             iterate->totals.folds, (double)smallest, flips));
  PetscCall(SolveFlipped(solver, flipped));
  PetscCall(EqmSoupDestroy(&flipped));
  iterate->number++;
  PetscCall(EqmHistoryAddRow(solver));
  PetscCall(EqmSolverCallMonitor(solver, EQM_MONITOR_END, solver->message));
  PetscFunctionReturn(0);
}
