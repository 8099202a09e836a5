/* First maps of solids to the ball (003 section 4), and to the cube: the surface is mapped by the caller's function,
   the interior by volumetric stretch energy minimisation with the boundary held. */
#include "start/start.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

/* Mean and covariance of the vertices' places (003 (12)). */
static PetscErrorCode Moments(EqmMesh mesh, PetscReal center[3], PetscReal covariance[9])
{
  PetscReal sum[9] = {0.};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * mesh->num_owned; k++) sum[k % 3] += mesh->position[k];
  PetscCall(MPIU_Allreduce(sum, center, 3, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt k = 0; k < 3; k++) {
    center[k] /= mesh->num_vertices;
    sum[k] = 0.;
  }
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscReal *const p = mesh->position + 3 * v;
    for (PetscInt k = 0; k < 9; k++) sum[k] += (p[k / 3] - center[k / 3]) * (p[k % 3] - center[k % 3]);
  }
  PetscCall(MPIU_Allreduce(sum, covariance, 9, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

/* One rotation of Jacobi's: row and column i, j of the symmetric matrix are made orthogonal, and the axes with them.
   What is off the diagonal by rounding is none: between equal axes it would choose a turn, or 0/0 where its square
   vanishes. */
static void JacobiRotate(PetscReal matrix[9], PetscReal axes[9], PetscInt i, PetscInt j)
{
  const PetscReal half = .5 * (matrix[4 * j] - matrix[4 * i]), entry = matrix[3 * i + j];
  const PetscReal rounding = 1e-14 * PetscSqrtReal(PetscAbsReal(matrix[4 * i] * matrix[4 * j]));
  const PetscReal off = PetscAbsReal(entry) <= rounding ? 0. : entry;
  const PetscReal root = PetscSqrtReal(half * half + off * off);
  const PetscReal tangent = off == 0. ? 0. : off / (half >= 0. ? half + root : half - root);
  const PetscReal c = 1. / PetscSqrtReal(1. + tangent * tangent), s = tangent * c;

  for (PetscInt k = 0; k < 3; k++) {
    const PetscReal p = matrix[3 * i + k], q = matrix[3 * j + k], x = axes[3 * i + k], y = axes[3 * j + k];
    matrix[3 * i + k] = c * p - s * q;
    matrix[3 * j + k] = s * p + c * q;
    axes[3 * i + k] = c * x - s * y;
    axes[3 * j + k] = s * x + c * y;
  }
  for (PetscInt k = 0; k < 3; k++) {
    const PetscReal p = matrix[3 * k + i], q = matrix[3 * k + j];
    matrix[3 * k + i] = c * p - s * q;
    matrix[3 * k + j] = s * p + c * q;
  }
}

/* Rows: the principal axes, a rotation where 003 (13) may give a reflection: Jacobi's rotations begin at the identity.
 */
static void PrincipalAxes(PetscReal covariance[9], PetscReal axes[9])
{
  enum { SWEEPS = 20 };

  for (PetscInt k = 0; k < 9; k++) axes[k] = k % 4 ? 0. : 1.;
  for (PetscInt sweep = 0; sweep < SWEEPS; sweep++) {
    JacobiRotate(covariance, axes, 0, 1);
    JacobiRotate(covariance, axes, 0, 2);
    JacobiRotate(covariance, axes, 1, 2);
  }
}

/* Places of the mesh's vertices, for an anisotropic scaling turned and scaled to fill the cube [-1, 1]^3 (003 (11),
   with the largest absolute value that it means). */
static PetscErrorCode PlaceMesh(EqmMesh mesh, PetscBool scaled, PetscReal *x)
{
  PetscReal center[3], covariance[9], axes[9], local[3] = {0.}, largest[3];

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(x, mesh->position, 3 * mesh->num_local));
  if (!scaled) PetscFunctionReturn(0);
  PetscCall(Moments(mesh, center, covariance));
  PrincipalAxes(covariance, axes);
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    PetscReal p[3];
    for (PetscInt k = 0; k < 3; k++) p[k] = mesh->position[3 * v + k] - center[k];
    for (PetscInt k = 0; k < 3; k++) {
      x[3 * v + k] = EqmDot3(axes + 3 * k, p);
      local[k] = PetscMax(local[k], PetscAbsReal(x[3 * v + k]));
    }
  }
  PetscCall(MPIU_Allreduce(local, largest, 3, MPIU_REAL, MPIU_MAX, mesh->comm));
  for (PetscInt k = 0; k < 3 * mesh->num_local; k++) x[k] /= largest[k % 3];
  PetscFunctionReturn(0);
}

/* Factorisations and solves of the surface's map are counted for the run; evaluations, which are of another energy, are
   not. */
static PetscErrorCode CountWork(EqmLedger from, EqmLedger to)
{
  EqmWork *part, *all;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(from, &part));
  PetscCall(EqmLedgerGetWork(to, &all));
  all->factorizations += part->factorizations;
  all->coupled_factorizations += part->coupled_factorizations;
  all->solves += part->solves;
  all->cg_iterations += part->cg_iterations;
  all->set_ups += part->set_ups;
  PetscFunctionReturn(0);
}

/* Map the boundary vertices, x, three per local vertex; interior vertices are not moved. */
static PetscErrorCode MapBoundary(EqmMesh solid, const EqmStartOptions *options, PetscReal *x, PetscInt64 *folds)
{
  EqmSurface surface;
  EqmLedger ledger;
  EqmMesh mesh;
  PetscReal *slab, *image;

  PetscFunctionBegin;
  PetscCall(EqmSurfaceCreate(solid, &surface));
  PetscCall(EqmSurfaceFromSolid(surface, 3, x, surface->soup->vertices));
  PetscCall(EqmLedgerCreate(solid->comm, &ledger));
  PetscCall(EqmMeshCreate(surface->soup, ledger, &mesh));
  PetscCall(PetscMalloc1(3 * mesh->num_local, &image));
  PetscCall(options->map_surface(options->context, mesh, image, folds));
  PetscCall(PetscMalloc1(3 * (surface->soup->vertex_end - surface->soup->vertex_start), &slab));
  PetscCall(EqmMeshVerticesToInput(mesh, surface->soup, 3, image, slab));
  PetscCall(EqmSurfaceToSolid(surface, 3, slab, x));
  PetscCall(CountWork(ledger, solid->ledger));
  PetscCall(PetscFree(slab));
  PetscCall(PetscFree(image));
  PetscCall(EqmMeshDestroy(&mesh));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscCall(EqmSurfaceDestroy(&surface));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStartPlaceBoundary(EqmMesh solid, const EqmStartOptions *options, PetscReal *x, PetscInt64 *folds)
{
  PetscFunctionBegin;
  PetscCall(PlaceMesh(solid, options->anisotropic_scaling, x));
  PetscCall(MapBoundary(solid, options, x, folds));
  PetscFunctionReturn(0);
}

/* The boundary alone decides the sign of the image's volume (003 section 3): a mirrored one turns every cell over. */
static PetscErrorCode TurnMirrored(EqmProblem problem, EqmIterate iterate)
{
  PetscFunctionBegin;
  PetscCall(EqmImageMeasure(problem->domain, &iterate->place, iterate->image));
  PetscCall(EqmImageSum(problem->mesh, iterate->image, &iterate->totals));
  if (iterate->totals.total > 0.) PetscFunctionReturn(0);
  for (PetscInt v = 0; v < problem->mesh->num_local; v++) iterate->place.x[3 * v] *= -1.;
  PetscFunctionReturn(0);
}

static PetscErrorCode PlaceBoundary(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  PetscInt64 folds;

  PetscFunctionBegin;
  if (!options->map_surface) {
    PetscCall(EqmDomainPlaceBoundary(problem->domain, &iterate->place));
    PetscFunctionReturn(0);
  }
  PetscCall(MapBoundary(problem->mesh, options, iterate->place.x, &folds));
  if (folds > 0)
    PetscCall(EqmProblemNotify(problem,
                               "the first map of the boundary has %" PetscInt64_FMT
                               " folded triangles: folds of the solid are likely\n",
                               folds));
  PetscFunctionReturn(0);
}

/* Relative tolerance of iterative solves: the error after a solve over that before it. */
static const PetscReal start_tolerance = 1e-3;

/* Ratios' variance up to which a map without folds needs no more fixed-point steps before a method takes over. */
static const PetscReal good_variance = .1;

static PetscErrorCode IsGood(EqmProblem problem, EqmIterate iterate, PetscBool *is_good)
{
  PetscFunctionBegin;
  PetscCall(EqmIterateUpdate(problem, iterate));
  *is_good = (PetscBool)(iterate->totals.folds == 0 && iterate->totals.energy < good_variance * iterate->totals.total);
  PetscFunctionReturn(0);
}

/* The harmonic map, then fixed-point steps: as many as the options say, or no more than that while they are needed. */
static PetscErrorCode Iterate(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options,
                              PetscBool while_needed)
{
  const EqmMesh mesh = problem->mesh;
  PetscBool is_good = PETSC_FALSE;
  signed char *group;
  PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(6 * mesh->num_local_cells, &weights, mesh->num_local, &group));
  for (PetscInt v = 0; v < mesh->num_local; v++) group[v] = mesh->on_boundary[v] ? EQM_GROUP_FIXED : 0;
  PetscCall(PlaceMesh(mesh, options->anisotropic_scaling, iterate->place.x));
  /* L_V of the mesh's own places is the Laplacian of the Dirichlet energy: the first step is the harmonic map */
  for (PetscInt k = 0; k <= options->steps && !is_good; k++) {
    PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_STRETCH, &iterate->place, weights));
    if (k == 0) PetscCall(PlaceBoundary(problem, iterate, options));
    PetscCall(EqmHeldImprove(problem, weights, group, 3, start_tolerance, iterate->place.x));
    if (k == 0 && options->map_surface) PetscCall(TurnMirrored(problem, iterate));
    PetscCall(EqmLinearKeepCoarseSpaces(problem->scalar, (PetscBool)(k > 0))); /* successive images differ little */
    if (while_needed && k < options->steps) PetscCall(IsGood(problem, iterate, &is_good));
  }
  PetscCall(EqmLinearKeepCoarseSpaces(problem->scalar, PETSC_FALSE));
  PetscCall(PetscFree2(weights, group));
  PetscFunctionReturn(0);
}

static PetscErrorCode Run(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  PetscFunctionBegin;
  PetscCall(Iterate(problem, iterate, options, PETSC_FALSE));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunGuarded(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  PetscFunctionBegin;
  PetscCall(Iterate(problem, iterate, options, PETSC_TRUE));
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartBallHarmonic = {EQM_STARTS_BALL, "harmonic",
                                           "boundary area-preserving on the sphere, interior harmonic", 0, Run};
const EqmStartType EqmStartBallFixedPoint = {EQM_STARTS_BALL, "fixed-point",
                                             "harmonic, then fixed-point steps with the boundary held (003 section 4)",
                                             4, Run};
const EqmStartType EqmStartBallGuarded = {EQM_STARTS_BALL, "guarded",
                                          "the same steps, while tetrahedra are folded or volumes far from equal", 4,
                                          RunGuarded};
