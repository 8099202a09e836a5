/* The double covering of a surface with a boundary: the surface and its mirror image, glued along the boundary into one
   closed surface (004 section 2.2). */
#include "mesh/build.h"
#include "mesh/mesh_private.h"
#include "base/exchange.h"
#include "base/rows.h"

/* The numbers on the covering of the surface's local vertices and of their twins: first all of the surface in input
   order, then the twins of the interior ones, also in input order. */
static PetscErrorCode NumberHalves(EqmMesh surface, PetscInt *original, PetscInt *twin)
{
  PetscInt *leaf, *number, num_interior = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(surface->num_local, &leaf, surface->num_local, &number));
  for (PetscInt v = 0; v < surface->num_local; v++) leaf[v] = v;
  PetscCall(EqmMeshNumberInOrder(surface, surface->num_local, leaf, original));
  for (PetscInt v = 0; v < surface->num_local; v++) {
    twin[v] = original[v];
    if (!surface->on_boundary[v]) leaf[num_interior++] = v;
  }
  PetscCall(EqmMeshNumberInOrder(surface, num_interior, leaf, number));
  for (PetscInt k = 0; k < num_interior; k++) twin[leaf[k]] = surface->num_vertices + number[k];
  PetscCall(PetscFree2(leaf, number));
  PetscFunctionReturn(0);
}

/* The surface's triangles in input order, then the same turned over with twins for corners, each on the rank whose slab
   it belongs to. */
static PetscErrorCode CollectTriangles(EqmMesh surface, const PetscInt *original, const PetscInt *twin,
                                       PetscInt *num_cells, PetscInt **cells)
{
  const PetscInt num_records = 2 * surface->num_owned_cells;
  PetscInt *records, *received;
  PetscMPIInt *destination;
  PetscLayout layout;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(4 * num_records, &records, num_records, &destination));
  PetscCall(PetscLayoutCreateFromSizes(surface->comm, PETSC_DECIDE, 2 * surface->num_cells, 1, &layout));
  for (PetscInt r = 0; r < num_records; r++) {
    const PetscBool mirrored = (PetscBool)(r % 2);
    const PetscInt *const corner = surface->cells + 3 * (r / 2), *const number = mirrored ? twin : original;
    PetscInt *const record = records + 4 * r;
    record[0] = surface->cell_input[r / 2] + (mirrored ? surface->num_cells : 0);
    for (PetscInt k = 0; k < 3; k++) record[1 + k] = number[corner[mirrored ? 2 - k : k]];
    PetscCall(PetscLayoutFindOwner(layout, record[0], &destination[r]));
  }
  PetscCall(EqmExchange(surface->comm, num_records, 4, destination, records, num_cells, &received));
  PetscCall(PetscMalloc1(3 * *num_cells, cells));
  for (PetscInt r = 0; r < *num_cells; r++)
    PetscCall(PetscArraycpy(*cells + 3 * (received[4 * r] - layout->rstart), received + 4 * r + 1, 3));
  PetscCall(PetscFree(received));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscCall(PetscFree2(records, destination));
  PetscFunctionReturn(0);
}

/* Who on the covering is who on the surface. */
static PetscErrorCode CreateSF(EqmMesh surface, PetscLayout layout, PetscInt *numbers, PetscSF *sf)
{
  PetscFunctionBegin;
  PetscCall(PetscSFCreate(surface->comm, sf));
  PetscCall(PetscSFSetGraphLayout(*sf, layout, surface->num_owned, NULL, PETSC_OWN_POINTER, numbers));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDoubleCreate(EqmMesh surface, EqmDouble *covering)
{
  PetscInt *original, *twin, num_cells, *cells;
  PetscReal *vertices;
  PetscLayout layout;
  EqmDouble d;

  PetscFunctionBegin;
  if (surface->cell_size != 3 || surface->num_boundary_vertices == 0)
    EqmFail(surface->comm, EQM_ERR_USAGE, "only a surface with a boundary has a double covering");
  PetscCall(PetscNew(&d));
  PetscCall(PetscMalloc2(surface->num_local, &original, surface->num_local, &twin));
  PetscCall(NumberHalves(surface, original, twin));
  PetscCall(PetscLayoutCreateFromSizes(surface->comm, PETSC_DECIDE,
                                       2 * surface->num_vertices - surface->num_boundary_vertices, 1, &layout));
  PetscCall(CreateSF(surface, layout, original, &d->original));
  PetscCall(CreateSF(surface, layout, twin, &d->twin));
  PetscCall(PetscMalloc1(3 * layout->n, &vertices));
  PetscCall(EqmDoubleFromHalves(d, 3, surface->position, surface->position, vertices));
  PetscCall(CollectTriangles(surface, original, twin, &num_cells, &cells));
  PetscCall(EqmSoupCreateFromSlabs(surface->comm, 3, layout->n, vertices, num_cells, cells,
                                   "the double covering of the surface", &d->soup));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscCall(PetscFree2(original, twin));
  *covering = d;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDoubleFromHalves(EqmDouble covering, PetscInt width, const PetscReal *original, const PetscReal *twin,
                                   PetscReal *slab)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsToRoots(covering->twin, width, twin, slab));
  PetscCall(EqmRowsToRoots(covering->original, width, original, slab));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDoubleToOriginal(EqmDouble covering, PetscInt width, const PetscReal *slab, PetscReal *owned)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsToLeaves(covering->original, width, slab, owned));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDoubleDestroy(EqmDouble *covering)
{
  PetscFunctionBegin;
  if (!*covering) PetscFunctionReturn(0);
  PetscCall(EqmSoupDestroy(&(*covering)->soup));
  PetscCall(PetscSFDestroy(&(*covering)->original));
  PetscCall(PetscSFDestroy(&(*covering)->twin));
  PetscCall(PetscFree(*covering));
  PetscFunctionReturn(0);
}
