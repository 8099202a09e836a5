/* Which neighbour a vertex may go onto: the surface must stay a surface, and its triangles usable. */
#include "hierarchy/decimation.h"
#include <float.h>

PetscBool EqmDecimationStar(EqmDecimation *d, PetscInt vertex, EqmStar *star)
{
  EqmSpoke spoke[EQM_MOST_SPOKES], scratch[EQM_MOST_SPOKES];
  PetscInt count = 0;

  EQM_FOR_CELLS_AROUND(d, vertex, c)
  {
    const PetscInt *const v = d->cells + 3 * c, a = v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
    if (count == EQM_MOST_SPOKES) return PETSC_FALSE;
    spoke[count++] = (EqmSpoke){.from = v[(a + 1) % 3], .to = v[(a + 2) % 3], .cell = c};
  }
  if (count == 0 || !EqmOrderSpokes(count, spoke, scratch, d->place, &star->closed)) return PETSC_FALSE;
  star->vertex = vertex;
  star->num_cells = count;
  star->size = star->closed ? count : count + 1;
  for (PetscInt k = 0; k < count; k++) {
    star->ring[k] = spoke[k].from;
    star->cell[k] = spoke[k].cell;
  }
  if (!star->closed) star->ring[count] = spoke[count - 1].to;
  star->num_on_boundary = 0;
  for (PetscInt k = 0; k < star->size; k++) star->num_on_boundary += d->level->part[star->ring[k]] != EQM_INSIDE;
  return PETSC_TRUE;
}

PetscInt EqmDecimationAcross(const EqmDecimation *d, PetscInt a, PetscInt b, PetscInt cell)
{
  EQM_FOR_CELLS_AROUND(d, a, c)
  {
    const PetscInt *const v = d->cells + 3 * c;
    if (c != cell && (v[0] == b || v[1] == b || v[2] == b)) return c;
  }
  return -1;
}

/* Boundary vertices go along the boundary, and no edge arises between two boundary vertices. */
static PetscBool KeepsBoundary(const EqmDecimation *d, const EqmStar *star, PetscInt target)
{
  const unsigned char *const part = d->level->part;
  const PetscInt *const ring = star->ring, size = star->size;

  if (!star->closed) return (PetscBool)((target == 0 || target == size - 1) && star->num_on_boundary == 2);
  if (part[ring[target]] == EQM_INSIDE) return PETSC_TRUE;
  return (PetscBool)(star->num_on_boundary - 1 <= (part[ring[(target + 1) % size]] != EQM_INSIDE) +
                                                      (part[ring[(target + size - 1) % size]] != EQM_INSIDE));
}

static PetscInt Valence(const EqmDecimation *d, PetscInt vertex)
{
  PetscInt count = 0;

  EQM_FOR_CELLS_AROUND(d, vertex, c) count++;
  return count;
}

/* The target's neighbours in the ring are the two beside it alone (link condition: Dey, Edelsbrunner, Guha and Nekhayev
   1999), and no vertex gets too many triangles nor too few. */
static PetscBool KeepsSurface(EqmDecimation *d, const EqmStar *star, PetscInt target)
{
  const PetscInt size = star->size, u = star->ring[target];
  PetscInt valence = star->num_cells;

  if (size == 2) return (PetscBool)(EqmDecimationAcross(d, star->ring[0], star->ring[1], star->cell[0]) >= 0);
  d->stamp++;
  EQM_FOR_CELLS_AROUND(d, u, c)
  {
    valence++;
    for (PetscInt a = 0; a < 3; a++) d->mark[d->cells[3 * c + a]] = d->stamp;
  }
  if (valence > EQM_MOST_VALENCE) return PETSC_FALSE;
  for (PetscInt k = 0; k < size; k++) {
    const PetscBool beside =
        (PetscBool)(k == target + 1 || k == target - 1 ||
                    (star->closed && (k == (target + 1) % size || k == (target + size - 1) % size)));
    if (k != target && !beside && d->mark[star->ring[k]] == d->stamp) return PETSC_FALSE;
  }
  for (PetscInt k = 0; k < size && star->closed && size == 3; k++) { /* else two triangles on the same three vertices */
    if (d->level->part[star->ring[k]] == EQM_INSIDE && Valence(d, star->ring[k]) <= 3) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The worst quality among the triangles that arise, lower where they turn away from the star's normal; the search ends
 * once it is no better than `enough`. */
static PetscReal QualityAfter(const EqmDecimation *d, const EqmStar *star, PetscInt target, const PetscReal normal[3],
                              PetscReal enough)
{
  const PetscReal *const x = d->level->position, along = PetscSqrtReal(EqmDot3(normal, normal));
  const PetscInt u = star->ring[target];
  PetscReal worst = 1.;

  for (PetscInt k = 0; k < star->num_cells && worst > enough; k++) {
    const PetscInt p = star->ring[k], q = star->ring[(k + 1) % star->size];
    PetscReal n[3], quality, cosine;
    if (p == u || q == u) continue;
    quality = EqmTriangleQuality(x + 3 * u, x + 3 * p, x + 3 * q, n);
    cosine =
        EqmDot3(n, normal) / (along * PetscSqrtReal(EqmDot3(n, n)) + PETSC_MACHINE_EPSILON * along * along + DBL_MIN);
    if (cosine < .3) quality *= cosine < -.2 ? 0. : .1;
    worst = PetscMin(worst, quality);
  }
  return worst;
}

PetscInt EqmChooseCollapse(EqmDecimation *d, const EqmStar *star, PetscReal quality)
{
  const PetscReal *const x = d->level->position;
  PetscReal normal[3] = {0., 0., 0.}, worst = 1., least;
  PetscInt best = -1;

  for (PetscInt k = 0; k < star->num_cells; k++) {
    PetscReal n[3];
    worst = PetscMin(worst, EqmTriangleQuality(x + 3 * star->vertex, x + 3 * star->ring[k],
                                               x + 3 * star->ring[(k + 1) % star->size], n));
    for (PetscInt c = 0; c < 3; c++) normal[c] += n[c];
  }
  least = PetscMin(quality, .5 * worst);
  for (PetscInt k = 0; k < star->size; k++) {
    PetscReal after;
    if (!KeepsBoundary(d, star, k)) continue;
    after = QualityAfter(d, star, k, normal, least);
    if (after <= least || !KeepsSurface(d, star, k)) continue;
    least = after;
    best = k;
  }
  return best;
}
