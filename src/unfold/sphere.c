/* Bijectivity repair on the sphere (001 section 6.2, corrected): a folded triangle is turned to the south pole, the cap
   around it is replaced by the mean-value map of its rim; then the next folded triangle. Caps alternate between large
   and small. */
#include "unfold/unfold.h"
#include "mesh/mesh_private.h"
#include "linalg/linalg.h"
#include "geometry/simplex.h"

enum { MOST_ROUNDS = 40 };
#define SHORTEST 1e-12

typedef struct {
  EqmMesh mesh;
  PetscReal *z;   /* stereographic images from the pole opposite to the cap, two per local vertex */
  PetscBool *cap; /* per local vertex: is it solved for? */
  Mat matrix;
  EqmLu lu;
  Vec b, x;
  PetscReal *values;
} Unfold;

/* The mean-value matrix is not symmetric: its own pattern, rows of owned vertices, both neighbours of each corner. */
static PetscErrorCode UnfoldCreate(EqmMesh mesh, Unfold *u)
{
  PetscInt *row, *column, entry = 0;
  const PetscInt most = 9 * mesh->num_local_cells;

  PetscFunctionBegin;
  u->mesh = mesh;
  PetscCall(PetscMalloc3(2 * mesh->num_local, &u->z, mesh->num_local, &u->cap, most, &u->values));
  PetscCall(PetscMalloc2(most, &row, most, &column));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    for (PetscInt k = 0; k < 9; k++, entry++) {
      const PetscInt v = mesh->cells[3 * c + k / 3];
      row[entry] = v < mesh->num_owned ? mesh->global[v] : -1;
      column[entry] = mesh->global[mesh->cells[3 * c + (k / 3 + k % 3) % 3]];
    }
  }
  PetscCall(MatCreate(mesh->comm, &u->matrix));
  PetscCall(MatSetSizes(u->matrix, mesh->num_owned, mesh->num_owned, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(u->matrix, MATAIJ));
  PetscCall(MatSetPreallocationCOO(u->matrix, most, row, column));
  PetscCall(PetscFree2(row, column));
  PetscCall(PetscArrayzero(u->values, most));
  PetscCall(MatSetValuesCOO(u->matrix, u->values, INSERT_VALUES));
  PetscCall(MatCreateVecs(u->matrix, &u->x, &u->b));
  PetscCall(EqmLuCreate(u->matrix, "unfold_", &u->lu));
  PetscFunctionReturn(0);
}

static PetscErrorCode UnfoldDestroy(Unfold *u)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(u->z, u->cap, u->values));
  PetscCall(EqmLuDestroy(&u->lu));
  PetscCall(MatDestroy(&u->matrix));
  PetscCall(VecDestroy(&u->x));
  PetscCall(VecDestroy(&u->b));
  PetscFunctionReturn(0);
}

/* tan(half the angle at corner a) over the length of each edge there (001 (6.3b)). */
static void MeanValueWeights(const PetscReal *a, const PetscReal *b, const PetscReal *c, PetscReal *to_b,
                             PetscReal *to_c)
{
  const PetscReal u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {c[0] - a[0], c[1] - a[1]};
  const PetscReal lu = PetscSqrtReal(u[0] * u[0] + u[1] * u[1]), lv = PetscSqrtReal(v[0] * v[0] + v[1] * v[1]);
  const PetscReal angle = PetscAbsReal(PetscAtan2Real(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]));
  const PetscReal tangent = PetscMax(1e-8, PetscMin(PetscTanReal(.5 * angle), 1e8));

  *to_b = tangent / PetscMax(lu, SHORTEST); /* keeps the weight finite where corners coincide */
  *to_c = tangent / PetscMax(lv, SHORTEST);
}

/* Rows are scaled to diagonal one and sum to zero: unscaled weights spread over sixteen orders of magnitude. */
static PetscErrorCode FillMatrix(Unfold *u)
{
  const EqmMesh mesh = u->mesh;
  PetscReal *total;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(mesh->num_local, &total));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    for (PetscInt a = 0; a < 3; a++) {
      const PetscInt i = mesh->cells[3 * c + a], j = mesh->cells[3 * c + (a + 1) % 3],
                     k = mesh->cells[3 * c + (a + 2) % 3];
      PetscReal *const entry = u->values + 9 * c + 3 * a, to_j = 0., to_k = 0.;
      if (u->cap[i]) MeanValueWeights(u->z + 2 * i, u->z + 2 * j, u->z + 2 * k, &to_j, &to_k);
      entry[0] = u->cap[i] ? to_j + to_k : 1.;
      entry[1] = -to_j;
      entry[2] = -to_k;
      total[i] += entry[0];
    }
  }
  for (PetscInt e = 0; e < 9 * mesh->num_local_cells; e++) u->values[e] /= total[mesh->cells[e / 3]];
  PetscCall(PetscFree(total));
  PetscCall(MatSetValuesCOO(u->matrix, u->values, INSERT_VALUES));
  PetscCall(EqmLuRefresh(u->lu));
  PetscFunctionReturn(0);
}

/* Both coordinates of the cap from those of the rim. The rows of held vertices are the identity's. */
static PetscErrorCode SolveCap(Unfold *u)
{
  const EqmMesh mesh = u->mesh;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(FillMatrix(u));
  PetscCall(EqmLedgerGetWork(mesh->ledger, &work));
  work->factorizations++;
  for (PetscInt k = 0; k < 2; k++) {
    PetscScalar *value;
    PetscCall(VecGetArrayWrite(u->b, &value)); /* right-hand side: zero in the cap, the images of held vertices */
    for (PetscInt v = 0; v < mesh->num_owned; v++) value[v] = u->cap[v] ? 0. : u->z[2 * v + k];
    PetscCall(VecRestoreArrayWrite(u->b, &value));
    PetscCall(EqmLuSolve(u->lu, u->b, u->x));
    work->solves++;
    PetscCall(VecGetArray(u->x, &value));
    for (PetscInt v = 0; v < mesh->num_owned; v++) u->z[2 * v + k] = u->cap[v] ? value[v] : u->z[2 * v + k];
    PetscCall(VecRestoreArray(u->x, &value));
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, u->z));
  PetscFunctionReturn(0);
}

/* Direction of the folded cell of lowest input number. Collective. */
static PetscErrorCode FirstFold(EqmProblem problem, EqmIterate iterate, const PetscReal *det, PetscReal center[3])
{
  const EqmMesh mesh = problem->mesh;
  PetscInt mine = PETSC_MAX_INT, lowest, cell = -1;
  PetscReal sum[3] = {0., 0., 0.}, length;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    if (det[c] > 0. || mesh->cell_input[c] >= mine) continue;
    mine = mesh->cell_input[c];
    cell = c;
  }
  PetscCall(MPIU_Allreduce(&mine, &lowest, 1, MPIU_INT, MPI_MIN, mesh->comm));
  for (PetscInt a = 0; a < 3 && mine == lowest; a++) {
    for (PetscInt k = 0; k < 3; k++) sum[k] += iterate->place.x[3 * mesh->cells[3 * cell + a] + k];
  }
  PetscCall(MPIU_Allreduce(sum, center, 3, MPIU_REAL, MPIU_SUM, mesh->comm));
  length = PetscSqrtReal(EqmDot3(center, center));
  for (PetscInt k = 0; k < 3; k++) center[k] /= length;
  PetscFunctionReturn(0);
}

/* Project the cap of stereographic radius r around `center` to the plane, solve, project back. */
static PetscErrorCode StraightenCap(EqmProblem problem, EqmIterate iterate, Unfold *u, const PetscReal center[3],
                                    PetscReal r)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal axis[3] = {0., 0., 0.}, b1[3], b2[3], length, *const x = iterate->place.x;
  PetscInt smallest = 0, rim = 0;

  PetscFunctionBegin;
  for (PetscInt k = 1; k < 3; k++) smallest = PetscAbsReal(center[k]) < PetscAbsReal(center[smallest]) ? k : smallest;
  axis[smallest] = 1.;
  EqmCross(center, axis, b1);
  length = PetscSqrtReal(EqmDot3(b1, b1));
  for (PetscInt k = 0; k < 3; k++) b1[k] /= length;
  EqmCross(center, b1, b2);
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal scale = PetscMax(1. + EqmDot3(x + 3 * v, center), PETSC_MACHINE_EPSILON);
    u->z[2 * v] = EqmDot3(x + 3 * v, b1) / scale;
    u->z[2 * v + 1] = EqmDot3(x + 3 * v, b2) / scale;
    u->cap[v] = (PetscBool)(PetscSqr(u->z[2 * v]) + PetscSqr(u->z[2 * v + 1]) < r * r);
  }
  for (PetscInt v = 0; v < mesh->num_owned; v++) rim += !u->cap[v];
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &rim, 1, MPIU_INT, MPI_SUM, mesh->comm));
  if (rim < 3) PetscFunctionReturn(0); /* nothing would hold the cap: so small a mesh is all cap */
  PetscCall(SolveCap(u));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal p = u->z[2 * v], q = u->z[2 * v + 1], squared = p * p + q * q;
    for (PetscInt k = 0; k < 3 && u->cap[v]; k++)
      x[3 * v + k] = (2. * p * b1[k] + 2. * q * b2[k] + (1. - squared) * center[k]) / (1. + squared);
  }
  PetscFunctionReturn(0);
}

/* Try to unfold iterate->place; `before` and `after` count the folds. The map with the fewest is kept. Collective. */
PetscErrorCode EqmSphereUnfold(EqmProblem problem, EqmIterate iterate, PetscInt64 *before, PetscInt64 *after)
{
  Unfold unfold;
  EqmPlace best;
  PetscInt64 folds;
  PetscReal *det, center[3];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(problem->mesh->num_local_cells, &det));
  PetscCall(EqmImageFolds(problem->domain, &iterate->place, det, before));
  *after = *before;
  if (*before > 0) {
    PetscCall(UnfoldCreate(problem->mesh, &unfold));
    PetscCall(EqmPlaceCreate(problem->domain, &best));
    PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &best));
    for (PetscInt round = 0; round < MOST_ROUNDS && (*after) > 0; round++) {
      PetscCall(FirstFold(problem, iterate, det, center));
      PetscCall(StraightenCap(problem, iterate, &unfold, center, round % 2 ? .6 : 1.2));
      PetscCall(EqmImageFolds(problem->domain, &iterate->place, det, &folds));
      if (folds >= *after) continue;
      *after = folds;
      PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &best));
    }
    PetscCall(EqmPlaceCopy(problem->domain, &best, &iterate->place));
    PetscCall(EqmPlaceMakeFrames(problem->domain, &iterate->place));
    PetscCall(EqmPlaceDestroy(&best));
    PetscCall(UnfoldDestroy(&unfold));
  }
  PetscCall(PetscFree(det));
  PetscFunctionReturn(0);
}

/* The correction as printed (001 section 6.2): the southern hemisphere and a little more by (6.2), and after the
   inversion (6.4) the northern one, once each; what comes of it is taken. */
PetscErrorCode EqmSphereUnfoldAsPrinted(EqmProblem problem, EqmIterate iterate, PetscInt64 *before, PetscInt64 *after)
{
  static const PetscReal poles[2][3] = {{0., 0., -1.}, {0., 0., 1.}};
  Unfold unfold;
  PetscReal *det;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(problem->mesh->num_local_cells, &det));
  PetscCall(EqmImageFolds(problem->domain, &iterate->place, det, before));
  *after = *before;
  if (*before > 0) {
    PetscCall(UnfoldCreate(problem->mesh, &unfold));
    for (int k = 0; k < 2; k++) PetscCall(StraightenCap(problem, iterate, &unfold, poles[k], 1.2));
    PetscCall(EqmImageFolds(problem->domain, &iterate->place, det, after));
    PetscCall(EqmPlaceMakeFrames(problem->domain, &iterate->place));
    PetscCall(UnfoldDestroy(&unfold));
  }
  PetscCall(PetscFree(det));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereUnfoldFirstMap(EqmProblem problem, EqmIterate iterate)
{
  PetscErrorCode (*const unfold)(EqmProblem, EqmIterate, PetscInt64 *, PetscInt64 *) =
      problem->unfolding == EQM_UNFOLD_PAPER ? EqmSphereUnfoldAsPrinted : EqmSphereUnfold;

  PetscFunctionBegin;
  if (problem->unfolding == EQM_UNFOLD_NONE) PetscFunctionReturn(0);
  PetscCall(unfold(problem, iterate, &iterate->unfolded_from, &iterate->unfolded_to));
  PetscFunctionReturn(0);
}
