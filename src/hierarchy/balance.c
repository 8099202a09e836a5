/* The minimum of a level's objective by damped Gauss-Newton steps on factored matrices. */
#include "hierarchy/balance.h"
#include "hierarchy/levelsystem.h"
#include "hierarchy/prolongation.h"

/* A cell's Laplacian with equal weights, for one coordinate; what is held goes to the right-hand side. */
static void AddTutteCell(const EqmLevelMap *map, const unsigned char *count, PetscInt axis, PetscInt cell,
                         EqmLevelSystem *system)
{
  const PetscInt *const v = map->level->cells + 3 * cell;
  PetscReal matrix[9], right[3];
  PetscInt size = 0, n = 0;

  for (PetscInt a = 0; a < 3; a++) size += count[v[a]];
  for (PetscInt a = 0; a < 3; a++) {
    PetscInt m = 0;
    if (!count[v[a]]) continue;
    right[n] = 0.;
    for (PetscInt b = 0; b < 3; b++) {
      if (count[v[b]])
        matrix[size * n + m++] = a == b ? 2. : -1.;
      else
        right[n] += map->x[2 * v[b] + axis];
    }
    n++;
  }
  EqmLevelSystemAdd(system, cell, matrix, right);
}

PetscErrorCode EqmTutteLevel(EqmLevelMap *map)
{
  const EqmHierarchyLevel *const level = map->level;
  unsigned char *count;
  EqmLevelSystem system;
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(level->num_vertices, &count));
  for (PetscInt v = 0; v < level->num_vertices; v++) count[v] = level->part[v] == EQM_INSIDE;
  PetscCall(EqmLevelSystemCreate(level, count, &system));
  for (PetscInt axis = 0; axis < 2; axis++) {
    PetscCall(EqmLevelSystemClear(&system));
    for (PetscInt c = 0; c < level->num_cells; c++) AddTutteCell(map, count, axis, c, &system);
    PetscCall(EqmLevelSystemEnd(&system, 0., &success));
    if (success) PetscCall(EqmLevelSystemFactorSolve(&system, &success));
    for (PetscInt v = 0; v < level->num_vertices && success; v++) {
      if (count[v]) map->x[2 * v + axis] = system.solution[2 * v];
    }
  }
  PetscCall(EqmLevelSystemDestroy(&system));
  PetscCall(PetscFree(count));
  PetscFunctionReturn(0);
}

/* Fewer are not worth the threads. */
enum { LEAST_VERTICES = 4096 };

typedef struct {
  EqmLevelMap *map;
  PetscInt coarser; /* levels for multigrid; 0: factor */
  EqmLevelSystem system;
  PetscReal damping, tolerance;
} Newton;

static void AssemblePiece(const EqmLevelMap *map, PetscReal damping, PetscReal floor, PetscInt piece,
                          EqmLevelSystem *system)
{
  const EqmLevelPieces *const pieces = &system->cells;

  for (PetscInt q = pieces->start[piece]; q < pieces->start[piece + 1]; q++)
    EqmBalanceAddCell(map, pieces->item[q], damping, floor, system);
}

PetscErrorCode EqmBalanceAssemble(const EqmLevelMap *map, PetscReal damping, PetscReal residual, EqmLevelSystem *system,
                                  PetscBool *success)
{
  const PetscReal floor = .3 * PetscSqrtReal(residual), shift = 1e-10;
  const EqmLevelPieces *const pieces = &system->cells;

  PetscFunctionBegin;
  PetscCall(EqmLevelSystemClear(system));
#pragma omp parallel for schedule(dynamic) if (pieces->count > 1)
  for (PetscInt k = 0; k < pieces->count; k++) AssemblePiece(map, damping, floor, k, system);
  AssemblePiece(map, damping, floor, pieces->count, system); /* the cells between pieces */
  PetscCall(EqmLevelSystemEnd(system, shift, success));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBalanceSystemCreate(const EqmLevelMap *map, EqmLevelSystem *system)
{
  unsigned char *count;
  PetscReal frame[6];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(map->level->num_vertices, &count));
  for (PetscInt v = 0; v < map->level->num_vertices; v++)
    count[v] = (unsigned char)EqmMotionFrame((EqmMotion)map->motion[v], map->x + map->dim * v, frame);
  PetscCall(EqmLevelSystemCreate(map->level, count, system));
  PetscCall(PetscFree(count));
  PetscFunctionReturn(0);
}

/* Solve by multigrid, with prolongations at the present map. */
static PetscErrorCode MultigridSolve(Newton *newton, PetscBool *success)
{
  PetscInt iterations;
  EqmProlongation prolongation[EQM_MOST_LEVELS];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < newton->coarser; k++) {
    EqmLevelMap *const map = newton->map + k;
    PetscCall(EqmLevelMapRestrict(map, map + 1));
    PetscCall(EqmProlongationCreate(map, map + 1, &prolongation[k]));
  }
  PetscCall(EqmLevelSystemMultigridSolve(&newton->system, newton->coarser, prolongation, newton->tolerance, &iterations,
                                         success));
  for (PetscInt k = 0; k < newton->coarser; k++) PetscCall(EqmProlongationDestroy(&prolongation[k]));
  PetscFunctionReturn(0);
}

void EqmBalanceMove(const EqmLevelMap *map, const PetscReal *step, PetscReal t, PetscReal *to)
{
  const PetscInt dim = map->dim;

#pragma omp parallel for schedule(static) if (map->level->num_vertices > LEAST_VERTICES)
  for (PetscInt v = 0; v < map->level->num_vertices; v++) {
    const EqmMotion motion = (EqmMotion)map->motion[v];
    PetscReal frame[6];
    const PetscInt count = EqmMotionFrame(motion, map->x + dim * v, frame);
    for (PetscInt c = 0; c < dim; c++) {
      PetscReal d = 0.;
      for (PetscInt k = 0; k < count; k++) d += step[2 * v + k] * frame[dim * k + c];
      to[dim * v + c] = map->x[dim * v + c] + t * d;
    }
    EqmRetract(motion, to + dim * v);
  }
}

PetscErrorCode EqmBalanceSearch(EqmLevelMap *map, const PetscReal *step, EqmBalanceEvaluate evaluate, void *context,
                                EqmLevelValue *value, PetscReal *t)
{
  enum { MOST_TRIALS = 12 };
  const PetscInt length = map->dim * map->level->num_vertices;
  EqmLevelValue best = *value;
  PetscReal s = 1., total = map->total, *trial, *kept;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(length, &trial, length, &kept));
  *t = 0.;
  for (PetscInt n = 0; n < MOST_TRIALS; n++, s *= .5) {
    EqmLevelValue there;
    EqmBalanceMove(map, step, s, trial);
    PetscCall(evaluate(context, map, trial, &there));
    if (there.objective < best.objective) {
      PetscCall(PetscArraycpy(kept, trial, length));
      best = there;
      total = map->total;
      *t = s;
    } else if (*t > 0.) {
      break;
    }
  }
  if (*t > 0.) PetscCall(PetscArraycpy(map->x, kept, length));
  PetscCall(PetscFree2(trial, kept));
  *value = best;
  map->total = total;
  PetscFunctionReturn(0);
}

PetscReal EqmBalanceNextDamping(PetscReal damping, PetscReal t)
{
  const PetscReal least = 1e-6;

  if (t >= .99) return PetscMax(.1 * damping, least);
  if (t > .3) return damping;
  return t < .13 ? 31.6 * damping : 10. * damping;
}

static PetscErrorCode Evaluate(void *context, EqmLevelMap *map, const PetscReal *x, EqmLevelValue *value)
{
  PetscFunctionBegin;
  (void)context;
  PetscCall(EqmLevelMapEvaluate(map, x, value));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBalanceLevel(EqmLevelMap *map, PetscInt coarser, const EqmBalanceOptions *options)
{
  const PetscReal hopeless = 1e8;
  Newton newton = {.map = map, .coarser = coarser, .damping = options->damping, .tolerance = options->tolerance};
  EqmLevelValue value;

  PetscFunctionBegin;
  PetscCall(EqmLevelMapEvaluate(map, map->x, &value));
  PetscCall(EqmBalanceSystemCreate(map, &newton.system));
  for (PetscInt k = 0; k < options->most_steps && value.folds == 0 && newton.damping < hopeless; k++) {
    const PetscReal before = value.objective;
    PetscReal t = 0.;
    PetscBool success;
    PetscCall(EqmBalanceAssemble(map, newton.damping, value.residual, &newton.system, &success));
    if (success && coarser > 0)
      PetscCall(MultigridSolve(&newton, &success));
    else if (success)
      PetscCall(EqmLevelSystemFactorSolve(&newton.system, &success));
    if (success) PetscCall(EqmBalanceSearch(map, newton.system.solution, Evaluate, NULL, &value, &t));
    newton.damping = EqmBalanceNextDamping(newton.damping, t);
    if (t >= .99 && before - value.objective < options->gain * before) break;
  }
  PetscCall(EqmLevelSystemDestroy(&newton.system));
  PetscFunctionReturn(0);
}
