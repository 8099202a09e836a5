/* From motions of a coarser level to those of a finer one. */
#include "hierarchy/prolongation.h"
#include <string.h>

enum { WIDTH = EQM_PROLONGATION_WIDTH, MOST_CANDIDATES = 10, MOST_SEEN = WIDTH * EQM_MOST_RECORD, LEAST_ROWS = 4096 };

typedef EqmProlongationRow Row;

/* The place with a third coordinate: weights that give it back add up to one in the plane. */
static void Lift(const EqmLevelMap *map, PetscInt v, PetscReal place[3])
{
  for (PetscInt c = 0; c < 3; c++) place[c] = c < map->dim ? map->x[map->dim * v + c] : 1.;
}

static PetscReal SquaredDistance(const PetscReal *p, const PetscReal *q)
{
  return PetscSqr(p[0] - q[0]) + PetscSqr(p[1] - q[1]) + PetscSqr(p[2] - q[2]);
}

/* The coarse vertices that the ring's rows have, the nearest ones; returns how many. */
static PetscInt Candidates(const EqmLevelMap *map, const EqmCollapse *record, const Row *rows, PetscInt *candidate)
{
  const PetscInt *const ring = map->level->ring + record->start;
  PetscReal distance[MOST_SEEN], x[3], y[3];
  PetscInt n = 0;

  Lift(map, record->vertex, x);
  for (PetscInt k = 0; k < record->size; k++) {
    for (PetscInt j = 0; j < rows[ring[k]].count; j++) {
      const PetscInt c = rows[ring[k]].vertex[j];
      PetscInt at = 0;
      while (at < n && candidate[at] != c) at++;
      if (at < n) continue;
      Lift(map, c, y);
      const PetscReal d = SquaredDistance(x, y);
      for (at = n++; at > 0 && distance[at - 1] > d; at--) {
        distance[at] = distance[at - 1];
        candidate[at] = candidate[at - 1];
      }
      distance[at] = d;
      candidate[at] = c;
    }
  }
  return PetscMin(n, MOST_CANDIDATES);
}

/* The triangle of candidates around x, or the one that x is least outside of, with the least mean squared distance. */
static PetscReal BestTriple(const PetscReal x[3], PetscInt n, const PetscInt *candidate, PetscReal (*place)[3],
                            Row *row)
{
  const PetscReal edge = -1e-9;
  PetscReal nearest = PETSC_MAX_REAL, inside = -PETSC_MAX_REAL, distance[MOST_CANDIDATES];
  PetscReal normal[MOST_CANDIDATES][MOST_CANDIDATES][3], along[MOST_CANDIDATES][MOST_CANDIDATES]; /* of pairs a < b */

  row->count = 0;
  for (PetscInt a = 0; a < n; a++) {
    distance[a] = SquaredDistance(x, place[a]);
    for (PetscInt b = a + 1; b < n; b++) {
      EqmCross(place[a], place[b], normal[a][b]);
      along[a][b] = EqmDot3(normal[a][b], x);
    }
  }
  for (PetscInt a = 0; a < n; a++) {
    for (PetscInt b = a + 1; b < n; b++) {
      for (PetscInt c = b + 1; c < n; c++) {
        const PetscReal det = EqmDot3(normal[a][b], place[c]);
        PetscReal w[3], least, spread;
        if (det == 0.) continue;
        w[0] = along[b][c] / det;
        w[1] = -along[a][c] / det;
        w[2] = along[a][b] / det;
        least = PetscMin(w[0], PetscMin(w[1], w[2]));
        spread = w[0] * distance[a] + w[1] * distance[b] + w[2] * distance[c];
        if (least >= edge ? spread >= nearest : nearest < PETSC_MAX_REAL || least <= inside) continue;
        if (least >= edge) nearest = spread;
        inside = PetscMax(inside, least);
        *row = (Row){.count = 3, .vertex = {candidate[a], candidate[b], candidate[c]}, .weight = {w[0], w[1], w[2]}};
      }
    }
  }
  return inside;
}

static void InsideRow(const EqmLevelMap *map, const EqmCollapse *record, const Row *rows, Row *row)
{
  const PetscReal too_far = -.5;
  PetscInt candidate[MOST_SEEN];
  PetscReal place[MOST_CANDIDATES][3], x[3];
  const PetscInt n = Candidates(map, record, rows, candidate);

  Lift(map, record->vertex, x);
  for (PetscInt k = 0; k < n; k++) Lift(map, candidate[k], place[k]);
  if (BestTriple(x, n, candidate, place, row) < too_far || row->count == 0)
    *row = (Row){.count = 1, .vertex = {candidate[0]}, .weight = {1.}};
}

/* How far y lies behind x along the boundary: an angle, or a length of the side. */
static PetscReal Along(const EqmLevelMap *map, EqmMotion motion, PetscInt x, PetscInt y)
{
  const PetscReal *const p = map->x + 2 * x, *const q = map->x + 2 * y;

  if (motion == EQM_MOVE_CIRCLE) return PetscAtan2Real(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]);
  return motion == EQM_MOVE_SIDE_X ? q[0] - p[0] : q[1] - p[1];
}

/* Of a boundary vertex: the nearest coarse ones on either side, linear between them. */
static void BoundaryRow(const EqmLevelMap *map, const EqmCollapse *record, const Row *rows, Row *row)
{
  const PetscInt *const ring = map->level->ring + record->start, end[2] = {ring[0], ring[record->size - 1]};
  const EqmMotion motion = (EqmMotion)map->motion[record->vertex];
  PetscReal distance[2] = {PETSC_MAX_REAL, PETSC_MAX_REAL};
  PetscInt vertex[2] = {-1, -1};

  for (PetscInt e = 0; e < 2; e++) {
    for (PetscInt j = 0; j < rows[end[e]].count; j++) {
      const PetscInt c = rows[end[e]].vertex[j];
      const PetscReal d = Along(map, motion, record->vertex, c);
      if (PetscAbsReal(d) >= distance[d < 0.]) continue;
      distance[d < 0.] = PetscAbsReal(d);
      vertex[d < 0.] = c;
    }
  }
  if (vertex[0] < 0 || vertex[1] < 0) {
    *row = (Row){.count = 1, .vertex = {PetscMax(vertex[0], vertex[1])}, .weight = {1.}};
    return;
  }
  const PetscReal all = distance[0] + distance[1], share = all > 0. ? distance[1] / all : .5;
  *row = (Row){.count = 2, .vertex = {vertex[0], vertex[1]}, .weight = {share, 1. - share}};
}

void EqmProlongationRows(const EqmLevelMap *map, PetscInt begin, PetscInt end, Row *rows)
{
  const EqmHierarchyLevel *const level = map->level;

  for (PetscInt k = end; k-- > begin;) {
    const EqmCollapse *const record = &level->collapse[k];
    (level->part[record->vertex] == EQM_INSIDE ? InsideRow : BoundaryRow)(map, record, rows, &rows[record->vertex]);
  }
}

static PetscErrorCode MakeRows(const EqmLevelMap *finer, const EqmLevelMap *coarser, Row *rows)
{
  PetscFunctionBegin;
  for (PetscInt c = 0; c < coarser->level->num_vertices; c++) {
    const PetscInt v = coarser->level->finer[c];
    rows[v] = (Row){.count = 1, .vertex = {v}, .weight = {1.}};
  }
  EqmProlongationRows(finer, 0, finer->level->num_collapses, rows);
  PetscFunctionReturn(0);
}

/* A fine vertex's entries: the weight times the product of the frames; along the boundary the weight alone, so that a
   rotation comes out exact. */
static void SetRow(const EqmLevelMap *map, PetscInt v, const Row *row, const PetscInt *number, PetscInt *column,
                   EqmBlock *entry)
{
  PetscReal to[6], from[6];
  const PetscInt dim = map->dim, count = EqmMotionFrame((EqmMotion)map->motion[v], map->x + dim * v, to);

  if (map->frame) memcpy(to, map->frame + 2 * dim * v, 2 * dim * sizeof(PetscReal));
  for (PetscInt j = 0; j < WIDTH; j++) {
    const PetscInt u = j < row->count ? row->vertex[j] : -1;
    const PetscInt moves = u < 0 ? 0 : EqmMotionFrame((EqmMotion)map->motion[u], map->x + dim * u, from);
    column[j] = u < 0 ? -1 : number[u];
    entry[j] = (EqmBlock){{0., 0., 0., 0.}};
    for (PetscInt k = 0; k < count; k++) {
      for (PetscInt l = 0; l < moves; l++) {
        PetscReal product = 0.;
        for (PetscInt c = 0; c < dim; c++) product += to[dim * k + c] * from[dim * l + c];
        entry[j].e[2 * k + l] = row->weight[j] * (count == 1 ? 1. : product);
      }
    }
  }
}

void EqmProlongationFindPlain(EqmProlongation *p, PetscInt begin, PetscInt end)
{
#pragma omp parallel for schedule(static) if (end - begin > LEAST_ROWS)
  for (PetscInt v = begin; v < end; v++) {
    PetscBool plain = PETSC_TRUE;
    for (PetscInt q = WIDTH * v; q < WIDTH * v + WIDTH; q++) {
      const PetscReal *const e = p->entry[q].e;
      plain = (PetscBool)(plain && e[1] == 0. && e[2] == 0. && e[0] == e[3]);
      p->weight[q] = e[0];
    }
    p->plain[v] = (unsigned char)plain;
  }
}

/* By columns, too. */
static PetscErrorCode Transpose(EqmProlongation *p)
{
  const PetscInt length = WIDTH * p->num_fine;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(p->num_coarse + 2, &p->start));
  for (PetscInt q = 0; q < length; q++) {
    if (p->column[q] >= 0) p->start[p->column[q] + 2]++;
  }
  for (PetscInt j = 0; j < p->num_coarse; j++) p->start[j + 2] += p->start[j + 1];
  PetscCall(PetscMalloc1(p->start[p->num_coarse + 1], &p->from));
  for (PetscInt q = 0; q < length; q++) {
    if (p->column[q] >= 0) p->from[p->start[p->column[q] + 1]++] = q;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProlongationSet(const EqmLevelMap *map, const EqmProlongationRow *rows, const PetscInt *number,
                                  PetscInt num_fine, PetscInt num_rows, PetscInt num_coarse, EqmProlongation *p)
{
  PetscFunctionBegin;
  p->num_fine = num_fine;
  p->num_rows = num_rows;
  p->num_coarse = p->num_columns = num_coarse;
  PetscCall(PetscMalloc1(WIDTH * num_rows, &p->column));
  PetscCall(PetscMalloc1(WIDTH * num_rows, &p->entry));
  PetscCall(PetscMalloc1(num_rows, &p->plain));
  PetscCall(PetscMalloc1(WIDTH * num_rows, &p->weight));
#pragma omp parallel for schedule(static) if (num_fine > LEAST_ROWS)
  for (PetscInt v = 0; v < num_fine; v++) SetRow(map, v, &rows[v], number, p->column + WIDTH * v, p->entry + WIDTH * v);
  EqmProlongationFindPlain(p, 0, num_fine);
  PetscCall(Transpose(p));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProlongationCreate(const EqmLevelMap *finer, const EqmLevelMap *coarser, EqmProlongation *p)
{
  const PetscInt n = finer->level->num_vertices, m = coarser->level->num_vertices;
  PetscInt *number;
  Row *rows;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &number, n, &rows));
  for (PetscInt c = 0; c < m; c++) number[coarser->level->finer[c]] = c;
  PetscCall(MakeRows(finer, coarser, rows));
  PetscCall(EqmProlongationSet(finer, rows, number, n, n, m, p));
  PetscCall(PetscFree2(number, rows));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProlongationDestroy(EqmProlongation *p)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(p->column));
  PetscCall(PetscFree(p->entry));
  PetscCall(PetscFree(p->plain));
  PetscCall(PetscFree(p->weight));
  PetscCall(PetscFree(p->start));
  PetscCall(PetscFree(p->from));
  PetscFunctionReturn(0);
}
