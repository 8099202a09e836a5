/* Getters and setters of a map. */
#include "store/map_private.h"
#include <math.h>
#include "mesh/soup_private.h"
#include <omp.h>

PetscErrorCode EqmMapGetSoup(EqmMap map, EqmSoup *soup)
{
  PetscFunctionBegin;
  *soup = map->soup;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetDimension(EqmMap map, PetscInt *dim)
{
  PetscFunctionBegin;
  *dim = map->dim;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetCoordinates(EqmMap map, PetscReal **coordinates)
{
  PetscFunctionBegin;
  *coordinates = map->coordinates;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetRatios(EqmMap map, const PetscReal **per_cell, const PetscReal **per_vertex)
{
  PetscFunctionBegin;
  if (per_cell) *per_cell = map->cell_ratio;
  if (per_vertex) *per_vertex = map->vertex_ratio;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetQuasiConformal(EqmMap map, const PetscReal **per_cell)
{
  PetscFunctionBegin;
  *per_cell = map->quasi_conformal;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetConformalFactor(EqmMap map, const PetscReal **per_vertex)
{
  PetscFunctionBegin;
  *per_vertex = map->conformal_factor;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetDistortion(EqmMap map, const EqmDistortion **distortion)
{
  PetscFunctionBegin;
  *distortion = &map->distortion;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetBoundaryFolds(EqmMap map, PetscInt64 *folds)
{
  PetscFunctionBegin;
  *folds = map->boundary_folds;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetEnergies(EqmMap map, PetscReal *initial, PetscReal *final)
{
  PetscFunctionBegin;
  if (initial) *initial = map->energy_initial;
  if (final) *final = map->energy_final;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapSetEnergies(EqmMap map, PetscReal initial, PetscReal final)
{
  PetscFunctionBegin;
  map->energy_initial = initial;
  map->energy_final = final;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetHistory(EqmMap map, PetscInt *num_rows, const EqmHistoryRow **rows)
{
  PetscFunctionBegin;
  *num_rows = map->num_history;
  *rows = map->history;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetStatus(EqmMap map, EqmStatus *status, const char **message)
{
  PetscFunctionBegin;
  *status = map->status;
  if (message) *message = map->message;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapSetStatus(EqmMap map, EqmStatus status, const char *message)
{
  PetscFunctionBegin;
  map->status = status;
  PetscCall(PetscStrncpy(map->message, message, sizeof(map->message)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetProvenance(EqmMap map, const char **command, const char **method, const char **linear_solver)
{
  PetscFunctionBegin;
  if (command) *command = map->command;
  if (method) *method = map->method;
  if (linear_solver) *linear_solver = map->linear_solver;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapSetCommand(EqmMap map, const char *command)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(map->command, command, sizeof(map->command)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetCost(EqmMap map, const EqmMapCost **cost)
{
  PetscFunctionBegin;
  *cost = &map->cost;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapSetCost(EqmMap map, EqmLedger ledger)
{
  EqmMapCost *const cost = &map->cost;

  PetscFunctionBegin;
  cost->threads = omp_get_max_threads();
  PetscCall(EqmLedgerGetSeconds(ledger, cost->phase_seconds, cost->event_seconds, &cost->total_seconds));
  PetscCall(EqmGetPeakMemory(map->soup->comm, &cost->memory_max_per_rank, &cost->memory_total));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapGetHessianEigenvalues(EqmMap map, PetscInt *num, const PetscReal **values)
{
  PetscFunctionBegin;
  *num = map->num_hessian_eigenvalues;
  *values = map->hessian_eigenvalues;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapSetHessianEigenvalues(EqmMap map, PetscInt num, const PetscReal *values)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(map->hessian_eigenvalues));
  PetscCall(PetscMalloc1(num, &map->hessian_eigenvalues));
  PetscCall(PetscArraycpy(map->hessian_eigenvalues, values, num));
  map->num_hessian_eigenvalues = num;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapRestoreUnit(EqmMap map, PetscInt exponent)
{
  const PetscInt count = map->in_space ? map->dim * (map->soup->vertex_end - map->soup->vertex_start) : 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < count; k++) map->coordinates[k] = ldexp(map->coordinates[k], (int)exponent);
  PetscCall(EqmSoupShift(map->soup, exponent));
  map->distortion.mesh_measure = ldexp(map->distortion.mesh_measure, (int)(exponent * (map->soup->cell_size - 1)));
  PetscFunctionReturn(0);
}
