/* The closed surface around a solid, as a mesh of its own whose vertices know their places in the solid. */
#include "mesh/build.h"
#include "mesh/mesh_private.h"
#include "base/exchange.h"
#include "base/rows.h"
#include "base/sort.h"

/* Who is who on the surface. */
typedef struct {
  PetscLayout layout;  /* of the surface's vertices */
  PetscInt num_leaves; /* boundary vertices among the solid's local ones */
  PetscInt *leaf;      /* their local numbers */
  PetscInt *number;    /* their numbers on the surface */
} Numbering;

/* Number the boundary vertices in input order, which no distribution changes. */
static PetscErrorCode NumberVertices(EqmMesh solid, Numbering *numbering)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < solid->num_local; v++) numbering->num_leaves += solid->on_boundary[v];
  PetscCall(PetscMalloc2(numbering->num_leaves, &numbering->leaf, numbering->num_leaves, &numbering->number));
  for (PetscInt v = 0, k = 0; v < solid->num_local; v++) {
    if (solid->on_boundary[v]) numbering->leaf[k++] = v;
  }
  PetscCall(EqmMeshNumberInOrder(solid, numbering->num_leaves, numbering->leaf, numbering->number));
  PetscCall(PetscLayoutCreateFromSizes(solid->comm, PETSC_DECIDE, solid->num_boundary_vertices, 1, &numbering->layout));
  PetscFunctionReturn(0);
}

static int CompareTriangles(const void *a, const void *b)
{
  const PetscInt *const s = (const PetscInt *)a, *const t = (const PetscInt *)b;

  for (int k = 0; k < 3; k++) {
    if (s[k] != t[k]) return s[k] < t[k] ? -1 : 1;
  }
  return 0;
}

/* The surface's triangles, each beginning with its lowest vertex, in ascending order; that of the lowest vertex decides
   which rank gets it. */
static PetscErrorCode CollectTriangles(EqmMesh solid, const Numbering *numbering, PetscInt *num_cells, PetscInt **cells)
{
  PetscInt *number, *records, count = 0;
  PetscMPIInt *destination;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(solid->num_local, &number, 3 * solid->num_boundary_facets, &records,
                         solid->num_boundary_facets, &destination));
  for (PetscInt k = 0; k < numbering->num_leaves; k++) number[numbering->leaf[k]] = numbering->number[k];
  for (PetscInt f = 0; f < solid->num_boundary_facets; f++) {
    const PetscInt *const corner = solid->boundary_facets + 3 * f;
    int owner = 0, low = 0;

    for (int k = 1; k < 3; k++) {
      if (solid->global[corner[k]] < solid->global[corner[owner]]) owner = k;
      if (number[corner[k]] < number[corner[low]]) low = k;
    }
    if (corner[owner] >= solid->num_owned) continue; /* another rank's */
    for (int k = 0; k < 3; k++) records[3 * count + k] = number[corner[(low + k) % 3]];
    PetscCall(PetscLayoutFindOwner(numbering->layout, records[3 * count], &destination[count]));
    count++;
  }
  PetscCall(EqmExchange(solid->comm, count, 3, destination, records, num_cells, cells));
  EqmSort(*cells, (size_t)*num_cells, 3 * sizeof(PetscInt), CompareTriangles);
  PetscCall(PetscFree3(number, records, destination));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSurfaceCreate(EqmMesh solid, EqmSurface *surface)
{
  Numbering numbering = {0};
  PetscInt num_cells, *cells;
  PetscReal *vertices;
  EqmSurface s;

  PetscFunctionBegin;
  if (solid->cell_size != 4) {
    EqmFail(solid->comm, EQM_ERR_USAGE, "only a solid has a surface around it, and this mesh is of triangles");
  }
  PetscCall(PetscNew(&s));
  PetscCall(NumberVertices(solid, &numbering));
  PetscCall(PetscSFCreate(solid->comm, &s->vertices));
  PetscCall(PetscSFSetGraphLayout(s->vertices, numbering.layout, numbering.num_leaves, numbering.leaf,
                                  PETSC_COPY_VALUES, numbering.number));
  PetscCall(PetscMalloc1(3 * numbering.layout->n, &vertices));
  PetscCall(EqmSurfaceFromSolid(s, 3, solid->position, vertices));
  PetscCall(CollectTriangles(solid, &numbering, &num_cells, &cells));
  PetscCall(EqmSoupCreateFromSlabs(solid->comm, 3, numbering.layout->n, vertices, num_cells, cells,
                                   "the surface of the solid", &s->soup));
  PetscCall(PetscLayoutDestroy(&numbering.layout));
  PetscCall(PetscFree2(numbering.leaf, numbering.number));
  *surface = s;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSurfaceToSolid(EqmSurface surface, PetscInt width, const PetscReal *slab, PetscReal *local)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsToLeaves(surface->vertices, width, slab, local));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSurfaceFromSolid(EqmSurface surface, PetscInt width, const PetscReal *local, PetscReal *slab)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsToRoots(surface->vertices, width, local, slab));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSurfaceDestroy(EqmSurface *surface)
{
  PetscFunctionBegin;
  if (!*surface) PetscFunctionReturn(0);
  PetscCall(EqmSoupDestroy(&(*surface)->soup));
  PetscCall(PetscSFDestroy(&(*surface)->vertices));
  PetscCall(PetscFree(*surface));
  PetscFunctionReturn(0);
}
