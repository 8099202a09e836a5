/* Maps of one level: where vertices may move, the objective. */
#include "hierarchy/levelmap.h"

/* Sums are taken piece by piece and then over the pieces, in one order for any number of threads. */
enum { CELLS_OF_PIECE = 8192 };

PetscErrorCode EqmLevelMapCreate(const EqmHierarchyLevel *level, EqmCascadeTarget target, EqmLevelMap *map)
{
  PetscFunctionBegin;
  map->level = level;
  map->dim = target == EQM_TARGET_SPHERE ? 3 : 2;
  map->frame = NULL;
  map->half = NULL;
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
  PetscCall(PetscFree(map->half));
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

PetscErrorCode EqmLevelMapKeepAngles(EqmLevelMap *map)
{
  PetscFunctionBegin;
  if (map->half) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(3 * map->level->num_cells, &map->half));
#pragma omp parallel for schedule(static) if (map->level->num_cells > CELLS_OF_PIECE)
  for (PetscInt c = 0; c < map->level->num_cells; c++) EqmHalfCotangents(map->level, c, map->half + 3 * c);
  PetscFunctionReturn(0);
}

/* Twice the Dirichlet energy of a cell's linear map is the sum of its squared sides times half cotangents. */
static PetscReal CellDirichlet(const EqmLevelMap *map, const PetscReal *x, PetscInt cell)
{
  const PetscInt *const v = map->level->cells + 3 * cell;
  PetscReal scratch[3], sum = 0.;
  const PetscReal *const half = EqmMapHalfCotangents(map, cell, scratch);

  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal *const p = x + map->dim * v[(a + 1) % 3], *const q = x + map->dim * v[(a + 2) % 3];
    for (PetscInt k = 0; k < map->dim; k++) sum += .5 * half[a] * PetscSqr(p[k] - q[k]);
  }
  return sum;
}

PetscReal EqmLevelMapArea(const EqmLevelMap *map, const PetscReal *x, PetscInt begin, PetscInt end)
{
  const PetscInt dim = map->dim;
  PetscReal total = 0.;

  for (PetscInt c = begin; c < end; c++) {
    const PetscInt *const v = map->level->cells + 3 * c;
    total += EqmLevelArea(dim, x + dim * v[0], x + dim * v[1], x + dim * v[2]);
  }
  return total;
}

void EqmLevelMapSum(const EqmLevelMap *map, const PetscReal *x, PetscInt begin, PetscInt end, EqmLevelSums *sums)
{
  const EqmHierarchyLevel *const level = map->level;
  const PetscInt dim = map->dim;

  for (PetscInt c = begin; c < end; c++) {
    const PetscInt *const v = level->cells + 3 * c;
    const PetscReal *const p = x + dim * v[0], *const q = x + dim * v[1], *const r = x + dim * v[2];
    const PetscReal share = map->total * level->weight[c], area = EqmLevelArea(dim, p, q, r);
    EqmLevelResidual residual[2];
    const PetscInt count = EqmLevelResiduals(dim, p, q, r, 1. / share, residual);
    sums->folds += count < 0;
    sums->energy += share * PetscSqr(area / share - 1.);
    for (PetscInt m = 0; m < count; m++) sums->residual += level->weight[c] * PetscSqr(residual[m].rho);
    if (map->epsilon > 0.)
      sums->angle += CellDirichlet(map, x, c) - (dim == 2 ? area : 4. * PETSC_PI * level->weight[c]);
  }
}

void EqmLevelMapValue(const EqmLevelMap *map, const EqmLevelSums *sums, EqmLevelValue *value)
{
  const PetscInt folds = (PetscInt)sums->folds;

  *value = (EqmLevelValue){.objective = folds > 0 ? PETSC_INFINITY : sums->residual + EqmAngleFactor(map) * sums->angle,
                           .residual = sums->residual,
                           .energy = sums->energy,
                           .folds = folds};
}

PetscErrorCode EqmLevelMapEvaluate(EqmLevelMap *map, const PetscReal *x, EqmLevelValue *value)
{
  const PetscInt n = map->level->num_cells, cells = CELLS_OF_PIECE, num_pieces = (n + cells - 1) / cells;
  PetscReal *area, total = 0.;
  EqmLevelSums *piece, all = {.folds = 0.};

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num_pieces, &area));
  PetscCall(PetscCalloc1(num_pieces, &piece));
#pragma omp parallel for schedule(dynamic) if (num_pieces > 1)
  for (PetscInt k = 0; k < num_pieces; k++) area[k] = EqmLevelMapArea(map, x, k * cells, PetscMin((k + 1) * cells, n));
  for (PetscInt k = 0; k < num_pieces; k++) total += area[k];
  map->total = total;
#pragma omp parallel for schedule(dynamic) if (num_pieces > 1)
  for (PetscInt k = 0; k < num_pieces; k++) EqmLevelMapSum(map, x, k * cells, PetscMin((k + 1) * cells, n), &piece[k]);
  for (PetscInt k = 0; k < num_pieces; k++) {
    all.folds += piece[k].folds;
    all.energy += piece[k].energy;
    all.residual += piece[k].residual;
    all.angle += piece[k].angle;
  }
  PetscCall(PetscFree(area));
  PetscCall(PetscFree(piece));
  EqmLevelMapValue(map, &all, value);
  PetscFunctionReturn(0);
}
