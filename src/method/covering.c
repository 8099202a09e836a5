/* The Riemann map of a disk-type surface by its double covering (004 section 2.2): the quasi-implicit Euler method maps
   the covering to the sphere, a Mobius map brings the boundary to the equator, stereographic projection the surface's
   own half to the disk. One step is a step on the sphere. */
#include "method/method.h"
#include "geometry/simplex.h"

typedef struct {
  EqmDouble covering;
  EqmMesh mesh;
  EqmSolver sphere; /* maps the covering */
  PetscReal *slab;  /* places on the sphere, in the covering's numbering */
  PetscReal *place; /* the same per local vertex of the surface: its own half */
} Covering;

/* The disk's places on the northern hemisphere, the twins' on the southern (004 section 5.1, which has it the other way
   round: then the sphere would be seen from inside). */
static PetscErrorCode LiftToSphere(EqmSolver solver, PetscReal *slab)
{
  const Covering *const data = solver->data;
  const PetscInt n = solver->mesh->num_owned;
  PetscReal *north, *south;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * n, &north, 3 * n, &south));
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal *const z = solver->place.x + 2 * v;
    const PetscReal squared = solver->mesh->on_boundary[v] ? 1. : z[0] * z[0] + z[1] * z[1];
    for (PetscInt k = 0; k < 2; k++) north[3 * v + k] = south[3 * v + k] = 2. * z[k] / (1. + squared);
    north[3 * v + 2] = (1. - squared) / (1. + squared);
    south[3 * v + 2] = -north[3 * v + 2];
  }
  PetscCall(EqmDoubleFromHalves(data->covering, 3, north, south, slab));
  PetscCall(PetscFree2(north, south));
  PetscFunctionReturn(0);
}

/* Axis and height of the circle that the boundary lies on. The loop's vector area is along the axis, to the side of
   the original half, as the surface is on the loop's left. */
static PetscErrorCode FindCircle(EqmMesh mesh, const PetscReal *x, PetscReal axis[3], PetscReal *height)
{
  PetscReal sum[6] = {0.}, length;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < mesh->num_boundary_facets; e++) {
    const PetscInt i = mesh->boundary_facets[2 * e], j = mesh->boundary_facets[2 * e + 1];
    PetscReal cross[3];
    if (i >= mesh->num_owned) continue; /* another rank's */
    EqmCross(x + 3 * i, x + 3 * j, cross);
    for (PetscInt k = 0; k < 3; k++) {
      sum[k] += cross[k];
      sum[3 + k] += x[3 * i + k];
    }
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 6, MPIU_REAL, MPIU_SUM, mesh->comm));
  length = PetscSqrtReal(EqmDot3(sum, sum));
  PetscCheck(length > 0., mesh->comm, PETSC_ERR_FP, "the boundary of the double covering has shrunk to a point");
  for (PetscInt k = 0; k < 3; k++) axis[k] = sum[k] / length;
  *height = EqmDot3(axis, sum + 3) / mesh->num_boundary_vertices;
  PetscFunctionReturn(0);
}

/* Two directions that make a right-handed frame with the axis. */
static void CompleteFrame(const PetscReal axis[3], PetscReal first[3], PetscReal second[3])
{
  PetscInt farthest = 0;
  PetscReal length;

  for (PetscInt k = 1; k < 3; k++) farthest = PetscAbsReal(axis[k]) < PetscAbsReal(axis[farthest]) ? k : farthest;
  for (PetscInt k = 0; k < 3; k++) first[k] = (k == farthest ? 1. : 0.) - axis[farthest] * axis[k];
  length = PetscSqrtReal(EqmDot3(first, first));
  for (PetscInt k = 0; k < 3; k++) first[k] /= length;
  EqmCross(axis, first, second);
}

/* Stereographic projection from the point opposite to the axis, after which the circle at that height has the radius
   sqrt((1 - h)/(1 + h)); scaling the plane by its inverse is the Mobius map that makes the circle the equator. */
static PetscErrorCode ProjectToDisk(EqmSolver solver, const PetscReal *x)
{
  const EqmMesh mesh = solver->mesh;
  PetscReal axis[3], first[3], second[3], height, scale;

  PetscFunctionBegin;
  PetscCall(FindCircle(mesh, x, axis, &height));
  CompleteFrame(axis, first, second);
  scale = PetscSqrtReal((1. + height) / (1. - height));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal *const p = x + 3 * v, from_pole = 1. + EqmDot3(axis, p);
    PetscReal *const z = solver->place.x + 2 * v;
    z[0] = scale * EqmDot3(first, p) / from_pole;
    z[1] = scale * EqmDot3(second, p) / from_pole;
    if (mesh->on_boundary[v]) {
      const PetscReal length = PetscSqrtReal(z[0] * z[0] + z[1] * z[1]); /* one but for rounding */
      for (PetscInt k = 0; k < 2; k++) z[k] /= length;
    }
  }
  PetscFunctionReturn(0);
}

/* The disk's map from the sphere's, and what the sphere's solver says of it. */
static PetscErrorCode TakeFromSphere(EqmSolver solver)
{
  const Covering *const data = solver->data;
  const EqmSolver sphere = data->sphere;

  PetscFunctionBegin;
  PetscCall(EqmMeshVerticesToInput(data->mesh, data->covering->soup, 3, sphere->place.x, data->slab));
  PetscCall(EqmDoubleToOriginal(data->covering, 3, data->slab, data->place));
  PetscCall(EqmMeshUpdateGhosts(solver->mesh, 3, data->place));
  PetscCall(ProjectToDisk(solver, data->place));
  PetscCall(EqmSolverLook(solver));
  solver->objective = sphere->objective;
  solver->gradient_norm = sphere->gradient_norm;
  solver->step_length = sphere->step_length;
  PetscFunctionReturn(0);
}

/* The covering's mesh and its solver, which begins with the lifted map. Its phases are the run's: phases do not nest.
 */
static PetscErrorCode CreateSphere(EqmSolver solver)
{
  const EqmLedger ledger = solver->mesh->ledger;
  Covering *const data = solver->data;
  PetscReal *first;

  PetscFunctionBegin;
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_MINIMISE));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(EqmDoubleCreate(solver->mesh, &data->covering));
  PetscCall(EqmMeshCreate(data->covering->soup, ledger, &data->mesh));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(PetscMalloc1(3 * (data->covering->soup->vertex_end - data->covering->soup->vertex_start), &data->slab));
  PetscCall(PetscMalloc1(3 * solver->mesh->num_local, &data->place));
  PetscCall(LiftToSphere(solver, data->slab));
  PetscCall(PetscMalloc1(3 * data->mesh->num_local, &first));
  PetscCall(EqmMeshVerticesFromInput(data->mesh, data->covering->soup, 3, data->slab, first));
  PetscCall(EqmSolverCreate(data->mesh, "conformal", &data->sphere));
  data->sphere->settings = solver->settings;
  data->sphere->settings.checkpoint[0] = data->sphere->settings.restart[0] = '\0';
  data->sphere->method = &EqmMethodQiem;
  PetscCall(EqmSolverSetFirstMap(data->sphere, 3, first));
  PetscCall(PetscFree(first));
  PetscCall(EqmSolverBegin(data->sphere));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_MINIMISE));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmSolver solver)
{
  Covering *data;

  PetscFunctionBegin;
  PetscCall(PetscNew(&data));
  solver->data = data;
  PetscCall(CreateSphere(solver));
  if (!solver->settings.quiet)
    PetscCall(PetscPrintf(solver->comm, "double covering: %" PetscInt_FMT " vertices, %" PetscInt_FMT " triangles\n",
                          data->mesh->num_vertices, data->mesh->num_cells));
  PetscCall(data->sphere->method->set_up(data->sphere));
  PetscCall(TakeFromSphere(solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmSolver solver, EqmStep *outcome)
{
  const EqmSolver sphere = ((Covering *)solver->data)->sphere;

  PetscFunctionBegin;
  PetscCall(sphere->method->step(sphere, outcome));
  if (*outcome == EQM_STEP_TAKEN) {
    PetscCall(TakeFromSphere(solver));
  } else {
    PetscCall(PetscStrncpy(solver->message, sphere->message, sizeof(solver->message)));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmSolver solver)
{
  Covering *const data = solver->data;

  PetscFunctionBegin;
  PetscCall(data->sphere->method->destroy(data->sphere));
  PetscCall(EqmSolverDestroy(&data->sphere));
  PetscCall(EqmMeshDestroy(&data->mesh));
  PetscCall(EqmDoubleDestroy(&data->covering));
  PetscCall(PetscFree(data->slab));
  PetscCall(PetscFree(data->place));
  PetscCall(PetscFree(solver->data));
  PetscFunctionReturn(0);
}

/* All of it is the sphere's, on the covering's mesh. */
static PetscErrorCode State(EqmSolver solver, EqmState state)
{
  const Covering *const data = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmStateUseMesh(state, data->mesh));
  PetscCall(EqmStatePlace(state, data->sphere->domain, "sphere", &data->sphere->place));
  PetscCall(data->sphere->method->state(data->sphere, state));
  PetscCall(EqmStateUseMesh(state, solver->mesh));
  PetscFunctionReturn(0);
}

/* The sphere's solver has the same. */
static PetscErrorCode Options(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(EqmMethodQiem.options(solver, PetscOptionsObject));
  PetscFunctionReturn(0);
}

const EqmMethod EqmMethodCovering = {
    .name = "qiem",
    .purpose = "Riemann map by the double covering and the quasi-implicit Euler method (004)",
    .options = Options,
    .set_up = SetUp,
    .step = Step,
    .state = State,
    .destroy = Destroy,
};
