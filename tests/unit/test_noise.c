/* Noise on a surface: along the normals, of the right size, the same bits on any number of ranks. */
#include "support/testing.h"

static PetscErrorCode Noisy(MPI_Comm comm, const char *shape, PetscInt n, PetscReal sigma, PetscInt seed, EqmSoup *soup)
{
  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(comm, shape, n, 1, soup));
  PetscCall(EqmSoupAddNoise(*soup, sigma, seed));
  PetscFunctionReturn(0);
}

/* Vertices and checksum of all ranks together and of each alone. */
static PetscErrorCode TestRanks(const char *shape)
{
  EqmSoup alone, together;

  PetscFunctionBegin;
  PetscCall(Noisy(PETSC_COMM_SELF, shape, 400, .01, 5, &alone));
  PetscCall(Noisy(PETSC_COMM_WORLD, shape, 400, .01, 5, &together));
  for (PetscInt k = 3 * together->vertex_start; k < 3 * together->vertex_end; k++) {
    CHECK(together->vertices[k - 3 * together->vertex_start] == alone->vertices[k], "vertex %d differs", (int)k / 3);
  }
  CHECK(together->checksum == alone->checksum, "the checksums differ");
  PetscCall(EqmSoupDestroy(&alone));
  PetscCall(EqmSoupDestroy(&together));
  PetscFunctionReturn(0);
}

/* No noise changes nothing; noise changes the checksum; another seed, other noise; the same seed, the same. */
static PetscErrorCode TestSeeds(void)
{
  EqmSoup plain, none, noisy[3];
  PetscReal difference = 0.;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "head", 300, 1, &plain));
  PetscCall(Noisy(PETSC_COMM_WORLD, "head", 300, 0., 5, &none));
  for (int k = 0; k < 3; k++) PetscCall(Noisy(PETSC_COMM_WORLD, "head", 300, .01, k ? 6 : 5, &noisy[k]));
  for (PetscInt k = 0; k < 3 * (plain->vertex_end - plain->vertex_start); k++) {
    CHECK(none->vertices[k] == plain->vertices[k], "sigma 0 moves vertex %d", (int)k / 3);
    CHECK(noisy[1]->vertices[k] == noisy[2]->vertices[k], "one seed, two results");
    difference = PetscMax(difference, PetscAbsReal(noisy[0]->vertices[k] - noisy[1]->vertices[k]));
  }
  CHECK(TestMax(PETSC_COMM_WORLD, difference) > .01, "two seeds, one result");
  CHECK(none->checksum == plain->checksum && noisy[0]->checksum != plain->checksum &&
            noisy[0]->checksum != noisy[1]->checksum && noisy[1]->checksum == noisy[2]->checksum,
        "checksums");
  PetscCall(EqmSoupDestroy(&plain));
  PetscCall(EqmSoupDestroy(&none));
  for (int k = 0; k < 3; k++) PetscCall(EqmSoupDestroy(&noisy[k]));
  PetscFunctionReturn(0);
}

/* On a sphere the noise is radial, with mean 0, standard deviation sigma and the moments of a normal distribution. */
static PetscErrorCode TestSize(PetscReal sigma)
{
  PetscReal moment[4] = {0., 0., 0., 0.};
  EqmSoup plain, noisy;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "sphere", 10000, 1, &plain));
  PetscCall(Noisy(PETSC_COMM_WORLD, "sphere", 10000, sigma, 7, &noisy));
  const PetscInt n = plain->num_vertices;
  for (PetscInt v = 0; v < plain->vertex_end - plain->vertex_start; v++) {
    const PetscReal *const x = plain->vertices + 3 * v, *const y = noisy->vertices + 3 * v;
    PetscReal along = 0., squared = 0.;
    for (PetscInt k = 0; k < 3; k++) {
      along += x[k] * (y[k] - x[k]) / sigma;
      squared += PetscSqr((y[k] - x[k]) / sigma);
    }
    CHECK_CLOSE(along * along, squared, .01, squared); /* normals of the mesh are nearly the sphere's */
    for (int k = 0; k < 4; k++) moment[k] += PetscPowRealInt(along, k + 1) / n;
  }
  for (int k = 0; k < 4; k++) moment[k] = TestSum(PETSC_COMM_WORLD, moment[k]);
  CHECK_CLOSE(moment[0], 0., .04, 1.); /* four standard errors */
  CHECK_CLOSE(moment[1], 1., .06, 1.);
  CHECK_CLOSE(moment[2], 0., .16, 1.);
  CHECK_CLOSE(moment[3], 3., .40, 1.);
  PetscCall(EqmSoupDestroy(&plain));
  PetscCall(EqmSoupDestroy(&noisy));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestRefused(const char *shape, PetscReal sigma)
{
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, shape, 100, 1, &soup));
  CHECK_FAILS(EQM_ERR_USAGE, EqmSoupAddNoise(soup, sigma, 0));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestRanks("head"));
  PetscCall(TestRanks("hills"));
  PetscCall(TestSeeds());
  PetscCall(TestSize(1e-3));
  PetscCall(TestSize(.2));
  PetscCall(TestRefused("head", -1.));
  PetscCall(TestRefused("ball", .01));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
