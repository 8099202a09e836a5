/* Angle-preserving maps to the sphere are unique up to Mobius maps: which one is it to be? The mass centre in the
   middle; three vertices at given places; least area distortion; or landmarks near given places. */
#include "method/method.h"
#include "domain/projective.h"
#include "geometry/simplex.h"
#include "register/landmark_list.h"

typedef enum { MOEBIUS_CENTER, MOEBIUS_AREA } Choice;
static const char *const choices[] = {"center", "area", "EqmMoebiusChoice", "EQM_MOEBIUS_", NULL};

PetscErrorCode EqmMoebiusCenter(EqmSolver solver)
{
  const PetscReal *mass;
  PetscReal offset;

  PetscFunctionBegin;
  PetscCall(EqmVertexMass(solver, &mass));
  PetscCall(EqmPlaceCenter(solver->domain, mass, &solver->place, &offset));
  PetscFunctionReturn(0);
}

/* Present places of some vertices (input numbers), on every rank. A vertex that no triangle uses has none. */
static PetscErrorCode PlacesOf(EqmSolver solver, PetscInt count, const PetscInt *vertex, PetscReal *x)
{
  const EqmMesh mesh = solver->mesh;
  PetscReal *found;
  PetscInt *sorted, *which;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(4 * count, &found));
  PetscCall(PetscMalloc2(count, &sorted, count, &which));
  for (PetscInt i = 0; i < count; i++) {
    sorted[i] = vertex[i];
    which[i] = i;
  }
  PetscCall(PetscSortIntWithArray(count, sorted, which));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    PetscInt place;
    PetscCall(PetscFindInt(mesh->vertex_input[v], count, sorted, &place));
    if (place < 0) continue;
    for (PetscInt k = 0; k < 3; k++) found[4 * which[place] + k] = solver->place.x[3 * v + k];
    found[4 * which[place] + 3] = 1.;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, found, (PetscMPIInt)(4 * count), MPIU_REAL, MPIU_SUM, solver->comm));
  for (PetscInt i = 0; i < count; i++) {
    if (found[4 * i + 3] == 0.)
      EqmFail(solver->comm, EQM_ERR_USAGE,
              "vertex %" PetscInt_FMT " belongs to no triangle: it has no place on the sphere", vertex[i]);
    for (PetscInt k = 0; k < 3; k++) x[3 * i + k] = found[4 * i + k];
  }
  PetscCall(PetscFree2(sorted, which));
  PetscCall(PetscFree(found));
  PetscFunctionReturn(0);
}

/* To length one; a usage error if there is no direction. */
static PetscErrorCode Normalise(MPI_Comm comm, const char *what, PetscInt count, PetscReal *points)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < count; i++) {
    PetscReal *const p = points + 3 * i, length = PetscSqrtReal(EqmDot3(p, p));
    if (!(length > 0.))
      EqmFail(comm, EQM_ERR_USAGE, "%s: point %" PetscInt_FMT " is zero: it has no place on the sphere", what, i + 1);
    for (PetscInt k = 0; k < 3; k++) p[k] /= length;
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Fix(EqmSolver solver)
{
  PetscReal x[9], points[9];
  EqmMoebius map;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(points, solver->settings.fix_points, 9));
  PetscCall(Normalise(solver->comm, "-fix_points", 3, points));
  PetscCall(PlacesOf(solver, 3, solver->settings.fix, x));
  map = EqmMoebiusThrough(x, points);
  PetscCall(EqmPlaceTransform(solver->domain, &map, &solver->place));
  PetscFunctionReturn(0);
}

/* The landmarks of -align: a vertex and a point each. */
static PetscErrorCode ReadLandmarks(EqmSolver solver, EqmLandmarkList *list)
{
  const char *const file = solver->settings.align;

  PetscFunctionBegin;
  PetscCall(EqmLandmarkListRead(solver->comm, file, solver->mesh->soup_vertices, -1, list));
  if (list->width != 3)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-align %s: each line must have a vertex and a point, vertex,x,y,z", file);
  PetscCall(Normalise(solver->comm, "-align", list->num, list->other));
  PetscFunctionReturn(0);
}

static PetscErrorCode Align(EqmSolver solver)
{
  EqmLandmarkList list;
  PetscReal *x, distance;
  EqmMoebius map;

  PetscFunctionBegin;
  PetscCall(ReadLandmarks(solver, &list));
  PetscCall(PetscMalloc1(3 * list.num, &x));
  PetscCall(PlacesOf(solver, list.num, list.vertex, x));
  PetscCall(EqmMoebiusAlign(list.num, x, list.other, solver->settings.align_rigid, &map, &distance));
  PetscCall(EqmPlaceTransform(solver->domain, &map, &solver->place));
  if (!solver->settings.quiet) {
    PetscCall(PetscPrintf(solver->comm,
                          "aligned: %" PetscInt_FMT " landmarks, %.4g from their points, root mean square\n", list.num,
                          (double)distance));
  }
  PetscCall(PetscFree(x));
  PetscCall(EqmLandmarkListReset(&list));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmConformalFinish(EqmSolver solver)
{
  const EqmSettings *const set = &solver->settings;

  PetscFunctionBegin;
  PetscCall(EqmMoebiusCenter(solver)); /* also a good place to begin the others from */
  if (set->has_fix) PetscCall(Fix(solver));
  if (set->align[0]) PetscCall(Align(solver));
  if ((int)set->moebius == MOEBIUS_AREA) PetscCall(EqmMoebiusLeastArea(solver, &solver->place));
  PetscCall(EqmSolverLook(solver));
  PetscFunctionReturn(0);
}

/* Is what was asked for possible? Known before the run, not after it. */
static PetscErrorCode Check(EqmSolver solver, PetscInt num_fix, PetscInt num_coordinates)
{
  const EqmSettings *const set = &solver->settings;
  const PetscInt num = set->has_fix + (set->align[0] != '\0') + ((int)set->moebius != MOEBIUS_CENTER);

  PetscFunctionBegin;
  if (num > 1) EqmFail(solver->comm, EQM_ERR_USAGE, "-fix, -align and -moebius area exclude each other");
  if (set->has_fix && num_fix != 3) EqmFail(solver->comm, EQM_ERR_USAGE, "-fix: give three vertices, i,j,k");
  if (num_coordinates != 9) EqmFail(solver->comm, EQM_ERR_USAGE, "-fix_points: give nine numbers, three points");
  for (PetscInt k = 0; k < 3 && set->has_fix; k++) {
    const PetscReal *const p = set->fix_points + 3 * k, *const q = set->fix_points + 3 * ((k + 1) % 3);
    if (set->fix[k] == set->fix[(k + 1) % 3] || (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]))
      EqmFail(solver->comm, EQM_ERR_USAGE, "-fix: the three vertices must differ, and so must their points");
    if (solver->mesh && (set->fix[k] < 0 || set->fix[k] >= solver->mesh->soup_vertices))
      EqmFail(solver->comm, EQM_ERR_USAGE,
              "-fix: there is no vertex %" PetscInt_FMT "; they count from 0 to %" PetscInt_FMT, set->fix[k],
              solver->mesh->soup_vertices - 1);
  }
  if (!solver->mesh || num == 0) PetscFunctionReturn(0);
  if (solver->mesh->num_boundary_vertices > 0)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-fix, -align and -moebius are for maps of closed surfaces");
  if (set->align[0]) {
    EqmLandmarkList list;
    PetscCall(ReadLandmarks(solver, &list));
    PetscCall(EqmLandmarkListReset(&list));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMoebiusAsk(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSettings *const set = &solver->settings;
  PetscInt num_fix = 3, num_coordinates = 9;
  PetscBool given;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 9; k++) set->fix_points[k] = 0.;
  for (PetscInt k = 0; k < 3; k++) { /* round the equator */
    set->fix_points[3 * k] = PetscCosReal(2. * PETSC_PI * k / 3.);
    set->fix_points[3 * k + 1] = PetscSinReal(2. * PETSC_PI * k / 3.);
  }
  PetscCall(
      PetscOptionsEnum("-moebius",
                       "closed surfaces: the Mobius map at the end: the mass centre in the sphere's, or the least "
                       "area distortion",
                       "EqmSolverSetFromOptions", choices, set->moebius, &set->moebius, NULL));
  PetscCall(PetscOptionsIntArray("-fix",
                                 "closed surfaces: three vertices (input numbers from 0) that go to given points",
                                 "EqmSolverSetFromOptions", set->fix, &num_fix, &set->has_fix));
  PetscCall(PetscOptionsRealArray("-fix_points",
                                  "the points of -fix, x,y,z,x,y,z,x,y,z (without: three around the equator)",
                                  "EqmSolverSetFromOptions", set->fix_points, &num_coordinates, &given));
  PetscCall(
      PetscOptionsString("-align",
                         "closed surfaces: a CSV file of landmarks, vertex,x,y,z after a header; the Mobius map at "
                         "the end brings them close to their points",
                         "EqmSolverSetFromOptions", set->align, set->align, sizeof(set->align), NULL));
  PetscCall(PetscOptionsBool("-align_rigid", "rotate only", "EqmSolverSetFromOptions", set->align_rigid,
                             &set->align_rigid, NULL));
  PetscCall(Check(solver, num_fix, given ? num_coordinates : 9));
  PetscFunctionReturn(0);
}
