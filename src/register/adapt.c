/* The map h of the target to itself: a rotation, a flow, and the minimisation that makes the landmarks meet. */
#include "register/registration.h"
#include "mesh/gather.h"
#include "mesh/mesh_private.h"
#include "register/closest.h"
#include "register/landmark_flow.h"
#include "geometry/rotation.h"
#include "solver/inner.h"
#include <string.h>

/* 000 section 6: the rotation of A's map that brings the landmarks closest to their goals, each with its weight.
   Collective. */
PetscErrorCode EqmRotateOntoLandmarks(EqmRegistration r)
{
  const PetscInt num = r->landmarks.num, dim = r->dim;
  PetscReal *place, correlation[9] = {0.}, rotation[9];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(dim * num, &place));
  PetscCall(EqmMeshGatherVertices(r->a.mesh, num, r->landmarks.vertex, dim, r->a.x, place, NULL));
  for (PetscInt k = 0; k < dim * dim * num; k++) {
    const PetscInt p = k / (dim * dim), i = k / dim % dim, j = k % dim;
    correlation[dim * i + j] += r->landmarks.weight[p] * r->goal[dim * p + i] * place[dim * p + j];
  }
  PetscCall(EqmBestRotation(dim, correlation, rotation));
  EqmRotate(dim, rotation, r->a.mesh->num_local, r->a.x);
  PetscCall(PetscFree(place));
  PetscFunctionReturn(0);
}

/* Is the boundary to be held, h_B = R f_B? The methods of 000 section 6 want it so. */
static PetscErrorCode HoldsBoundary(EqmRegistration r, EqmSolver solver, PetscBool *held)
{
  const char *name;

  PetscFunctionBegin;
  PetscCall(EqmSolverGetMethodName(solver, &name));
  *held = (PetscBool)(r->kind == EQM_IMAGE_PLANE && r->set.boundary != EQM_BOUNDARY_FREE);
  if (r->set.boundary == EQM_BOUNDARY_AUTO)
    *held = (PetscBool)(*held && (!strcmp(name, "fixed-point") || !strcmp(name, "ncg")));
  PetscFunctionReturn(0);
}

/* A solver for h o f from the present places, with the landmarks drawn to `goal`; `steps` of the fixed-point iteration
   (49), or as the options have it (0). Collective. */
static PetscErrorCode CreateSolver(EqmRegistration r, EqmSide *side, const PetscInt *vertices, const PetscReal *goal,
                                   PetscReal weight, PetscInt steps, PetscBool *held, EqmSolver *solver)
{
  PetscFunctionBegin;
  PetscCall(EqmSolverCreate(side->mesh, r->target, solver));
  PetscCall(EqmSolverSetTolerances(*solver, PETSC_DEFAULT, EQM_REGISTER_RATIO_TOL, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(EqmSolverSetMonitor(*solver, EqmSolverMonitorText, NULL));
  PetscCall(EqmSolverSetFromOptions(*solver));
  PetscCall(HoldsBoundary(r, *solver, held));
  if (steps > 0) {
    PetscCall(EqmSolverSetMethod(*solver, "fixed-point"));
    PetscCall(EqmSolverSetTolerances(*solver, 0., 0., 0., steps));
  }
  if (*held) PetscCall(EqmSolverHoldBoundary(*solver));
  PetscCall(EqmSolverSetFirstMap(*solver, r->dim, side->x));
  PetscCall(EqmSolverSetLandmarks(*solver, r->landmarks.num, r->dim, vertices, goal, r->landmarks.weight, weight,
                                  r->set.tolerance));
  PetscFunctionReturn(0);
}

/* Minimise the area energy of h o f with the landmarks drawn to `goal`, from the present places. Collective. */
static PetscErrorCode MinimiseOnce(EqmRegistration r, EqmSide *side, const PetscInt *vertices, const PetscReal *goal,
                                   PetscReal weight, PetscInt steps, PetscBool *reached)
{
  EqmSolver solver;
  const EqmPlace *place;
  PetscBool held;

  PetscFunctionBegin;
  PetscCall(CreateSolver(r, side, vertices, goal, weight, steps, &held, &solver));
  if (!r->set.quiet)
    PetscCall(PetscPrintf(r->comm, "h for %s: landmarks drawn with weight %.6g%s\n", side->name, (double)weight,
                          held ? ", boundary held" : ""));
  PetscCall(EqmRegistrationMinimise(r, solver));
  PetscCall(EqmSolverLandmarksReached(solver, reached));
  PetscCall(EqmSolverGetPlaces(solver, &place));
  PetscCall(PetscArraycpy(side->x, place->x, r->dim * side->mesh->num_local));
  if (side->read == side->map) side->read = NULL;
  PetscCall(EqmMapDestroy(&side->map));
  PetscCall(EqmSolverGetMap(solver, side->intake.mapped, &side->map));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* Conjugate gradients with the boundary held begin after five steps of (49) (000 section 6). */
static PetscErrorCode IsPrecededBySteps(EqmRegistration r, EqmSide *side, PetscBool *precedes)
{
  EqmSolver solver;
  const char *name;

  PetscFunctionBegin;
  PetscCall(EqmSolverCreate(side->mesh, r->target, &solver));
  PetscCall(EqmSolverSetFromOptions(solver));
  PetscCall(HoldsBoundary(r, solver, precedes));
  PetscCall(EqmSolverGetMethodName(solver, &name));
  *precedes = (PetscBool)(*precedes && !strcmp(name, "ncg"));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* Continuation: the weight grows tenfold until the landmarks are close enough. */
static PetscErrorCode Minimise(EqmRegistration r, EqmSide *side, const PetscInt *vertices, const PetscReal *goal)
{
  enum { FIRST_STEPS = 5 };
  PetscReal weight = r->set.weight;
  PetscBool reached = PETSC_FALSE, precedes;

  PetscFunctionBegin;
  PetscCall(IsPrecededBySteps(r, side, &precedes));
  if (precedes) PetscCall(MinimiseOnce(r, side, vertices, goal, weight, FIRST_STEPS, &reached));
  reached = PETSC_FALSE;
  for (PetscInt stage = 0; stage < r->set.stages && !reached && r->status != EQM_STATUS_STOPPED; stage++, weight *= 10.)
    PetscCall(MinimiseOnce(r, side, vertices, goal, weight, 0, &reached));
  PetscFunctionReturn(0);
}

/* Number of folded cells of the map with coordinates `x`. */
static PetscErrorCode CountFolds(EqmRegistration r, const EqmSide *side, const PetscReal *x, PetscInt64 *folds)
{
  PetscInt64 local = 0;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < side->mesh->num_owned_cells; c++) {
    const PetscReal *corner[4];
    for (PetscInt a = 0; a < side->mesh->cell_size; a++)
      corner[a] = x + r->dim * side->mesh->cells[side->mesh->cell_size * c + a];
    local += !(EqmSignedMeasure(r->kind, side->mesh->cell_size, corner) > 0.);
  }
  PetscCall(MPIU_Allreduce(&local, folds, 1, MPIU_INT64, MPI_SUM, r->comm));
  PetscFunctionReturn(0);
}

/* Move the landmarks towards their goals by the flow; if that adds folds, as in coarse triangles, the map is kept as it
   was. */
static PetscErrorCode Flow(EqmRegistration r, EqmSide *side, const PetscInt *vertices, const PetscReal *goal)
{
  const PetscInt length = r->dim * side->mesh->num_local;
  PetscReal *from, *moved;
  PetscInt64 before, after;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(r->dim * r->landmarks.num, &from, length, &moved));
  PetscCall(EqmMeshGatherVertices(side->mesh, r->landmarks.num, vertices, r->dim, side->x, from, NULL));
  PetscCall(PetscArraycpy(moved, side->x, length));
  PetscCall(EqmLandmarkFlow(r->dim, r->set.reach, r->landmarks.num, from, goal, side->mesh->num_local, moved,
                            &r->figures.start_left));
  PetscCall(CountFolds(r, side, side->x, &before));
  PetscCall(CountFolds(r, side, moved, &after));
  if (after <= before) PetscCall(PetscArraycpy(side->x, moved, length));
  if (!r->set.quiet)
    PetscCall(PetscPrintf(r->comm, "flow of %s: landmarks to within %.1e, %" PetscInt64_FMT " triangles folded%s\n",
                          side->name, (double)r->figures.start_left, after,
                          after <= before ? "" : ": not taken; a larger -landmark_reach is smoother"));
  PetscCall(PetscFree2(from, moved));
  PetscFunctionReturn(0);
}

static PetscErrorCode Move(EqmRegistration r, EqmSide *side, const PetscInt *vertices, const PetscReal *goal)
{
  PetscFunctionBegin;
  if (r->set.start == EQM_LANDMARKS_FLOW) PetscCall(Flow(r, side, vertices, goal));
  PetscCall(Minimise(r, side, vertices, goal));
  PetscFunctionReturn(0);
}

/* 001 section 6.6: both maps are moved half the way, to the midpoints between the landmarks. */
static PetscErrorCode MoveToMiddles(EqmRegistration r)
{
  const PetscInt num = r->landmarks.num, dim = r->dim;
  PetscReal *middle;
  PetscInt *of_b;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(dim * num, &middle, num, &of_b));
  PetscCall(EqmMeshGatherVertices(r->a.mesh, num, r->landmarks.vertex, dim, r->a.x, middle, NULL));
  for (PetscInt i = 0; i < num; i++) {
    PetscReal squared = 0., length;
    of_b[i] = (PetscInt)r->landmarks.other[i];
    for (PetscInt k = 0; k < dim; k++) {
      middle[dim * i + k] = .5 * (middle[dim * i + k] + r->goal[dim * i + k]);
      squared += PetscSqr(middle[dim * i + k]);
    }
    length = PetscSqrtReal(squared);
    for (PetscInt k = 0; k < dim && r->kind == EQM_IMAGE_SPHERE; k++) middle[dim * i + k] /= length;
  }
  PetscCall(Move(r, &r->a, r->landmarks.vertex, middle));
  if (r->status != EQM_STATUS_STOPPED) PetscCall(Move(r, &r->b, of_b, middle));
  PetscCall(PetscFree2(middle, of_b));
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmAdapt(EqmRegistration r)
{
  PetscReal *before;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(r->dim * r->a.mesh->num_local, &before));
  PetscCall(PetscArraycpy(before, r->a.x, r->dim * r->a.mesh->num_local));
  if (r->set.by == EQM_BY_MIDPOINTS)
    PetscCall(MoveToMiddles(r));
  else
    PetscCall(Move(r, &r->a, r->landmarks.vertex, r->goal));
  if (r->kind != EQM_IMAGE_SPACE) PetscCall(EqmMeasureOwnEnergy(r, before));
  PetscCall(PetscFree(before));
  PetscFunctionReturn(0);
}
