/* First maps that were made before, or by another program: the map in a file, moved and scaled to the unit domain, its
   boundary put exactly where the domain has it, and folds mended. */
#include "start/start.h"
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"
#include "base/lookup.h"
#include "measure/recognise.h"
#include "unfold/unfold.h"
#include <math.h>
#include <string.h>

/* How far a vertex may be from where the domain has it. */
static const PetscReal tolerance = 5e-3;
/* How far a vertex in a face of the cube may be from it: less than the first vertices off an edge are. */
static const PetscReal on_side = 1e-6;

PetscBool EqmStartIsFile(const char *name)
{
  return (PetscBool)(strpbrk(name, "./") != NULL);
}

PetscErrorCode EqmStartRequireFile(MPI_Comm comm, const char *name)
{
  PetscBool there;

  PetscFunctionBegin;
  if (!EqmStartIsFile(name)) PetscFunctionReturn(0);
  PetscCall(EqmFileIsThere(comm, name, &there));
  if (!there) EqmFail(comm, EQM_ERR_IO, "-start %s: there is no such file", name);
  PetscFunctionReturn(0);
}

/* The file's coordinates per local vertex, which must be numbers. */
static PetscErrorCode ReadPlaces(EqmMesh mesh, PetscInt wanted, const char *target, const char *file, PetscReal *x)
{
  PetscInt dim, bad = PETSC_MAX_INT;
  PetscReal *coordinates;
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(EqmMapRead(mesh->soup, file, &map));
  PetscCall(EqmMapGetDimension(map, &dim));
  PetscCall(EqmMapGetCoordinates(map, &coordinates));
  if (dim == wanted) PetscCall(EqmMeshVerticesFromInput(mesh, mesh->soup, dim, coordinates, x));
  PetscCall(EqmMapDestroy(&map));
  if (dim != wanted)
    EqmFail(mesh->comm, EQM_ERR_USAGE,
            "-start %s: its map has %" PetscInt_FMT " coordinates per vertex; one to the %s has %" PetscInt_FMT, file,
            dim, target, wanted);
  for (PetscInt k = 0; k < dim * mesh->num_owned; k++) {
    if (PetscIsInfOrNanReal(x[k])) bad = PetscMin(bad, mesh->vertex_input[k / dim]);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &bad, 1, MPIU_INT, MPI_MIN, mesh->comm));
  if (bad < PETSC_MAX_INT)
    EqmFail(mesh->comm, EQM_ERR_USAGE, "-start %s: the image of vertex %" PetscInt_FMT " (from 0) is not a number",
            file, bad);
  PetscFunctionReturn(0);
}

/* To the unit domain, which the image must fill. */
static PetscErrorCode MakeUnit(EqmProblem problem, const char *file, PetscReal *x)
{
  const EqmDomain domain = problem->domain;
  const PetscBool square = (PetscBool)!strcmp(domain->name, "square");
  const PetscBool cube = (PetscBool)!strcmp(domain->name, "cube");
  const EqmDomainShape wanted = cube                            ? EQM_FILLS_CUBE
                                : problem->mesh->cell_size == 4 ? EQM_FILLS_BALL
                                : domain->dim == 3              ? EQM_FILLS_SPHERE
                                : square                        ? EQM_FILLS_SQUARE
                                                                : EQM_FILLS_DISK;
  EqmImagePlacement placement;

  PetscFunctionBegin;
  PetscCall(EqmImageRecognise(problem->mesh, domain->dim, x, &placement));
  if (placement.shape != wanted)
    EqmFail(problem->comm, EQM_ERR_USAGE, "-start %s: what its map fills: %s; what this run wants: %s", file,
            EqmDomainShapeName(placement.shape), EqmDomainShapeName(wanted));
  EqmImageToUnit(problem->mesh, domain->dim, &placement, x);
  PetscFunctionReturn(0);
}

/* Reflect a map whose cells are turned over for the most part: in the plane the coordinates change places, so that the
   square stays where it is. */
static PetscErrorCode TurnOver(EqmProblem problem, EqmPlace *place)
{
  const EqmMesh mesh = problem->mesh;
  const EqmDomain domain = problem->domain;
  PetscInt64 turned = 0;
  PetscReal *a;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local_cells, &a));
  PetscCall(EqmImageMeasureOf(domain, domain->curved_image ? EQM_MEASURE_HALF_DET : domain->measure, place, a));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) turned += (a[c] < 0.) - (a[c] > 0.);
  PetscCall(PetscFree(a));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &turned, 1, MPIU_INT64, MPI_SUM, mesh->comm));
  for (PetscInt v = 0; v < mesh->num_local && turned > 0; v++) {
    PetscReal *const x = place->x + domain->dim * v, first = x[0];
    x[0] = x[1];
    x[1] = first;
  }
  PetscFunctionReturn(0);
}

static void QuarterTurn(EqmMesh mesh, PetscReal *x)
{
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal first = x[2 * v];
    x[2 * v] = 1. - x[2 * v + 1];
    x[2 * v + 1] = first;
  }
}

/* How far the domain's corners are from their places, at most. */
static PetscErrorCode CornersOff(EqmProblem problem, const PetscReal *x, const EqmPlace *ideal, PetscReal *off)
{
  PetscReal local = 0.;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < problem->mesh->num_owned; v++) {
    if (EqmDomainMotion(problem->domain, v) != &EqmMotionCorner) continue;
    for (PetscInt k = 0; k < 2; k++) local = PetscMax(local, PetscAbsReal(x[2 * v + k] - ideal->x[2 * v + k]));
  }
  PetscCall(MPIU_Allreduce(&local, off, 1, MPIU_REAL, MPIU_MAX, problem->comm));
  PetscFunctionReturn(0);
}

/* The boundary vertex at a corner of the unit square, by its input number; -1: there is none. */
static PetscErrorCode VertexAt(EqmMesh mesh, const PetscReal *x, PetscReal p, PetscReal q, PetscInt *number)
{
  PetscInt found = -1;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    if (mesh->on_boundary[v] && PetscAbsReal(x[2 * v] - p) + PetscAbsReal(x[2 * v + 1] - q) <= tolerance)
      found = mesh->vertex_input[v];
  }
  PetscCall(MPIU_Allreduce(&found, number, 1, MPIU_INT, MPI_MAX, mesh->comm));
  PetscFunctionReturn(0);
}

/* Square: quarter turns until its corners are at their places. */
static PetscErrorCode FitCorners(EqmProblem problem, const char *file, const EqmPlace *ideal, PetscReal *x)
{
  PetscInt corner[4];
  PetscReal off;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 4; k++) {
    PetscCall(CornersOff(problem, x, ideal, &off));
    if (off <= tolerance) PetscFunctionReturn(0);
    QuarterTurn(problem->mesh, x);
  }
  for (PetscInt k = 0; k < 4; k++) PetscCall(VertexAt(problem->mesh, x, k == 1 || k == 2, k >= 2, &corner[k]));
  if (PetscMin(PetscMin(corner[0], corner[1]), PetscMin(corner[2], corner[3])) < 0)
    EqmFail(problem->comm, EQM_ERR_USAGE, "-start %s: its map has no vertex at some corner of the square", file);
  EqmFail(problem->comm, EQM_ERR_USAGE,
          "-start %s: its map has other vertices at the square's corners than this run; add -corners %" PetscInt_FMT
          ",%" PetscInt_FMT ",%" PetscInt_FMT ",%" PetscInt_FMT,
          file, corner[0], corner[1], corner[2], corner[3]);
}

/* Along sides and faces coordinates are free or fixed each on its own. */
static PetscBool IsFlat(const EqmVertexMotion *motion)
{
  return (PetscBool)(motion->is_free[0] || motion->is_free[1] || motion->is_free[2]);
}

/* A place goes to the nearest one where its vertex may be; false where that is far. `ideal`: where it has no choice. */
static PetscBool Snap(const EqmVertexMotion *motion, PetscInt dim, const PetscReal *ideal, PetscReal *x)
{
  PetscReal old[3] = {0., 0., 0.}, length = 0., off = 0.;

  if (motion == &EqmMotionFree) return PETSC_TRUE;
  for (PetscInt k = 0; k < dim; k++) {
    old[k] = x[k];
    length += PetscSqr(x[k]);
  }
  for (PetscInt k = 0; k < dim; k++) {
    if (motion == &EqmMotionCorner || motion == &EqmMotionCubeCorner || motion == &EqmMotionHeldOnCircle)
      x[k] = ideal[k];
    else if (IsFlat(motion))
      x[k] = motion->is_free[k] ? PetscMin(PetscMax(x[k], 0.), 1.) : ideal[k];
    else
      x[k] /= PetscSqrtReal(length);
    off = PetscMax(off, PetscAbsReal(x[k] - old[k]));
  }
  return (PetscBool)(off <= tolerance || motion == &EqmMotionHeldOnCircle);
}

/* Boundary vertices exactly onto the boundary, in its order. */
static PetscErrorCode PlaceExactly(EqmProblem problem, const char *file, const EqmPlace *ideal, EqmPlace *place)
{
  const EqmMesh mesh = problem->mesh;
  const PetscInt dim = problem->domain->dim;
  PetscInt bad = PETSC_MAX_INT;
  PetscBool in_order;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    if (!Snap(EqmDomainMotion(problem->domain, v), dim, ideal->x + dim * v, place->x + dim * v) && v < mesh->num_owned)
      bad = PetscMin(bad, mesh->vertex_input[v]);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &bad, 1, MPIU_INT, MPI_MIN, mesh->comm));
  if (bad < PETSC_MAX_INT)
    EqmFail(problem->comm, EQM_ERR_USAGE,
            "-start %s: the image of vertex %" PetscInt_FMT " (from 0) is not where the boundary of the %s has it",
            file, bad, problem->domain->name);
  PetscCall(EqmPlaceMakeFrames(problem->domain, place));
  PetscCall(EqmDomainBoundaryInOrder(problem->domain, place, &in_order));
  if (!in_order)
    EqmFail(problem->comm, EQM_ERR_USAGE,
            "-start %s: along the boundary the images of its vertices go back, or coincide; that is no first map",
            file);
  PetscFunctionReturn(0);
}

/* Surfaces; a solid's methods go on from folds, and mend them at the end. */
static PetscErrorCode Unfold(EqmProblem problem, EqmIterate iterate, const char *file)
{
  PetscInt64 before, after;

  PetscFunctionBegin;
  if (problem->mesh->cell_size == 4) PetscFunctionReturn(0);
  PetscCall(problem->domain->dim == 3 ? EqmSphereUnfold(problem, iterate, &before, &after)
                                      : EqmPlaneUnfold(problem, iterate, &before, &after));
  iterate->unfolded_from = before;
  iterate->unfolded_to = after;
  if (after > 0)
    EqmFail(problem->comm, EQM_ERR_USAGE,
            "-start %s: %" PetscInt64_FMT " triangles of its map are folded, and %" PetscInt64_FMT
            " could not be unfolded; take a map without folds, or leave -start out",
            file, before, after);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCubeFromFile(EqmMesh solid, const char *file, PetscReal *x)
{
  EqmImagePlacement placement;

  PetscFunctionBegin;
  PetscCall(ReadPlaces(solid, 3, "cube", file, x));
  PetscCall(EqmImageRecognise(solid, 3, x, &placement));
  if (placement.shape != EQM_FILLS_CUBE)
    EqmFail(solid->comm, EQM_ERR_USAGE, "-start %s: what its map fills: %s; what this run wants: %s", file,
            EqmDomainShapeName(placement.shape), EqmDomainShapeName(EQM_FILLS_CUBE));
  EqmImageToUnit(solid, 3, &placement, x);
  for (PetscInt k = 0; k < 3 * solid->num_local; k++) {
    const PetscReal nearest = x[k] < .5 ? 0. : 1.;
    if (solid->on_boundary[k / 3] && PetscAbsReal(x[k] - nearest) <= on_side) x[k] = nearest;
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Run(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  const char *const file = options->name;
  EqmPlace ideal;

  PetscFunctionBegin;
  PetscCall(ReadPlaces(problem->mesh, problem->domain->dim, problem->domain->name, file, iterate->place.x));
  PetscCall(MakeUnit(problem, file, iterate->place.x));
  PetscCall(TurnOver(problem, &iterate->place));
  PetscCall(EqmPlaceCreate(problem->domain, &ideal));
  if (problem->domain->boundary_length > 0. || problem->domain->boundary_place)
    PetscCall(EqmDomainPlaceBoundary(problem->domain, &ideal));
  if (!strcmp(problem->domain->name, "square")) PetscCall(FitCorners(problem, file, &ideal, iterate->place.x));
  PetscCall(PlaceExactly(problem, file, &ideal, &iterate->place));
  PetscCall(EqmPlaceDestroy(&ideal));
  PetscCall(Unfold(problem, iterate, file));
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartFilePlane = {EQM_STARTS_PLANE, "FILE", "a map made before, or by another program", 0, Run};
const EqmStartType EqmStartFileSphere = {EQM_STARTS_SPHERE, "FILE", "a map made before, or by another program", 0, Run};
const EqmStartType EqmStartFileBall = {EQM_STARTS_BALL, "FILE", "a map made before, or by another program", 0, Run};
