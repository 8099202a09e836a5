/* Statistics of distributed samples against a serial sort; distortion of maps whose distortion is known. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "measure/quantile.h"
#include "store/map_private.h"

/* The value at fraction q of a sorted array, linear between neighbours. */
static PetscReal Quantile(PetscInt n, const PetscReal *sorted, PetscReal q)
{
  const PetscInt below = (PetscInt)(q * (n - 1));
  const PetscReal rest = q * (n - 1) - below;

  return below + 1 < n ? sorted[below] + rest * (sorted[below + 1] - sorted[below]) : sorted[below];
}

/* Deal `all` to the ranks by `owner` and compare with the whole. */
static PetscErrorCode CheckSample(PetscInt n, const PetscReal *all, PetscMPIInt (*owner)(PetscInt, PetscMPIInt))
{
  PetscReal *sorted, *mine, mean = 0., variance = 0., scale = 0.;
  PetscInt num_mine = 0;
  PetscMPIInt rank, size;
  EqmStatistics s;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(PetscMalloc2(n, &sorted, n, &mine));
  PetscCall(PetscArraycpy(sorted, all, n));
  PetscCall(PetscSortReal(n, sorted));
  for (PetscInt i = 0; i < n; i++) {
    if (owner(i, size) == rank) mine[num_mine++] = all[i];
    mean += all[i] / n;
    scale = PetscMax(scale, PetscAbsReal(all[i]));
  }
  for (PetscInt i = 0; i < n; i++) variance += PetscSqr((all[i] - mean) / scale) / n;
  PetscCall(EqmStatisticsOf(PETSC_COMM_WORLD, num_mine, mine, &s));
  CHECK_CLOSE(s.mean, mean, 1e-13, scale);
  CHECK_CLOSE(s.sd, scale * PetscSqrtReal(variance), 1e-13, scale);
  CHECK(s.min == sorted[0] && s.max == sorted[n - 1], "min %g max %g", (double)s.min, (double)s.max);
  CHECK_CLOSE(s.p25, Quantile(n, sorted, .25), 1e-15, scale);
  CHECK_CLOSE(s.p50, Quantile(n, sorted, .5), 1e-15, scale);
  CHECK_CLOSE(s.p75, Quantile(n, sorted, .75), 1e-15, scale);
  CHECK_CLOSE(s.p95, Quantile(n, sorted, .95), 1e-15, scale);
  PetscCall(PetscFree2(sorted, mine));
  PetscFunctionReturn(0);
}

static PetscMPIInt InTurn(PetscInt i, PetscMPIInt size)
{
  return (PetscMPIInt)(i % size);
}

static PetscMPIInt LastRankAlone(PetscInt i, PetscMPIInt size)
{
  return size - 1;
}

static PetscReal Uniform(PetscInt i)
{
  return TestRandom(1, i, 0);
}

/* Long runs of equal values, zeros of both signs among them. */
static PetscReal Ties(PetscInt i)
{
  return i % 5 == 4 ? -0. : (PetscReal)(i % 5 - 2);
}

static PetscReal Negative(PetscInt i)
{
  return -1. - PetscAbsReal(TestRandom(2, i, 0));
}

/* Over 300 orders of magnitude, both signs. */
static PetscReal Wide(PetscInt i)
{
  return (i % 2 ? 1. : -1.) * PetscPowReal(10., 140. * TestRandom(3, i, 0));
}

static PetscReal Constant(PetscInt i)
{
  return 1. / 3.;
}

static PetscErrorCode TestStatistics(void)
{
  static PetscReal (*const values[])(PetscInt) = {Uniform, Ties, Negative, Wide, Constant};
  static const PetscInt sizes[] = {1, 2, 3, 20, 21, 1000};
  PetscReal all[1000];
  EqmStatistics s;

  PetscFunctionBegin;
  for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(values); f++) {
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(sizes); k++) {
      for (PetscInt i = 0; i < sizes[k]; i++) all[i] = values[f](i);
      PetscCall(CheckSample(sizes[k], all, InTurn));
      PetscCall(CheckSample(sizes[k], all, LastRankAlone));
    }
  }
  PetscCall(EqmStatisticsOf(PETSC_COMM_WORLD, 0, all, &s));
  CHECK(s.mean == 0. && s.sd == 0. && s.min == 0. && s.max == 0. && s.p50 == 0., "nothing at all has the mean %g",
        (double)s.mean);
  PetscFunctionReturn(0);
}

/* ---- maps of a flat mesh by a matrix */

/* The unit square with irregular triangles, in the plane. */
static PetscErrorCode MakeFlat(TestMesh *test)
{
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "hills", 400, 4, &soup));
  for (PetscInt v = 0; v < soup->vertex_end - soup->vertex_start; v++) soup->vertices[3 * v + 2] = 0.;
  PetscCall(TestMeshFromSoup(soup, test));
  PetscFunctionReturn(0);
}

/* Measure x -> matrix x, in the plane (dim 2) or in space. */
static PetscErrorCode MeasureLinear(TestMesh *test, PetscInt dim, const PetscReal matrix[6], EqmMap *map)
{
  const EqmMesh mesh = test->mesh;
  PetscReal *x;

  PetscFunctionBegin;
  PetscCall(EqmMapCreate(test->soup, dim, map));
  PetscCall(PetscMalloc1(dim * mesh->num_local, &x));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    for (PetscInt c = 0; c < dim; c++)
      x[dim * v + c] = matrix[2 * c] * mesh->position[3 * v] + matrix[2 * c + 1] * mesh->position[3 * v + 1];
  }
  PetscCall(EqmMapMeasure(*map, mesh, x));
  PetscCall(PetscFree(x));
  PetscFunctionReturn(0);
}

/* A linear map keeps shares: ratio one everywhere, energy zero; its angles and singular values are known. */
static PetscErrorCode CheckLinear(TestMesh *test, const PetscReal matrix[6], PetscReal quasiconformal,
                                  PetscBool conformal)
{
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(MeasureLinear(test, 2, matrix, &map));
  const EqmDistortion *const d = &map->distortion;
  const PetscReal determinant = PetscAbsReal(matrix[0] * matrix[3] - matrix[1] * matrix[2]);
  CHECK(d->folds == 0, "%d folds", (int)d->folds);
  CHECK_CLOSE(d->image_measure, determinant * d->mesh_measure, 1e-12, determinant);
  CHECK_CLOSE(d->energy, 0., 1e-20, 1.);
  CHECK_CLOSE(d->ratio.mean, 1., 1e-12, 1.);
  CHECK_CLOSE(d->ratio.sd, 0., 1e-12, 1.);
  CHECK_CLOSE(d->ratio_error.max, 0., 1e-11, 1.);
  CHECK_CLOSE(d->quasiconformal.mean, quasiconformal, 1e-6, 1.); /* the square root of a difference near one */
  CHECK_CLOSE(d->quasiconformal.max, quasiconformal, 1e-5, 1.);
  CHECK((d->angle_error.max < 1e-9) == conformal, "angles change by %g degrees", (double)d->angle_error.max);
  for (PetscInt c = 0; c < test->soup->cell_end - test->soup->cell_start; c++)
    CHECK_CLOSE(map->cell_ratio[c], 1., 1e-11, 1.);
  for (PetscInt v = 0; v < test->soup->vertex_end - test->soup->vertex_start; v++)
    CHECK_CLOSE(map->vertex_ratio[v], 1., 1e-11, 1.);
  PetscCall(EqmMapDestroy(&map));
  PetscFunctionReturn(0);
}

/* The map that folds the left half over the right one: folds are the cells of the smaller side. */
static PetscErrorCode TestFolds(TestMesh *test)
{
  const EqmMesh mesh = test->mesh;
  PetscReal *x;
  PetscInt64 wanted = 0;
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(EqmMapCreate(test->soup, 2, &map));
  PetscCall(PetscMalloc1(2 * mesh->num_local, &x));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    x[2 * v] = PetscAbsReal(mesh->position[3 * v] - .3);
    x[2 * v + 1] = mesh->position[3 * v + 1];
  }
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    wanted += (x[2 * v[1]] - x[2 * v[0]]) * (x[2 * v[2] + 1] - x[2 * v[0] + 1]) -
                  (x[2 * v[1] + 1] - x[2 * v[0] + 1]) * (x[2 * v[2]] - x[2 * v[0]]) <=
              0.;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &wanted, 1, MPIU_INT64, MPI_SUM, PETSC_COMM_WORLD));
  PetscCall(EqmMapMeasure(map, mesh, x));
  CHECK(wanted > 0 && map->distortion.folds == wanted, "%d folds, not %d", (int)map->distortion.folds, (int)wanted);
  CHECK(map->distortion.ratio.min < 0., "the smallest ratio of a folded map is %g", (double)map->distortion.ratio.min);
  PetscCall(PetscFree(x));
  PetscCall(EqmMapDestroy(&map));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestMaps(void)
{
  static const PetscReal identity[6] = {1., 0., 0., 1.}, turned[6] = {-3., 4., -4., -3.},
                         mirrored[6] = {0., 1., 1., 0.};
  static const PetscReal stretched[6] = {2., 0., 0., 1.}, sheared[6] = {1., 1., 0., 1.};
  TestMesh test;

  PetscFunctionBegin;
  PetscCall(MakeFlat(&test));
  PetscCall(CheckLinear(&test, identity, 1., PETSC_TRUE));
  PetscCall(CheckLinear(&test, turned, 1., PETSC_TRUE));
  PetscCall(CheckLinear(&test, mirrored, 1., PETSC_TRUE)); /* turned over as a whole: no fold */
  PetscCall(CheckLinear(&test, stretched, 2., PETSC_FALSE));
  PetscCall(CheckLinear(&test, sheared, .5 * (3. + PetscSqrtReal(5.)), PETSC_FALSE)); /* golden mean, squared */
  PetscCall(TestFolds(&test));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestStatistics());
  PetscCall(TestMaps());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
