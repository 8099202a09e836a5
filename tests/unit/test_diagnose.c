/* The diagnosis: every kind of finding provoked, its places and counts the same on any number of ranks; what repair
   makes of it. */
#include <equimap/soup.h>
#include "mesh/soup_private.h"
#include "support/checks.h"
#include <string.h>

/* A mesh under construction, the same on every rank; rank 0's copy becomes the soup. */
typedef struct {
  PetscInt cell_size, num_vertices, num_cells;
  PetscReal vertices[3 * 512];
  PetscInt cells[4 * 1024];
} Draft;

static PetscInt AddVertex(Draft *draft, PetscReal x, PetscReal y, PetscReal z)
{
  PetscReal *const place = draft->vertices + 3 * draft->num_vertices;

  place[0] = x;
  place[1] = y;
  place[2] = z;
  return draft->num_vertices++;
}

static PetscInt AddCell(Draft *draft, PetscInt a, PetscInt b, PetscInt c, PetscInt d)
{
  const PetscInt vertex[4] = {a, b, c, d};

  for (PetscInt k = 0; k < draft->cell_size; k++) draft->cells[draft->cell_size * draft->num_cells + k] = vertex[k];
  return draft->num_cells++;
}

/* n by n squares with rising diagonals, in the plane at height z, two triangles each: square (i, j) has the cells
   2 (n j + i) and the next; the corners where a diagonal does not end have an ear. */
static void AddGrid(Draft *draft, PetscInt n, PetscReal z)
{
  const PetscInt first = draft->num_vertices;

  draft->cell_size = 3;
  for (PetscInt j = 0; j <= n; j++) {
    for (PetscInt i = 0; i <= n; i++) (void)AddVertex(draft, i, j, z);
  }
  for (PetscInt j = 0; j < n; j++) {
    for (PetscInt i = 0; i < n; i++) {
      const PetscInt corner = first + (n + 1) * j + i;

      (void)AddCell(draft, corner, corner + 1, corner + n + 2, -1);
      (void)AddCell(draft, corner, corner + n + 2, corner + n + 1, -1);
    }
  }
}

/* n^3 small cubes, six tetrahedra each, all cut alike. */
static void AddBlock(Draft *draft, PetscInt n)
{
  static const int path[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  const PetscInt stride[3] = {1, n + 1, (n + 1) * (n + 1)};

  draft->cell_size = 4;
  for (PetscInt v = 0; v < (n + 1) * (n + 1) * (n + 1); v++) {
    (void)AddVertex(draft, v % (n + 1), v / (n + 1) % (n + 1), v / (n + 1) / (n + 1));
  }
  for (PetscInt cube = 0; cube < n * n * n; cube++) {
    const PetscInt corner = cube % n + stride[1] * (cube / n % n) + stride[2] * (cube / n / n);

    for (int p = 0; p < 6; p++) {
      const PetscInt second = corner + stride[path[p][0]], third = second + stride[path[p][1]];
      const PetscInt last = third + stride[path[p][2]];

      (void)AddCell(draft, corner, second, p < 3 ? third : last, p < 3 ? last : third);
    }
  }
}

static PetscErrorCode MakeSoup(const Draft *draft, EqmSoup *soup)
{
  EqmSerialMesh serial;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  memset(&serial, 0, sizeof(serial));
  if (rank == 0) {
    serial.num_vertices = draft->num_vertices;
    serial.num_cells = draft->num_cells;
    serial.cell_size = draft->cell_size;
    PetscCall(PetscMalloc1(3 * draft->num_vertices, &serial.vertices));
    PetscCall(PetscMalloc1(draft->cell_size * draft->num_cells, &serial.cells));
    PetscCall(PetscArraycpy(serial.vertices, draft->vertices, 3 * draft->num_vertices));
    PetscCall(PetscArraycpy(serial.cells, draft->cells, draft->cell_size * draft->num_cells));
  }
  PetscCall(EqmSoupCreateFromRoot(PETSC_COMM_WORLD, rank == 0 ? &serial : NULL, "draft", soup));
  PetscFunctionReturn(0);
}

static PetscErrorCode Diagnose(const Draft *draft, EqmDiagnosis *diagnosis)
{
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(MakeSoup(draft, &soup));
  PetscCall(EqmSoupDiagnose(soup, diagnosis));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

static PetscErrorCode Mend(const Draft *draft, EqmRepair *repair, EqmDiagnosis *diagnosis)
{
  PetscInt *parent;
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(MakeSoup(draft, &soup));
  PetscCall(EqmSoupRepair(&soup, repair, &parent));
  PetscCall(EqmSoupDiagnose(soup, diagnosis));
  PetscCall(PetscFree(parent));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

/* A finding has this count and its first place is (a, b, c). */
#define CHECK_FINDING(diagnosis, kind, expected, a, b, c)                                                              \
  do {                                                                                                                 \
    const EqmFinding *const found = &(diagnosis).finding[kind];                                                        \
    CHECK(found->count == (expected), "%s: %d", #kind, (int)found->count);                                             \
    CHECK(found->shown == 0 || (found->where[0][0] == (a) && found->where[0][1] == (b) && found->where[0][2] == (c)),  \
          "%s: first at %d %d %d", #kind, (int)found->where[0][0], (int)found->where[0][1], (int)found->where[0][2]);  \
  } while (0)

/* Nothing is found but the kinds listed. */
static void CheckNothingElse(const EqmDiagnosis *diagnosis, int n, const EqmFindingKind *allowed, int line)
{
  for (int kind = 0; kind < EQM_NUM_FINDINGS; kind++) {
    PetscBool expected = PETSC_FALSE;

    for (int k = 0; k < n; k++) expected = (PetscBool)(expected || (int)allowed[k] == kind);
    CHECK(expected || diagnosis->finding[kind].count == 0, "called from line %d: %d findings of kind %d", line,
          (int)diagnosis->finding[kind].count, kind);
  }
}
#define ONLY(diagnosis, ...)                                                                                           \
  CheckNothingElse(&(diagnosis), sizeof((EqmFindingKind[]){__VA_ARGS__}) / sizeof(EqmFindingKind),                     \
                   (EqmFindingKind[]){__VA_ARGS__}, __LINE__)

static PetscErrorCode TestGoodGrid(void)
{
  Draft draft = {0};
  EqmDiagnosis d;
  EqmRepair repair;

  PetscFunctionBegin;
  AddGrid(&draft, 4, 0.0);
  PetscCall(Diagnose(&draft, &d));
  CHECK(d.topology == EQM_TOPOLOGY_DISK && d.genus == 0 && d.num_components == 1 && d.num_boundary_loops == 1, "grid");
  CHECK(d.num_edges == 56 && d.num_faces == 32 && d.num_boundary_edges == 16 && d.num_boundary_vertices == 16, "grid");
  CHECK(PetscAbsReal(d.measure - 16.0) < 1e-12 && PetscAbsReal(d.smallest_cell - 0.5) < 1e-14, "area %g", d.measure);
  CHECK(PetscAbsReal(d.worst_cell_quality - 0.5 * PetscSqrtReal(3.0)) < 1e-12, "quality %g", d.worst_cell_quality);
  ONLY(d, EQM_FINDING_OPEN, EQM_FINDING_NO_INTERIOR_VERTEX, EQM_FINDING_CHORD);
  /* the ears at the corners (4, 0) and (0, 4) */
  CHECK_FINDING(d, EQM_FINDING_NO_INTERIOR_VERTEX, 2, 6, -1, -1);
  CHECK_FINDING(d, EQM_FINDING_CHORD, 2, 3, 9, -1);
  PetscCall(Mend(&draft, &repair, &d));
  CHECK(repair.cells_split == 4 && repair.vertices_added == 2 && d.num_cells == 36, "mended grid");
  CHECK(PetscAbsReal(d.measure - 16.0) < 1e-12 && d.topology == EQM_TOPOLOGY_DISK, "mended grid");
  ONLY(d, EQM_FINDING_OPEN);
  PetscFunctionReturn(0);
}

static PetscErrorCode TestVerticesAndCells(void)
{
  Draft draft = {0};
  EqmDiagnosis d;
  EqmRepair repair;

  PetscFunctionBegin;
  AddGrid(&draft, 4, 0.0);
  draft.vertices[3 * 12] = NAN;
  draft.vertices[3 * 7 + 2] = INFINITY;
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_NOT_FINITE, 2, 7, -1, -1);
  CHECK(d.topology == EQM_TOPOLOGY_DISK && d.measure < 16.0 && d.measure > 0.0, "area %g", d.measure);

  draft = (Draft){0};
  AddGrid(&draft, 4, 0.0);
  (void)AddVertex(&draft, NAN, INFINITY, 0.0); /* of no cell: no harm */
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_NOT_FINITE, 0, -1, -1, -1);
  CHECK_FINDING(d, EQM_FINDING_UNREFERENCED, 1, 25, -1, -1);

  draft = (Draft){0};
  AddGrid(&draft, 4, 0.0);
  (void)AddCell(&draft, 3, 25, 4, -1);
  (void)AddCell(&draft, 0, -7, PETSC_MAX_INT, -1);
  (void)AddCell(&draft, 5, 9, 5, -1);  /* 34 */
  (void)AddCell(&draft, 6, 1, 0, -1);  /* 35: cell 0 backwards */
  (void)AddCell(&draft, 7, 12, 6, -1); /* 36: cell 10 turned on */
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_BAD_INDEX, 2, 32, -1, -1);
  CHECK_FINDING(d, EQM_FINDING_DEGENERATE_CELL, 1, 34, -1, -1);
  CHECK_FINDING(d, EQM_FINDING_DUPLICATE_CELL, 2, 35, 0, -1);
  CHECK(d.topology == EQM_TOPOLOGY_DISK && PetscAbsReal(d.measure - 16.0) < 1e-12, "area %g", d.measure);
  ONLY(d, EQM_FINDING_BAD_INDEX, EQM_FINDING_DEGENERATE_CELL, EQM_FINDING_DUPLICATE_CELL, EQM_FINDING_OPEN,
       EQM_FINDING_NO_INTERIOR_VERTEX, EQM_FINDING_CHORD);
  PetscCall(Mend(&draft, &repair, &d));
  CHECK(repair.degenerate_cells_removed == 1 && repair.duplicate_cells_removed == 2, "removed");
  CHECK_FINDING(d, EQM_FINDING_BAD_INDEX, 2, 36, -1, -1);
  ONLY(d, EQM_FINDING_BAD_INDEX, EQM_FINDING_OPEN);

  draft = (Draft){0};
  AddGrid(&draft, 4, 0.0);
  (void)AddVertex(&draft, 1.0, 1.0, 0.0); /* 25, not in use: no twin */
  draft.vertices[3 * 12] = draft.vertices[3 * 13];
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_UNREFERENCED, 1, 25, -1, -1);
  CHECK_FINDING(d, EQM_FINDING_DUPLICATE_VERTEX, 1, 13, 12, -1);
  /* the two cells between the vertices that have fallen together */
  CHECK_FINDING(d, EQM_FINDING_DEGENERATE_CELL, 2, 13, -1, -1);
  PetscCall(Mend(&draft, &repair, &d));
  CHECK(repair.vertices_unreferenced == 1, "%d", (int)repair.vertices_unreferenced);
  CHECK_FINDING(d, EQM_FINDING_UNREFERENCED, 1, 25, -1, -1);
  PetscFunctionReturn(0);
}

static PetscErrorCode TestManifold(void)
{
  Draft draft = {0};
  EqmDiagnosis d;
  PetscInt tip;

  PetscFunctionBegin;
  AddGrid(&draft, 4, 0.0);
  tip = AddVertex(&draft, 1.5, 1.0, 1.0);
  (void)AddCell(&draft, 6, 7, tip, -1);
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_NON_MANIFOLD_EDGE, 1, 6, 7, -1);
  CHECK_FINDING(d, EQM_FINDING_NON_MANIFOLD_VERTEX, 0, -1, -1, -1);
  CHECK(d.genus == -1 && d.topology == EQM_TOPOLOGY_OTHER, "fin");

  draft = (Draft){0};
  AddGrid(&draft, 4, 0.0);
  (void)AddVertex(&draft, 5.0, 4.0, 1.0);
  (void)AddVertex(&draft, 5.0, 5.0, 1.0);
  (void)AddCell(&draft, 24, 25, 26, -1);
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_NON_MANIFOLD_VERTEX, 1, 24, -1, -1);
  CHECK_FINDING(d, EQM_FINDING_NON_MANIFOLD_EDGE, 0, -1, -1, -1);
  CHECK(d.num_components == 1 && d.topology == EQM_TOPOLOGY_OTHER, "bow tie");
  PetscFunctionReturn(0);
}

static PetscErrorCode TestOrientation(void)
{
  Draft draft = {0};
  EqmDiagnosis d;
  EqmRepair repair;
  EqmSoup soup;

  PetscFunctionBegin;
  AddGrid(&draft, 4, 0.0);
  for (PetscInt c = 10; c < 13; c++) {
    const PetscInt swap = draft.cells[3 * c];

    draft.cells[3 * c] = draft.cells[3 * c + 1];
    draft.cells[3 * c + 1] = swap;
  }
  PetscCall(Diagnose(&draft, &d));
  CHECK(d.finding[EQM_FINDING_INCONSISTENT_ORIENTATION].count == 7, "%d",
        (int)d.finding[EQM_FINDING_INCONSISTENT_ORIENTATION].count);
  CHECK_FINDING(d, EQM_FINDING_NOT_ORIENTABLE, 0, -1, -1, -1);
  CHECK(d.topology == EQM_TOPOLOGY_DISK, "still a disk");
  PetscCall(Mend(&draft, &repair, &d));
  CHECK(repair.cells_flipped == 3, "%d turned", (int)repair.cells_flipped);
  ONLY(d, EQM_FINDING_OPEN);

  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "moebius", 500, 3, &soup));
  PetscCall(EqmSoupDiagnose(soup, &d));
  CHECK_FINDING(d, EQM_FINDING_NOT_ORIENTABLE, 1, 0, -1, -1);
  CHECK(d.topology == EQM_TOPOLOGY_OTHER && d.genus == -1 && d.num_boundary_loops == 1, "band");
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

/* Neighbours by far-away numbers, every third cell turned: pieces and orientation must travel through all ranks. */
static PetscErrorCode TestShuffled(void)
{
  Draft plain = {0}, draft;
  EqmDiagnosis d;
  EqmRepair repair;

  PetscFunctionBegin;
  AddGrid(&plain, 12, 0.0);
  draft = plain;
  for (PetscInt v = 0; v < plain.num_vertices; v++) {
    const PetscInt place = v * 50 % plain.num_vertices;

    for (int k = 0; k < 3; k++) draft.vertices[3 * place + k] = plain.vertices[3 * v + k];
  }
  for (PetscInt c = 0; c < plain.num_cells; c++) {
    const PetscInt place = c * 61 % plain.num_cells;

    for (int k = 0; k < 3; k++) {
      draft.cells[3 * place + k] = plain.cells[3 * c + (c % 3 ? k : 2 - k)] * 50 % plain.num_vertices;
    }
  }
  PetscCall(Diagnose(&draft, &d));
  CHECK(d.topology == EQM_TOPOLOGY_DISK && d.num_components == 1 && d.num_boundary_loops == 1, "shuffled");
  CHECK_FINDING(d, EQM_FINDING_NOT_ORIENTABLE, 0, -1, -1, -1);
  PetscCall(Mend(&draft, &repair, &d));
  CHECK(repair.cells_flipped == 96, "%d turned", (int)repair.cells_flipped);
  ONLY(d, EQM_FINDING_OPEN);
  PetscFunctionReturn(0);
}

static PetscErrorCode TestTopology(void)
{
  Draft draft = {0};
  EqmDiagnosis d;
  EqmSoup soup;

  PetscFunctionBegin;
  for (int piece = 0; piece < 6; piece++) AddGrid(&draft, 2, piece);
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_COMPONENTS, 6, 0, -1, -1);
  CHECK_FINDING(d, EQM_FINDING_HOLES, 0, -1, -1, -1); /* the only loop of each piece is its outer one */
  CHECK(d.num_boundary_loops == 6, "%d loops", (int)d.num_boundary_loops);
  for (int k = 0; k < EQM_FINDING_SHOWN; k++) {
    CHECK(d.finding[EQM_FINDING_COMPONENTS].where[k][0] == 9 * k, "piece %d", k);
  }
  CHECK(d.num_components == 6 && d.genus == 0 && d.topology == EQM_TOPOLOGY_OTHER, "six pieces");

  draft = (Draft){0};
  AddGrid(&draft, 5, 0.0);
  /* a hole: the middle square's cells 24 and 25 give way to a second square in front of the others */
  draft.num_cells = 24;
  for (PetscInt j = 2; j < 5; j++) {
    for (PetscInt i = j == 2 ? 3 : 0; i < 5; i++) {
      const PetscInt corner = 6 * j + i;

      (void)AddCell(&draft, corner, corner + 1, corner + 7, -1);
      (void)AddCell(&draft, corner, corner + 7, corner + 6, -1);
    }
  }
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_HOLES, 1, 0, -1, -1);
  CHECK(d.finding[EQM_FINDING_HOLES].shown == 2 && d.finding[EQM_FINDING_HOLES].where[1][0] == 14, "hole");
  CHECK(d.finding[EQM_FINDING_OPEN].count == 2 && d.num_boundary_loops == 2 && d.genus == 0, "hole");
  AddGrid(&draft, 2, 9.0); /* a piece of its own adds a loop and no hole */
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_HOLES, 1, 0, -1, -1);
  CHECK(d.finding[EQM_FINDING_HOLES].shown == 2 && d.num_boundary_loops == 3 && d.num_components == 2, "two pieces");

  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "torus", 300, 1, &soup));
  PetscCall(EqmSoupDiagnose(soup, &d));
  CHECK(d.finding[EQM_FINDING_GENUS].count == 1 && d.finding[EQM_FINDING_CLOSED].count == 1 && d.genus == 1, "torus");
  ONLY(d, EQM_FINDING_GENUS, EQM_FINDING_CLOSED);
  PetscCall(EqmSoupDestroy(&soup));

  draft = (Draft){.cell_size = 3};
  PetscCall(Diagnose(&draft, &d));
  CHECK(d.topology == EQM_TOPOLOGY_OTHER && d.num_cells == 0 && d.genus == -1, "nothing at all");
  PetscFunctionReturn(0);
}

static PetscErrorCode TestSolids(void)
{
  Draft draft = {0};
  EqmDiagnosis d;
  EqmRepair repair;
  PetscInt swap;

  PetscFunctionBegin;
  AddBlock(&draft, 3);
  swap = draft.cells[4 * 80];
  draft.cells[4 * 80] = draft.cells[4 * 80 + 1];
  draft.cells[4 * 80 + 1] = swap;
  PetscCall(Diagnose(&draft, &d));
  CHECK(d.topology == EQM_TOPOLOGY_BALL && d.euler_characteristic == 1 && d.num_boundary_loops == 1, "block");
  CHECK(PetscAbsReal(d.measure - 27.0) < 1e-12 && d.num_boundary_vertices == 56, "volume %g", d.measure);
  CHECK_FINDING(d, EQM_FINDING_INCONSISTENT_ORIENTATION, 1, 80, -1, -1);
  ONLY(d, EQM_FINDING_INCONSISTENT_ORIENTATION, EQM_FINDING_NO_INTERIOR_VERTEX, EQM_FINDING_CHORD);
  CHECK(d.finding[EQM_FINDING_NO_INTERIOR_VERTEX].count > 0 && d.finding[EQM_FINDING_CHORD].count > 0, "block");
  PetscCall(Mend(&draft, &repair, &d));
  CHECK(repair.cells_flipped == 1 && repair.cells_split > 0, "block");
  CHECK(d.topology == EQM_TOPOLOGY_BALL && PetscAbsReal(d.measure - 27.0) < 1e-12, "mended block, volume %g",
        d.measure);
  CheckNothingElse(&d, 0, NULL, __LINE__);

  /* an inner vertex that went through a face: turning cells does not help */
  draft = (Draft){0};
  AddBlock(&draft, 3);
  draft.vertices[3 * 21] = 2.5;
  PetscCall(Diagnose(&draft, &d));
  CHECK(d.finding[EQM_FINDING_INCONSISTENT_ORIENTATION].count > 0, "through a face");
  CHECK(d.finding[EQM_FINDING_OVERLAP].count > 0, "through a face");
  PetscCall(Mend(&draft, &repair, &d));
  CHECK(repair.cells_flipped > 0 && d.finding[EQM_FINDING_OVERLAP].count > 0, "through a face, mended");
  ONLY(d, EQM_FINDING_OVERLAP);

  draft = (Draft){0};
  AddBlock(&draft, 1);
  (void)AddVertex(&draft, 2.0, -1.0, -1.0);
  (void)AddVertex(&draft, 2.0, -1.0, 1.5);
  (void)AddCell(&draft, 1, 8, 5, 9); /* has the edge 1-5 alone in common with the cube */
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_NON_MANIFOLD_VERTEX, 2, 1, -1, -1);
  CHECK(d.topology == EQM_TOPOLOGY_OTHER && d.num_components == 1, "hinge");

  draft = (Draft){0};
  AddBlock(&draft, 1);
  (void)AddVertex(&draft, 2.0, 2.0, 3.0);
  (void)AddCell(&draft, 0, 1, 7, 8);
  PetscCall(Diagnose(&draft, &d));
  CHECK_FINDING(d, EQM_FINDING_NON_MANIFOLD_EDGE, 1, 0, 1, 7);

  draft = (Draft){0};
  AddBlock(&draft, 3);
  draft.num_cells -= 6;
  for (PetscInt k = 13 * 6 * 4; k < 14 * 6 * 4; k++) draft.cells[k] = draft.cells[k + 13 * 6 * 4];
  PetscCall(Diagnose(&draft, &d));
  CHECK(d.num_boundary_loops == 2 && d.finding[EQM_FINDING_HOLES].count == 1, "cavity");
  CHECK(d.topology == EQM_TOPOLOGY_OTHER && d.euler_characteristic == 2, "cavity");
  PetscFunctionReturn(0);
}

/* One triangle, one tetrahedron, and an octahedron's ring: cells that only a vertex at the centre can help. */
static PetscErrorCode TestCenters(void)
{
  Draft draft = {.cell_size = 3};
  EqmDiagnosis d;
  EqmRepair repair;

  PetscFunctionBegin;
  (void)AddVertex(&draft, 0.0, 0.0, 0.0);
  (void)AddVertex(&draft, 1.0, 0.0, 0.0);
  (void)AddVertex(&draft, 0.0, 1.0, 0.0);
  (void)AddCell(&draft, 0, 1, 2, -1);
  PetscCall(Mend(&draft, &repair, &d));
  CHECK(d.num_cells == 3 && d.num_vertices == 4 && PetscAbsReal(d.measure - 0.5) < 1e-14, "one triangle");
  ONLY(d, EQM_FINDING_OPEN);
  draft.cell_size = 4;
  draft.num_cells = 0;
  (void)AddVertex(&draft, 0.0, 0.0, 1.0);
  (void)AddCell(&draft, 0, 1, 2, 3);
  PetscCall(Mend(&draft, &repair, &d));
  CHECK(d.num_cells == 4 && d.num_vertices == 5 && d.topology == EQM_TOPOLOGY_BALL, "one tetrahedron");
  CheckNothingElse(&d, 0, NULL, __LINE__);
  PetscFunctionReturn(0);
}

/* Densities and parents follow the cells. */
static PetscErrorCode TestParents(void)
{
  Draft draft = {0};
  PetscInt *parent, previous = -1;
  PetscReal sum = 0.0;
  EqmRepair repair;
  EqmSoup soup;

  PetscFunctionBegin;
  AddGrid(&draft, 4, 0.0);
  PetscCall(MakeSoup(&draft, &soup));
  PetscCall(PetscMalloc1(soup->cell_end - soup->cell_start, &soup->density));
  for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) soup->density[c - soup->cell_start] = 1.0 + c;
  PetscCall(EqmSoupRepair(&soup, &repair, &parent));
  for (PetscInt c = 0; c < soup->cell_end - soup->cell_start; c++) {
    CHECK(soup->density[c] == 1.0 + parent[c] && parent[c] >= previous, "cell %d", (int)c);
    previous = parent[c];
    sum += parent[c];
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPIU_SUM, PETSC_COMM_WORLD));
  /* 0 .. 31, and once more the four cells at the chords: 6 with 7, 24 with 25 */
  CHECK(sum == 496.0 + 6 + 7 + 24 + 25, "parents' sum %g", sum);
  PetscCall(PetscFree(parent));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestDescription(void)
{
  static const char *const target[5] = {"disk", "square", "sphere", "ball", "conformal"};
  static const char *const shape[4] = {"cap", "sphere", "ball", "torus"};
  static const int takes[4][5] = {{1, 1, 0, 0, 1}, {0, 0, 1, 0, 1}, {0, 0, 0, 1, 0}, {0, 0, 0, 0, 0}};
  char text[EQM_MESSAGE_MAX];
  Draft draft = {0};
  EqmDiagnosis d;
  PetscBool fatal;

  PetscFunctionBegin;
  for (int s = 0; s < 4; s++) {
    EqmSoup soup;

    PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, shape[s], 300, 0, &soup));
    PetscCall(EqmSoupDiagnose(soup, &d));
    PetscCall(EqmSoupDestroy(&soup));
    for (int t = 0; t < 5; t++) {
      PetscCall(EqmDiagnosisDescribe(&d, target[t], &fatal, text, sizeof(text)));
      CHECK(fatal == !takes[s][t], "%s to %s: %s", shape[s], target[t], text);
      CHECK(!strncmp(text, fatal ? "error: " : "good: ", 6), "%s", text);
    }
    PetscCall(EqmDiagnosisDescribe(&d, NULL, &fatal, text, sizeof(text)));
    CHECK(fatal == (s == 3), "%s: %s", shape[s], text);
  }
  AddGrid(&draft, 4, 0.0);
  (void)AddVertex(&draft, 1.5, 1.0, 1.0);
  (void)AddCell(&draft, 6, 7, 25, -1);
  PetscCall(Diagnose(&draft, &d));
  PetscCall(EqmDiagnosisDescribe(&d, "disk", &fatal, text, sizeof(text)));
  CHECK(fatal && strstr(text, "error: 1 edge belongs to more than two triangles (6-7): "), "%s", text);
  CHECK(strstr(text, "warning: 8 interior edges join two boundary vertices (first: 0-6, "), "%s", text);
  PetscCall(EqmDiagnosisDescribe(&d, "disk", &fatal, text, 20));
  CHECK(fatal && strlen(text) == 19, "cut short: %s", text);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestGoodGrid());
  PetscCall(TestVerticesAndCells());
  PetscCall(TestManifold());
  PetscCall(TestOrientation());
  PetscCall(TestShuffled());
  PetscCall(TestTopology());
  PetscCall(TestSolids());
  PetscCall(TestCenters());
  PetscCall(TestParents());
  PetscCall(TestDescription());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
