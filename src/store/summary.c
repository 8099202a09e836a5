/* The summary of a run as JSON, for scripts. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "store/store.h"
#include "base/atomicfile.h"
#include <cjson/cJSON.h>
#include <string.h>
#include <time.h>

/* cJSON writes the shortest digits that bring back the same bits, and null for what is not a number. */
static void AddNumber(cJSON *object, const char *key, PetscReal value)
{
  (void)cJSON_AddNumberToObject(object, key, value);
}

static void AddCount(cJSON *object, const char *key, PetscInt64 value)
{
  (void)cJSON_AddNumberToObject(object, key, (double)value);
}

static void AddText(cJSON *object, const char *key, const char *text)
{
  (void)cJSON_AddStringToObject(object, key, text);
}

static void AddDate(cJSON *root)
{
  const time_t now = time(NULL);
  struct tm parts;
  char date[32] = "";

  if (gmtime_r(&now, &parts)) (void)strftime(date, sizeof(date), "%Y-%m-%dT%H:%M:%SZ", &parts);
  AddText(root, "date", date);
}

static void AddRun(cJSON *root, EqmMap map)
{
  cJSON *mesh, *parallel;

  AddText(root, "equimap", EqmVersion());
  AddText(root, "git_commit", EqmCommit());
  AddDate(root);
  AddText(root, "command", map->command);
  AddText(root, "method", map->method);
  AddText(root, "linear_solver", map->linear_solver);
  AddText(root, "status", EqmStatusName(map->status));
  AddCount(root, "exit_code", (PetscInt64)map->status);
  AddText(root, "message", map->message);
  (void)cJSON_AddBoolToObject(root, "poor", map->poor);
  mesh = cJSON_AddObjectToObject(root, "mesh");
  AddText(mesh, "file", map->soup->file);
  AddCount(mesh, "vertices", map->soup->num_vertices);
  AddCount(mesh, "cells", map->soup->num_cells);
  AddCount(mesh, "boundary_vertices", map->num_boundary_vertices);
  AddNumber(mesh, "measure", map->distortion.mesh_measure);
  AddCount(mesh, "checksum", map->soup->checksum);
  parallel = cJSON_AddObjectToObject(root, "parallel");
  AddCount(parallel, "ranks", map->cost.ranks);
  AddCount(parallel, "threads", map->cost.threads);
}

/* Only where something was repaired. */
static void AddRepair(cJSON *root, const EqmRepair *repair)
{
  cJSON *group = cJSON_AddObjectToObject(root, "repair");

  AddCount(group, "duplicate_cells_removed", repair->duplicate_cells_removed);
  AddCount(group, "degenerate_cells_removed", repair->degenerate_cells_removed);
  AddCount(group, "cells_flipped", repair->cells_flipped);
  AddCount(group, "cells_split", repair->cells_split);
  AddCount(group, "vertices_added", repair->vertices_added);
  AddCount(group, "vertices_unreferenced", repair->vertices_unreferenced);
}

/* What was done to the input first, step by step. */
static void AddPrepared(cJSON *root, EqmMap map)
{
  cJSON *list = cJSON_AddArrayToObject(root, "prepared");

  for (PetscInt k = 0; k < map->num_prepared; k++) {
    cJSON *const entry = cJSON_CreateObject();

    AddText(entry, "step", map->prepared[k].step);
    AddCount(entry, "count", map->prepared[k].count);
    AddText(entry, "what", map->prepared[k].what);
    (void)cJSON_AddItemToArray(list, entry);
  }
}

static void AddPercentiles(cJSON *object, const EqmStatistics *statistics)
{
  AddNumber(object, "p25", statistics->p25);
  AddNumber(object, "p50", statistics->p50);
  AddNumber(object, "p75", statistics->p75);
  AddNumber(object, "p95", statistics->p95);
}

static void AddWeightedRatio(cJSON *root, const EqmWeightedRatio *weighted)
{
  cJSON *group = cJSON_AddObjectToObject(root, "ratio_weighted");

  AddNumber(group, "sd", weighted->sd);
  AddNumber(group, "p05", weighted->p05);
  AddNumber(group, "p25", weighted->p25);
  AddNumber(group, "p50", weighted->p50);
  AddNumber(group, "p75", weighted->p75);
  AddNumber(group, "p95", weighted->p95);
  AddCount(group, "outliers", weighted->outliers);
  AddNumber(group, "outlier_share", weighted->outlier_share);
  AddNumber(group, "cell_sd_without_outliers", weighted->cell_sd_without);
}

/* Angles mean something on triangles only: null elsewhere. */
static void AddAngle(cJSON *object, const char *key, PetscBool known, PetscReal value)
{
  if (known)
    AddNumber(object, key, value);
  else
    (void)cJSON_AddNullToObject(object, key);
}

/* Folds mended: in the first map, row 0 of the history, and at the end, a row after the last iteration. */
static void AddUnfolded(cJSON *root, EqmMap map)
{
  const EqmHistoryRow none = {0};
  const EqmHistoryRow *const first = map->num_history ? &map->history[0] : &none;
  const EqmHistoryRow *const last = map->num_history > 1 ? &map->history[map->num_history - 1] : &none;
  cJSON *const group = cJSON_AddObjectToObject(root, "unfolded");

  AddCount(group, "before", last->unfolded_from);
  AddCount(group, "after", last->unfolded_from ? last->folds + map->boundary_folds : 0);
  AddCount(group, "start_before", first->unfolded_from);
  AddCount(group, "start_after", first->unfolded_from ? first->folds : 0);
}

/* How many iterations each phase took, for methods that have them. */
static void AddPhases(cJSON *root, EqmMap map)
{
  cJSON *group = NULL;
  PetscInt64 phase = 0;

  for (PetscInt k = 0; k < map->num_history; k++) phase = PetscMax(phase, map->history[k].phase);
  if (phase == 0) return;
  group = cJSON_AddArrayToObject(root, "phases");
  for (PetscInt64 p = 1; p <= phase; p++) {
    PetscInt64 iterations = 0;
    for (PetscInt k = 1; k < map->num_history; k++) iterations += map->history[k].phase == p;
    (void)cJSON_AddItemToArray(group, cJSON_CreateNumber((double)iterations));
  }
}

static void AddQuality(cJSON *root, EqmMap map)
{
  const EqmDistortion *distortion = &map->distortion;
  const PetscBool flat = (PetscBool)(map->soup->cell_size == 3);
  cJSON *group;

  AddCount(root, "iterations", map->iterations);
  group = cJSON_AddObjectToObject(root, "energy");
  AddNumber(group, "initial", map->energy_initial);
  AddNumber(group, "final", map->energy_final);
  AddNumber(group, "stretch", distortion->energy + distortion->image_measure); /* 002: at least the bound */
  AddNumber(group, "bound", distortion->image_measure);
  group = cJSON_AddObjectToObject(root, "ratio");
  AddNumber(group, "mean", distortion->ratio.mean);
  AddNumber(group, "sd", distortion->ratio.sd);
  AddNumber(group, "min", distortion->ratio.min);
  AddNumber(group, "max", distortion->ratio.max);
  AddPercentiles(group, &distortion->ratio);
  group = cJSON_AddObjectToObject(root, "ratio_error");
  AddNumber(group, "mean", distortion->ratio_error.mean);
  AddNumber(group, "sd", distortion->ratio_error.sd);
  AddPercentiles(group, &distortion->ratio_error);
  AddWeightedRatio(root, &distortion->weighted_ratio);
  group = cJSON_AddObjectToObject(root, "angle_error_deg");
  AddAngle(group, "mean", flat, distortion->angle_error.mean);
  AddAngle(group, "median", flat, distortion->angle_error.p50);
  AddAngle(group, "sd", flat, distortion->angle_error.sd);
  AddAngle(group, "max", flat, distortion->angle_error.max);
  group = cJSON_AddObjectToObject(root, "quasiconformal");
  AddAngle(group, "mean", flat, distortion->quasiconformal.mean);
  AddAngle(group, "median", flat, distortion->quasiconformal.p50);
  AddAngle(group, "max", flat, distortion->quasiconformal.max);
  AddCount(root, "folds", distortion->folds);
  if (!flat) AddCount(root, "boundary_folds", map->boundary_folds);
}

/* Only where they were computed. */
static void AddHessian(cJSON *root, EqmMap map)
{
  cJSON *list = cJSON_AddArrayToObject(root, "hessian_eigenvalues");

  for (PetscInt k = 0; k < map->num_hessian_eigenvalues; k++)
    (void)cJSON_AddItemToArray(list, cJSON_CreateNumber((double)map->hessian_eigenvalues[k]));
}

static void AddCost(cJSON *root, EqmMap map)
{
  static const struct {
    const char *key;
    EqmPhase phase;
  } phases[] = {{"read", EQM_PHASE_READ},       {"diagnose", EQM_PHASE_DIAGNOSE}, {"distribute", EQM_PHASE_DISTRIBUTE},
                {"start", EQM_PHASE_START},     {"minimise", EQM_PHASE_MINIMISE}, {"checkpoint", EQM_PHASE_CHECKPOINT},
                {"measure", EQM_PHASE_MEASURE}, {"write", EQM_PHASE_WRITE}};
  static const struct {
    const char *key;
    EqmEvent event;
  } events[] = {{"partition", EQM_EVENT_PARTITION},
                {"assemble", EQM_EVENT_ASSEMBLE},
                {"factor", EQM_EVENT_FACTOR},
                {"solve", EQM_EVENT_SOLVE},
                {"kernel", EQM_EVENT_KERNEL}};
  cJSON *group;

  group = cJSON_AddObjectToObject(root, "work");
  AddCount(group, "evaluations", map->cost.work.evaluations);
  AddCount(group, "factorizations", map->cost.work.factorizations);
  AddCount(group, "coupled_factorizations", map->cost.work.coupled_factorizations);
  AddCount(group, "solves", map->cost.work.solves);
  AddCount(group, "cg_iterations", map->cost.work.cg_iterations);
  AddCount(group, "set_ups", map->cost.work.set_ups);
  group = cJSON_AddObjectToObject(root, "seconds");
  AddNumber(group, "total", map->cost.total_seconds);
  for (int k = 0; k < EQM_NUM_PHASES; k++) AddNumber(group, phases[k].key, map->cost.phase_seconds[phases[k].phase]);
  group = cJSON_AddObjectToObject(root, "events");
  for (int k = 0; k < EQM_NUM_EVENTS; k++) AddNumber(group, events[k].key, map->cost.event_seconds[events[k].event]);
  group = cJSON_AddObjectToObject(root, "memory_bytes");
  AddCount(group, "max_per_rank", map->cost.memory_max_per_rank);
  AddCount(group, "total", map->cost.memory_total);
}

/* What the command has added: dots in a key open groups. */
static void AddFigure(cJSON *root, const EqmMapFigure *figure)
{
  const char *key = figure->key;
  cJSON *group = root;

  for (const char *dot = strchr(key, '.'); dot; dot = strchr(key, '.')) {
    char name[sizeof(figure->key)];
    (void)snprintf(name, sizeof(name), "%.*s", (int)(dot - key), key);
    group = cJSON_GetObjectItemCaseSensitive(group, name) ? cJSON_GetObjectItemCaseSensitive(group, name)
                                                          : cJSON_AddObjectToObject(group, name);
    key = dot + 1;
  }
  switch (figure->kind) {
  case EQM_FIGURE_TEXT:
    AddText(group, key, figure->text);
    break;
  case EQM_FIGURE_COUNT:
    AddCount(group, key, figure->count);
    break;
  case EQM_FIGURE_REAL:
    AddNumber(group, key, figure->real);
  }
}

/* NULL: there is no memory for it. */
static char *MakeSummary(EqmMap map)
{
  cJSON *const root = cJSON_CreateObject();
  char *text;

  AddRun(root, map);
  if (map->num_prepared) AddPrepared(root, map);
  if (map->repaired) AddRepair(root, &map->repair);
  AddQuality(root, map);
  AddUnfolded(root, map);
  AddPhases(root, map);
  if (map->hessian_eigenvalues) AddHessian(root, map);
  for (PetscInt k = 0; k < map->num_figures; k++) AddFigure(root, &map->figures[k]);
  AddCost(root, map);
  text = cJSON_Print(root);
  cJSON_Delete(root);
  return text;
}

/* Write the summary of a run as JSON, whole or not at all. Errors: EQM_ERR_IO on all ranks. Collective; rank 0 writes.
 */
PetscErrorCode EqmMapWriteSummary(EqmMap map, const char *file)
{
  char *const text = MakeSummary(map);

  PetscFunctionBegin;
  PetscCall(EqmAtomicPrintFile(map->soup->comm, file, EqmAtomicPrintLine, text));
  cJSON_free(text);
  PetscFunctionReturn(0);
}
