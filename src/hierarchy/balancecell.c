/* One cell's part of the objective's Gauss-Newton system. */
#include "hierarchy/balance.h"

/* A cell's Laplacian `weight` (per corner: of the edge opposite it) times the product of the corners' frames. */
static void AddLaplacian(const EqmLevelMap *map, const PetscReal weight[3], EqmCellSystem *s, const PetscInt first[3],
                         PetscInt size)
{
  for (PetscInt a = 0; a < 3; a++) {
    for (PetscInt b = 0; b < 3; b++) {
      const PetscReal w = a == b ? weight[(a + 1) % 3] + weight[(a + 2) % 3] : -weight[3 - a - b];
      for (PetscInt k = 0; k < s->count[a]; k++) {
        for (PetscInt l = 0; l < s->count[b]; l++) {
          PetscReal product = 0.;
          for (PetscInt c = 0; c < map->dim; c++)
            product += s->frame[a][map->dim * k + c] * s->frame[b][map->dim * l + c];
          s->matrix[size * (first[a] + k) + first[b] + l] += w * product;
        }
      }
    }
  }
}

/* Sums over a cell's corners and their directions: derivatives of a measure. */
static void Project(const EqmLevelMap *map, PetscBool of_area, const PetscReal *const p[3], const EqmCellSystem *s,
                    PetscReal row[6])
{
  PetscReal g[3];

  for (PetscInt a = 0, n = 0; a < 3; a++) {
    EqmLevelGradient(map->dim, of_area, p[a], p[(a + 1) % 3], p[(a + 2) % 3], g);
    for (PetscInt k = 0; k < s->count[a]; k++, n++) {
      row[n] = 0.;
      for (PetscInt c = 0; c < map->dim; c++) row[n] += s->frame[a][map->dim * k + c] * g[c];
    }
  }
}

/* Minus the gradient of factor times (the cell's Dirichlet energy - its area), on the sphere without the area. */
static void AddAnglePull(const EqmLevelMap *map, PetscReal factor, const PetscReal half[3], const PetscReal *const p[3],
                         EqmCellSystem *s)
{
  PetscReal area[6] = {0., 0., 0., 0., 0., 0.};

  if (map->dim == 2) Project(map, PETSC_TRUE, p, s, area);
  for (PetscInt a = 0, n = 0; a < 3; a++) {
    const PetscInt b = (a + 1) % 3, c = (a + 2) % 3;
    for (PetscInt k = 0; k < s->count[a]; k++, n++) {
      PetscReal pull = 0.;
      for (PetscInt e = 0; e < map->dim; e++)
        pull += s->frame[a][map->dim * k + e] * (half[c] * (p[a][e] - p[b][e]) + half[b] * (p[a][e] - p[c][e]));
      s->right[n] -= factor * (pull - area[n]);
    }
  }
}

void EqmBalanceCell(const EqmLevelMap *map, PetscInt cell, PetscReal damping, PetscReal floor, EqmCellSystem *s)
{
  const PetscInt *const v = map->level->cells + 3 * cell, dim = map->dim;
  const PetscReal w = map->level->weight[cell], angle = .5 * EqmAngleFactor(map);
  const PetscReal *const p[3] = {map->x + dim * v[0], map->x + dim * v[1], map->x + dim * v[2]};
  PetscReal scratch[3], weight[3], worst = 0., row[6];
  const PetscReal *const half = EqmMapHalfCotangents(map, cell, scratch);
  EqmLevelResidual residual[2];
  const PetscInt count = EqmLevelResiduals(dim, p[0], p[1], p[2], 1. / (map->total * w), residual);
  PetscInt first[3], size = 0;

  for (PetscInt a = 0; a < 3; a++) {
    s->count[a] = EqmMotionFrame((EqmMotion)map->motion[v[a]], p[a], s->frame[a]);
    first[a] = size;
    size += s->count[a];
  }
  for (PetscInt k = 0; k < size; k++) s->right[k] = 0.;
  for (PetscInt k = 0; k < size * size; k++) s->matrix[k] = 0.;
  for (PetscInt m = 0; m < count; m++) {
    Project(map, residual[m].of_area, p, s, row);
    for (PetscInt k = 0; k < size; k++) row[k] *= residual[m].slope;
    for (PetscInt k = 0; k < size; k++) s->right[k] -= w * residual[m].rho * row[k];
    for (PetscInt k = 0; k < size * size; k++) s->matrix[k] += w * row[k / size] * row[k % size];
    worst = PetscMax(worst, PetscAbsReal(residual[m].rho));
  }
  AddAnglePull(map, angle, half, p, s);
  for (PetscInt a = 0; a < 3; a++) weight[a] = angle * half[a] + damping / (2. * PetscSqrtReal(3.)) * (worst + floor);
  AddLaplacian(map, weight, s, first, size);
}

/* The same, where each corner has two directions, as all do inside: blocks on and above the diagonal. */
typedef struct {
  PetscReal block[3][3][4], right[6];
} FullSystem;

/* The products of residuals' gradients; returns the largest |rho|. `dim` is a constant wherever this is called. */
static inline PetscReal AddResiduals(const PetscInt dim, const EqmLevelMap *map, PetscReal w,
                                     const PetscReal *const p[3], const EqmCellSystem *frames, FullSystem *s)
{
  EqmLevelResidual residual[2];
  const PetscInt count = EqmLevelResiduals(dim, p[0], p[1], p[2], 1. / (map->total * w), residual);
  PetscReal row[6], worst = 0.;

  for (PetscInt m = 0; m < count; m++) {
    const PetscReal pull = w * residual[m].rho * residual[m].slope, stiffness = w * PetscSqr(residual[m].slope);
    if (dim == 2)
      EqmArea2Gradient(p[0], p[1], p[2], row);
    else
      Project(map, residual[m].of_area, p, frames, row);
    for (PetscInt k = 0; k < 6; k++) s->right[k] -= pull * row[k];
    for (PetscInt a = 0; a < 3; a++) {
      for (PetscInt b = a; b < 3; b++) {
        for (PetscInt e = 0; e < 4; e++) s->block[a][b][e] += stiffness * row[2 * a + e / 2] * row[2 * b + e % 2];
      }
    }
    worst = PetscMax(worst, PetscAbsReal(residual[m].rho));
  }
  return worst;
}

static inline void AddAngles(const PetscInt dim, const EqmLevelMap *map, PetscReal factor, const PetscReal half[3],
                             const PetscReal *const p[3], const EqmCellSystem *frames, FullSystem *s)
{
  PetscReal area[6] = {0., 0., 0., 0., 0., 0.};

  if (dim == 2) EqmArea2Gradient(p[0], p[1], p[2], area);
  for (PetscInt a = 0; a < 3; a++) {
    const PetscInt b = (a + 1) % 3, c = (a + 2) % 3;
    PetscReal pull[3];
    for (PetscInt e = 0; e < dim; e++) pull[e] = half[c] * (p[a][e] - p[b][e]) + half[b] * (p[a][e] - p[c][e]);
    for (PetscInt k = 0; k < 2; k++) {
      const PetscReal along = dim == 2 ? pull[k] : EqmDot3(frames->frame[a] + 3 * k, pull);
      s->right[2 * a + k] -= factor * (along - area[2 * a + k]);
    }
  }
}

/* `weight` times the products of frames, which are those of the plane's axes but on the sphere. */
static inline void AddSprings(const PetscInt dim, const PetscReal weight[3], const EqmCellSystem *frames, FullSystem *s)
{
  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal own = weight[(a + 1) % 3] + weight[(a + 2) % 3];
    s->block[a][a][0] += own;
    s->block[a][a][3] += own;
    for (PetscInt b = a + 1; b < 3; b++) {
      const PetscReal w = weight[3 - a - b];
      for (PetscInt e = 0; e < 4; e++) {
        if (dim == 3)
          s->block[a][b][e] -= w * EqmDot3(frames->frame[a] + 3 * (e / 2), frames->frame[b] + 3 * (e % 2));
        else if (e == 0 || e == 3)
          s->block[a][b][e] -= w;
      }
    }
  }
}

static inline void AddFullCell(const PetscInt dim, const EqmLevelMap *map, PetscInt cell, PetscReal damping,
                               PetscReal floor, EqmLevelSystem *system)
{
  const PetscInt *const v = map->level->cells + 3 * cell;
  const PetscReal w = map->level->weight[cell], angle = .5 * EqmAngleFactor(map);
  const PetscReal *const p[3] = {map->x + dim * v[0], map->x + dim * v[1], map->x + dim * v[2]};
  PetscReal scratch[3], weight[3], worst;
  const PetscReal *const half = EqmMapHalfCotangents(map, cell, scratch);
  EqmCellSystem frames;
  FullSystem s = {.right = {0.}};

  for (PetscInt a = 0; a < 3 && dim == 3; a++) frames.count[a] = EqmMotionFrame(EQM_MOVE_SPHERE, p[a], frames.frame[a]);
  worst = AddResiduals(dim, map, w, p, &frames, &s);
  AddAngles(dim, map, angle, half, p, &frames, &s);
  for (PetscInt a = 0; a < 3; a++) weight[a] = angle * half[a] + damping / (2. * PetscSqrtReal(3.)) * (worst + floor);
  AddSprings(dim, weight, &frames, &s);
  for (PetscInt a = 0; a < 3; a++) {
    system->right[2 * v[a]] += s.right[2 * a];
    system->right[2 * v[a] + 1] += s.right[2 * a + 1];
    for (PetscInt b = a; b < 3; b++) {
      const PetscReal *const e = s.block[a][b];
      PetscReal *to = EqmLevelSystemBlock(system, cell, a, b)->e;
      for (PetscInt k = 0; k < 4; k++) to[k] += e[k];
      if (a == b) continue;
      to = EqmLevelSystemBlock(system, cell, b, a)->e;
      for (PetscInt k = 0; k < 4; k++) to[k] += e[2 * (k % 2) + k / 2];
    }
  }
}

void EqmBalanceAddCell(const EqmLevelMap *map, PetscInt cell, PetscReal damping, PetscReal floor,
                       EqmLevelSystem *system)
{
  const PetscInt *const v = map->level->cells + 3 * cell;
  EqmCellSystem s;

  if (system->count[v[0]] == 2 && system->count[v[1]] == 2 && system->count[v[2]] == 2) {
    if (map->dim == 2)
      AddFullCell(2, map, cell, damping, floor, system);
    else
      AddFullCell(3, map, cell, damping, floor, system);
    return;
  }
  EqmBalanceCell(map, cell, damping, floor, &s);
  EqmLevelSystemAdd(system, cell, s.matrix, s.right);
}
