/* What the tests of the library share: checks that say what is wrong, meshes ready for use, runs of the solver. */
#ifndef EQM_TESTING_H
#define EQM_TESTING_H

#include <equimap.h>
#include "domain/domain_private.h"
#include "solver/solver_private.h"
#include "support/checks.h"

/* A number in [-1, 1] that belongs to an input vertex, and so is the same on any number of ranks. */
static inline PetscReal TestRandom(PetscInt seed, PetscInt vertex, PetscInt channel)
{
  uint64_t x = 0x9e3779b97f4a7c15u * (uint64_t)(seed + 1) + 0xbf58476d1ce4e5b9u * (uint64_t)(vertex + 1) +
               0x94d049bb133111ebu * (uint64_t)(channel + 1);

  for (int round = 0; round < 3; round++) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    x ^= x >> 31;
  }
  return 2. * (PetscReal)(x >> 11) / 9007199254740992. - 1.;
}

/* A mesh with what it stands on. */
typedef struct {
  EqmLedger ledger;
  EqmSoup soup;
  EqmMesh mesh;
} TestMesh;

static inline PetscErrorCode TestMeshFromSoup(EqmSoup soup, TestMesh *test)
{
  PetscFunctionBegin;
  test->soup = soup;
  PetscCall(EqmLedgerCreate(soup->comm, &test->ledger));
  PetscCall(EqmMeshCreate(soup, test->ledger, &test->mesh));
  PetscFunctionReturn(0);
}

static inline PetscErrorCode TestMeshCreate(MPI_Comm comm, const char *shape, PetscInt n, PetscInt seed, TestMesh *test)
{
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(comm, shape, n, seed, &soup));
  PetscCall(TestMeshFromSoup(soup, test));
  PetscFunctionReturn(0);
}

/* The cap, whose conformal map is the stereographic projection; `flat`: laid flat by that projection. */
static inline PetscErrorCode TestCapCreate(PetscInt n, PetscBool flat, TestMesh *test)
{
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "cap", n, 0, &soup));
  for (PetscInt v = 0; v < soup->vertex_end - soup->vertex_start && flat; v++) {
    PetscReal *const p = soup->vertices + 3 * v;
    for (PetscInt k = 0; k < 2; k++) p[k] /= 1. + p[2];
    p[2] = 0.;
  }
  PetscCall(TestMeshFromSoup(soup, test));
  PetscFunctionReturn(0);
}

/* A soup of a mesh written down in arrays. */
static inline PetscErrorCode TestSoupFromArrays(MPI_Comm comm, PetscInt num_vertices, const PetscReal *points,
                                                PetscInt cell_size, PetscInt num_cells, const PetscInt *corners,
                                                EqmSoup *soup)
{
  EqmSerialMesh serial = {.num_vertices = num_vertices, .num_cells = num_cells, .cell_size = cell_size};
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) {
    PetscCall(PetscMalloc1(3 * num_vertices, &serial.vertices));
    PetscCall(PetscMalloc1(cell_size * num_cells, &serial.cells));
    PetscCall(PetscArraycpy(serial.vertices, points, 3 * num_vertices));
    PetscCall(PetscArraycpy(serial.cells, corners, cell_size * num_cells));
  }
  PetscCall(EqmSoupCreateFromRoot(comm, rank == 0 ? &serial : NULL, "arrays", soup));
  PetscFunctionReturn(0);
}

/* Blocks cut the owned vertices; each lists every cell that touches it once, in ascending order. */
static inline PetscErrorCode TestCheckBlocks(EqmMesh mesh)
{
  PetscFunctionBegin;
  CHECK(mesh->block_vertex[0] == 0 && mesh->block_vertex[mesh->num_blocks] == mesh->num_owned, "blocks end at %d",
        (int)mesh->block_vertex[mesh->num_blocks]);
  for (PetscInt b = 0; b < mesh->num_blocks; b++) {
    PetscInt listed = mesh->block_start[b];
    for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
      PetscBool touches = PETSC_FALSE;
      for (PetscInt a = 0; a < mesh->cell_size; a++) {
        const PetscInt v = mesh->cells[mesh->cell_size * c + a];
        if (v >= mesh->block_vertex[b] && v < mesh->block_vertex[b + 1]) touches = PETSC_TRUE;
      }
      if (!touches) continue;
      CHECK(listed < mesh->block_start[b + 1] && mesh->block_cell[listed] == c, "block %d lacks cell %d", (int)b,
            (int)c);
      listed++;
    }
    CHECK(listed == mesh->block_start[b + 1], "block %d lists %d cells too many", (int)b,
          (int)(mesh->block_start[b + 1] - listed));
  }
  PetscFunctionReturn(0);
}

static inline PetscErrorCode TestMeshDestroy(TestMesh *test)
{
  PetscFunctionBegin;
  PetscCall(EqmMeshDestroy(&test->mesh));
  PetscCall(EqmSoupDestroy(&test->soup));
  PetscCall(EqmLedgerDestroy(&test->ledger));
  PetscFunctionReturn(0);
}

/* Options that hold until TestOptionsEnd. */
static inline PetscErrorCode TestOptionsBegin(const char *text, PetscOptions *options)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsCreate(options));
  PetscCall(PetscOptionsInsertString(*options, text));
  PetscCall(PetscOptionsPush(*options));
  PetscFunctionReturn(0);
}

static inline PetscErrorCode TestOptionsEnd(PetscOptions *options)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsPop());
  PetscCall(PetscOptionsDestroy(options));
  PetscFunctionReturn(0);
}

/* Run the solver as the program would with these options. */
static inline PetscErrorCode TestSolve(EqmMesh mesh, const char *target, const char *text, EqmSolver *solver)
{
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(TestOptionsBegin(text, &options));
  PetscCall(PetscOptionsInsertString(options, "-quiet"));
  PetscCall(EqmSolverCreate(mesh, target, solver));
  PetscCall(EqmSolverSetFromOptions(*solver));
  PetscCall(EqmSolverSolve(*solver));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

/* A fold-free map of the mesh that is far from area-preserving. */
static inline PetscErrorCode TestStart(EqmMesh mesh, const char *target, EqmSolver *solver)
{
  PetscFunctionBegin;
  PetscCall(TestSolve(mesh, target, "-method lm -start tutte -max_it 0", solver));
  CHECK((*solver)->iterate->totals.folds == 0, "a Tutte map folds %d times", (int)(*solver)->iterate->totals.folds);
  PetscFunctionReturn(0);
}

/* Degrees of freedom at random, each entry in [-size, size], the same on any number of ranks. */
static inline PetscErrorCode TestRandomStep(EqmDomain domain, PetscInt seed, PetscReal size, Vec step)
{
  PetscScalar *s;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(step, &s));
  for (PetscInt v = 0; v < domain->mesh->num_owned; v++) {
    for (PetscInt k = 0; k < domain->dof_count[v]; k++) {
      s[domain->dof_start[v] - domain->dof_first + k] = size * TestRandom(seed, domain->mesh->vertex_input[v], k);
    }
  }
  PetscCall(VecRestoreArrayWrite(step, &s));
  PetscFunctionReturn(0);
}

/* The mesh "ball" as a map of itself, every vertex moved at random by up to `size` in each coordinate. */
static inline PetscErrorCode TestShakenBall(EqmDomain domain, PetscInt seed, PetscReal size, EqmPlace *place)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    PetscReal *const x = place->x + 3 * v, squared = 0.;
    for (PetscInt k = 0; k < 3; k++) {
      x[k] = mesh->position[3 * v + k] + size * TestRandom(seed, mesh->vertex_input[v], k);
      squared += x[k] * x[k];
    }
    for (PetscInt k = 0; k < 3 && mesh->on_boundary[v]; k++) x[k] /= PetscSqrtReal(squared);
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 3, place->x));
  PetscCall(EqmPlaceMakeFrames(domain, place));
  PetscFunctionReturn(0);
}

static inline PetscReal TestSum(MPI_Comm comm, PetscReal local)
{
  PetscReal sum;

  MPI_Allreduce(&local, &sum, 1, MPIU_REAL, MPIU_SUM, comm);
  return sum;
}

static inline PetscReal TestMax(MPI_Comm comm, PetscReal local)
{
  PetscReal largest;

  MPI_Allreduce(&local, &largest, 1, MPIU_REAL, MPIU_MAX, comm);
  return largest;
}

/* Root mean square distance of two planar maps (two numbers per local vertex) after the best rotation. Collective. */
static inline PetscReal TestRmsAfterRotation(EqmMesh mesh, const PetscReal *x, const PetscReal *y)
{
  PetscReal turn[2] = {0., 0.}, sum = 0.;

  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    turn[0] += x[2 * v] * y[2 * v] + x[2 * v + 1] * y[2 * v + 1];
    turn[1] += x[2 * v] * y[2 * v + 1] - x[2 * v + 1] * y[2 * v];
  }
  for (int k = 0; k < 2; k++) turn[k] = TestSum(mesh->comm, turn[k]);
  const PetscReal length = PetscSqrtReal(turn[0] * turn[0] + turn[1] * turn[1]), c = turn[0] / length,
                  s = turn[1] / length;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    sum +=
        PetscSqr(c * x[2 * v] - s * x[2 * v + 1] - y[2 * v]) + PetscSqr(s * x[2 * v] + c * x[2 * v + 1] - y[2 * v + 1]);
  }
  return PetscSqrtReal(TestSum(mesh->comm, sum) / mesh->num_vertices);
}

#endif
