/* The Galerkin matrix of the space of solenoidal motions, whose size does not depend on the mesh's: every rank has it
   whole. Cells that meet the same splines give a dense block together. */
#include "problem/solenoidal_private.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"
#include "mesh/mesh_private.h"
#include <omp.h>
#include <petscblaslapack.h>

/* Rows of a block that are multiplied at once; cells of a task, of which there are enough for the threads. */
enum { DEPTH = 128, CELLS_OF_TASK = 1024 };
/* In the Laplacian of smooth fields a cell stands for its neighbours, too: of small meshes every cell is taken, of
   larger ones so many at least, and one of so many. */
enum { LEAST_SAMPLE = 16384, MOST_PER_SAMPLE = 32 };
/* The fields are not independent: potentials that are gradients have no curl. Relative to the diagonal. */
static const PetscReal shift = 1e-9;

/* The splines that a cell meets: width[k] in each direction from begin[k] on. */
typedef struct {
  PetscInt begin[3], width[3];
} Range;

typedef struct {
  EqmSolenoidal space;
  const PetscReal *x, *weights;
  PetscReal share;
  PetscInt cells_per_sample;
  PetscInt *cell, *code, *task; /* owned cells by their ranges; tasks are parts of that list */
  PetscInt num_tasks;
} Galerkin;

static Range RangeOf(EqmMesh mesh, const PetscReal *x, PetscInt cell)
{
  Range range;

  for (PetscInt k = 0; k < 3; k++) {
    PetscInt least = EQM_SPLINE_SIDE, most = -EQM_SPLINE_SIDE;
    for (PetscInt a = 0; a < 4; a++) {
      const PetscInt base = EqmSplineBase(x[3 * mesh->cells[4 * cell + a] + k]);
      least = PetscMin(least, base);
      most = PetscMax(most, base);
    }
    range.begin[k] = least - 1;
    range.width[k] = most - least + 3;
  }
  return range;
}

static PetscInt CodeOf(const Range *r)
{
  PetscInt code = 0;

  for (PetscInt k = 0; k < 3; k++)
    code = (code * EQM_SPLINE_SIDE + r->begin[k] + EQM_SPLINE_SIDE / 2) * 10 + r->width[k];
  return code;
}

/* Tasks: cells of one range, not too many. */
static PetscErrorCode MakeTasks(Galerkin *g)
{
  const EqmMesh mesh = g->space->problem->mesh;
  const PetscInt n = mesh->num_owned_cells;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &g->cell, n, &g->code, n + 1, &g->task));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < n; c++) {
    const Range range = RangeOf(mesh, g->x, c);
    g->cell[c] = c;
    g->code[c] = CodeOf(&range);
  }
  PetscCall(PetscSortIntWithArray(n, g->code, g->cell));
  g->num_tasks = 0;
  for (PetscInt c = 0, begin = 0; c < n; c++) {
    if (c > 0 && g->code[c] == g->code[c - 1] && c - begin < CELLS_OF_TASK) continue;
    g->task[g->num_tasks++] = begin = c;
  }
  g->task[g->num_tasks] = n;
  PetscFunctionReturn(0);
}

/* What a thread works with. */
typedef struct {
  PetscScalar *row, *product, *sum; /* of `most` fields: DEPTH rows; their products; the sum of these */
  PetscInt columns, depth;
} Block;

/* Add the products of the rows so far to the sum, from the diagonal down. */
static void BlockMultiply(Block *b)
{
  const PetscInt n = b->columns;

  if (b->depth == 0) return;
  EqmDenseUpdate(b->row, n, n, b->depth, 0, n, b->product);
  for (PetscInt j = 0; j < n; j++) {
    for (PetscInt i = j; i < n; i++) b->sum[n * j + i] -= b->product[n * j + i];
  }
  b->depth = 0;
}

static PetscScalar *BlockNewRow(Block *b)
{
  PetscScalar *row;

  if (b->depth == DEPTH) BlockMultiply(b);
  row = b->row + b->columns * b->depth++;
  for (PetscInt i = 0; i < b->columns; i++) row[i] = 0.;
  return row;
}

/* Add the fields at a corner against a velocity there to a row. */
EQM_CLONES static void AddCorner(const Range *range, const EqmSplines *s, const PetscReal *x,
                                 const PetscReal velocity[3], PetscScalar *row)
{
  const PetscInt num_splines = range->width[0] * range->width[1] * range->width[2];
  PetscReal product[EQM_FIELDS_PER_SPLINE][EQM_SPLINES_AT_POINT];
  PetscInt offset[3];

  for (PetscInt k = 0; k < 3; k++) offset[k] = s->base[k] - 1 - range->begin[k];
  EqmSolenoidalAgainst(s, x, velocity, product);
  for (PetscInt f = 0; f < EQM_FIELDS_PER_SPLINE; f++) {
    for (PetscInt i = 0; i < 3; i++) {
      for (PetscInt j = 0; j < 3; j++) {
        PetscScalar *const to =
            row + f * num_splines + (range->width[1] * (offset[0] + i) + offset[1] + j) * range->width[2] + offset[2];
        for (PetscInt k = 0; k < 3; k++) to[k] += product[f][9 * i + 3 * j + k];
      }
    }
  }
}

/* The cell's Laplacian as C C^T, C with three columns: it has the constants in its null space. */
static void RootOfLaplacian(const PetscReal *weights, PetscReal root[4][3])
{
  PetscReal a[4][4];

  EqmCellLaplacian(4, weights, a);
  for (PetscInt m = 0; m < 3; m++) {
    const PetscReal pivot =
        PetscSqrtReal(PetscMax(a[m][m], PETSC_SMALL * PetscAbsReal(a[3][3]) + PETSC_MACHINE_EPSILON));
    for (PetscInt i = 0; i < 4; i++) root[i][m] = i < m ? 0. : a[i][m] / pivot;
    for (PetscInt i = m + 1; i < 4; i++) {
      for (PetscInt j = m + 1; j < 4; j++) a[i][j] -= root[i][m] * root[j][m];
    }
  }
}

static void AddCell(const Galerkin *g, PetscInt cell, const Range *range, Block *b)
{
  const EqmMesh mesh = g->space->problem->mesh;
  const PetscInt *const v = mesh->cells + 4 * cell;
  const PetscReal *const x = g->x, *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
  const PetscReal factor = PetscSqrtReal(1. / mesh->weight[cell]),
                  part = PetscSqrtReal(g->share * (PetscReal)g->cells_per_sample);
  PetscReal gradient[4][3], root[4][3];
  EqmSplines s[4];
  PetscScalar *row = BlockNewRow(b);

  EqmVolumeGradient(p, gradient[0]);
  for (PetscInt a = 0; a < 4; a++) {
    const PetscReal velocity[3] = {factor * gradient[a][0], factor * gradient[a][1], factor * gradient[a][2]};
    EqmSplinesAt(p[a], &s[a]);
    AddCorner(range, &s[a], p[a], velocity, row);
  }
  if (mesh->cell_input[cell] % g->cells_per_sample != 0) return;
  RootOfLaplacian(g->weights + 6 * cell, root);
  for (PetscInt k = 0; k < 3; k++) {
    for (PetscInt m = 0; m < 3; m++) {
      row = BlockNewRow(b);
      for (PetscInt a = m; a < 4; a++) {
        PetscReal velocity[3] = {0., 0., 0.};
        velocity[k] = part * root[a][m];
        AddCorner(range, &s[a], p[a], velocity, row);
      }
    }
  }
}

/* Which of all fields a block's are; -1: none. */
static void NumberFields(const EqmSolenoidal space, const Range *range, PetscInt *field)
{
  PetscInt n = 0;

  for (PetscInt f = 0; f < EQM_FIELDS_PER_SPLINE; f++) {
    for (PetscInt i = 0; i < range->width[0]; i++) {
      for (PetscInt j = 0; j < range->width[1]; j++) {
        for (PetscInt k = 0; k < range->width[2]; k++) {
          const PetscInt place = EqmSplinePlace(range->begin[0] + i, range->begin[1] + j, range->begin[2] + k);
          const PetscInt which = space->number[place];
          field[n++] = which < 0 ? -1 : f * space->num_splines + which;
        }
      }
    }
  }
}

/* Add a block's sum to the lower triangle; fields are numbered in the block as in the matrix. */
static void AddBlock(const EqmSolenoidal space, const Range *range, const Block *b)
{
  PetscInt field[EQM_FIELDS_PER_SPLINE * EQM_SPLINES];
  const PetscInt n = b->columns;

  NumberFields(space, range, field);
  for (PetscInt j = 0; j < n; j++) {
    if (field[j] < 0) continue;
    for (PetscInt i = j; i < n; i++) {
      if (field[i] >= 0) space->factor[(size_t)space->size * (size_t)field[j] + (size_t)field[i]] += b->sum[n * j + i];
    }
  }
}

static PetscInt ColumnsOf(const Range *range)
{
  return EQM_FIELDS_PER_SPLINE * range->width[0] * range->width[1] * range->width[2];
}

/* This rank's cells. Sums of tasks are added in the order of the tasks, whoever computed them. */
static PetscErrorCode AddCells(Galerkin *g)
{
  const EqmMesh mesh = g->space->problem->mesh;
  const PetscInt num_threads = omp_get_max_threads();
  PetscInt most = 1;
  PetscScalar *room;

  PetscFunctionBegin;
  for (PetscInt t = 0; t < g->num_tasks; t++) {
    const Range range = RangeOf(mesh, g->x, g->cell[g->task[t]]);
    most = PetscMax(most, ColumnsOf(&range));
  }
  PetscCall(PetscMalloc1(num_threads * most * (DEPTH + 2 * most), &room));
#pragma omp parallel for ordered schedule(dynamic, 1) num_threads(num_threads)
  for (PetscInt t = 0; t < g->num_tasks; t++) {
    PetscScalar *const mine = room + omp_get_thread_num() * most * (DEPTH + 2 * most);
    const Range range = RangeOf(mesh, g->x, g->cell[g->task[t]]);
    Block b = {.row = mine,
               .product = mine + most * DEPTH,
               .sum = mine + most * (DEPTH + most),
               .columns = ColumnsOf(&range)};
    for (PetscInt i = 0; i < b.columns * b.columns; i++) b.sum[i] = 0.;
    for (PetscInt c = g->task[t]; c < g->task[t + 1]; c++) AddCell(g, g->cell[c], &range, &b);
    BlockMultiply(&b);
#pragma omp ordered
    AddBlock(g->space, &range, &b);
  }
  PetscCall(PetscFree(room));
  PetscFunctionReturn(0);
}

/* The sum over all ranks, definite, factored. */
static PetscErrorCode Factor(EqmSolenoidal space)
{
  const size_t size = (size_t)space->size;
  PetscBLASInt n, info;
  PetscReal largest = 0.;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(space->size, &n));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, space->factor, n * n, MPIU_SCALAR, MPI_SUM, space->problem->comm));
  for (size_t i = 0; i < size; i++) largest = PetscMax(largest, space->factor[(size + 1) * i]);
  for (size_t i = 0; i < size; i++) {
    PetscScalar *const d = &space->factor[(size + 1) * i];
    *d = *d > 0. ? *d * (1. + shift) : largest;
  }
  PetscCallBLAS("LAPACKpotrf", LAPACKpotrf_("L", &n, space->factor, &n, &info));
  PetscCheck(info == 0, space->problem->comm, PETSC_ERR_MAT_CH_ZRPVT,
             "no factor of the metric's smooth part: the map is not finite");
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolenoidalFactor(EqmSolenoidal space, const EqmPlace *place, const PetscReal *weights,
                                   PetscReal share)
{
  const EqmMesh mesh = space->problem->mesh;
  Galerkin g = {.space = space,
                .x = place->x,
                .weights = weights,
                .share = share,
                .cells_per_sample = PetscMax(1, PetscMin(MOST_PER_SAMPLE, mesh->num_cells / LEAST_SAMPLE))};

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_FACTOR));
  if (!space->factor) PetscCall(PetscMalloc1((size_t)space->size * (size_t)space->size, &space->factor));
  PetscCall(PetscArrayzero(space->factor, (size_t)space->size * (size_t)space->size));
  PetscCall(EqmSolenoidalMakeParts(space, place->x));
  PetscCall(MakeTasks(&g));
  PetscCall(AddCells(&g));
  PetscCall(PetscFree3(g.cell, g.code, g.task));
  PetscCall(Factor(space));
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_FACTOR));
  PetscFunctionReturn(0);
}
