/* First maps of solids to the ball (003 section 4): the surface goes to the sphere by the sphere's own solver, the
   interior follows by volumetric stretch energy minimisation with the boundary held. */
#include "method/method.h"
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

/* One rotation of Jacobi's: row and column i, j of the symmetric matrix are made orthogonal, and the axes with them. */
static void JacobiRotate(PetscReal matrix[9], PetscReal axes[9], PetscInt i, PetscInt j)
{
  const PetscReal half = .5 * (matrix[4 * j] - matrix[4 * i]), off = matrix[3 * i + j];
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
static PetscErrorCode PlaceMesh(EqmSolver solver, EqmPlace *place)
{
  const EqmMesh mesh = solver->mesh;
  PetscReal center[3], covariance[9], axes[9], local[3] = {0.}, largest[3];

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(place->x, mesh->position, 3 * mesh->num_local));
  if (!solver->settings.anisotropic_scaling) PetscFunctionReturn(0);
  PetscCall(Moments(mesh, center, covariance));
  PrincipalAxes(covariance, axes);
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    PetscReal p[3];
    for (PetscInt k = 0; k < 3; k++) p[k] = mesh->position[3 * v + k] - center[k];
    for (PetscInt k = 0; k < 3; k++) {
      place->x[3 * v + k] = EqmDot3(axes + 3 * k, p);
      local[k] = PetscMax(local[k], PetscAbsReal(place->x[3 * v + k]));
    }
  }
  PetscCall(MPIU_Allreduce(local, largest, 3, MPIU_REAL, MPIU_MAX, mesh->comm));
  for (PetscInt k = 0; k < 3 * mesh->num_local; k++) place->x[k] /= largest[k % 3];
  PetscFunctionReturn(0);
}

/* Map the surface to the sphere with options of its own, and the same solvers; what the run does and how it ends
 * concerns the start only. */
static PetscErrorCode MapSurface(EqmSolver solver, EqmMesh surface, EqmSolver *sphere)
{
  const EqmSettings *const set = &solver->settings;
  const PetscBool by_fixed_point = (PetscBool)(solver->method == &EqmMethodFixedPoint);
  const char *const method = !set->boundary_method[0] && by_fixed_point ? solver->method->name : set->boundary_method;
  PetscInt max_it = set->boundary_max_it;
  const char *enough = "";
  char text[256];
  PetscOptions options;

  PetscFunctionBegin;
  if (max_it < 0) {
    max_it = by_fixed_point ? 10 : 60;
    enough = by_fixed_point ? "" : " -ratio_tol .01"; /* a longer run would magnify the last digits of the input */
  }
  PetscCall(PetscSNPrintf(text, sizeof(text), "-quiet -max_it %" PetscInt_FMT "%s%s%s%s%s", max_it, enough,
                          method[0] ? " -method " : "", method, set->boundary_start[0] ? " -start " : "",
                          set->boundary_start));
  PetscCall(PetscOptionsCreate(&options));
  PetscCall(PetscOptionsInsertString(options, text));
  PetscCall(EqmLinearPassOptions(options));
  PetscCall(PetscOptionsPush(options));
  PetscCall(EqmSolverCreate(surface, "sphere", sphere));
  PetscCall(EqmSolverSetFromOptions(*sphere));
  (*sphere)->checkpoints.deaf = PETSC_TRUE; /* a start that was cut short would be another start */
  PetscCall(EqmSolverSolve(*sphere));
  PetscCall(PetscOptionsPop());
  PetscCall(PetscOptionsDestroy(&options));
  PetscFunctionReturn(0);
}

/* Factorisations and solves of the surface's map count as the run's; its energy is another one, and evaluations of it
   do not. */
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
  PetscFunctionReturn(0);
}

/* Boundary vertices from where the solid's surface is to the sphere, the others stay. */
static PetscErrorCode PlaceBoundary(EqmSolver solver, EqmPlace *place)
{
  EqmSurface surface;
  EqmLedger ledger;
  EqmMesh mesh;
  EqmSolver sphere;
  PetscReal *slab;

  PetscFunctionBegin;
  PetscCall(EqmSurfaceCreate(solver->mesh, &surface));
  PetscCall(EqmSurfaceFromSolid(surface, 3, place->x, surface->soup->vertices));
  PetscCall(EqmLedgerCreate(solver->comm, &ledger));
  PetscCall(EqmMeshCreate(surface->soup, ledger, &mesh));
  PetscCall(MapSurface(solver, mesh, &sphere));
  if (sphere->totals.folds > 0 && !solver->settings.quiet)
    PetscCall(PetscPrintf(solver->comm,
                          "the first map of the boundary has %" PetscInt64_FMT
                          " folded triangles: folds of the solid are likely\n",
                          sphere->totals.folds));
  PetscCall(PetscMalloc1(3 * (surface->soup->vertex_end - surface->soup->vertex_start), &slab));
  PetscCall(EqmMeshVerticesToInput(mesh, surface->soup, 3, sphere->place.x, slab));
  PetscCall(EqmSurfaceToSolid(surface, 3, slab, place->x));
  PetscCall(CountWork(ledger, solver->mesh->ledger));
  PetscCall(PetscFree(slab));
  PetscCall(EqmSolverDestroy(&sphere));
  PetscCall(EqmMeshDestroy(&mesh));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscCall(EqmSurfaceDestroy(&surface));
  PetscFunctionReturn(0);
}

/* The boundary alone decides the sign of the image's volume (003 section 3): a mirrored one turns every cell over. */
static PetscErrorCode TurnMirrored(EqmSolver solver)
{
  PetscFunctionBegin;
  PetscCall(EqmImageMeasure(solver->domain, &solver->place, solver->image));
  PetscCall(EqmImageSum(solver->mesh, solver->image, &solver->totals));
  if (solver->totals.total > 0.) PetscFunctionReturn(0);
  for (PetscInt v = 0; v < solver->mesh->num_local; v++) solver->place.x[3 * v] *= -1.;
  PetscFunctionReturn(0);
}

/* Error that each solve leaves of the one that it finds, where the solver is an iteration. */
static const PetscReal start_tolerance = 1e-3;

PetscErrorCode EqmBallStart(EqmSolver solver, PetscInt steps)
{
  const EqmMesh mesh = solver->mesh;
  signed char *group;
  PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(6 * mesh->num_local_cells, &weights, mesh->num_local, &group));
  for (PetscInt v = 0; v < mesh->num_local; v++) group[v] = mesh->on_boundary[v] ? EQM_GROUP_FIXED : 0;
  PetscCall(PlaceMesh(solver, &solver->place));
  /* L_V of the mesh's own places is the Laplacian of the Dirichlet energy: the first step is the harmonic map */
  for (PetscInt k = 0; k <= steps; k++) {
    PetscCall(EqmLaplacianWeights(solver->domain, EQM_LAPLACIAN_STRETCH, &solver->place, weights));
    if (k == 0) PetscCall(PlaceBoundary(solver, &solver->place));
    PetscCall(EqmHeldImprove(solver, weights, group, 3, start_tolerance, solver->place.x));
    if (k == 0) PetscCall(TurnMirrored(solver));
    PetscCall(EqmLinearKeepCoarseSpaces(solver->scalar, (PetscBool)(k > 0))); /* from image to image little changes */
  }
  PetscCall(EqmLinearKeepCoarseSpaces(solver->scalar, PETSC_FALSE));
  PetscCall(PetscFree2(weights, group));
  PetscFunctionReturn(0);
}
