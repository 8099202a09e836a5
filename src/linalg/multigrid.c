/* Conjugate gradients with smoothed aggregation (P. Vanek, J. Mandel, M. Brezina, Computing 56, 1996), where a factor
   would not fit. The matrix gets as many rows for every vertex, identities where a vertex has fewer unknowns, so that
   aggregates are sets of vertices. One cycle on its own, a metric's, does as well on aggregates that are not smoothed
   (singlecycle.h), which cost a fraction to set up. */
#include "linalg/linalg.h"
#include "linalg/singlecycle.h"
#include "mesh/mesh_private.h"

typedef struct {
  KSP ksp;
  EqmSingleCycle cycle; /* of a metric, where single precision will do; else NULL */
  Vec b, x;
  PetscInt block;       /* rows per vertex */
  PetscInt *row;        /* per owned unknown: which of this rank's rows */
  PetscInt *start;      /* per local vertex: its first row */
  unsigned char *count; /* per local vertex: `block` */
  PetscInt num_fields;
  Vec *fields; /* near-null, orthonormal */
} Multigrid;

/* Diagonal of a row without an unknown, relative to the others: coarse functions that reach into it cost nothing. */
static const PetscReal padding = 1e-6;

/* The caller's matrix of a cell, spread over the rows of its vertices. */
static void PaddedCell(void *context, PetscInt cell, PetscReal *matrix)
{
  const EqmLinear linear = context;
  const Multigrid *const g = linear->data;
  const EqmMesh mesh = linear->mesh;
  const PetscInt size = mesh->cell_size * g->block;
  PetscReal given[EQM_MOST_CELL_UNKNOWNS * EQM_MOST_CELL_UNKNOWNS], largest = PETSC_SMALL;
  PetscInt row[EQM_MOST_CELL_UNKNOWNS], n = 0;

  for (PetscInt a = 0; a < mesh->cell_size; a++) {
    const PetscInt v = mesh->cells[mesh->cell_size * cell + a];
    for (PetscInt k = 0; k < linear->unknowns.count[v]; k++) row[n++] = g->block * a + k;
  }
  linear->cell_matrix(linear->context, cell, n == size ? matrix : given);
  if (n == size) return;
  for (PetscInt i = 0; i < n; i++) largest = PetscMax(largest, given[(n + 1) * i]);
  for (PetscInt k = 0; k < size * size; k++) matrix[k] = k % (size + 1) == 0 ? padding * largest : 0.;
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt j = 0; j < n; j++) matrix[size * row[i] + row[j]] = given[n * i + j];
  }
}

/* The matrix's rows: `block` for every vertex. */
static PetscErrorCode MakeRows(EqmLinear linear)
{
  Multigrid *const g = linear->data;
  const EqmMesh mesh = linear->mesh;
  const EqmUnknowns *const u = &linear->unknowns;
  PetscInt most = 1;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_local; v++) most = PetscMax(most, u->count[v]);
  PetscCall(MPIU_Allreduce(&most, &g->block, 1, MPIU_INT, MPI_MAX, mesh->comm));
  PetscCall(PetscMalloc3(u->num_owned, &g->row, mesh->num_local, &g->start, mesh->num_local, &g->count));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    g->start[v] = g->block * mesh->global[v];
    g->count[v] = (unsigned char)g->block;
  }
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt k = 0; k < u->count[v]; k++) g->row[u->start[v] - u->first + k] = g->block * v + k;
  }
  linear->rows = (EqmUnknowns){.num_owned = g->block * mesh->num_owned,
                               .first = g->block * mesh->vertex_start,
                               .start = g->start,
                               .count = g->count};
  linear->padded_cell = PaddedCell;
  PetscFunctionReturn(0);
}

static PetscErrorCode Analyse(EqmLinear linear, EqmOrdering ordering)
{
  Multigrid *const g = linear->data;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  PetscCall(MatSetBlockSize(matrix, g->block));
  PetscCall(MatCreateVecs(matrix, &g->x, &g->b));
  PetscFunctionReturn(0);
}

/* From unknowns to rows. Rows without an unknown are zero; in near-null fields (`field` >= 0) they are anything
   else, so that the fields stay independent on every aggregate. */
static PetscErrorCode Spread(EqmLinear linear, const PetscReal *unknowns, PetscInt field, Vec rows)
{
  const Multigrid *const g = linear->data;
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(rows, &array));
  for (PetscInt i = 0; i < linear->rows.num_owned; i++)
    array[i] = field < 0 ? 0. : PetscSinReal(1. + (PetscReal)(linear->rows.first + i) * (PetscReal)(field + 1));
  for (PetscInt i = 0; i < linear->num_owned; i++) array[g->row[i]] = unknowns[i];
  PetscCall(VecRestoreArrayWrite(rows, &array));
  PetscFunctionReturn(0);
}

/* And back. */
static PetscErrorCode Collect(EqmLinear linear, Vec rows, PetscReal *unknowns)
{
  const Multigrid *const g = linear->data;
  const PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(rows, &array));
  for (PetscInt i = 0; i < linear->num_owned; i++) unknowns[i] = array[g->row[i]];
  PetscCall(VecRestoreArrayRead(rows, &array));
  PetscFunctionReturn(0);
}

/* Orthonormal fields from those given; one that depends on its predecessors is left out. */
static PetscErrorCode SetFields(EqmLinear linear, PetscInt count, const PetscReal *fields)
{
  Multigrid *const g = linear->data;
  const PetscReal dependent = 1e-8;

  PetscFunctionBegin;
  PetscCall(VecDestroyVecs(g->num_fields, &g->fields));
  PetscCall(VecDuplicateVecs(g->x, count, &g->fields));
  g->num_fields = count;
  linear->num_fields = 0;
  for (PetscInt k = 0; k < count; k++) {
    const Vec field = g->fields[linear->num_fields];
    PetscReal before, norm;
    PetscCall(Spread(linear, fields + k * linear->num_owned, k, field));
    PetscCall(VecNormalize(field, &before));
    for (PetscInt pass = 0; pass < 2; pass++) {
      for (PetscInt m = 0; m < linear->num_fields; m++) {
        PetscScalar dot;
        PetscCall(VecDot(field, g->fields[m], &dot));
        PetscCall(VecAXPY(field, -dot, g->fields[m]));
      }
    }
    PetscCall(VecNorm(field, NORM_2, &norm));
    if (!(before > 0.) || norm < dependent) continue;
    PetscCall(VecScale(field, 1. / norm));
    linear->num_fields++;
  }
  PetscFunctionReturn(0);
}

/* Smoothers are symmetric Gauss-Seidel sweeps, which are safe for every definite matrix; Chebyshev's are not where the
   estimate of the spectrum fails. A second sweep costs more than it saves. The shift, far below every entry, is for
   coarse rows of aggregates that are too small for all the fields. From three ranks on (the last line), coarse matrices
   are sums in an order that does not depend on whose message comes first, as it does in PETSc's own choice of product,
   which is faster. The options database may say otherwise. */
static const char *const defaults[][2] = {{"-multigrid_mg_levels_ksp_type", "richardson"},
                                          {"-multigrid_mg_levels_ksp_max_it", "1"},
                                          {"-multigrid_mg_levels_pc_type", "sor"},
                                          {"-multigrid_mg_levels_pc_sor_diagonal_shift", "1e-100"},
                                          {"-matptap_via", "backend"}};

/* Of a metric: no smoothed aggregates, but small ones, not made from squares of graphs, as coarse matrices stay sparse.
 */
static const char *const metric_defaults[][2] = {{"-multigrid_pc_gamg_agg_nsmooths", "0"},
                                                 {"-multigrid_pc_gamg_aggressive_coarsening", "0"}};

/* Take what the options database says. */
static PetscErrorCode SetFromOptions(KSP ksp, EqmMatrixUse use)
{
  const PetscInt count = (PetscInt)(sizeof(metric_defaults) / sizeof(metric_defaults[0]));
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(EqmOptionsPushDefaults(metric_defaults, use == EQM_MATRIX_METRIC ? count : 0, &options));
  PetscCall(KSPSetFromOptions(ksp));
  PetscCall(EqmOptionsPopDefaults(&options));
  PetscFunctionReturn(0);
}

/* Set up all levels. */
static PetscErrorCode SetUp(KSP ksp, PetscMPIInt size)
{
  const PetscInt count = (PetscInt)(sizeof(defaults) / sizeof(defaults[0]));
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(EqmOptionsPushDefaults(defaults, size > 2 ? count : count - 1, &options));
  PetscCall(KSPSetUp(ksp));
  PetscCall(EqmOptionsPopDefaults(&options));
  PetscFunctionReturn(0);
}

/* A new iteration: PETSc's remembers fields and more of the first matrix that it has seen, and what is factored must
   not depend on what was before. */
static PetscErrorCode MakeIteration(EqmLinear linear)
{
  Multigrid *const g = linear->data;
  PC pc;

  PetscFunctionBegin;
  PetscCall(EqmSingleCycleDestroy(&g->cycle));
  PetscCall(KSPDestroy(&g->ksp));
  PetscCall(KSPCreate(linear->mesh->comm, &g->ksp));
  PetscCall(KSPSetType(g->ksp, KSPCG));
  PetscCall(KSPSetTolerances(g->ksp, linear->tolerance, PETSC_DEFAULT, PETSC_DEFAULT, 2000));
  PetscCall(KSPGetPC(g->ksp, &pc));
  PetscCall(PCSetType(pc, PCGAMG));
  PetscCall(KSPSetOptionsPrefix(g->ksp, "multigrid_"));
  PetscCall(SetFromOptions(g->ksp, linear->use));
  PetscFunctionReturn(0);
}

/* New matrices on all levels. Only the iteration can find that a matrix is not definite; what cannot be set up is not.
 */
static PetscErrorCode Factor(EqmLinear linear, PetscBool *success)
{
  Multigrid *const g = linear->data;
  PCFailedReason failed;
  MatNullSpace near;
  Mat matrix;
  PC pc;

  PetscFunctionBegin;
  if (!linear->keeps_coarse_spaces || !g->ksp) PetscCall(MakeIteration(linear));
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  PetscCall(MatSetOption(matrix, MAT_SPD, PETSC_TRUE));
  if (linear->num_fields > 0) {
    PetscCall(MatNullSpaceCreate(linear->mesh->comm, PETSC_FALSE, linear->num_fields, g->fields, &near));
    PetscCall(MatSetNearNullSpace(matrix, near));
    PetscCall(MatNullSpaceDestroy(&near));
  }
  PetscCall(KSPSetNormType(g->ksp, linear->inexact ? KSP_NORM_NATURAL : KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetTolerances(g->ksp, linear->tolerance, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSetOperators(g->ksp, matrix, matrix));
  PetscCall(KSPGetPC(g->ksp, &pc));
  PetscCall(PCGAMGSetReuseInterpolation(pc, linear->keeps_coarse_spaces));
  PetscCall(SetUp(g->ksp, linear->mesh->size));
  PetscCall(PCGetFailedReason(pc, &failed));
  *success = (PetscBool)(failed == PC_NOERROR);
  if (*success && linear->use == EQM_MATRIX_METRIC) PetscCall(EqmSingleCycleRenew(pc, &g->cycle));
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x, PetscBool *success)
{
  Multigrid *const g = linear->data;
  KSPConvergedReason reason;
  PetscInt iterations;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(linear->mesh->ledger, &work));
  for (PetscInt k = 0; k < num_rhs; k++) {
    PetscCall(Spread(linear, b + k * linear->num_owned, -1, g->b));
    PetscCall(KSPSolve(g->ksp, g->b, g->x));
    PetscCall(KSPGetConvergedReason(g->ksp, &reason));
    PetscCall(KSPGetIterationNumber(g->ksp, &iterations));
    work->cg_iterations += iterations;
    if (reason <= 0) *success = PETSC_FALSE;
    PetscCall(Collect(linear, g->x, x + k * linear->num_owned));
  }
  PetscFunctionReturn(0);
}

/* One cycle, of a metric in single precision where that will do: with symmetric sweeps before and after it is a fixed
 * symmetric definite operator. */
static PetscErrorCode Apply(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x)
{
  Multigrid *const g = linear->data;
  PC pc;

  PetscFunctionBegin;
  PetscCall(KSPGetPC(g->ksp, &pc));
  for (PetscInt k = 0; k < num_rhs; k++) {
    PetscCall(Spread(linear, b + k * linear->num_owned, -1, g->b));
    if (g->cycle)
      PetscCall(EqmSingleCycleApply(g->cycle, g->b, g->x));
    else
      PetscCall(PCApply(pc, g->b, g->x));
    PetscCall(Collect(linear, g->x, x + k * linear->num_owned));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmLinear linear)
{
  Multigrid *const g = linear->data;

  PetscFunctionBegin;
  PetscCall(VecDestroyVecs(g->num_fields, &g->fields));
  PetscCall(EqmSingleCycleDestroy(&g->cycle));
  PetscCall(KSPDestroy(&g->ksp));
  PetscCall(VecDestroy(&g->b));
  PetscCall(VecDestroy(&g->x));
  PetscCall(PetscFree3(g->row, g->start, g->count));
  PetscCall(PetscFree(linear->data));
  PetscFunctionReturn(0);
}

/* Make `linear` a multigrid-preconditioned iteration; options with the prefix -multigrid_. Collective. */
PetscErrorCode EqmLinearSetUpMultigrid(EqmLinear linear)
{
  Multigrid *g;

  PetscFunctionBegin;
  PetscCall(PetscNew(&g));
  linear->data = g;
  linear->analyse = Analyse;
  linear->set_fields = SetFields;
  linear->factor = Factor;
  linear->solve = Solve;
  linear->apply = Apply;
  linear->destroy = Destroy;
  PetscCall(MakeRows(linear));
  PetscFunctionReturn(0);
}
