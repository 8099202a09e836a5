/* Normalisation of angle-preserving maps to the sphere, which are unique up to Mobius maps: mass centre at the origin;
   three vertices at given points; least area distortion; or landmarks near given points. */
#include "solver/solver_private.h"
#include "mesh/gather.h"
#include "mesh/mesh_private.h"
#include "domain/projective.h"
#include "geometry/simplex.h"
#include "format/landmark_list.h"

typedef enum { MOEBIUS_CENTER, MOEBIUS_AREA } Choice;
static const char *const choices[] = {"center", "area", "EqmMoebiusChoice", "EQM_MOEBIUS_", NULL};

/* Images of some vertices (input numbers), on every rank. A usage error for a vertex that no triangle uses. */
static PetscErrorCode GatherImages(EqmProblem problem, EqmIterate iterate, PetscInt num, const PetscInt *vertices,
                                   PetscReal *x)
{
  PetscInt missing;

  PetscFunctionBegin;
  PetscCall(EqmMeshGatherVertices(problem->mesh, num, vertices, 3, iterate->place.x, x, &missing));
  if (missing >= 0)
    EqmFail(problem->comm, EQM_ERR_USAGE,
            "vertex %" PetscInt_FMT " belongs to no triangle: it has no place on the sphere", vertices[missing]);
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

static PetscErrorCode Fix(EqmProblem problem, EqmIterate iterate, const EqmNormaliseSettings *set)
{
  PetscReal x[9], points[9];
  EqmMoebius map;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(points, set->fix_points, 9));
  PetscCall(Normalise(problem->comm, "-fix_points", 3, points));
  PetscCall(GatherImages(problem, iterate, 3, set->fix, x));
  map = EqmMoebiusThrough(x, points);
  PetscCall(EqmPlaceTransform(problem->domain, &map, &iterate->place));
  PetscFunctionReturn(0);
}

/* The landmarks of -align: a vertex and a point each. */
static PetscErrorCode ReadLandmarks(EqmMesh mesh, const char *file, EqmLandmarkList *list)
{
  PetscFunctionBegin;
  PetscCall(EqmLandmarkListRead(mesh->comm, file, mesh->soup_vertices, -1, list));
  if (list->width != 3)
    EqmFail(mesh->comm, EQM_ERR_USAGE, "-align %s: each line must have a vertex and a point, vertex,x,y,z", file);
  PetscCall(Normalise(mesh->comm, "-align", list->num, list->other));
  PetscFunctionReturn(0);
}

static PetscErrorCode Align(EqmProblem problem, EqmIterate iterate, const EqmNormaliseSettings *set)
{
  EqmLandmarkList list;
  PetscReal *x, distance;
  EqmMoebius map;

  PetscFunctionBegin;
  PetscCall(ReadLandmarks(problem->mesh, set->align, &list));
  PetscCall(PetscMalloc1(3 * list.num, &x));
  PetscCall(GatherImages(problem, iterate, list.num, list.vertex, x));
  PetscCall(EqmMoebiusAlign(list.num, x, list.other, set->align_rigid, &map, &distance));
  PetscCall(EqmPlaceTransform(problem->domain, &map, &iterate->place));
  PetscCall(EqmProblemNotify(problem,
                             "aligned: %" PetscInt_FMT " landmarks, %.4g from their points, root mean square\n",
                             list.num, (double)distance));
  PetscCall(PetscFree(x));
  PetscCall(EqmLandmarkListReset(&list));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmConformalFinish(EqmSolver solver)
{
  const EqmNormaliseSettings *const set = &solver->settings.normalise;
  const EqmProblem problem = solver->problem;
  const EqmIterate iterate = solver->iterate;

  PetscFunctionBegin;
  PetscCall(EqmIterateCenter(problem, iterate)); /* also a good starting point for the others */
  if (set->has_fix) PetscCall(Fix(problem, iterate, set));
  if (set->align[0]) PetscCall(Align(problem, iterate, set));
  if ((int)set->moebius == MOEBIUS_AREA) PetscCall(EqmMoebiusLeastArea(problem, &iterate->place));
  PetscCall(EqmIterateUpdate(problem, iterate));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmNormaliseSettingsDefault(EqmNormaliseSettings *set)
{
  PetscFunctionBegin;
  *set = (EqmNormaliseSettings){.moebius = (PetscEnum)MOEBIUS_CENTER, .intrinsic = PETSC_TRUE};
  for (PetscInt k = 0; k < 3; k++) { /* round the equator */
    set->fix_points[3 * k] = PetscCosReal(2. * PETSC_PI * k / 3.);
    set->fix_points[3 * k + 1] = PetscSinReal(2. * PETSC_PI * k / 3.);
  }
  PetscFunctionReturn(0);
}

/* Three vertices at three points. */
static PetscErrorCode CheckFix(MPI_Comm comm, EqmMesh mesh, const EqmNormaliseSettings *set)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3; k++) {
    const PetscReal *const p = set->fix_points + 3 * k, *const q = set->fix_points + 3 * ((k + 1) % 3);
    if (set->fix[k] == set->fix[(k + 1) % 3] || (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]))
      EqmFail(comm, EQM_ERR_USAGE, "-fix: the three vertices must differ, and so must their points");
    if (mesh && (set->fix[k] < 0 || set->fix[k] >= mesh->soup_vertices))
      EqmFail(comm, EQM_ERR_USAGE, "-fix: there is no vertex %" PetscInt_FMT "; they count from 0 to %" PetscInt_FMT,
              set->fix[k], mesh->soup_vertices - 1);
  }
  PetscFunctionReturn(0);
}

/* Check the options before the run. */
static PetscErrorCode Check(MPI_Comm comm, EqmMesh mesh, const EqmNormaliseSettings *set, PetscInt num_fix,
                            PetscInt num_coordinates)
{
  const PetscInt num = set->has_fix + (set->align[0] != '\0') + ((int)set->moebius != MOEBIUS_CENTER);

  PetscFunctionBegin;
  if (num > 1) EqmFail(comm, EQM_ERR_USAGE, "-fix, -align and -moebius area exclude each other");
  if (set->has_fix && num_fix != 3) EqmFail(comm, EQM_ERR_USAGE, "-fix: give three vertices, i,j,k");
  if (num_coordinates != 9) EqmFail(comm, EQM_ERR_USAGE, "-fix_points: give nine numbers, three points");
  if (set->has_fix) {
    PetscReal points[9];
    PetscCall(PetscArraycpy(points, set->fix_points, 9));
    PetscCall(Normalise(comm, "-fix_points", 3, points));
    PetscCall(CheckFix(comm, mesh, set));
  }
  if (!mesh || num == 0) PetscFunctionReturn(0);
  if (mesh->num_boundary_vertices > 0)
    EqmFail(comm, EQM_ERR_USAGE, "-fix, -align and -moebius are for maps of closed surfaces");
  if (set->align[0]) {
    EqmLandmarkList list;
    PetscCall(ReadLandmarks(mesh, set->align, &list));
    PetscCall(EqmLandmarkListReset(&list));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmNormaliseSetFromOptions(MPI_Comm comm, EqmMesh mesh, EqmNormaliseSettings *set,
                                          PetscOptionItems *PetscOptionsObject)
{
  PetscInt num_fix = 3, num_coordinates = 9;
  PetscBool given;

  PetscFunctionBegin;
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
  PetscCall(PetscOptionsBool("-intrinsic",
                             "closed surfaces: a map that folds or has jammed is made once more on the intrinsic "
                             "Delaunay triangulation",
                             "EqmSolverSetFromOptions", set->intrinsic, &set->intrinsic, NULL));
  PetscCall(Check(comm, mesh, set, num_fix, given ? num_coordinates : 9));
  PetscFunctionReturn(0);
}
