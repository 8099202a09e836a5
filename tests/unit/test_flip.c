/* Intrinsic Delaunay flips: what must stay, what must become, the same on any number of ranks. */
#include "support/testing.h"
#include "mesh/mesh_private.h"

typedef struct {
  PetscInt64 flips;
  PetscReal area, energy; /* of the flipped surface; Dirichlet energy of the vertices' places on it */
} Outcome;

/* No pair of vertices has a negative weight; on one rank. */
static PetscErrorCode CheckWeights(EqmMesh mesh, const PetscReal *weights)
{
  const PetscInt n = mesh->num_owned;
  PetscReal *sum;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n * n, &sum));
  for (PetscInt k = 0; k < 3 * mesh->num_owned_cells; k++) {
    const PetscInt *const v = mesh->cells + 3 * (k / 3), p = v[(k + 1) % 3], q = v[(k + 2) % 3];
    CHECK(p != q, "an edge from vertex %d to itself", (int)p);
    sum[n * PetscMin(p, q) + PetscMax(p, q)] += weights[k];
  }
  for (PetscInt k = 0; k < n * n; k++) CHECK(sum[k] > -1e-9, "a weight of %g", (double)sum[k]);
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(0);
}

/* Area and energy of a soup. */
static PetscErrorCode Measure(EqmSoup soup, PetscBool check, Outcome *outcome)
{
  EqmLedger ledger;
  EqmMesh mesh;
  EqmDomain domain;
  PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(EqmLedgerCreate(soup->comm, &ledger));
  PetscCall(EqmMeshCreate(soup, ledger, &mesh));
  PetscCall(EqmDomainCreateSphere(mesh, &domain));
  PetscCall(PetscMalloc1(3 * mesh->num_local_cells, &weights));
  PetscCall(EqmLaplacianWeights(domain, EQM_LAPLACIAN_COTANGENT, NULL, weights));
  PetscCall(EqmLaplacianEnergy(mesh, weights, 3, mesh->position, &outcome->energy));
  outcome->area = mesh->measure;
  CHECK(mesh->num_boundary_vertices == 0 && mesh->num_cells == soup->num_cells, "the surface is no longer closed");
  if (check) PetscCall(CheckWeights(mesh, weights));
  PetscCall(PetscFree(weights));
  PetscCall(EqmDomainDestroy(&domain));
  PetscCall(EqmMeshDestroy(&mesh));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscFunctionReturn(0);
}

static PetscErrorCode Run(MPI_Comm comm, const char *shape, Outcome *before, Outcome *after)
{
  EqmSoup soup, flipped;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(comm, shape, 600, 5, &soup));
  PetscCall(EqmSoupFlip(soup, &flipped, &after->flips));
  PetscCall(Measure(soup, PETSC_FALSE, before));
  PetscCall(Measure(flipped, (PetscBool)(comm == PETSC_COMM_SELF), after));
  PetscCall(EqmSoupDestroy(&soup));
  PetscCall(EqmSoupDestroy(&flipped));
  PetscFunctionReturn(0);
}

/* The metric stays; energies of functions fall (Rippa 1990), and no further flip is left; any number of ranks comes to
   the same triangulation, which is unique. */
static PetscErrorCode TestShape(const char *shape)
{
  Outcome before, alone, together;

  PetscFunctionBegin;
  PetscCall(Run(PETSC_COMM_SELF, shape, &before, &alone));
  CHECK(alone.flips > 5, "%s: only %d flips", shape, (int)alone.flips);
  CHECK_CLOSE(alone.area, before.area, 1e-12, before.area);
  CHECK_CLOSE(before.energy, before.area, 1e-12, before.area); /* of the identity */
  CHECK(alone.energy < before.energy, "%s: energy %g, before %g", shape, (double)alone.energy, (double)before.energy);
  PetscCall(Run(PETSC_COMM_WORLD, shape, &before, &together));
  CHECK_CLOSE(together.area, alone.area, 1e-12, alone.area);
  CHECK_CLOSE(together.energy, alone.energy, 1e-11, alone.energy);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestShape("head"));
  PetscCall(TestShape("starfish"));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
