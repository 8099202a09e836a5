/* The distributed solid and the surface around it: orientation, stars, measures, the same surface on any number of
   ranks, values carried there and back; what repair does to a solid, and a map brought back from there. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "store/map_private.h"

/* Turn over the tetrahedra that `which` picks. */
static void TurnOver(EqmSoup soup, PetscBool (*which)(PetscInt cell))
{
  for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) {
    PetscInt *const v = soup->cells + 4 * (c - soup->cell_start), first = v[0];

    if (!which(c)) continue;
    v[0] = v[1];
    v[1] = first;
  }
}

static PetscBool None(PetscInt cell)
{
  return PETSC_FALSE;
}

static PetscBool All(PetscInt cell)
{
  return PETSC_TRUE;
}

static PetscReal Volume(const PetscReal *p, const PetscReal *q, const PetscReal *r, const PetscReal *s)
{
  PetscReal a[3], b[3], c[3];

  for (int k = 0; k < 3; k++) {
    a[k] = q[k] - p[k];
    b[k] = r[k] - p[k];
    c[k] = s[k] - p[k];
  }
  return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
          a[2] * (b[0] * c[1] - b[1] * c[0])) /
         6.;
}

/* Every local tetrahedron is positive, an owned vertex has all its cells, the volumes sum to the whole. */
static PetscErrorCode CheckCells(EqmMesh mesh, EqmSoup serial)
{
  const PetscReal *const p = mesh->position;
  PetscReal whole = 0., sum = 0.;
  PetscInt *wanted, *got;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(serial->num_vertices, &wanted, mesh->num_local, &got));
  for (PetscInt c = 0; c < serial->num_cells; c++) {
    const PetscInt *const v = serial->cells + 4 * c;
    const PetscReal *const q = serial->vertices;

    whole += PetscAbsReal(Volume(q + 3 * v[0], q + 3 * v[1], q + 3 * v[2], q + 3 * v[3]));
    for (int a = 0; a < 4; a++) wanted[v[a]]++;
  }
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt *const v = mesh->cells + 4 * c;
    const PetscReal volume = Volume(p + 3 * v[0], p + 3 * v[1], p + 3 * v[2], p + 3 * v[3]);

    CHECK(volume > 0., "cell %d has volume %g", (int)mesh->cell_input[c], (double)volume);
    CHECK_CLOSE(mesh->cell_measure[c], volume, 1e-9, volume);
    for (int a = 0; a < 4; a++) got[v[a]]++;
    if (c < mesh->num_owned_cells) sum += mesh->cell_measure[c];
  }
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    CHECK(got[v] == wanted[mesh->vertex_input[v]], "vertex %d has %d cells", (int)mesh->vertex_input[v], (int)got[v]);
  }
  CHECK_CLOSE(TestSum(mesh->comm, sum), whole, 1e-12, whole);
  CHECK_CLOSE(mesh->measure, whole, 1e-12, whole);
  PetscCall(PetscFree2(wanted, got));
  PetscFunctionReturn(0);
}

/* The mesh's own facets look outward: by the divergence theorem they enclose its volume. Each is one rank's that owns
   its vertex of lowest global number. */
static PetscErrorCode CheckFacets(EqmMesh mesh)
{
  const PetscReal *const p = mesh->position, origin[3] = {.3, -.2, .1};
  PetscReal volume = 0.;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    const PetscInt *const v = mesh->boundary_facets + 3 * f;
    PetscInt lowest = v[0];

    for (int k = 1; k < 3; k++) {
      if (mesh->global[v[k]] < mesh->global[lowest]) lowest = v[k];
    }
    for (int k = 0; k < 3; k++) CHECK(mesh->on_boundary[v[k]], "facet %d has an interior vertex", (int)f);
    if (lowest < mesh->num_owned) volume += Volume(origin, p + 3 * v[0], p + 3 * v[1], p + 3 * v[2]);
  }
  CHECK_CLOSE(TestSum(mesh->comm, volume), mesh->measure, 1e-12, mesh->measure);
  PetscFunctionReturn(0);
}

/* The surface as a mesh of its own: closed, without handles, looking outward. */
static PetscErrorCode CheckSurface(EqmMesh mesh, EqmSurface surface)
{
  EqmDiagnosis diagnosis;
  TestMesh test;
  EqmSoup copy;
  PetscReal volume = 0.;
  const PetscReal origin[3] = {0., 0., 0.};

  PetscFunctionBegin;
  PetscCall(EqmSoupDiagnose(surface->soup, &diagnosis));
  CHECK(diagnosis.topology == EQM_TOPOLOGY_SPHERE, "topology %d", (int)diagnosis.topology);
  CHECK(surface->soup->num_vertices == mesh->num_boundary_vertices, "%d vertices", (int)surface->soup->num_vertices);
  CHECK(!diagnosis.finding[EQM_FINDING_INCONSISTENT_ORIENTATION].count, "turned");
  CHECK(surface->soup->num_cells == 2 * (surface->soup->num_vertices - 2), "%d cells", (int)surface->soup->num_cells);
  PetscCall(EqmSoupCopy(surface->soup, &copy));
  PetscCall(TestMeshFromSoup(copy, &test));
  for (PetscInt c = 0; c < test.mesh->num_owned_cells; c++) {
    const PetscInt *const v = test.mesh->cells + 3 * c;
    const PetscReal *const p = test.mesh->position;

    volume += Volume(origin, p + 3 * v[0], p + 3 * v[1], p + 3 * v[2]);
  }
  CHECK_CLOSE(TestSum(mesh->comm, volume), mesh->measure, 1e-12, mesh->measure);
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Values go from the surface to the boundary vertices, ghosts too, and back; interior vertices keep theirs. */
static PetscErrorCode CheckCarrying(EqmMesh mesh, EqmSurface surface)
{
  const PetscInt num_slab = surface->soup->vertex_end - surface->soup->vertex_start;
  PetscReal *local, *slab;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * mesh->num_local, &local, 3 * num_slab, &slab));
  for (PetscInt k = 0; k < 3 * mesh->num_local; k++) local[k] = -7.;
  PetscCall(EqmSurfaceToSolid(surface, 3, surface->soup->vertices, local));
  for (PetscInt k = 0; k < 3 * mesh->num_local; k++) {
    CHECK(local[k] == (mesh->on_boundary[k / 3] ? mesh->position[k] : -7.), "vertex %d", (int)(k / 3));
  }
  PetscCall(EqmSurfaceFromSolid(surface, 3, local, slab));
  for (PetscInt k = 0; k < 3 * num_slab; k++) CHECK(slab[k] == surface->soup->vertices[k], "entry %d", (int)k);
  PetscCall(PetscFree2(local, slab));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestSolid(const char *shape, PetscInt n, const char *options_text, PetscBool (*which)(PetscInt))
{
  EqmSoup soup, serial;
  EqmSurface surface, alone;
  PetscOptions options;
  TestMesh test, whole;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, shape, n, 5, &soup));
  PetscCall(EqmSoupGenerate(PETSC_COMM_SELF, shape, n, 5, &serial));
  TurnOver(soup, which);
  TurnOver(serial, which);
  PetscCall(TestOptionsBegin(options_text, &options));
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(CheckCells(test.mesh, serial));
  PetscCall(TestCheckBlocks(test.mesh));
  PetscCall(CheckFacets(test.mesh));
  PetscCall(EqmSurfaceCreate(test.mesh, &surface));
  PetscCall(CheckSurface(test.mesh, surface));
  PetscCall(CheckCarrying(test.mesh, surface));
  PetscCall(TestMeshFromSoup(serial, &whole));
  PetscCall(EqmSurfaceCreate(whole.mesh, &alone));
  CHECK(alone->soup->checksum == surface->soup->checksum, "%s: not the surface that one rank makes", shape);
  PetscCall(EqmSurfaceDestroy(&alone));
  PetscCall(EqmSurfaceDestroy(&surface));
  PetscCall(TestMeshDestroy(&whole));
  PetscCall(TestMeshDestroy(&test));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestSurfaceHasNone(void)
{
  EqmSurface surface;
  TestMesh test;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "sphere", 100, 0, &test));
  CHECK_FAILS(EQM_ERR_USAGE, EqmSurfaceCreate(test.mesh, &surface));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* An octahedron of four tetrahedra around its axis, one of them inside out and one there twice. */
static PetscErrorCode MakeOctahedron(EqmSoup *soup)
{
  static const PetscReal points[18] = {0., 0., 1., 0., 0., -1., 1., 0., 0., 0., 1., 0., -1., 0., 0., 0., -1., 0.};
  static const PetscInt corners[20] = {0, 1, 3, 2, 1, 0, 4, 3, 0, 1, 5, 4, 0, 1, 2, 5, 3, 0, 2, 1};

  PetscFunctionBegin;
  PetscCall(TestSoupFromArrays(PETSC_COMM_WORLD, 6, points, 4, 5, corners, soup));
  PetscFunctionReturn(0);
}

/* What is found on the mended octahedron goes back to the cells that it was made of. */
static PetscErrorCode CheckMappedBack(EqmSoup given, EqmSoup mended, const PetscInt *parent)
{
  EqmMap found, map;
  PetscReal *weight;

  PetscFunctionBegin;
  PetscCall(EqmMapCreate(mended, 3, &found));
  for (PetscInt k = 0; k < 3 * (mended->vertex_end - mended->vertex_start); k++) {
    found->coordinates[k] = 2. * mended->vertices[k];
  }
  PetscCall(PetscMalloc1(mended->cell_end - mended->cell_start + 1, &weight));
  for (PetscInt c = mended->cell_start; c < mended->cell_end; c++) { /* the children of cell p: 2 p and 2 p + 1 */
    const PetscInt place = c - mended->cell_start;

    weight[place] = c % 2 ? 3. : 1.;
    found->cell_ratio[place] = c;
    CHECK(parent[place] == c / 2, "cell %d is a child of %d", (int)c, (int)parent[place]);
  }
  PetscCall(EqmMapOntoInput(found, given, parent, NULL, weight, &map));
  for (PetscInt k = 0; k < 3 * (given->vertex_end - given->vertex_start); k++) {
    CHECK(map->coordinates[k] == 2. * given->vertices[k], "coordinate %d", (int)k);
  }
  for (PetscInt c = given->cell_start; c < given->cell_end; c++) {
    CHECK_CLOSE(map->cell_ratio[c - given->cell_start], c < 4 ? 2. * c + .75 : 1., 1e-14, 1.);
  }
  PetscCall(EqmMapDestroy(&map));
  PetscCall(EqmMapDestroy(&found));
  PetscCall(PetscFree(weight));
  PetscFunctionReturn(0);
}

/* The axis is a chord: it is cut, and with it all tetrahedra. */
static PetscErrorCode TestMendedSolid(void)
{
  EqmSoup given, mended;
  EqmDiagnosis diagnosis;
  const EqmFinding *const chord = &diagnosis.finding[EQM_FINDING_CHORD];
  EqmRepair repair;
  PetscInt *parent;

  PetscFunctionBegin;
  PetscCall(MakeOctahedron(&given));
  PetscCall(EqmSoupDiagnose(given, &diagnosis));
  CHECK(chord->count == 1 && chord->where[0][0] == 0 && chord->where[0][1] == 1, "%d chords", (int)chord->count);
  CHECK(diagnosis.finding[EQM_FINDING_NO_INTERIOR_VERTEX].count == 4, "all four lie on the boundary");
  PetscCall(EqmSoupCopy(given, &mended));
  PetscCall(EqmSoupRepair(&mended, &repair, &parent));
  CHECK(repair.cells_split == 4 && repair.vertices_added == 1, "%d split, %d added", (int)repair.cells_split,
        (int)repair.vertices_added);
  CHECK(repair.cells_flipped == 1 && repair.duplicate_cells_removed == 1, "%d turned, %d removed",
        (int)repair.cells_flipped, (int)repair.duplicate_cells_removed);
  PetscCall(EqmSoupDiagnose(mended, &diagnosis));
  CHECK(diagnosis.topology == EQM_TOPOLOGY_BALL && diagnosis.num_cells == 8, "%d cells", (int)diagnosis.num_cells);
  for (int k = 0; k < EQM_NUM_FINDINGS; k++) CHECK(!diagnosis.finding[k].count, "finding %d is left", k);
  CHECK_CLOSE(diagnosis.measure, 4. / 3., 1e-14, 1.);
  PetscCall(CheckMappedBack(given, mended, parent));
  PetscCall(PetscFree(parent));
  PetscCall(EqmSoupDestroy(&mended));
  PetscCall(EqmSoupDestroy(&given));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestSolid("blob", 700, "-partition metis", None));
  PetscCall(TestSolid("blob", 700, "-partition slab", All));
  PetscCall(TestSolid("ball", 8000, "-partition metis", None)); /* more than one block on each rank */
  PetscCall(TestSolid("cube", 1, "-partition metis", None));
  PetscCall(TestSurfaceHasNone());
  PetscCall(TestMendedSolid());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
