/* The Galerkin matrix of the space of solenoidal motions, whose size does not depend on the mesh's: every rank has it
   whole. Cells that meet the same splines give a dense block together. */
#include "problem/solenoidal_block.h"
#include "base/random.h"
#include "mesh/mesh_private.h"
#include <omp.h>
#include <petscblaslapack.h>

/* Cells of a task, of which there are enough for the threads. */
enum { CELLS_OF_TASK = 1024 };
/* In sums over smooth fields a cell stands for its neighbours, too: of small meshes every cell is taken, of larger ones
   so many at least, in the Laplacian, where a cell counts nine times, one of so many. */
enum { LEAST_SAMPLE = 16384, MOST_PER_SAMPLE = 32, LEAST_SAMPLE_OF_VOLUMES = 262144 };
/* The fields are not independent: potentials that are gradients have no curl. Relative to the diagonal. */
static const PetscReal shift = 1e-9;

typedef struct {
  EqmSolenoidal space;
  const PetscReal *x, *weights;
  PetscReal share;
  PetscInt cells_per_sample, cells_per_volume;
  PetscInt *cell, *code, *task; /* owned cells by their ranges; tasks are parts of that list */
  PetscInt num_tasks;
} Galerkin;

static EqmSplineRange RangeOf(EqmMesh mesh, const PetscReal *x, PetscInt cell)
{
  EqmSplineRange range;

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

static PetscInt CodeOf(const EqmSplineRange *r)
{
  PetscInt code = 0;

  for (PetscInt k = 0; k < 3; k++)
    code = (code * EQM_SPLINE_SIDE + r->begin[k] + EQM_SPLINE_SIDE / 2) * 10 + r->width[k];
  return code;
}

/* Whether a cell is in a sample of one in so many: by chance, as meshes often have cells of one kind in steps. The same
   on any number of ranks. */
static PetscBool IsSampled(EqmMesh mesh, PetscInt cell, PetscInt channel, PetscInt cells_per_sample)
{
  return (PetscBool)(EqmHashUniform(1, mesh->cell_input[cell], channel) * (PetscReal)cells_per_sample < 1.);
}

static PetscBool IsInVolumes(const Galerkin *g, PetscInt cell)
{
  return IsSampled(g->space->problem->mesh, cell, 0, g->cells_per_volume);
}

static PetscBool IsInLaplacian(const Galerkin *g, PetscInt cell)
{
  return IsSampled(g->space->problem->mesh, cell, 1, g->cells_per_sample);
}

/* Tasks: sampled cells of one range, not too many. */
static PetscErrorCode MakeTasks(Galerkin *g)
{
  const EqmMesh mesh = g->space->problem->mesh;
  const PetscInt num_cells = mesh->num_owned_cells;
  PetscInt n = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(num_cells, &g->cell, num_cells, &g->code, num_cells + 1, &g->task));
  for (PetscInt c = 0; c < num_cells; c++) {
    if (IsInVolumes(g, c) || IsInLaplacian(g, c)) g->cell[n++] = c;
  }
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < n; c++) {
    const EqmSplineRange range = RangeOf(mesh, g->x, g->cell[c]);
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

static void AddCell(const Galerkin *g, PetscInt cell, EqmSplineBlock *b)
{
  const EqmMesh mesh = g->space->problem->mesh;
  const PetscInt *const v = mesh->cells + 4 * cell;
  const PetscReal *const x = g->x, *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
  EqmSplines splines[4];

  for (PetscInt a = 0; a < 4; a++) EqmSplinesAt(p[a], &splines[a]);
  if (IsInVolumes(g, cell)) EqmSplineBlockAddVolume(b, p, splines, (PetscReal)g->cells_per_volume / mesh->weight[cell]);
  if (IsInLaplacian(g, cell))
    EqmSplineBlockAddLaplacian(b, p, splines, g->weights + 6 * cell, g->share * (PetscReal)g->cells_per_sample);
}

/* Which of all fields a block's are; -1: none. */
static void NumberFields(const EqmSolenoidal space, const EqmSplineRange *range, PetscInt *field)
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
static void AddBlock(const EqmSolenoidal space, const EqmSplineBlock *b)
{
  PetscInt field[EQM_FIELDS_PER_SPLINE * EQM_SPLINES];
  const PetscInt n = b->columns;

  NumberFields(space, &b->range, field);
  for (PetscInt j = 0; j < n; j++) {
    if (field[j] < 0) continue;
    for (PetscInt i = j; i < n; i++) {
      if (field[i] >= 0) space->factor[(size_t)space->size * (size_t)field[j] + (size_t)field[i]] += b->sum[n * j + i];
    }
  }
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
    const EqmSplineRange range = RangeOf(mesh, g->x, g->cell[g->task[t]]);
    most = PetscMax(most, EqmSplineRangeColumns(&range));
  }
  PetscCall(PetscMalloc1(num_threads * EqmSplineBlockRoom(most), &room));
#pragma omp parallel for ordered schedule(dynamic, 1) num_threads(num_threads)
  for (PetscInt t = 0; t < g->num_tasks; t++) {
    PetscScalar *const mine = room + omp_get_thread_num() * EqmSplineBlockRoom(most);
    const EqmSplineRange range = RangeOf(mesh, g->x, g->cell[g->task[t]]);
    EqmSplineBlock b;
    EqmSplineBlockBegin(&range, mine, &b);
    for (PetscInt c = g->task[t]; c < g->task[t + 1]; c++) AddCell(g, g->cell[c], &b);
    EqmSplineBlockEnd(&b);
#pragma omp ordered
    AddBlock(g->space, &b);
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
                .cells_per_sample = PetscMax(1, PetscMin(MOST_PER_SAMPLE, mesh->num_cells / LEAST_SAMPLE)),
                .cells_per_volume = PetscMax(1, mesh->num_cells / LEAST_SAMPLE_OF_VOLUMES)};

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
