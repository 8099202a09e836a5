/* Whole runs to the sphere: small energies without folds, the same map on any number of ranks, the same bits for any
   number of threads, and nothing that depends on where the mesh lies in space or in which units. */
#include "support/runs.h"
#include "mesh/soup_private.h"
#include "store/map_private.h"

/* The default ends by itself with a small energy, without folds, with every vertex on the sphere. The shape is made
   `stretch` times as long first. */
static PetscErrorCode TestDefault(const char *shape, PetscInt n, PetscReal stretch, PetscReal most)
{
  TestMesh test;
  EqmSoup soup;
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, shape, n, 1, &soup));
  for (PetscInt v = 0; v < soup->vertex_end - soup->vertex_start; v++) soup->vertices[3 * v + 2] *= stretch;
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(TestMap(&test, "sphere", "", &map));
  CHECK(map->status == EQM_STATUS_CONVERGED && map->distortion.folds == 0, "%s: status %d, %d folds: %s", shape,
        (int)map->status, (int)map->distortion.folds, map->message);
  CHECK(map->distortion.energy <= most, "%s: energy %g", shape, (double)map->distortion.energy);
  CHECK(map->distortion.image_measure > 12. && map->distortion.image_measure < 4. * PETSC_PI, "image area %g",
        (double)map->distortion.image_measure);
  for (PetscInt v = 0; v < test.soup->vertex_end - test.soup->vertex_start; v++) {
    const PetscReal *const x = map->coordinates + 3 * v;
    CHECK_CLOSE(PetscSqrtReal(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]), 1., 1e-14, 1.);
  }
  for (PetscInt k = 1; k < map->num_history; k++)
    CHECK(map->history[k].energy < map->history[0].energy, "iteration %d is worse than the start", (int)k);
  PetscCall(EqmMapDestroy(&map));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Turn about the axis (1, 2, 3), scale, shift. */
static void Displace(EqmSoup soup)
{
  const PetscReal angle = 1.1, c = PetscCosReal(angle), s = PetscSinReal(angle), length = PetscSqrtReal(14.);
  const PetscReal e[3] = {1. / length, 2. / length, 3. / length}, shift[3] = {.7, -1.3, 2.};

  for (PetscInt v = 0; v < soup->vertex_end - soup->vertex_start; v++) {
    PetscReal *const x = soup->vertices + 3 * v, y[3];
    const PetscReal along = e[0] * x[0] + e[1] * x[1] + e[2] * x[2];
    for (PetscInt k = 0; k < 3; k++) {
      const PetscReal across = e[(k + 1) % 3] * x[(k + 2) % 3] - e[(k + 2) % 3] * x[(k + 1) % 3];
      y[k] = c * x[k] + s * across + (1. - c) * along * e[k];
    }
    for (PetscInt k = 0; k < 3; k++) x[k] = 37. * y[k] + shift[k];
  }
}

/* The energies of the iterates do not tell where the mesh lies nor in which units it is given. */
static PetscErrorCode TestInvariance(const char *shape, const char *options)
{
  EqmMap map[2];
  TestMesh test[2];

  PetscFunctionBegin;
  for (int k = 0; k < 2; k++) {
    EqmSoup soup;
    PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, shape, 600, 2, &soup));
    if (k == 1) Displace(soup);
    PetscCall(TestMeshFromSoup(soup, &test[k]));
    PetscCall(TestMap(&test[k], "sphere", options, &map[k]));
  }
  CHECK(map[0]->num_history == map[1]->num_history && map[0]->num_history >= 5, "%s: %d and %d rows", options,
        (int)map[0]->num_history, (int)map[1]->num_history);
  for (PetscInt k = 0; k < map[0]->num_history; k++) {
    const PetscReal energy = map[0]->history[k].energy;
    CHECK_CLOSE(map[1]->history[k].energy, energy, 1e-9, energy);
  }
  CHECK_CLOSE(map[1]->distortion.mesh_measure, 37. * 37. * map[0]->distortion.mesh_measure, 1e-12,
              map[1]->distortion.mesh_measure);
  for (int k = 0; k < 2; k++) {
    PetscCall(EqmMapDestroy(&map[k]));
    PetscCall(TestMeshDestroy(&test[k]));
  }
  PetscFunctionReturn(0);
}

/* What does not suit the sphere: options of the plane, an open surface. */
static PetscErrorCode TestRefusals(void)
{
  TestMesh closed, open;
  EqmDomain domain;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "sphere", 100, 1, &closed));
  PetscCall(TestRefused(closed.mesh, "sphere", "-method fixed-point -balance .01"));
  PetscCall(TestRefused(closed.mesh, "sphere", "-start harmonic"));
  PetscCall(TestMeshDestroy(&closed));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 100, 1, &open));
  CHECK_FAILS(EQM_ERR_MESH, EqmDomainCreateSphere(open.mesh, &domain));
  PetscCall(TestMeshDestroy(&open));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestDefault("head", 900, 1., 2e-7));
  PetscCall(TestDefault("sphere", 900, 1., 2e-7));
  /* Needles: the linear map has no folds, but a tip smaller than the arithmetic resolves; or it folds for that. */
  PetscCall(TestDefault("sphere", 2500, 7.5, 2e-7));
  PetscCall(TestDefault("sphere", 2500, 9., 2e-7));
  PetscCall(TestDefault("sphere", 2500, 10., 2e-7));

  PetscCall(TestSameOnRanks("head", 600, "sphere", "-method fixed-point -max_it 4 -energy_rtol 0", 1e-9, .5));
  PetscCall(TestSameOnRanks("head", 600, "sphere", "-method lm -max_it 4 -energy_rtol 0", 1e-6, .5));
  PetscCall(TestSameOnRanks("sphere", 600, "sphere", "-method lm -max_it 3 -energy_rtol 0", 1e-7, .5));

  PetscCall(TestSameWithThreads(PETSC_COMM_WORLD, "head", 1500, "sphere", "-method fixed-point -max_it 3"));
  PetscCall(TestSameWithThreads(PETSC_COMM_WORLD, "head", 1500, "sphere", "-method lm -max_it 3"));

  PetscCall(TestInvariance("head", "-method fixed-point -max_it 10 -energy_rtol 0"));
  PetscCall(TestInvariance("head", "-method lm -max_it 10 -energy_rtol 0"));

  PetscCall(TestRefusals());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
