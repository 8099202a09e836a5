/* The distributed mesh against the same mesh on one rank: stars, halo, measures, boundary, blocks, ways to the input.
 */
#include "support/testing.h"
#include "mesh/gather.h"
#include "mesh/build.h"
#include "mesh/mesh_private.h"

/* Vertex numbers of the input for every local vertex, ghosts from their owners. */
static PetscErrorCode InputNumbers(EqmMesh mesh, PetscInt **input)
{
  PetscReal *number;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local, &number));
  PetscCall(PetscMalloc1(mesh->num_local, input));
  for (PetscInt v = 0; v < mesh->num_local; v++) number[v] = v < mesh->num_owned ? mesh->vertex_input[v] : -1;
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, number));
  for (PetscInt v = 0; v < mesh->num_local; v++) (*input)[v] = (PetscInt)number[v];
  PetscCall(PetscFree(number));
  PetscFunctionReturn(0);
}

/* Every vertex and every cell of the input has one owner; owned vertices are contiguous in rank order. */
static PetscErrorCode CheckOwners(EqmMesh mesh, EqmSoup serial)
{
  PetscInt *vertex, *cell, end;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(serial->num_vertices, &vertex, serial->num_cells, &cell));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    vertex[mesh->vertex_input[v]]++;
    CHECK(mesh->global[v] == mesh->vertex_start + v, "owned vertex %d has the global number %d", (int)v,
          (int)mesh->global[v]);
  }
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) cell[mesh->cell_input[c]]++;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, vertex, serial->num_vertices, MPIU_INT, MPI_SUM, mesh->comm));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, cell, serial->num_cells, MPIU_INT, MPI_SUM, mesh->comm));
  for (PetscInt v = 0; v < serial->num_vertices; v++)
    CHECK(vertex[v] == 1, "vertex %d has %d owners", (int)v, (int)vertex[v]);
  for (PetscInt c = 0; c < serial->num_cells; c++) CHECK(cell[c] == 1, "cell %d has %d owners", (int)c, (int)cell[c]);
  PetscCallMPI(MPI_Scan(&mesh->num_owned, &end, 1, MPIU_INT, MPI_SUM, mesh->comm));
  CHECK(mesh->vertex_start == end - mesh->num_owned, "the first vertex is %d", (int)mesh->vertex_start);
  CHECK(mesh->num_vertices == serial->num_vertices && mesh->num_cells == serial->num_cells, "%d vertices, %d cells",
        (int)mesh->num_vertices, (int)mesh->num_cells);
  PetscCall(PetscFree2(vertex, cell));
  PetscFunctionReturn(0);
}

/* Local vertices stand where the input has them; an owned vertex sees all its cells; a cell keeps its corners' order.
 */
static PetscErrorCode CheckStars(EqmMesh mesh, EqmSoup serial, const PetscInt *input)
{
  const PetscInt cs = mesh->cell_size;
  PetscInt *wanted, *got;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(serial->num_vertices, &wanted, mesh->num_local, &got));
  for (PetscInt k = 0; k < cs * serial->num_cells; k++) wanted[serial->cells[k]]++;
  for (PetscInt k = 0; k < cs * mesh->num_local_cells; k++) got[mesh->cells[k]]++;
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    for (PetscInt k = 0; k < 3; k++) {
      CHECK(mesh->position[3 * v + k] == serial->vertices[3 * input[v] + k], "vertex %d is elsewhere", (int)input[v]);
    }
    CHECK(v >= mesh->num_owned || got[v] == wanted[input[v]], "vertex %d has %d of %d cells", (int)input[v],
          (int)got[v], (int)wanted[input[v]]);
    CHECK(v < mesh->num_owned || got[v] > 0, "ghost %d belongs to no cell here", (int)input[v]);
  }
  for (PetscInt k = 0; k < cs * mesh->num_owned_cells; k++) {
    CHECK(input[mesh->cells[k]] == serial->cells[cs * mesh->cell_input[k / cs] + k % cs], "cell %d",
          (int)mesh->cell_input[k / cs]);
  }
  PetscCall(PetscFree2(wanted, got));
  PetscFunctionReturn(0);
}

static PetscReal Distance(const PetscReal *p, const PetscReal *q)
{
  return PetscSqrtReal(PetscSqr(p[0] - q[0]) + PetscSqr(p[1] - q[1]) + PetscSqr(p[2] - q[2]));
}

/* By Heron's formula. */
static PetscReal TriangleArea(const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  const PetscReal a = Distance(p, q), b = Distance(p, r), c = Distance(q, r);
  return .25 * PetscSqrtReal((a + b + c) * (-a + b + c) * (a - b + c) * (a + b - c));
}

/* Areas, weights (density included) and their sums; ghosts' cells have the same weights as their owners'. */
static PetscErrorCode CheckMeasures(EqmMesh mesh, EqmSoup serial, const PetscInt *input, PetscReal (*density)(PetscInt))
{
  const PetscReal *const p = serial->vertices;
  PetscReal total = 0., sum = 0., *by_vertex;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(serial->num_vertices, &by_vertex));
  for (PetscInt c = 0; c < serial->num_cells; c++) {
    const PetscInt *const v = serial->cells + 3 * c;
    const PetscReal w = density(c) * TriangleArea(p + 3 * v[0], p + 3 * v[1], p + 3 * v[2]);
    total += w;
    for (PetscInt k = 0; k < 3; k++) by_vertex[v[k]] += w;
  }
  CHECK_CLOSE(mesh->measure, total, 1e-12, total);
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    const PetscReal area = TriangleArea(p + 3 * input[v[0]], p + 3 * input[v[1]], p + 3 * input[v[2]]);
    CHECK_CLOSE(mesh->cell_measure[c], area, 1e-9, area);
    for (PetscInt k = 0; k < 3; k++) by_vertex[input[v[k]]] -= mesh->weight[c] * total;
    if (c >= mesh->num_owned_cells) continue;
    CHECK_CLOSE(mesh->weight[c], area * density(mesh->cell_input[c]) / total, 1e-9, mesh->weight[c]);
    sum += mesh->weight[c];
  }
  for (PetscInt v = 0; v < mesh->num_owned; v++) CHECK_CLOSE(by_vertex[input[v]], 0., 1e-9, total);
  CHECK_CLOSE(TestSum(mesh->comm, sum), 1., 1e-13, 1.);
  PetscCall(PetscFree(by_vertex));
  PetscFunctionReturn(0);
}

/* The vertex after every vertex along the boundary, -1 inside: the edge that no other cell runs through backwards. */
static PetscErrorCode NextOnBoundary(EqmSoup serial, PetscInt *next)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < serial->num_vertices; v++) next[v] = -1;
  for (PetscInt k = 0; k < 3 * serial->num_cells; k++) {
    const PetscInt i = serial->cells[k], j = serial->cells[k - k % 3 + (k + 1) % 3];
    PetscBool alone = PETSC_TRUE;
    for (PetscInt q = 0; q < 3 * serial->num_cells && alone; q++) {
      alone = (PetscBool) !(serial->cells[q] == j && serial->cells[q - q % 3 + (q + 1) % 3] == i);
    }
    if (alone) next[i] = j;
  }
  PetscFunctionReturn(0);
}

/* Place and arc length along the loop from a walk on the serial mesh. */
static PetscErrorCode CheckBoundary(EqmMesh mesh, EqmSoup serial, const PetscInt *input)
{
  PetscInt *next, *place, *got_place, first = 0, count = 0;
  PetscReal *arc, *got_arc, length = 0.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc5(serial->num_vertices, &next, serial->num_vertices, &place, serial->num_vertices, &arc,
                         mesh->num_local, &got_place, mesh->num_local, &got_arc));
  PetscCall(NextOnBoundary(serial, next));
  for (PetscInt v = 0; v < serial->num_vertices; v++) place[v] = -1;
  while (next[first] < 0) first++;
  for (PetscInt v = first; place[v] < 0; v = next[v]) {
    place[v] = count++;
    arc[v] = length;
    length += Distance(serial->vertices + 3 * v, serial->vertices + 3 * next[v]);
  }
  PetscCall(EqmMeshBoundaryLoop(mesh, got_place, got_arc));
  CHECK(mesh->num_boundary_vertices == count, "%d boundary vertices, not %d", (int)mesh->num_boundary_vertices,
        (int)count);
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    CHECK(got_place[v] == place[input[v]], "vertex %d has place %d, not %d", (int)input[v], (int)got_place[v],
          (int)place[input[v]]);
    CHECK(mesh->on_boundary[v] == (place[input[v]] >= 0), "vertex %d", (int)input[v]);
    CHECK_CLOSE(got_arc[v], place[input[v]] < 0 ? -1. : arc[input[v]] / length, 1e-12, 1.);
  }
  PetscCall(PetscFree5(next, place, arc, got_place, got_arc));
  PetscFunctionReturn(0);
}

/* To the input's slabs and back: every value at its own vertex or cell. */
static PetscErrorCode CheckRoundTrip(EqmMesh mesh, EqmSoup soup, const PetscInt *input)
{
  const PetscInt num_vertices = soup->vertex_end - soup->vertex_start, num_cells = soup->cell_end - soup->cell_start;
  PetscReal *owned, *slab, *local;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(2 * PetscMax(mesh->num_owned, mesh->num_owned_cells), &owned,
                         2 * PetscMax(num_vertices, num_cells), &slab, 2 * mesh->num_local, &local));
  for (PetscInt k = 0; k < 2 * mesh->num_owned; k++) owned[k] = 10. * mesh->vertex_input[k / 2] + k % 2;
  PetscCall(EqmMeshVerticesToInput(mesh, soup, 2, owned, slab));
  for (PetscInt k = 0; k < 2 * num_vertices; k++)
    CHECK(slab[k] == 10. * (soup->vertex_start + k / 2) + k % 2, "%g", (double)slab[k]);
  PetscCall(EqmMeshVerticesFromInput(mesh, soup, 2, slab, local));
  for (PetscInt k = 0; k < 2 * mesh->num_local; k++)
    CHECK(local[k] == 10. * input[k / 2] + k % 2, "%g", (double)local[k]);
  for (PetscInt k = 0; k < 2 * mesh->num_owned_cells; k++) owned[k] = 10. * mesh->cell_input[k / 2] + k % 2;
  PetscCall(EqmMeshCellsToInput(mesh, soup, 2, owned, slab));
  for (PetscInt k = 0; k < 2 * num_cells; k++)
    CHECK(slab[k] == 10. * (soup->cell_start + k / 2) + k % 2, "%g", (double)slab[k]);
  PetscCall(PetscFree3(owned, slab, local));
  PetscFunctionReturn(0);
}

static PetscReal One(PetscInt cell)
{
  return 1.;
}

static PetscReal Uneven(PetscInt cell)
{
  return 1. + cell % 7;
}

/* All checks on the mesh of `soup`; `serial` is the same mesh whole. Both are used up. */
static PetscErrorCode CheckMesh(EqmSoup soup, EqmSoup serial, PetscReal (*density)(PetscInt))
{
  PetscInt *input;
  TestMesh test;

  PetscFunctionBegin;
  if (density != One) {
    PetscCall(PetscMalloc1(soup->cell_end - soup->cell_start + 1, &soup->density)); /* NULL would say: none */
    for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) soup->density[c - soup->cell_start] = density(c);
  }
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(InputNumbers(test.mesh, &input));
  PetscCall(CheckOwners(test.mesh, serial));
  PetscCall(CheckStars(test.mesh, serial, input));
  PetscCall(CheckMeasures(test.mesh, serial, input, density));
  PetscCall(CheckBoundary(test.mesh, serial, input));
  PetscCall(TestCheckBlocks(test.mesh));
  PetscCall(CheckRoundTrip(test.mesh, soup, input));
  PetscCall(PetscFree(input));
  PetscCall(TestMeshDestroy(&test));
  PetscCall(EqmSoupDestroy(&serial));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestShape(const char *shape, PetscInt n, const char *partition, PetscReal (*density)(PetscInt))
{
  EqmSoup soup, serial;
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, shape, n, 5, &soup));
  PetscCall(EqmSoupGenerate(PETSC_COMM_SELF, shape, n, 5, &serial));
  PetscCall(TestOptionsBegin(partition, &options));
  PetscCall(CheckMesh(soup, serial, density));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

/* Ranges along the curve: as many vertices on each rank, and the same ranks for the same vertices however the file
   numbers them: here the other way round on each rank. */
static PetscErrorCode TestCurve(void)
{
  EqmSoup soup, turned;
  PetscMPIInt size;
  PetscInt *owner, *turned_owner, n, start, count[2] = {0, 0}, most;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "hills", 700, 5, &soup));
  PetscCall(EqmSoupCopy(soup, &turned));
  n = soup->vertex_end - soup->vertex_start;
  start = soup->vertex_start;
  for (PetscInt v = 0; v < n; v++) { /* points alone count: turn their order round */
    for (PetscInt k = 0; k < 3; k++) turned->vertices[3 * v + k] = soup->vertices[3 * (n - 1 - v) + k];
  }
  PetscCall(PetscMalloc2(n, &owner, n, &turned_owner));
  PetscCall(EqmPartitionAlongCurve(soup, owner));
  PetscCall(EqmPartitionAlongCurve(turned, turned_owner));
  for (PetscInt v = 0; v < n; v++) {
    CHECK(owner[v] == turned_owner[n - 1 - v], "vertex %d goes to rank %d, or %d", (int)(start + v), (int)owner[v],
          (int)turned_owner[n - 1 - v]);
    CHECK(owner[v] >= 0 && owner[v] < size, "vertex %d goes to rank %d", (int)(start + v), (int)owner[v]);
    count[0] += owner[v] == 0;
    count[1] += owner[v] == size - 1;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 2, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD));
  most = soup->num_vertices / size + 1;
  CHECK(count[0] >= most - 1 && count[0] <= most && count[1] >= most - 1 && count[1] <= most,
        "the first rank gets %d vertices, the last %d, of %d", (int)count[0], (int)count[1], (int)soup->num_vertices);
  PetscCall(PetscFree2(owner, turned_owner));
  PetscCall(EqmSoupDestroy(&soup));
  PetscCall(EqmSoupDestroy(&turned));
  PetscFunctionReturn(0);
}

/* Three triangles round one vertex: on more than four ranks some have nothing. */
static PetscErrorCode MakeFan(MPI_Comm comm, EqmSoup *soup)
{
  static const PetscReal points[12] = {0., 0., 1., 1., 0., 0., -1., 1., 0., -1., -1., 0.};
  static const PetscInt corners[9] = {0, 1, 2, 0, 2, 3, 0, 3, 1};

  PetscFunctionBegin;
  PetscCall(TestSoupFromArrays(comm, 4, points, 3, 3, corners, soup));
  PetscFunctionReturn(0);
}

/* The smallest mesh of disk type, checked and mapped: by symmetry all areas are equal in any map that minimises. */
static PetscErrorCode TestFan(void)
{
  EqmSoup soup, serial;
  TestMesh test;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(MakeFan(PETSC_COMM_WORLD, &soup));
  PetscCall(MakeFan(PETSC_COMM_SELF, &serial));
  PetscCall(CheckMesh(soup, serial, Uneven));
  PetscCall(MakeFan(PETSC_COMM_WORLD, &soup));
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(TestSolve(test.mesh, "disk", "-method lm", &solver));
  CHECK(solver->iterate->totals.folds == 0 && solver->iterate->totals.energy < 1e-10, "energy %g",
        (double)solver->iterate->totals.energy);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Refined with its density, on ranks that have no cell too. */
static PetscErrorCode TestRefinedFan(void)
{
  EqmSoup soup;
  TestMesh coarse, fine;

  PetscFunctionBegin;
  for (PetscInt times = 0; times < 2; times++) {
    PetscCall(MakeFan(PETSC_COMM_WORLD, &soup));
    PetscCall(PetscMalloc1(soup->cell_end - soup->cell_start + 1, &soup->density));
    for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) soup->density[c - soup->cell_start] = Uneven(c);
    if (times) PetscCall(EqmSoupRefine(&soup, 1));
    PetscCall(TestMeshFromSoup(soup, times ? &fine : &coarse));
  }
  CHECK(fine.mesh->num_cells == 12, "%d cells", (int)fine.mesh->num_cells);
  CHECK_CLOSE(fine.mesh->measure, coarse.mesh->measure, 1e-13, coarse.mesh->measure);
  PetscCall(TestMeshDestroy(&coarse));
  PetscCall(TestMeshDestroy(&fine));
  PetscFunctionReturn(0);
}

/* Positions of a few vertices on every rank, one of them twice; vertex 2 is of no cell. */
static PetscErrorCode TestGather(void)
{
  static const PetscReal points[] = {0., 0., 0., 1., 0., .5, 9., 9., 9., 1., 1., -.25, 0., 1., 2.};
  static const PetscInt corners[] = {0, 1, 3, 0, 3, 4}, all[] = {4, 2, 0, 4}, used[] = {3, 1};
  PetscReal got[12];
  PetscInt missing;
  EqmSoup soup;
  TestMesh test;

  PetscFunctionBegin;
  PetscCall(TestSoupFromArrays(PETSC_COMM_WORLD, 5, points, 3, 2, corners, &soup));
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(EqmMeshGatherVertices(test.mesh, 2, used, 3, test.mesh->position, got, &missing));
  CHECK(missing == -1, "vertex %d is of no cell", (int)missing);
  for (PetscInt k = 0; k < 6; k++) CHECK(got[k] == points[3 * used[k / 3] + k % 3], "entry %d is %g", (int)k, got[k]);
  PetscCall(EqmMeshGatherVertices(test.mesh, 4, all, 3, test.mesh->position, got, &missing));
  CHECK(missing == 1, "the first missing vertex is at %d", (int)missing);
  for (PetscInt k = 0; k < 12; k++)
    CHECK(got[k] == (k / 3 == 1 ? 0. : points[3 * all[k / 3] + k % 3]), "entry %d is %g", (int)k, got[k]);
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestShape("cap", 700, "-partition metis", One));
  PetscCall(TestShape("hills", 700, "-partition metis", Uneven));
  PetscCall(TestShape("hills", 700, "-partition slab", Uneven));
  PetscCall(TestShape("hills", 700, "-partition curve", Uneven));
#if defined(EQM_HAVE_PTSCOTCH)
  PetscCall(TestShape("hills", 700, "-partition ptscotch", Uneven));
#endif
  PetscCall(TestCurve());
  PetscCall(TestShape("patch", 1, "-partition metis", One));
  PetscCall(TestFan());
  PetscCall(TestRefinedFan());
  PetscCall(TestGather());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
