/* Test shapes and refinement: the topology that they promise, the same mesh on any number of ranks. */
#include <equimap/soup.h>
#include "mesh/soup_private.h"
#include "support/checks.h"

typedef struct {
  const char *name;
  EqmTopology topology;
  PetscInt genus, loops;
} Expected;

static const Expected expected[] = {
    {"cap", EQM_TOPOLOGY_DISK, 0, 1},       {"patch", EQM_TOPOLOGY_DISK, 0, 1},
    {"hills", EQM_TOPOLOGY_DISK, 0, 1},     {"sphere", EQM_TOPOLOGY_SPHERE, 0, 0},
    {"head", EQM_TOPOLOGY_SPHERE, 0, 0},    {"starfish", EQM_TOPOLOGY_SPHERE, 0, 0},
    {"ball", EQM_TOPOLOGY_BALL, 0, 1},      {"blob", EQM_TOPOLOGY_BALL, 0, 1},
    {"figure", EQM_TOPOLOGY_BALL, 0, 1},    {"cube", EQM_TOPOLOGY_BALL, 0, 1},
    {"torus", EQM_TOPOLOGY_OTHER, 1, 0},    {"annulus", EQM_TOPOLOGY_OTHER, 0, 2},
    {"moebius", EQM_TOPOLOGY_OTHER, -1, 1},
};

/* The shape is what it promises, without a finding that stands in a map's way, and refining keeps that. */
static PetscErrorCode TestShape(const Expected *shape, PetscInt n, PetscInt seed)
{
  EqmDiagnosis coarse, fine;
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, shape->name, n, seed, &soup));
  PetscCall(EqmSoupDiagnose(soup, &coarse));
  CHECK(coarse.topology == shape->topology && coarse.genus == shape->genus, "%s %d", shape->name, (int)n);
  CHECK(coarse.num_boundary_loops == shape->loops && coarse.num_components == 1, "%s %d", shape->name, (int)n);
  CHECK(coarse.worst_cell_quality > 0.005, "%s %d: quality %g", shape->name, (int)n, coarse.worst_cell_quality);
  if (n >= 300) {
    CHECK(soup->num_vertices > 0.6 * n && soup->num_vertices < 1.6 * n, "%s: %d for %d", shape->name,
          (int)soup->num_vertices, (int)n);
    CHECK(!coarse.finding[EQM_FINDING_CHORD].count && !coarse.finding[EQM_FINDING_NO_INTERIOR_VERTEX].count &&
              !coarse.finding[EQM_FINDING_UNREFERENCED].count && !coarse.finding[EQM_FINDING_DUPLICATE_VERTEX].count,
          "%s %d", shape->name, (int)n);
  }
  if (shape->genus >= 0) {
    CHECK(!coarse.finding[EQM_FINDING_INCONSISTENT_ORIENTATION].count, "%s %d", shape->name, (int)n);
  }
  PetscCall(EqmSoupRefine(&soup, 1));
  PetscCall(EqmSoupDiagnose(soup, &fine));
  CHECK(fine.topology == coarse.topology && fine.genus == coarse.genus, "%s refined", shape->name);
  CHECK(fine.num_boundary_loops == shape->loops && fine.num_components == 1, "%s refined", shape->name);
  CHECK(fine.num_vertices == coarse.num_vertices + coarse.num_edges, "%s refined", shape->name);
  CHECK(fine.num_cells == coarse.num_cells * (coarse.cell_size == 3 ? 4 : 8), "%s refined", shape->name);
  CHECK(PetscAbsReal(fine.measure - coarse.measure) < 1e-10 * coarse.measure, "%s refined: %g", shape->name,
        fine.measure - coarse.measure);
  if (shape->genus >= 0) {
    CHECK(!fine.finding[EQM_FINDING_INCONSISTENT_ORIENTATION].count, "%s refined", shape->name);
  }
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

/* A number that depends on every vertex, every cell and their order. */
static PetscErrorCode Fingerprint(EqmSoup soup, uint64_t *fingerprint)
{
  uint64_t sum = 0, total;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * (soup->vertex_end - soup->vertex_start); k++) {
    uint64_t bits;

    memcpy(&bits, &soup->vertices[k], sizeof(bits));
    bits = (bits ^ (uint64_t)(3 * soup->vertex_start + k)) * 0x9e3779b97f4a7c15u;
    sum += (bits ^ (bits >> 31)) * 0xbf58476d1ce4e5b9u;
  }
  for (PetscInt k = 0; k < soup->cell_size * (soup->cell_end - soup->cell_start); k++) {
    uint64_t bits =
        ((uint64_t)soup->cells[k] << 32 ^ (uint64_t)(soup->cell_size * soup->cell_start + k)) * 0x94d049bb133111ebu;

    sum += (bits ^ (bits >> 29)) * 0x9e3779b97f4a7c15u;
  }
  PetscCallMPI(MPI_Allreduce(&sum, &total, 1, MPI_UINT64_T, MPI_SUM, soup->comm));
  *fingerprint = total;
  PetscFunctionReturn(0);
}

/* Rank 0 alone makes the same mesh as all ranks together, refined or not. */
static PetscErrorCode TestSameOnAnyRanks(const char *name, PetscInt times)
{
  uint64_t together, alone = 0, other;
  PetscMPIInt rank;
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, name, 700, 11, &soup));
  PetscCall(EqmSoupRefine(&soup, times));
  PetscCall(Fingerprint(soup, &together));
  PetscCall(EqmSoupDestroy(&soup));
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, name, 700, 12, &soup));
  PetscCall(EqmSoupRefine(&soup, times));
  PetscCall(Fingerprint(soup, &other));
  PetscCall(EqmSoupDestroy(&soup));
  CHECK(together != other, "%s: the seed changes nothing", name);
  if (rank == 0) {
    PetscCall(EqmSoupGenerate(PETSC_COMM_SELF, name, 700, 11, &soup));
    PetscCall(EqmSoupRefine(&soup, times));
    PetscCall(Fingerprint(soup, &alone));
    PetscCall(EqmSoupDestroy(&soup));
    CHECK(alone == together, "%s, refined %d times", name, (int)times);
  }
  PetscFunctionReturn(0);
}

/* Densities go from parents to children. */
static PetscErrorCode TestDensity(void)
{
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "cap", 300, 0, &soup));
  PetscCall(PetscMalloc1(soup->cell_end - soup->cell_start, &soup->density));
  for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) soup->density[c - soup->cell_start] = 1.0 + c;
  PetscCall(EqmSoupRefine(&soup, 2));
  for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) {
    CHECK(soup->density[c - soup->cell_start] == 1.0 + (PetscReal)(c / 16), "cell %d", (int)c);
  }
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestListOfShapes(void)
{
  const char *const *names, *const *descriptions;
  PetscBool same;
  int n;

  PetscFunctionBegin;
  PetscCall(EqmGenerateShapes(&names, &descriptions, &n));
  CHECK(n == (int)PETSC_STATIC_ARRAY_LENGTH(expected), "%d shapes", n);
  for (int k = 0; k < n; k++) {
    PetscCall(PetscStrcmp(names[k], expected[k].name, &same));
    CHECK(same && descriptions[k][0], "%s", names[k]);
  }
  PetscCall(PetscFree(names));
  PetscCall(PetscFree(descriptions));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  static const PetscInt sizes[3] = {1, 60, 800};

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestListOfShapes());
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(expected); s++) {
    for (int k = 0; k < 3; k++) PetscCall(TestShape(&expected[s], sizes[k], k));
  }
  PetscCall(TestSameOnAnyRanks("hills", 1));
  PetscCall(TestSameOnAnyRanks("starfish", 2));
  PetscCall(TestSameOnAnyRanks("blob", 1));
  PetscCall(TestDensity());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
