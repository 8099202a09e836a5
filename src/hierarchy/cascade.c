/* From the coarsest level to the finest. */
#include "hierarchy/balance.h"
#include "hierarchy/cycle.h"
#include "hierarchy/reinsert.h"
#include "base/quiet.h"
#include <math.h>

PetscErrorCode EqmCascadeOptionsDefault(EqmCascadeOptions *options)
{
  PetscFunctionBegin;
  *options = (EqmCascadeOptions){.epsilon = .1,
                                 .epsilon_finest = .1,
                                 .sweeps = 6,
                                 .least_gain = .02,
                                 .steps = 1,
                                 .direct = 1500,
                                 .bottom = EQM_CYCLE_BOTTOM,
                                 .coarsest = 1000,
                                 .trace = PETSC_FALSE};
  PetscFunctionReturn(0);
}

/* The first four vertices on the sphere, as the corners of a regular tetrahedron; the rest comes by reinsertion. */
static PetscErrorCode PlaceTetrahedron(EqmLevelMap *map)
{
  static const signed char corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  EqmLevelValue value;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 12; k++) map->x[k] = corner[k / 3][k % 3] / PetscSqrtReal(3.);
  PetscCall(EqmLevelMapEvaluate(map, map->x, &value));
  if (value.folds > 0) {
    for (PetscInt v = 0; v < 4; v++) map->x[3 * v] *= -1.;
  }
  PetscFunctionReturn(0);
}

/* To the minimum. Where that is far from equal areas in the plane, the weight of the angles falls until it is close:
   shear grows with a strip's length by width, and outweighs the areas where that is in the hundreds. */
static PetscErrorCode BalanceCoarsest(EqmLevelMap *map, EqmCascadeOptions *options)
{
  const EqmBalanceOptions steps = {.most_steps = 60, .gain = 1e-3, .damping = .1};
  const PetscReal far = .1, close = .01, least_epsilon = 1e-6;
  EqmLevelValue value;

  PetscFunctionBegin;
  map->epsilon = options->epsilon;
  for (int k = 0; k < 2; k++) PetscCall(EqmBalanceLevel(map, 0, &steps)); /* once more with the damping of the first */
  PetscCall(EqmLevelMapEvaluate(map, map->x, &value));
  if (map->dim == 3 || !(value.energy > far * map->total)) PetscFunctionReturn(0);
  while (value.energy > close * map->total && map->epsilon > least_epsilon) {
    map->epsilon *= .1;
    PetscCall(EqmBalanceLevel(map, 0, &steps));
    PetscCall(EqmLevelMapEvaluate(map, map->x, &value));
  }
  options->epsilon = map->epsilon;
  options->epsilon_finest = PetscMin(map->epsilon, options->epsilon_finest);
  PetscFunctionReturn(0);
}

/* Map one of the coarsest levels. Planar: the finest of them, for coarser ones have more ways to go wrong, but Tutte's
   map shrinks limbs until arithmetic loses them. Returns which. */
static PetscErrorCode MapCoarsest(EqmLevelMap *map, PetscInt last, EqmCascadeOptions *options, PetscInt *which)
{
  PetscInt k = last;
  EqmLevelValue value;

  PetscFunctionBegin;
  if (map[last].dim == 3) {
    PetscCall(PlaceTetrahedron(&map[last]));
  } else {
    while (k > 0 && map[k - 1].level->num_vertices <= options->coarsest) k--;
    for (; k <= last; k++) {
      PetscCall(EqmTutteLevel(&map[k]));
      PetscCall(EqmLevelMapEvaluate(&map[k], map[k].x, &value));
      if (value.folds == 0 || k == last) break;
    }
  }
  PetscCall(BalanceCoarsest(&map[k], options));
  *which = k;
  PetscFunctionReturn(0);
}

static PetscErrorCode Show(const EqmCascadeOptions *options, EqmLevelMap *map, const char *what, PetscInt count)
{
  EqmLevelValue value;

  PetscFunctionBegin;
  if (!options->trace) PetscFunctionReturn(0);
  PetscCall(EqmLevelMapEvaluate(map, map->x, &value));
  PetscCall(PetscPrintf(PETSC_COMM_SELF,
                        "  %8" PetscInt_FMT " vertices, %-12s %5" PetscInt_FMT
                        ": energy %.3e, objective %.3e, folds %" PetscInt_FMT ", worst quality %.2g\n",
                        map->level->num_vertices, what, count, (double)value.energy, (double)value.objective,
                        value.folds, (double)EqmLevelWorstQuality(map->level)));
  PetscFunctionReturn(0);
}

/* How many of the next coarser levels multigrid needs; none where the level is small enough to be factored. */
static PetscInt LevelsBelow(const EqmLevelMap *map, PetscInt left, const EqmCascadeOptions *options)
{
  PetscInt k = 0;

  if (map->level->num_vertices <= options->direct) return 0;
  while (k < left && map[k].level->num_vertices > options->bottom) k++;
  return k;
}

/* A level whose map has come back from the next coarser one; `left`: how many are below. */
static PetscErrorCode RelaxLevel(EqmLevelMap *map, PetscInt left, const EqmCascadeOptions *options)
{
  enum { MOST_STEPS = 60, WORK = 1000000 };
  const PetscInt below = LevelsBelow(map, left, options);
  const EqmBalanceOptions direct = {.most_steps = PetscMin(MOST_STEPS, WORK / map->level->num_vertices + 1),
                                    .gain = 1e-3,
                                    .damping = .1},
                          multigrid = {.most_steps = options->steps, .gain = 1e-2, .damping = .03, .tolerance = .1};
  EqmLevelStars stars;
  EqmLevelValue first, value;

  PetscFunctionBegin;
  PetscCall(EqmLevelMapKeepAngles(map));
  PetscCall(EqmLevelStarsCreate(map->level, &stars));
  PetscCall(EqmLevelMapEvaluate(map, map->x, &first)); /* for its total, too */
  value = first;
  for (PetscInt s = 0; s < options->sweeps; s += 2) {
    const PetscReal before = value.objective;
    PetscCall(EqmRelaxLevel(map, &stars, PetscMin(2, options->sweeps - s)));
    PetscCall(EqmLevelMapEvaluate(map, map->x, &value));
    if (value.objective > (1. - options->least_gain) * before) break;
  }
  PetscCall(Show(options, map, "sweeps", options->sweeps));
  if (below == 0 || value.objective <= (1. - options->least_gain) * first.objective)
    PetscCall(EqmBalanceLevel(map, below, below > 0 ? &multigrid : &direct));
  PetscCall(Show(options, map, "steps", below));
  PetscCall(EqmRelaxLevel(map, &stars, EQM_SWEEPS_AFTER));
  PetscCall(EqmLevelStarsDestroy(&stars));
  PetscFunctionReturn(0);
}

/* Maps of all levels; `x`, the finest's places, tells where vertices may move. */
static PetscErrorCode CreateMaps(EqmHierarchy hierarchy, EqmCascadeTarget target, const PetscReal *x, EqmLevelMap *map)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < hierarchy->num_levels; k++) {
    PetscCall(EqmLevelMapCreate(&hierarchy->level[k], target, &map[k]));
    if (k == 0) {
      PetscCall(PetscArraycpy(map[0].x, x, map[0].dim * hierarchy->level[0].num_vertices));
      PetscCall(EqmLevelMapSetMotions(&map[0], target));
    } else {
      PetscCall(EqmLevelMapRestrict(&map[k - 1], &map[k]));
    }
  }
  PetscFunctionReturn(0);
}

/* The finest level's map goes to x, and all are freed. */
static PetscErrorCode TakeFinest(EqmHierarchy hierarchy, EqmLevelMap *map, PetscReal *x, EqmCascadeResult *result)
{
  EqmLevelValue value;

  PetscFunctionBegin;
  PetscCall(EqmLevelMapEvaluate(&map[0], map[0].x, &value));
  result->folds = value.folds;
  result->energy = value.energy;
  result->objective = value.objective;
  PetscCall(PetscArraycpy(x, map[0].x, map[0].dim * hierarchy->level[0].num_vertices));
  for (PetscInt k = 0; k < hierarchy->num_levels; k++) PetscCall(EqmLevelMapDestroy(&map[k]));
  PetscFunctionReturn(0);
}

/* What the first rank does. */
typedef PetscErrorCode (*Work)(EqmHierarchy, EqmCascadeTarget, const EqmCascadeOptions *, PetscReal *,
                               EqmCascadeResult *);

static PetscErrorCode CascadeLevels(EqmHierarchy hierarchy, EqmCascadeTarget target, const EqmCascadeOptions *options,
                                    PetscReal *x, EqmCascadeResult *result)
{
  const PetscInt last = hierarchy->num_levels - 1;
  EqmCascadeOptions weighted = *options;
  EqmLevelMap map[EQM_MOST_LEVELS];
  PetscInt coarsest;

  PetscFunctionBegin;
  PetscCall(CreateMaps(hierarchy, target, x, map));
  result->before = INFINITY;
  PetscCall(MapCoarsest(map, last, &weighted, &coarsest));
  result->epsilon = weighted.epsilon;
  PetscCall(Show(options, &map[coarsest], "coarsest", 0));
  for (PetscInt k = coarsest - 1; k >= 0; k--) {
    PetscInt hard;
    PetscCall(EqmReinsert(&map[k + 1], &map[k], &hard));
    map[k].epsilon = k == 0 ? weighted.epsilon_finest : weighted.epsilon;
    PetscCall(Show(options, &map[k], "reinserted", hard));
    PetscCall(RelaxLevel(&map[k], last - k, options));
  }
  PetscCall(TakeFinest(hierarchy, map, x, result));
  PetscFunctionReturn(0);
}

static PetscErrorCode RelaxFinest(EqmHierarchy hierarchy, EqmCascadeTarget target, const EqmCascadeOptions *options,
                                  PetscReal *x, EqmCascadeResult *result)
{
  EqmLevelMap map[EQM_MOST_LEVELS];
  EqmLevelValue value;

  PetscFunctionBegin;
  PetscCall(CreateMaps(hierarchy, target, x, map));
  map[0].epsilon = result->epsilon = options->epsilon_finest;
  PetscCall(EqmLevelMapEvaluate(&map[0], map[0].x, &value));
  result->before = value.objective;
  if (value.folds == 0) PetscCall(RelaxLevel(&map[0], hierarchy->num_levels - 1, options));
  PetscCall(TakeFinest(hierarchy, map, x, result));
  PetscFunctionReturn(0);
}

static PetscErrorCode OnFirstRank(EqmHierarchy hierarchy, Work work, EqmCascadeTarget target,
                                  const EqmCascadeOptions *options, PetscReal *x, EqmCascadeResult *result)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message)); /* the other ranks wait for this one */
  if (hierarchy->rank == 0) code = work(hierarchy, target, options, x, result);
  PetscCall(PetscPopErrorHandler());
  PetscCall(EqmAgree(hierarchy->comm, code, message));
  PetscCallMPI(MPI_Bcast(&result->folds, 1, MPIU_INT, 0, hierarchy->comm));
  PetscCallMPI(MPI_Bcast(&result->energy, 1, MPIU_REAL, 0, hierarchy->comm));
  PetscCallMPI(MPI_Bcast(&result->objective, 1, MPIU_REAL, 0, hierarchy->comm));
  PetscCallMPI(MPI_Bcast(&result->before, 1, MPIU_REAL, 0, hierarchy->comm));
  PetscCallMPI(MPI_Bcast(&result->epsilon, 1, MPIU_REAL, 0, hierarchy->comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCascade(EqmHierarchy hierarchy, EqmCascadeTarget target, const EqmCascadeOptions *options,
                          PetscReal *x, EqmCascadeResult *result)
{
  PetscFunctionBegin;
  PetscCall(OnFirstRank(hierarchy, CascadeLevels, target, options, x, result));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCascadeRelax(EqmHierarchy hierarchy, EqmCascadeTarget target, const EqmCascadeOptions *options,
                               PetscReal *x, EqmCascadeResult *result)
{
  PetscFunctionBegin;
  PetscCall(OnFirstRank(hierarchy, RelaxFinest, target, options, x, result));
  PetscFunctionReturn(0);
}
