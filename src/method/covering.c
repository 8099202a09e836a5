/* The Riemann map of a disk-type surface by its double covering (004 section 2.2): one of the Euler methods maps the
   covering to the sphere, a Mobius map brings the boundary to the equator, stereographic projection the surface's
   own half to the disk. One step is a step on the sphere. */
#include "method/method.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

typedef struct {
  EqmMethod inner; /* maps the covering; has the settings */
  EqmDouble covering;
  EqmMesh mesh;
  EqmProblem problem; /* the covering's, to the sphere */
  EqmIterate sphere;
  PetscReal *slab;  /* places on the sphere, in the covering's numbering */
  PetscReal *place; /* the same per local vertex of the surface: its own half */
} Covering;

/* The disk's places on the northern hemisphere, the twins' on the southern (004 section 5.1, which has it the other way
   round: then the sphere would be seen from inside). */
static PetscErrorCode LiftToSphere(EqmMethod method, EqmIterate iterate, PetscReal *slab)
{
  const Covering *const data = method->data;
  const PetscInt n = method->problem->mesh->num_owned;
  PetscReal *north, *south;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * n, &north, 3 * n, &south));
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal *const z = iterate->place.x + 2 * v;
    const PetscReal squared = method->problem->mesh->on_boundary[v] ? 1. : z[0] * z[0] + z[1] * z[1];
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
static PetscErrorCode ProjectToDisk(EqmMethod method, EqmIterate iterate, const PetscReal *x)
{
  const EqmMesh mesh = method->problem->mesh;
  PetscReal axis[3], first[3], second[3], height, scale;

  PetscFunctionBegin;
  PetscCall(FindCircle(mesh, x, axis, &height));
  CompleteFrame(axis, first, second);
  scale = PetscSqrtReal((1. + height) / (1. - height));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal *const p = x + 3 * v, from_pole = 1. + EqmDot3(axis, p);
    PetscReal *const z = iterate->place.x + 2 * v;
    z[0] = scale * EqmDot3(first, p) / from_pole;
    z[1] = scale * EqmDot3(second, p) / from_pole;
    if (mesh->on_boundary[v]) {
      const PetscReal length = PetscSqrtReal(z[0] * z[0] + z[1] * z[1]); /* one but for rounding */
      for (PetscInt k = 0; k < 2; k++) z[k] /= length;
    }
  }
  PetscFunctionReturn(0);
}

/* The map to the disk from the map to the sphere, with totals, gradient norm and step length. */
static PetscErrorCode TakeFromSphere(EqmMethod method, EqmIterate iterate)
{
  const Covering *const data = method->data;
  const EqmIterate sphere = data->sphere;

  PetscFunctionBegin;
  PetscCall(EqmMeshVerticesToInput(data->mesh, data->covering->soup, 3, sphere->place.x, data->slab));
  PetscCall(EqmDoubleToOriginal(data->covering, 3, data->slab, data->place));
  PetscCall(EqmMeshUpdateGhosts(method->problem->mesh, 3, data->place));
  PetscCall(ProjectToDisk(method, iterate, data->place));
  PetscCall(EqmIterateUpdate(method->problem, iterate));
  iterate->objective = sphere->objective;
  iterate->gradient_norm = sphere->gradient_norm;
  iterate->step_length = sphere->step_length;
  iterate->figures = sphere->figures;
  PetscFunctionReturn(0);
}

/* The covering's mesh. Its phases are the run's: phases do not nest. */
static PetscErrorCode CreateCovering(EqmMethod method)
{
  const EqmMesh mesh = method->problem->mesh;
  Covering *const data = method->data;

  PetscFunctionBegin;
  PetscCall(EqmPhaseEnd(mesh->ledger, EQM_PHASE_MINIMISE));
  PetscCall(EqmPhaseBegin(mesh->ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(EqmDoubleCreate(mesh, &data->covering));
  PetscCall(EqmMeshCreate(data->covering->soup, mesh->ledger, &data->mesh));
  PetscCall(EqmPhaseEnd(mesh->ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(PetscMalloc1(3 * (data->covering->soup->vertex_end - data->covering->soup->vertex_start), &data->slab));
  PetscCall(PetscMalloc1(3 * mesh->num_local, &data->place));
  PetscCall(EqmProblemNotify(method->problem,
                             "double covering: %" PetscInt_FMT " vertices, %" PetscInt_FMT " triangles\n",
                             data->mesh->num_vertices, data->mesh->num_cells));
  PetscFunctionReturn(0);
}

/* The covering's problem, and its first map: the disk's, lifted to the sphere. */
static PetscErrorCode CreateSphere(EqmMethod method, EqmIterate iterate)
{
  const EqmLedger ledger = method->problem->mesh->ledger;
  Covering *const data = method->data;
  EqmDomain domain;

  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_START));
  PetscCall(EqmDomainCreateSphere(data->mesh, &domain));
  PetscCall(EqmProblemCreate(domain, &EqmObjectiveConformal, &data->problem));
  data->problem->notify = method->problem->notify;
  data->problem->context = method->problem->context;
  PetscCall(EqmIterateCreate(data->problem, &data->sphere));
  PetscCall(LiftToSphere(method, iterate, data->slab));
  PetscCall(EqmMeshVerticesFromInput(data->mesh, data->covering->soup, 3, data->slab, data->sphere->place.x));
  PetscCall(EqmPlaceMakeFrames(domain, &data->sphere->place));
  PetscCall(EqmIterateUpdate(data->problem, data->sphere));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_START));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_MINIMISE));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  Covering *const data = method->data;

  PetscFunctionBegin;
  PetscCall(CreateCovering(method));
  PetscCall(CreateSphere(method, iterate));
  PetscCall(EqmMethodSetUp(data->inner, data->problem, data->sphere));
  PetscCall(TakeFromSphere(method, iterate));
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  const Covering *const data = method->data;

  PetscFunctionBegin;
  PetscCall(EqmMethodStep(data->inner, data->sphere, outcome));
  if (*outcome == EQM_STEP_TAKEN) {
    data->sphere->number++;
    PetscCall(TakeFromSphere(method, iterate));
  }
  PetscCall(PetscStrncpy(method->message, data->inner->message, sizeof(method->message)));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  Covering *const data = method->data;

  PetscFunctionBegin;
  PetscCall(EqmMethodReset(data->inner));
  PetscCall(EqmIterateDestroy(&data->sphere));
  PetscCall(EqmProblemDestroy(&data->problem));
  PetscCall(EqmMeshDestroy(&data->mesh));
  PetscCall(EqmDoubleDestroy(&data->covering));
  PetscCall(PetscFree(data->slab));
  PetscCall(PetscFree(data->place));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmMethod method)
{
  PetscFunctionBegin;
  PetscCall(EqmMethodDestroy(&((Covering *)method->data)->inner));
  PetscCall(PetscFree(method->data));
  PetscFunctionReturn(0);
}

/* The whole state belongs to the covering's iterate. */
static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  const Covering *const data = method->data;

  PetscFunctionBegin;
  (void)iterate;
  PetscCall(EqmStateUseMesh(state, data->mesh));
  PetscCall(EqmStatePlace(state, data->problem->domain, "sphere", &data->sphere->place));
  PetscCall(EqmMethodVisitState(data->inner, data->sphere, state));
  PetscCall(EqmStateUseMesh(state, method->problem->mesh));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(EqmMethodSetFromOptions(((Covering *)method->data)->inner, PetscOptionsObject));
  PetscFunctionReturn(0);
}

static PetscErrorCode Create(EqmMethod method, const char *inner, const char *purpose)
{
  Covering *data;

  PetscFunctionBegin;
  PetscCall(PetscNew(&data));
  method->data = data;
  method->purpose = purpose;
  PetscCall(EqmMethodCreate(method->comm, inner, &data->inner));
  method->ops = (EqmMethodOps){.set_from_options = SetFromOptions,
                               .set_up = SetUp,
                               .step = Step,
                               .state = State,
                               .reset = Reset,
                               .destroy = Destroy};
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateCovering(EqmMethod method)
{
  PetscFunctionBegin;
  PetscCall(Create(method, "qiem", "Riemann map by the double covering and the quasi-implicit Euler method (004)"));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateCoveringExplicit(EqmMethod method)
{
  PetscFunctionBegin;
  PetscCall(Create(method, "euler-explicit", "Riemann map by the double covering and the explicit Euler method (004)"));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateCoveringImplicit(EqmMethod method)
{
  PetscFunctionBegin;
  PetscCall(Create(method, "euler-implicit", "Riemann map by the double covering and the implicit Euler method (004)"));
  PetscFunctionReturn(0);
}
