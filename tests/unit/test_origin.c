/* A mended mesh in the numbers of the file that it was made of: values of vertices and cells there and back, points. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "base/rows.h"
#include "register/origin.h"

/* Squares of two triangles, or cubes of six tetrahedra, all cut alike: at two corners, and along edges of the block,
   cells hang on the boundary alone. Every fifth is turned. */
static PetscErrorCode MakeBlock(PetscInt dim, PetscInt n, EqmSoup *soup)
{
  static const int path[6][3] = {{0, 1, 2}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}};
  const PetscInt cs = dim + 1, stride[3] = {1, n + 1, (n + 1) * (n + 1)}, ways = dim == 2 ? 2 : 6;
  EqmSerialMesh block = {.cell_size = cs, .num_vertices = stride[1] * (dim == 2 ? n + 1 : stride[2])};
  PetscMPIInt rank;

  PetscFunctionBegin;
  block.num_cells = ways * n * n * (dim == 2 ? 1 : n);
  PetscCall(PetscMalloc1(3 * block.num_vertices, &block.vertices));
  PetscCall(PetscMalloc1(cs * block.num_cells, &block.cells));
  for (PetscInt k = 0; k < 3 * block.num_vertices; k++)
    block.vertices[k] = (PetscReal)(k / 3 / stride[k % 3] % (n + 1)) + .1 * TestRandom(7, k / 3, k % 3);
  for (PetscInt c = 0; c < block.num_cells; c++) {
    const PetscInt cube = c / ways, turn = c % 5 == 0;
    PetscInt *const corner = block.cells + cs * c;
    corner[0] = cube % n + stride[1] * (cube / n % n) + (dim == 3 ? stride[2] * (cube / n / n) : 0);
    for (PetscInt a = 0; a < dim; a++) corner[a + 1] = corner[a] + stride[path[c % ways][a]];
    if (turn != (c % ways == 1 || c % ways >= 4)) { /* odd orders of the axes turn back */
      const PetscInt first = corner[0];
      corner[0] = corner[1];
      corner[1] = first;
    }
  }
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank != 0) PetscCall(EqmSerialMeshReset(&block));
  PetscCall(EqmSoupCreateFromRoot(PETSC_COMM_WORLD, rank == 0 ? &block : NULL, "block", soup));
  PetscFunctionReturn(0);
}

/* What is read, and what mending makes of it. */
static PetscErrorCode MakeIntake(PetscInt dim, PetscInt n, EqmIntake *intake)
{
  PetscFunctionBegin;
  *intake = (EqmIntake){.given = NULL};
  PetscCall(MakeBlock(dim, n, &intake->given));
  PetscCall(EqmSoupCopy(intake->given, &intake->mapped));
  PetscCall(EqmSoupRepair(&intake->mapped, &intake->repair, &intake->parent));
  CHECK(intake->repair.cells_flipped > 0 && intake->repair.cells_split > 0, "in %d dimensions nothing is mended",
        (int)dim);
  PetscFunctionReturn(0);
}

static PetscReal Slope(const PetscReal *p)
{
  return 1. + p[0] - 2. * p[1] + 3. * p[2];
}

/* A linear function is known at new vertices, too, and comes back as it went. */
static PetscErrorCode CheckVertices(EqmOrigin origin)
{
  const EqmSoup given = origin->intake->given;
  const EqmMesh mesh = origin->mesh;
  const PetscInt count = given->vertex_end - given->vertex_start;
  PetscReal *slab, *back, *local;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(2 * count, &slab, 2 * count, &back, 2 * mesh->num_local, &local));
  for (PetscInt i = 0; i < count; i++) {
    slab[2 * i] = Slope(given->vertices + 3 * i);
    slab[2 * i + 1] = back[2 * i] = back[2 * i + 1] = -1.;
  }
  PetscCall(EqmVerticesFromOrigin(origin, 2, slab, local));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    CHECK_CLOSE(local[2 * v], Slope(mesh->position + 3 * v), 1e-13, 10.);
    CHECK(local[2 * v + 1] == -1., "the second column is mixed up");
  }
  PetscCall(EqmVerticesToOrigin(origin, 2, local, back));
  for (PetscInt i = 0; i < 2 * count; i++) CHECK(back[i] == slab[i], "%g, not %g", (double)back[i], (double)slab[i]);
  PetscCall(PetscFree3(slab, back, local));
  PetscFunctionReturn(0);
}

/* Cells know the number of the file's cell that they are parts of, and give it back. */
static PetscErrorCode CheckCells(EqmOrigin origin)
{
  const EqmSoup given = origin->intake->given;
  const PetscInt count = given->cell_end - given->cell_start;
  PetscReal *slab, *back, *owned;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(count, &slab, count, &back, origin->mesh->num_owned_cells, &owned));
  for (PetscInt c = 0; c < count; c++) {
    slab[c] = given->cell_start + c;
    back[c] = -1.;
  }
  PetscCall(EqmCellsFromOrigin(origin, 1, slab, owned));
  for (PetscInt c = 0; c < origin->mesh->num_owned_cells; c++)
    CHECK(owned[c] == origin->parent[c], "the parent is %d", (int)owned[c]);
  PetscCall(EqmCellsToOrigin(origin, 1, owned, back));
  for (PetscInt c = 0; c < count; c++) CHECK(back[c] == slab[c], "cell %d got %g", (int)slab[c], (double)back[c]);
  PetscCall(PetscFree3(slab, back, owned));
  PetscFunctionReturn(0);
}

/* The middles of cells, found in the mended mesh, are where cells of the file and coordinates in them say. */
static PetscErrorCode CheckLocation(EqmOrigin origin)
{
  const EqmSoup given = origin->intake->given;
  const EqmMesh mesh = origin->mesh;
  const PetscInt cs = mesh->cell_size, num = mesh->num_owned_cells;
  EqmLocator locator;
  EqmLocation location;
  PetscReal *point, *barycentric, *position;
  PetscInt *cell, *corner;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(num, &cell, cs * num, &corner));
  PetscCall(PetscMalloc3(3 * num, &point, cs * num, &barycentric, 3 * cs * num, &position));
  PetscCall(PetscArrayzero(point, 3 * num));
  for (PetscInt k = 0; k < 3 * cs * num; k++)
    point[k / (3 * cs) * 3 + k % 3] += mesh->position[3 * mesh->cells[k / 3] + k % 3] / cs;
  PetscCall(EqmLocatorCreate(mesh, EQM_IMAGE_SPACE, mesh->position, &locator));
  PetscCall(EqmLocatorFind(locator, num, point, &location));
  PetscCall(EqmLocationInOrigin(origin, location, cell, barycentric));
  PetscCall(
      EqmFetchRows(mesh->comm, given->cell_end - given->cell_start, num, cell, MPIU_INT, cs, given->cells, corner));
  PetscCall(EqmFetchRows(mesh->comm, given->vertex_end - given->vertex_start, cs * num, corner, MPIU_REAL, 3,
                         given->vertices, position));
  for (PetscInt k = 0; k < 3 * num; k++) {
    PetscReal x = 0.;
    for (PetscInt a = 0; a < cs; a++) x += barycentric[cs * (k / 3) + a] * position[3 * (cs * (k / 3) + a) + k % 3];
    CHECK_CLOSE(x, point[k], 1e-12, 1.);
  }
  PetscCall(EqmLocationDestroy(&location));
  PetscCall(EqmLocatorDestroy(&locator));
  PetscCall(PetscFree2(cell, corner));
  PetscCall(PetscFree3(point, barycentric, position));
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckBlock(PetscInt dim, PetscInt n)
{
  EqmIntake intake;
  EqmLedger ledger;
  EqmMesh mesh;
  EqmOrigin origin;

  PetscFunctionBegin;
  PetscCall(MakeIntake(dim, n, &intake));
  PetscCall(EqmLedgerCreate(PETSC_COMM_WORLD, &ledger));
  PetscCall(EqmMeshCreate(intake.mapped, ledger, &mesh));
  PetscCall(EqmOriginCreate(&intake, mesh, &origin));
  PetscCall(CheckVertices(origin));
  PetscCall(CheckCells(origin));
  PetscCall(CheckLocation(origin));
  PetscCall(EqmOriginDestroy(&origin));
  PetscCall(EqmMeshDestroy(&mesh));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscCall(EqmIntakeDestroy(&intake));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(CheckBlock(2, 4));
  PetscCall(CheckBlock(3, 2));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
