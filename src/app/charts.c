/* The images of pieces side by side in the unit square. */
#include "mesh/soup_private.h"
#include "pieces.h"
#include "store/map_private.h"
#include "base/sort.h"

/* Where the square around an image lies. */
typedef struct {
  PetscInt number;
  PetscReal side, x, y;
} Chart;

/* Larger first, then by number. */
static int CompareCharts(const void *a, const void *b)
{
  const Chart *const s = a, *const t = b;

  if (s->side != t->side) return s->side > t->side ? -1 : 1;
  return (s->number > t->number) - (s->number < t->number);
}

/* Put the charts on shelves of the unit square, `scale` times their sides; false: they do not fit. */
static PetscBool Shelve(PetscInt n, Chart *chart, PetscReal scale)
{
  PetscReal x = 0., y = 0., shelf = 0.;

  for (PetscInt i = 0; i < n; i++) {
    const PetscReal side = scale * chart[i].side;

    if (x + side > 1.) {
      y += shelf;
      x = shelf = 0.;
    }
    if (x + side > 1. || y + side > 1.) return PETSC_FALSE;
    chart[i].x = x;
    chart[i].y = y;
    x += side;
    shelf = PetscMax(shelf, side);
  }
  return PETSC_TRUE;
}

/* The largest scale at which they fit, up to a thousandth. */
static PetscReal Pack(PetscInt n, Chart *chart)
{
  PetscReal fits = 0., fails = 1.001 / chart[0].side;

  while (fails - fits > 1e-3 * fails) {
    const PetscReal middle = .5 * (fits + fails);
    if (Shelve(n, chart, middle))
      fits = middle;
    else
      fails = middle;
  }
  (void)Shelve(n, chart, fits);
  return fits;
}

PetscErrorCode EqmPiecesCharts(const EqmPieces *pieces, EqmMap *charts)
{
  const PetscReal margin = .02; /* of a chart's side, free all around */
  const EqmSoup soup = pieces->map->soup;
  const PetscInt count = soup->vertex_end - soup->vertex_start;
  PetscInt n = 0, *place;
  PetscReal scale, least = 0.;
  Chart *chart;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(pieces->num_pieces, &chart, pieces->num_pieces + 1, &place));
  for (PetscInt p = 0; p < pieces->num_pieces; p++) {
    if (!pieces->piece[p].message[0])
      chart[n++] = (Chart){.number = p + 1, .side = PetscSqrtReal(pieces->piece[p].measure)};
  }
  EqmSort(chart, (size_t)n, sizeof(*chart), CompareCharts);
  scale = Pack(n, chart);
  for (PetscInt i = 0; i < n; i++) place[chart[i].number] = i;
  for (PetscInt k = 0; k < 2 * count; k++) least = PetscMin(least, pieces->map->coordinates[k]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPIU_REAL, MPIU_MIN, soup->comm));
  PetscCall(EqmMapCreate(soup, 2, charts));
  for (PetscInt k = 0; k < 2 * count; k++) {
    const PetscInt piece = pieces->vertex[k / 2];
    const PetscReal x = pieces->map->coordinates[k], unit = least < 0. ? .5 * (1. + x) : x; /* the disk has radius 1 */

    if (!piece) continue;
    const Chart *const to = &chart[place[piece]];
    (*charts)->coordinates[k] = (k % 2 ? to->y : to->x) + scale * to->side * (margin + (1. - 2. * margin) * unit);
  }
  PetscCall(PetscFree2(chart, place));
  PetscFunctionReturn(0);
}
