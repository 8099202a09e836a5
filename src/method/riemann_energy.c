/* Riemann map by boundary angles: elimination of the interior, value and gradient (docs/methods.md, Riemann map). */
#include "method/riemann.h"
#include "domain/domain_private.h"

/* The vertex with the most of a function that is zero on the boundary; of several the first in the input. */
static PetscErrorCode FindPole(EqmMesh mesh, const PetscReal *depth, EqmRiemann riemann)
{
  PetscReal mine = 0., most;
  PetscInt first = PETSC_MAX_INT, number;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) mine = PetscMax(mine, mesh->on_boundary[v] ? 0. : depth[v]);
  PetscCall(MPIU_Allreduce(&mine, &most, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    if (!mesh->on_boundary[v] && depth[v] >= (1. - 1e-9) * most) first = PetscMin(first, mesh->vertex_input[v]);
  }
  PetscCall(MPIU_Allreduce(&first, &number, 1, MPIU_INT, MPI_MIN, mesh->comm));
  riemann->pole = -1;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    if (mesh->vertex_input[v] == number) riemann->pole = v;
  }
  PetscFunctionReturn(0);
}

/* h = m_B - L_BI L_II^-1 m_I: weights of the boundary's vertices in the mass centre of a harmonic map. The solution
   L_II^-1 m_I, the mean time of a random walk to the boundary, tells the pole. */
static PetscErrorCode FindCentreWeights(EqmProblem problem, EqmRiemann riemann)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal *mass, *image = riemann->scratch;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(mesh->num_local, &mass));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    for (PetscInt a = 0; a < 3; a++) mass[mesh->cells[3 * c + a]] += mesh->weight[c] / 3.;
  }
  for (PetscInt b = 0; b < riemann->num_boundary; b++) {
    riemann->centre[b] = mass[riemann->boundary[b]];
    mass[riemann->boundary[b]] = 0.;
  }
  PetscCall(EqmGroupSolve(problem, 1, mass)); /* the boundary's rows are identities */
  PetscCall(FindPole(mesh, mass, riemann));
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, mass));
  PetscCall(EqmLaplacianApply(mesh, riemann->weights, 1, mass, image));
  for (PetscInt b = 0; b < riemann->num_boundary; b++) riemann->centre[b] -= image[riemann->boundary[b]];
  PetscCall(PetscFree(mass));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRiemannCreate(EqmProblem problem, EqmRiemann *out)
{
  const EqmMesh mesh = problem->mesh;
  EqmRiemann riemann;

  PetscFunctionBegin;
  PetscCall(PetscNew(&riemann));
  PetscCall(PetscMalloc5(mesh->num_owned, &riemann->boundary, mesh->num_owned, &riemann->centre,
                         3 * mesh->num_local_cells, &riemann->weights, mesh->num_local, &riemann->group,
                         2 * mesh->num_owned, &riemann->scratch));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    riemann->group[v] = mesh->on_boundary[v] ? EQM_GROUP_FIXED : 0;
    if (v < mesh->num_owned && mesh->on_boundary[v]) riemann->boundary[riemann->num_boundary++] = v;
  }
  PetscCall(EqmLoopCreate(mesh, riemann->num_boundary, riemann->boundary, &riemann->loop));
  PetscCall(EqmDomainCreateVec(problem->domain, &riemann->move));
  PetscCall(VecZeroEntries(riemann->move));
  PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_COTANGENT, NULL, riemann->weights));
  PetscCall(EqmGroupFactor(problem, riemann->weights, riemann->group, NULL));
  PetscCall(FindCentreWeights(problem, riemann));
  *out = riemann;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRiemannDestroy(EqmRiemann *riemann)
{
  PetscFunctionBegin;
  if (!*riemann) PetscFunctionReturn(0);
  PetscCall(PetscFree5((*riemann)->boundary, (*riemann)->centre, (*riemann)->weights, (*riemann)->group,
                       (*riemann)->scratch));
  PetscCall(EqmLoopDestroy(&(*riemann)->loop));
  PetscCall(VecDestroy(&(*riemann)->move));
  PetscCall(PetscFree(*riemann));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRiemannCreateVec(EqmProblem problem, EqmRiemann riemann, Vec *angles)
{
  PetscFunctionBegin;
  PetscCall(VecCreateMPI(problem->comm, riemann->num_boundary, problem->mesh->num_boundary_vertices, angles));
  PetscFunctionReturn(0);
}

/* Boundary angles as degrees of freedom of the domain. */
static PetscErrorCode Spread(EqmProblem problem, EqmRiemann riemann, Vec angles)
{
  const EqmDomain domain = problem->domain;
  const PetscScalar *from;
  PetscScalar *to;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(angles, &from));
  PetscCall(VecGetArray(riemann->move, &to));
  for (PetscInt b = 0; b < riemann->num_boundary; b++)
    to[domain->dof_start[riemann->boundary[b]] - domain->dof_first] = from[b];
  PetscCall(VecRestoreArray(riemann->move, &to));
  PetscCall(VecRestoreArrayRead(angles, &from));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRiemannMove(EqmProblem problem, EqmRiemann riemann, const EqmPlace *from, PetscReal t, Vec angles,
                              EqmPlace *to)
{
  PetscFunctionBegin;
  PetscCall(Spread(problem, riemann, angles));
  PetscCall(EqmDomainMove(problem->domain, from, t, riemann->move, to));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRiemannSmallestGap(EqmProblem problem, const EqmPlace *place, PetscReal *smallest)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal local = 2. * PETSC_PI;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < mesh->num_boundary_facets; e++) {
    const PetscReal *const p = place->x + 2 * mesh->boundary_facets[2 * e], *const q =
                                                                                place->x +
                                                                                2 * mesh->boundary_facets[2 * e + 1];
    local = PetscMin(local, PetscAtan2Real(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]));
  }
  PetscCall(MPIU_Allreduce(&local, smallest, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  PetscFunctionReturn(0);
}

/* Add the enclosed area's part: to the energy -1/2 sin of each gap, to the gradient of its two ends (per owned vertex)
   +-1/2 cos. */
static PetscReal AddArea(EqmMesh mesh, const PetscReal *x, PetscReal *slope)
{
  PetscReal energy = 0.;

  for (PetscInt e = 0; e < mesh->num_boundary_facets; e++) {
    const PetscInt i = mesh->boundary_facets[2 * e], j = mesh->boundary_facets[2 * e + 1];
    const PetscReal *const p = x + 2 * i, *const q = x + 2 * j;
    const PetscReal sine = p[0] * q[1] - p[1] * q[0], cosine = p[0] * q[0] + p[1] * q[1];
    if (i < mesh->num_owned) {
      energy -= .5 * sine;
      slope[i] += .5 * cosine;
    }
    if (j < mesh->num_owned) slope[j] -= .5 * cosine;
  }
  return energy;
}

PetscErrorCode EqmRiemannEnergy(EqmProblem problem, EqmRiemann riemann, EqmPlace *place, PetscReal *energy,
                                Vec gradient)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal sum[3] = {0., 0., 0.}, *slope; /* energy without the last term, mass centre */
  PetscScalar *g;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmHeldExtend(problem, riemann->weights, riemann->group, 2, place->x));
  PetscCall(EqmLaplacianApply(mesh, riemann->weights, 2, place->x, riemann->scratch));
  PetscCall(PetscCalloc1(mesh->num_owned, &slope));
  sum[0] = AddArea(mesh, place->x, slope);
  for (PetscInt b = 0; b < riemann->num_boundary; b++) {
    const PetscReal *const x = place->x + 2 * riemann->boundary[b], *const s =
                                                                        riemann->scratch + 2 * riemann->boundary[b];
    sum[0] += .5 * (x[0] * s[0] + x[1] * s[1]);
    for (PetscInt k = 0; k < 2; k++) sum[1 + k] += riemann->centre[b] * x[k];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 3, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscCall(VecGetArrayWrite(gradient, &g));
  for (PetscInt b = 0; b < riemann->num_boundary; b++) {
    const PetscInt v = riemann->boundary[b];
    const PetscReal *const x = place->x + 2 * v, *const s = riemann->scratch + 2 * v;
    g[b] = x[0] * s[1] - x[1] * s[0] + slope[v] + riemann->centre[b] * (x[0] * sum[2] - x[1] * sum[1]);
  }
  PetscCall(VecRestoreArrayWrite(gradient, &g));
  PetscCall(PetscFree(slope));
  *energy = sum[0] + .5 * (PetscSqr(sum[1]) + PetscSqr(sum[2]));
  PetscCall(EqmLedgerGetWork(mesh->ledger, &work));
  work->evaluations++;
  PetscFunctionReturn(0);
}

/* z -> (z + a) / (1 + conj(a) z), put back onto the circle. */
static void MoveCircle(const PetscReal a[2], PetscReal *z)
{
  const PetscReal up[2] = {z[0] + a[0], z[1] + a[1]};
  const PetscReal down[2] = {1. + a[0] * z[0] + a[1] * z[1], a[0] * z[1] - a[1] * z[0]};
  const PetscReal moved[2] = {up[0] * down[0] + up[1] * down[1], up[1] * down[0] - up[0] * down[1]};
  const PetscReal length = PetscSqrtReal(moved[0] * moved[0] + moved[1] * moved[1]);

  for (PetscInt k = 0; k < 2; k++) z[k] = moved[k] / length;
}

PetscErrorCode EqmRiemannCentre(EqmProblem problem, EqmRiemann riemann, EqmPlace *place)
{
  enum { MOST_ROUNDS = 50 };
  const PetscReal longest = .5;

  PetscFunctionBegin;
  for (PetscInt round = 0; round < MOST_ROUNDS; round++) {
    PetscReal sum[5] = {0., 0., 0., 0., 0.}; /* c = h . z, h . 1, h . z^2 */
    for (PetscInt b = 0; b < riemann->num_boundary; b++) {
      const PetscReal *const z = place->x + 2 * riemann->boundary[b], h = riemann->centre[b];
      const PetscReal term[5] = {z[0], z[1], 1., z[0] * z[0] - z[1] * z[1], 2. * z[0] * z[1]};
      for (PetscInt k = 0; k < 5; k++) sum[k] += h * term[k];
    }
    PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 5, MPIU_REAL, MPIU_SUM, problem->comm));
    if (sum[0] * sum[0] + sum[1] * sum[1] < 1e-24) break;
    /* Newton: to first order in a the centre moves by a (h . 1) - conj(a) (h . z^2) */
    const PetscReal m[3] = {sum[2] - sum[3], -sum[4], sum[2] + sum[3]}, det = m[0] * m[2] - m[1] * m[1];
    PetscReal a[2] = {(m[1] * sum[1] - m[2] * sum[0]) / det, (m[1] * sum[0] - m[0] * sum[1]) / det};
    const PetscReal length = PetscSqrtReal(a[0] * a[0] + a[1] * a[1]);
    if (PetscIsInfOrNanReal(length)) break; /* the mass is where the boundary has run together: there is no centre */
    for (PetscInt k = 0; k < 2 && length > longest; k++) a[k] *= longest / length;
    for (PetscInt b = 0; b < riemann->num_boundary; b++) MoveCircle(a, place->x + 2 * riemann->boundary[b]);
  }
  PetscCall(EqmMeshUpdateGhosts(problem->mesh, 2, place->x));
  PetscFunctionReturn(0);
}
