/* Conformal maps of closed surfaces that fold, or that have cells too small for the arithmetic: once more on the
   intrinsic Delaunay triangulation (docs/methods.md, Thin limbs). */
#include "method/method.h"
#include <string.h>

/* The places that another solver, on another mesh of the same vertices, has found. */
static PetscErrorCode TakePlaces(EqmSolver solver, EqmSoup soup, EqmSolver other, EqmSoup other_soup)
{
  PetscReal *slab;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * (soup->vertex_end - soup->vertex_start), &slab));
  PetscCall(EqmMeshVerticesToInput(other->mesh, other_soup, 3, other->place.x, slab));
  PetscCall(EqmMeshVerticesFromInput(solver->mesh, soup, 3, slab, solver->place.x));
  PetscCall(PetscFree(slab));
  PetscCall(EqmPlaceMakeFrames(solver->domain, &solver->place));
  if (solver->problem->finish) PetscCall(solver->problem->finish(solver));
  PetscCall(EqmSolverLook(solver));
  if (solver->totals.folds == 0) PetscFunctionReturn(0);
  PetscCall(solver->problem->unfold(solver, &solver->unfolded_from, &solver->unfolded_to));
  PetscCall(EqmSolverLook(solver));
  PetscCall(EqmMonitorUnfolded(solver, "of what is left"));
  PetscFunctionReturn(0);
}

/* Where the new map folds no more than the old one, which has jammed or worse, it is taken. */
static PetscErrorCode TakeIfBetter(EqmSolver solver, EqmSoup soup, EqmSolver other, EqmSoup other_soup)
{
  const PetscInt64 folds = solver->totals.folds;
  EqmPlace before;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(solver->domain, &before));
  PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &before));
  PetscCall(TakePlaces(solver, soup, other, other_soup));
  if (solver->totals.folds > folds) {
    PetscCall(EqmPlaceCopy(solver->domain, &before, &solver->place));
    PetscCall(EqmSolverLook(solver));
  } else if (solver->totals.folds == 0) {
    solver->status = EQM_STATUS_CONVERGED;
    PetscCall(
        PetscStrncpy(solver->message, "harmonic on the intrinsic Delaunay triangulation", sizeof(solver->message)));
  }
  PetscCall(EqmPlaceDestroy(&before));
  PetscFunctionReturn(0);
}

/* The map on the flipped mesh. Two of its triangles may have the same corners: folds mean nothing there. */
static PetscErrorCode SolveFlipped(EqmSolver solver, EqmSoup soup, EqmSoup flipped)
{
  EqmMesh mesh;
  EqmSolver other;

  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(solver->mesh->ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(EqmMeshCreate(flipped, solver->mesh->ledger, &mesh));
  PetscCall(EqmPhaseEnd(solver->mesh->ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(EqmSolverCreate(mesh, solver->target, &other));
  other->method = solver->method;
  other->settings.quiet = solver->settings.quiet;
  PetscCall(PetscStrncpy(other->settings.start, "resolved", sizeof(other->settings.start)));
  PetscCall(EqmSolverBegin(other));
  PetscCall(TakeIfBetter(solver, soup, other, flipped));
  PetscCall(EqmSolverDestroy(&other));
  PetscCall(EqmMeshDestroy(&mesh));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverStraighten(EqmSolver solver, EqmSoup soup)
{
  const PetscBool can =
      (PetscBool)(!strcmp(solver->target, "conformal") && solver->domain->curved_image &&
                  solver->status != EQM_STATUS_STOPPED && solver->method == solver->problem->offers[0].method);
  EqmSoup flipped;
  PetscInt64 flips;
  PetscReal smallest;

  PetscFunctionBegin;
  if (!can) PetscFunctionReturn(0);
  PetscCall(EqmSphereSmallestImage(solver, &smallest));
  const PetscBool jammed = (PetscBool)(solver->checkpoints.finished && solver->status == EQM_STATUS_NOT_CONVERGED);
  if (solver->totals.folds == 0 && !jammed && smallest >= EqmSmallestImage) PetscFunctionReturn(0);
  PetscCall(EqmSoupFlip(soup, &flipped, &flips));
  if (!solver->settings.quiet) {
    PetscCall(PetscPrintf(solver->comm,
                          "%" PetscInt64_FMT " folds, smallest image triangle %.1e: once more on the intrinsic "
                          "Delaunay triangulation, %" PetscInt64_FMT " edges flipped\n",
                          solver->totals.folds, (double)smallest, flips));
  }
  PetscCall(SolveFlipped(solver, soup, flipped));
  PetscCall(EqmSoupDestroy(&flipped));
  solver->iteration++;
  PetscCall(EqmMonitorRow(solver));
  PetscCall(EqmMonitorEnd(solver));
  PetscFunctionReturn(0);
}
