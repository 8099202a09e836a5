/* Maps of one level: where vertices may move, the objective. */
#include "hierarchy/levelmap.h"

PetscErrorCode EqmLevelMapCreate(const EqmHierarchyLevel *level, EqmCascadeTarget target, EqmLevelMap *map)
{
  PetscFunctionBegin;
  map->level = level;
  map->dim = target == EQM_TARGET_SPHERE ? 3 : 2;
  map->epsilon = 0.;
  map->total = target == EQM_TARGET_SPHERE ? 4. * PETSC_PI : target == EQM_TARGET_DISK ? PETSC_PI : 1.;
  PetscCall(PetscMalloc1(map->dim * level->num_vertices, &map->x));
  PetscCall(PetscMalloc1(level->num_vertices, &map->motion));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelMapDestroy(EqmLevelMap *map)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(map->x));
  PetscCall(PetscFree(map->motion));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelMapSetMotions(EqmLevelMap *map, EqmCascadeTarget target)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < map->level->num_vertices; v++) {
    const EqmVertexPart part = (EqmVertexPart)map->level->part[v];
    EqmMotion motion = EQM_MOVE_CIRCLE;
    if (target == EQM_TARGET_SPHERE)
      motion = EQM_MOVE_SPHERE;
    else if (part == EQM_INSIDE)
      motion = EQM_MOVE_PLANE;
    else if (part == EQM_CORNER)
      motion = EQM_MOVE_NOT;
    else if (target == EQM_TARGET_SQUARE)
      motion = map->x[2 * v + 1] == 0. || map->x[2 * v + 1] == 1. ? EQM_MOVE_SIDE_X : EQM_MOVE_SIDE_Y;
    map->motion[v] = (unsigned char)motion;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelMapRestrict(const EqmLevelMap *finer, EqmLevelMap *coarser)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < coarser->level->num_vertices; v++) {
    const PetscInt from = coarser->level->finer[v];
    coarser->motion[v] = finer->motion[from];
    PetscCall(PetscArraycpy(coarser->x + coarser->dim * v, finer->x + finer->dim * from, finer->dim));
  }
  PetscFunctionReturn(0);
}

void EqmHalfCotangents(const EqmHierarchyLevel *level, PetscInt cell, PetscReal half[3])
{
  const PetscInt *const v = level->cells + 3 * cell;
  const PetscReal fattened = .02;
  PetscReal side[3][3], normal[3], squares = 0., area;

  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal *const p = level->position + 3 * v[(a + 1) % 3], *const q = level->position + 3 * v[(a + 2) % 3];
    for (PetscInt k = 0; k < 3; k++) side[a][k] = q[k] - p[k];
    squares += EqmDot3(side[a], side[a]);
  }
  EqmCross(side[0], side[1], normal);
  area = PetscMax(PetscSqrtReal(EqmDot3(normal, normal)), fattened * squares);
  for (PetscInt a = 0; a < 3; a++)
    half[a] = area > 0. ? -.5 * EqmDot3(side[(a + 1) % 3], side[(a + 2) % 3]) / area : 0.;
}

/* Twice the Dirichlet energy of a cell's linear map is the sum of its squared sides times half cotangents. */
static PetscReal CellDirichlet(const EqmLevelMap *map, const PetscReal *x, PetscInt cell)
{
  const PetscInt *const v = map->level->cells + 3 * cell;
  PetscReal half[3], sum = 0.;

  EqmHalfCotangents(map->level, cell, half);
  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal *const p = x + map->dim * v[(a + 1) % 3], *const q = x + map->dim * v[(a + 2) % 3];
    for (PetscInt k = 0; k < map->dim; k++) sum += .5 * half[a] * PetscSqr(p[k] - q[k]);
  }
  return sum;
}

EqmLevelValue EqmLevelMapEvaluate(EqmLevelMap *map, const PetscReal *x)
{
  const EqmHierarchyLevel *const level = map->level;
  const PetscInt dim = map->dim;
  EqmLevelValue value = {.objective = 0., .residual = 0., .energy = 0., .folds = 0};
  PetscReal total = 0., angle = 0.;

  for (PetscInt c = 0; c < level->num_cells; c++) {
    const PetscInt *const v = level->cells + 3 * c;
    total += EqmLevelArea(dim, x + dim * v[0], x + dim * v[1], x + dim * v[2]);
  }
  map->total = total;
  for (PetscInt c = 0; c < level->num_cells; c++) {
    const PetscInt *const v = level->cells + 3 * c;
    const PetscReal *const p = x + dim * v[0], *const q = x + dim * v[1], *const r = x + dim * v[2];
    const PetscReal share = total * level->weight[c], area = EqmLevelArea(dim, p, q, r);
    EqmResidual residual[2];
    const PetscInt count = EqmLevelResiduals(dim, p, q, r, 1. / share, residual);
    value.folds += count < 0;
    value.energy += share * PetscSqr(area / share - 1.);
    for (PetscInt m = 0; m < count; m++) value.residual += level->weight[c] * PetscSqr(residual[m].rho);
    if (map->epsilon > 0.) angle += CellDirichlet(map, x, c) - (dim == 2 ? area : 4. * PETSC_PI * level->weight[c]);
  }
  value.objective = value.folds > 0 ? PETSC_INFINITY : value.residual + EqmAngleFactor(map) * angle;
  return value;
}
