/* Distributed point location: queries go to the ranks whose cells may hold the point, results come back; points outside
   all cells are sent once more to every rank that could have a closer cell. */
#include "register/tree.h"
#include "mesh/mesh_private.h"
#include "base/exchange.h"
#include "base/rows.h"
#include <math.h>

/* Number of boxes by which the other ranks know the extent of a rank's cells. */
enum { OUTLINE_LEVELS = 3, OUTLINE = 1 << OUTLINE_LEVELS };

struct _p_EqmLocator {
  EqmMesh mesh;
  PetscInt dim;
  EqmTree tree;
  EqmBox *outline; /* OUTLINE of each rank */
};

typedef struct {
  PetscReal point[3], squared; /* squared distance found so far: only closer cells are returned */
  PetscInt query, label;
  PetscMPIInt rank;
} Query;

typedef struct {
  EqmHit hit;
  PetscInt query;
  PetscMPIInt rank; /* of the cell */
} Result;

/* Gather the outlines of all ranks: boxes around their cells. */
static PetscErrorCode ShareOutline(EqmLocator locator)
{
  const EqmTree *const tree = &locator->tree;
  const PetscInt level = PetscMin(tree->num_levels, OUTLINE_LEVELS), first = (PetscInt)1 << level;
  const PetscMPIInt size = sizeof(EqmBox) * OUTLINE;
  EqmBox mine[OUTLINE];

  PetscFunctionBegin;
  for (PetscInt b = 0; b < OUTLINE; b++) mine[b] = tree->box[first + PetscMin(b, first - 1)];
  PetscCall(PetscMalloc1(OUTLINE * locator->mesh->size, &locator->outline));
  PetscCallMPI(MPI_Allgather(mine, size, MPI_BYTE, locator->outline, size, MPI_BYTE, locator->mesh->comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLocatorCreate(EqmMesh mesh, EqmImageKind kind, const PetscReal *x, EqmLocator *out)
{
  const PetscInt dim = kind == EQM_IMAGE_PLANE ? 2 : 3, cs = mesh->cell_size, n = mesh->num_owned_cells;
  PetscReal *corner, extent = 0.;
  PetscInt *label;
  EqmLocator locator;

  PetscFunctionBegin;
  PetscCall(PetscNew(&locator));
  locator->mesh = mesh;
  locator->dim = dim;
  PetscCall(PetscCalloc1(3 * cs * n, &corner));
  PetscCall(PetscMalloc1(n, &label));
  for (PetscInt c = 0; c < n; c++) {
    label[c] = mesh->cell_input[c];
    for (PetscInt a = 0; a < cs; a++) {
      for (PetscInt k = 0; k < dim; k++) corner[3 * (cs * c + a) + k] = x[dim * mesh->cells[cs * c + a] + k];
    }
  }
  for (PetscInt k = 0; k < 3 * cs * n; k++) extent = PetscMax(extent, PetscAbsReal(corner[k]));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &extent, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  PetscCall(EqmTreeCreate(kind, cs, n, corner, label, 1e-12 * extent, &locator->tree));
  PetscCall(ShareOutline(locator));
  *out = locator;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmLocatorDestroy(EqmLocator *locator)
{
  PetscFunctionBegin;
  if (!*locator) PetscFunctionReturn(0);
  PetscCall(EqmTreeReset(&(*locator)->tree));
  PetscCall(PetscFree((*locator)->outline));
  PetscCall(PetscFree(*locator));
  PetscFunctionReturn(0);
}

static PetscReal OutlineDistance(EqmLocator locator, PetscMPIInt rank, const PetscReal y[3])
{
  PetscReal least = INFINITY;

  for (PetscInt b = 0; b < OUTLINE; b++)
    least = PetscMin(least, EqmBoxSquaredDistance(&locator->outline[OUTLINE * rank + b], y));
  return least;
}

/* The rank whose outline is closest. */
static PetscMPIInt ClosestRank(EqmLocator locator, const PetscReal y[3])
{
  PetscReal least = INFINITY;
  PetscMPIInt closest = 0;

  for (PetscMPIInt p = 0; p < locator->mesh->size; p++) {
    const PetscReal distance = OutlineDistance(locator, p, y);
    if (distance >= least) continue;
    least = distance;
    closest = p;
  }
  return closest;
}

/* Does rank p get the query of a point? In the first round ranks whose outline holds it, else the closest rank; in the
   second all others that could have a closer cell. */
static PetscBool GetsQuery(EqmLocator locator, PetscMPIInt p, PetscBool second, const PetscReal y[3],
                           PetscMPIInt closest, PetscReal squared)
{
  const PetscReal distance = OutlineDistance(locator, p, y);
  const PetscBool before = (PetscBool)(distance == 0. || p == closest);

  return (PetscBool)(second ? !before && distance <= squared : before);
}

/* The queries of one round. */
static PetscErrorCode CollectQueries(EqmLocator locator, PetscBool second, PetscInt num, const PetscReal *points,
                                     const Result *found, PetscInt *count, Query **queries, PetscMPIInt **destination)
{
  PetscInt most = PetscMax(16, 2 * num), n = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc(sizeof(Query) * (size_t)most, queries));
  PetscCall(PetscMalloc(sizeof(PetscMPIInt) * (size_t)most, destination));
  for (PetscInt i = 0; i < num; i++) {
    Query query = {.squared = found[i].hit.squared, .query = i, .label = found[i].hit.label};
    PetscMPIInt closest;
    if (second && found[i].hit.squared == 0.) continue;
    for (PetscInt k = 0; k < locator->dim; k++) query.point[k] = points[locator->dim * i + k];
    query.rank = locator->mesh->rank;
    closest = ClosestRank(locator, query.point);
    for (PetscMPIInt p = 0; p < locator->mesh->size; p++) {
      if (!GetsQuery(locator, p, second, query.point, closest, query.squared)) continue;
      if (n == most) {
        most *= 2;
        PetscCall(PetscRealloc(sizeof(Query) * (size_t)most, queries));
        PetscCall(PetscRealloc(sizeof(PetscMPIInt) * (size_t)most, destination));
      }
      (*queries)[n] = query;
      (*destination)[n++] = p;
    }
  }
  *count = n;
  PetscFunctionReturn(0);
}

/* One round: exchange queries, search the trees, keep the closest results. */
static PetscErrorCode ExchangeQueries(EqmLocator locator, PetscBool second, PetscInt num, const PetscReal *points,
                                      Result *found)
{
  MPI_Comm comm = locator->mesh->comm;
  PetscInt count, num_incoming, num_results;
  Query *queries, *incoming;
  Result *results, *received;
  PetscMPIInt *destination;

  PetscFunctionBegin;
  PetscCall(CollectQueries(locator, second, num, points, found, &count, &queries, &destination));
  PetscCall(EqmExchangeBytes(comm, count, sizeof(Query), destination, queries, &num_incoming, &incoming));
  PetscCall(PetscFree(queries));
  PetscCall(PetscFree(destination));
  PetscCall(PetscMalloc2(num_incoming, &results, num_incoming, &destination));
#pragma omp parallel for schedule(dynamic, 256)
  for (PetscInt k = 0; k < num_incoming; k++) {
    Result result = {.hit = {.cell = -1, .label = incoming[k].label, .squared = incoming[k].squared},
                     .query = incoming[k].query,
                     .rank = locator->mesh->rank};
    EqmTreeFind(&locator->tree, incoming[k].point, &result.hit);
    results[k] = result;
    destination[k] = incoming[k].rank;
  }
  PetscCall(EqmExchangeBytes(comm, num_incoming, sizeof(Result), destination, results, &num_results, &received));
  PetscCall(PetscFree2(results, destination));
  PetscCall(PetscFree(incoming));
  for (PetscInt k = 0; k < num_results; k++) {
    const EqmHit *const hit = &received[k].hit, *const best = &found[received[k].query].hit;
    if (hit->cell >= 0 && (hit->squared < best->squared || (hit->squared == best->squared && hit->label < best->label)))
      found[received[k].query] = received[k];
  }
  PetscCall(PetscFree(received));
  PetscFunctionReturn(0);
}

/* From results to the location object. */
static PetscErrorCode CreateLocation(EqmLocator locator, PetscInt num, const Result *found, EqmLocation *out)
{
  const EqmMesh mesh = locator->mesh;
  PetscSFNode *remote;
  PetscInt64 clamped = 0;
  PetscReal farthest = 0.;
  EqmLocation location;

  PetscFunctionBegin;
  PetscCall(PetscNew(&location));
  location->comm = mesh->comm;
  location->num = num;
  location->cell_size = mesh->cell_size;
  PetscCall(PetscMalloc1(num, &location->cell));
  PetscCall(PetscMalloc1(mesh->cell_size * num, &location->barycentric));
  PetscCall(PetscMalloc1(num, &location->distance));
  PetscCall(PetscMalloc1(num, &remote));
  for (PetscInt i = 0; i < num; i++) {
    PetscCheck(found[i].hit.cell >= 0, PETSC_COMM_SELF, PETSC_ERR_PLIB, "a point that is no number was looked for");
    location->cell[i] = found[i].hit.label;
    location->distance[i] = PetscSqrtReal(found[i].hit.squared);
    for (PetscInt a = 0; a < mesh->cell_size; a++)
      location->barycentric[mesh->cell_size * i + a] = found[i].hit.barycentric[a];
    clamped += location->distance[i] > 0.;
    farthest = PetscMax(farthest, location->distance[i]);
    remote[i].rank = found[i].rank;
    remote[i].index = found[i].hit.cell;
  }
  PetscCall(MPIU_Allreduce(&clamped, &location->num_clamped, 1, MPIU_INT64, MPI_SUM, mesh->comm));
  PetscCall(MPIU_Allreduce(&farthest, &location->most_distant, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  PetscCall(PetscSFCreate(mesh->comm, &location->cells));
  PetscCall(
      PetscSFSetGraph(location->cells, mesh->num_owned_cells, num, NULL, PETSC_OWN_POINTER, remote, PETSC_OWN_POINTER));
  *out = location;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLocatorFind(EqmLocator locator, PetscInt num, const PetscReal *points, EqmLocation *location)
{
  Result *found;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num, &found));
  for (PetscInt i = 0; i < num; i++)
    found[i].hit = (EqmHit){.cell = -1, .label = PETSC_MAX_INT, .squared = PETSC_MAX_REAL};
  PetscCall(ExchangeQueries(locator, PETSC_FALSE, num, points, found));
  PetscCall(ExchangeQueries(locator, PETSC_TRUE, num, points, found));
  PetscCall(CreateLocation(locator, num, found, location));
  PetscCall(PetscFree(found));
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmLocationDestroy(EqmLocation *location)
{
  PetscFunctionBegin;
  if (!*location) PetscFunctionReturn(0);
  PetscCall(PetscSFDestroy(&(*location)->cells));
  PetscCall(PetscFree((*location)->cell));
  PetscCall(PetscFree((*location)->barycentric));
  PetscCall(PetscFree((*location)->distance));
  PetscCall(PetscFree(*location));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLocationSample(EqmLocation location, EqmMesh mesh, PetscInt width, const PetscReal *cells,
                                 PetscReal *points)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsToLeaves(location->cells, width, cells, points));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLocationInterpolate(EqmLocation location, EqmMesh mesh, PetscInt width, const PetscReal *vertices,
                                      PetscReal *points)
{
  const PetscInt cs = mesh->cell_size;
  PetscReal *of_cells, *fetched;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(cs * width * mesh->num_owned_cells, &of_cells, cs * width * location->num, &fetched));
  for (PetscInt k = 0; k < cs * mesh->num_owned_cells; k++) {
    for (PetscInt i = 0; i < width; i++) of_cells[width * k + i] = vertices[width * mesh->cells[k] + i];
  }
  PetscCall(EqmRowsToLeaves(location->cells, cs * width, of_cells, fetched));
  for (PetscInt p = 0; p < location->num; p++) {
    for (PetscInt i = 0; i < width; i++) {
      PetscReal sum = 0.;
      for (PetscInt a = 0; a < cs; a++) sum += location->barycentric[cs * p + a] * fetched[width * (cs * p + a) + i];
      points[width * p + i] = sum;
    }
  }
  PetscCall(PetscFree2(of_cells, fetched));
  PetscFunctionReturn(0);
}
