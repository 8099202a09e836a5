/* Maps of two disks to hemispheres by barycentric weights. */
#include "start/hemispheres.h"
#include "geometry/simplex.h"
#include "linalg/linalg.h"
#include "unfold/unfold.h"

/* Weights of a cell: from corner a to the corners after it, 2a and 2a + 1. Those of both cells at an edge add up. */
enum { DIRECTIONS = 6 };

/* Cosine and sine of the angle at corner a, times the lengths of its sides. */
static void AngleAt(const PetscReal *const p[3], PetscInt a, PetscReal *cosine, PetscReal *sine)
{
  PetscReal u[3], v[3], cross[3];

  for (PetscInt k = 0; k < 3; k++) {
    u[k] = p[(a + 1) % 3][k] - p[a][k];
    v[k] = p[(a + 2) % 3][k] - p[a][k];
  }
  EqmCross(u, v, cross);
  *cosine = EqmDot3(u, v);
  *sine = PetscSqrtReal(EqmDot3(cross, cross));
}

static PetscReal Length(const PetscReal *p, const PetscReal *q)
{
  return PetscSqrtReal(PetscSqr(p[0] - q[0]) + PetscSqr(p[1] - q[1]) + PetscSqr(p[2] - q[2]));
}

/* 004 section 5.1 names harmonic weights [Pinkall and Polthier 1993], half the cotangent of the angle opposite;
   mean-value weights [Floater 2003], the tangent of half the angle beside over the length, which are not symmetric; and
   semi-cotangent weights, taken here as the cotangent of half the angle opposite, which is positive. */
static void WeightsOfCell(const PetscReal *const p[3], EqmHemisphereWeights kind, PetscReal weights[DIRECTIONS])
{
  for (PetscInt a = 0; a < 3; a++) {
    PetscReal cosine, sine, half;
    AngleAt(p, a, &cosine, &sine);
    half = PetscTanReal(.5 * PetscAtan2Real(sine, cosine));
    for (PetscInt side = 0; side < 2; side++) {
      const PetscInt b = (a + 1 + side) % 3, c = (a + 2 - side) % 3;
      if (kind == EQM_HEMISPHERE_MEAN_VALUE)
        weights[2 * a + side] = half / Length(p[a], p[b]);
      else /* of the side opposite a, from b to c */
        weights[2 * b + ((b + 1) % 3 == c ? 0 : 1)] = kind == EQM_HEMISPHERE_UNIFORM    ? .5
                                                      : kind == EQM_HEMISPHERE_HARMONIC ? .5 * cosine / sine
                                                                                        : .5 / half;
    }
  }
}

typedef struct {
  EqmMesh mesh;
  const PetscReal *weights;
  const signed char *group;
} Means;

/* Rows: weights times differences to the neighbours in the same part. */
static void CellOfMeans(void *context, PetscInt cell, PetscReal *matrix)
{
  const Means *const means = context;
  const PetscInt *const v = means->mesh->cells + 3 * cell;

  for (PetscInt k = 0; k < 9; k++) matrix[k] = 0.;
  for (PetscInt k = 0; k < DIRECTIONS; k++) {
    const PetscInt a = k / 2, b = (a + 1 + k % 2) % 3;
    const PetscReal w = means->weights[DIRECTIONS * cell + k];
    matrix[4 * a] += w;
    if (means->group[v[a]] == means->group[v[b]]) matrix[3 * a + b] -= w;
  }
}

/* Mean-value weights: L U. */
static PetscErrorCode SolveUnsymmetric(EqmProblem problem, Means *means, PetscReal *columns)
{
  const EqmMesh mesh = problem->mesh;
  EqmUnknowns unknowns = {.num_owned = mesh->num_owned, .first = mesh->vertex_start, .start = mesh->global};
  unsigned char *count;
  EqmGeneral general;
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local, &count));
  for (PetscInt v = 0; v < mesh->num_local; v++) count[v] = 1;
  unknowns.count = count;
  PetscCall(EqmGeneralCreate(mesh, &unknowns, PETSC_FALSE, PETSC_FALSE, &general));
  PetscCall(EqmGeneralFactor(general, CellOfMeans, means, 0., &success));
  if (!success)
    EqmFail(problem->comm, EQM_ERR_MESH, "the matrix of -start_weights is singular (degenerate cells): take another");
  PetscCall(EqmGeneralSolve(general, 2, columns));
  PetscCall(EqmGeneralDestroy(&general));
  PetscCall(PetscFree(count));
  PetscFunctionReturn(0);
}

/* The others: the scalar Laplacian with weights per edge, in the order of EqmCellEdge. */
static PetscErrorCode SolveSymmetric(EqmProblem problem, const Means *means, PetscReal *columns)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal *edges;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * mesh->num_local_cells, &edges));
  for (PetscInt k = 0; k < 3 * mesh->num_local_cells; k++) {
    PetscInt a, b;
    EqmCellEdge(3, k % 3, &a, &b);
    edges[k] = means->weights[DIRECTIONS * (k / 3) + 2 * a + ((a + 1) % 3 == b ? 0 : 1)];
  }
  PetscCall(EqmGroupFactor(problem, edges, means->group, NULL));
  PetscCall(EqmGroupSolve(problem, 2, columns));
  PetscCall(PetscFree(edges));
  PetscFunctionReturn(0);
}

/* Right-hand side from the held circle: an edge that the curve crosses joins each of its ends to the crossing's point
   on the circle. */
static void CircleRightHandSide(const EqmCut *cut, const PetscReal *weights, PetscReal *columns)
{
  const EqmMesh mesh = cut->problem->mesh;
  const PetscInt n = mesh->num_owned;

  for (PetscInt k = 0; k < 2 * n; k++) columns[k] = 0.;
  for (PetscInt k = 0; k < DIRECTIONS * mesh->num_local_cells; k++) {
    const PetscInt *const v = mesh->cells + 3 * (k / DIRECTIONS), a = k % DIRECTIONS / 2;
    const PetscInt i = v[a], j = v[(a + 1 + k % 2) % 3];
    const PetscInt low = EqmCutIsBelow(cut, i) ? i : j, high = low == i ? j : i;
    if (i >= n || EqmCutIsBelow(cut, i) == EqmCutIsBelow(cut, j)) continue;
    const EqmCrossing *const crossing = EqmCutFindCrossing(cut, (PetscInt)cut->input[low], (PetscInt)cut->input[high]);
    columns[i] += weights[k] * PetscCosReal(crossing->angle);
    columns[n + i] += weights[k] * PetscSinReal(crossing->angle);
  }
}

PetscErrorCode EqmHemispheresMap(const EqmCut *cut, EqmHemisphereWeights kind, EqmIterate iterate, signed char *group)
{
  const EqmProblem problem = cut->problem;
  const EqmMesh mesh = problem->mesh;
  const PetscInt n = mesh->num_owned;
  PetscReal *columns, *weights;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(2 * n, &columns, DIRECTIONS * mesh->num_local_cells, &weights));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscReal *p[3];
    for (PetscInt a = 0; a < 3; a++) p[a] = mesh->position + 3 * mesh->cells[3 * c + a];
    WeightsOfCell(p, kind, weights + DIRECTIONS * c);
  }
  for (PetscInt v = 0; v < mesh->num_local; v++) group[v] = EqmCutIsBelow(cut, v) ? 0 : 1;
  Means means = {mesh, weights, group};
  CircleRightHandSide(cut, weights, columns);
  if (kind == EQM_HEMISPHERE_MEAN_VALUE)
    PetscCall(SolveUnsymmetric(problem, &means, columns));
  else
    PetscCall(SolveSymmetric(problem, &means, columns));
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal p = columns[v], q = columns[n + v], squared = p * p + q * q;
    PetscReal *const x = iterate->place.x + 3 * v;
    x[0] = 2. * p / (1. + squared);
    x[1] = 2. * q / (1. + squared);
    x[2] = (group[v] == 0 ? -1. : 1.) * (1. - squared) / (1. + squared);
  }
  PetscCall(PetscFree2(columns, weights));
  PetscCall(EqmMeshUpdateGhosts(mesh, 3, iterate->place.x));
  PetscCall(EqmSphereOrient(problem, iterate));
  PetscFunctionReturn(0);
}
