/* From one level to the next coarser: passes over the vertices in order; in each, vertices go onto neighbours, but no
   two neighbours go in the same pass, which keeps what is left evenly spread. */
#include "hierarchy/decimation.h"

enum { MOST_PASSES = 12 };

PetscErrorCode EqmDecimationCreate(PetscInt n, PetscInt m, EqmDecimation *d)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(d, sizeof(*d)));
  PetscCall(PetscMalloc2(3 * m, &d->cells, m, &d->weight));
  PetscCall(PetscMalloc2(n + 2, &d->corners.start, 3 * m, &d->corners.corner));
  PetscCall(PetscMalloc6(m, &d->dead, n, &d->gone, n, &d->place, n, &d->mark, n, &d->pass_kept, n, &d->next));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDecimationDestroy(EqmDecimation *d)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(d->cells, d->weight));
  PetscCall(PetscFree2(d->corners.start, d->corners.corner));
  PetscCall(PetscFree6(d->dead, d->gone, d->place, d->mark, d->pass_kept, d->next));
  PetscFunctionReturn(0);
}

void EqmDecimationBegin(EqmDecimation *d, EqmHierarchyLevel *level, const char *held)
{
  const PetscInt n = level->num_vertices, m = level->num_cells;

  d->level = level;
  d->held = held;
  d->num_left = n;
  d->num_boundary = level->num_boundary;
  d->stamp = 0;
  for (PetscInt k = 0; k < 3 * m; k++) d->cells[k] = level->cells[k];
  for (PetscInt c = 0; c < m; c++) {
    d->weight[c] = level->weight[c];
    d->dead[c] = 0;
  }
  EqmCornersFill(n, m, d->cells, &d->corners);
  for (PetscInt v = 0; v < n; v++) {
    d->gone[v] = 0;
    d->place[v] = d->mark[v] = d->pass_kept[v] = 0;
    d->next[v] = -1;
  }
  level->num_collapses = level->ring_length = 0;
}

static void Record(EqmDecimation *d, const EqmStar *star, PetscInt onto)
{
  EqmHierarchyLevel *const level = d->level;

  level->collapse[level->num_collapses++] =
      (EqmCollapse){.vertex = star->vertex, .onto = onto, .start = level->ring_length, .size = star->size};
  for (PetscInt k = 0; k < star->size; k++) {
    level->ring[level->ring_length + k] = star->ring[k];
    level->ring_weight[level->ring_length + k] = k < star->num_cells ? d->weight[star->cell[k]] : 0.;
  }
  level->ring_length += star->size;
}

/* The whole weight of the star is distributed to the triangles that replace it, by their areas, a positive part to
 * each. */
static void DistributeWeight(EqmDecimation *d, const EqmStar *star, PetscInt onto)
{
  const PetscReal *const x = d->level->position;
  PetscReal area[EQM_MOST_SPOKES], areas = 0., weight = 0.;
  PetscInt heirs = 0;

  for (PetscInt k = 0; k < star->num_cells; k++) {
    const PetscInt *const v = d->cells + 3 * star->cell[k];
    weight += d->weight[star->cell[k]];
    if (d->dead[star->cell[k]]) continue;
    area[k] = EqmArea3(x + 3 * v[0], x + 3 * v[1], x + 3 * v[2]);
    areas += area[k];
    heirs++;
  }
  if (heirs == 0) d->weight[EqmDecimationAcross(d, star->ring[0], star->ring[1], star->cell[0])] += weight;
  for (PetscInt k = 0; k < star->num_cells; k++) {
    const PetscReal least = 1e-3;
    if (d->dead[star->cell[k]]) continue;
    d->weight[star->cell[k]] = weight * ((1. - least) * (areas > 0. ? area[k] / areas : 1. / heirs) + least / heirs);
  }
}

static void Collapse(EqmDecimation *d, const EqmStar *star, PetscInt target, PetscInt pass)
{
  const PetscInt u = star->ring[target], v = star->vertex;
  PetscInt last = v;

  Record(d, star, u);
  for (PetscInt k = 0; k < star->num_cells; k++) {
    PetscInt *const corner = d->cells + 3 * star->cell[k];
    if (star->ring[k] == u || star->ring[(k + 1) % star->size] == u) d->dead[star->cell[k]] = 1;
    for (PetscInt a = 0; a < 3 && !d->dead[star->cell[k]]; a++) corner[a] = corner[a] == v ? u : corner[a];
  }
  DistributeWeight(d, star, u);
  while (d->next[last] >= 0) last = d->next[last];
  d->next[last] = d->next[u];
  d->next[u] = v;
  d->gone[v] = 1;
  d->num_left--;
  d->num_boundary -= !star->closed;
  for (PetscInt k = 0; k < star->size; k++) d->pass_kept[star->ring[k]] = pass;
}

/* Where all weight goes to the triangle across the ring's one edge, that must not be another's to change. */
static PetscBool AcrossIsHeld(const EqmDecimation *d, const EqmStar *star)
{
  return (PetscBool)(d->held && star->size == 2 && (d->held[star->ring[0]] || d->held[star->ring[1]]));
}

/* Returns how many vertices went. */
static PetscInt Pass(EqmDecimation *d, PetscInt pass, PetscInt goal, PetscInt least_boundary, PetscReal quality)
{
  const EqmHierarchyLevel *const level = d->level;
  PetscInt removed = 0;
  EqmStar star;

  for (PetscInt v = 0; v < level->num_vertices && d->num_left > goal; v++) {
    PetscInt target;
    if (d->gone[v] || d->pass_kept[v] == pass || level->part[v] == EQM_CORNER || (d->held && d->held[v])) continue;
    if (level->part[v] == EQM_ON_BOUNDARY && d->num_boundary <= least_boundary) continue;
    if (!EqmDecimationStar(d, v, &star) || star.closed != (level->part[v] == EQM_INSIDE)) continue;
    if (AcrossIsHeld(d, &star)) continue;
    target = EqmChooseCollapse(d, &star, quality);
    if (target < 0) continue;
    Collapse(d, &star, target, pass);
    removed++;
  }
  return removed;
}

void EqmDecimationRun(EqmDecimation *d, PetscInt goal, PetscInt least_boundary, PetscReal *quality)
{
  PetscInt n = d->num_left;
  const PetscReal few = .04, no_more = 1e-5; /* below that quality any triangle will do */

  for (PetscInt v = 0; v < d->level->num_vertices && d->held; v++) n -= d->held[v];
  for (PetscInt pass = 1; pass <= MOST_PASSES && d->num_left > goal; pass++) {
    const PetscInt removed = Pass(d, pass, goal, least_boundary, *quality);
    if (removed == 0 && *quality < 0.) break;
    if (removed <= few * n) *quality = *quality < no_more ? -1. : .5 * *quality;
  }
}

PetscErrorCode EqmLevelShrinkRecords(EqmHierarchyLevel *level)
{
  PetscFunctionBegin;
  PetscCall(PetscRealloc(level->num_collapses * sizeof(*level->collapse), &level->collapse));
  PetscCall(PetscRealloc(level->ring_length * sizeof(*level->ring), &level->ring));
  PetscCall(PetscRealloc(level->ring_length * sizeof(*level->ring_weight), &level->ring_weight));
  PetscFunctionReturn(0);
}

/* What is left, numbered anew in the same order. */
static PetscErrorCode MakeCoarser(const EqmDecimation *d, EqmHierarchyLevel *coarser)
{
  const EqmHierarchyLevel *const level = d->level;
  PetscInt *number, cells = 0, n = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(level->num_vertices, &number));
  for (PetscInt c = 0; c < level->num_cells; c++) cells += !d->dead[c];
  coarser->num_vertices = d->num_left;
  coarser->num_boundary = d->num_boundary;
  PetscCall(PetscMalloc1(3 * d->num_left, &coarser->position));
  PetscCall(PetscMalloc1(d->num_left, &coarser->part));
  PetscCall(PetscMalloc1(d->num_left, &coarser->finer));
  PetscCall(PetscMalloc1(3 * cells, &coarser->cells));
  PetscCall(PetscMalloc1(cells, &coarser->weight));
  for (PetscInt v = 0; v < level->num_vertices; v++) {
    if (d->gone[v]) continue;
    PetscCall(PetscArraycpy(coarser->position + 3 * n, level->position + 3 * v, 3));
    coarser->part[n] = level->part[v];
    coarser->finer[n] = v;
    number[v] = n++;
  }
  coarser->num_cells = 0;
  for (PetscInt c = 0; c < level->num_cells; c++) {
    if (d->dead[c]) continue;
    for (PetscInt a = 0; a < 3; a++) coarser->cells[3 * coarser->num_cells + a] = number[d->cells[3 * c + a]];
    coarser->weight[coarser->num_cells++] = d->weight[c];
  }
  PetscCall(PetscFree(number));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDecimate(EqmHierarchyLevel *finer, PetscReal ratio, PetscInt least_boundary, PetscReal *quality,
                           EqmHierarchyLevel *coarser)
{
  const PetscInt goal = PetscMax((PetscInt)(finer->num_vertices / ratio), 4), most = finer->num_vertices - goal;
  EqmDecimation d;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(PetscMax(most, 0), &finer->collapse));
  PetscCall(PetscMalloc1(EQM_MOST_RECORD * PetscMax(most, 0), &finer->ring));
  PetscCall(PetscMalloc1(EQM_MOST_RECORD * PetscMax(most, 0), &finer->ring_weight));
  PetscCall(EqmDecimationCreate(finer->num_vertices, finer->num_cells, &d));
  EqmDecimationBegin(&d, finer, NULL);
  EqmDecimationRun(&d, goal, least_boundary, quality);
  PetscCall(MakeCoarser(&d, coarser));
  PetscCall(EqmDecimationDestroy(&d));
  PetscCall(EqmLevelShrinkRecords(finer));
  PetscFunctionReturn(0);
}
