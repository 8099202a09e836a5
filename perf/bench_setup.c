/* The mesh and the arrays of the kernel benchmark, and the triad that measures the machine. */
#include "bench.h"
#include "mesh/mesh_private.h"
#include <omp.h>
#include <time.h>
#include <unistd.h>

/* ---- the machine */

double BenchSeconds(void)
{
  struct timespec now;

  if (omp_get_max_threads() > 1 || clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now)) return MPI_Wtime();
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void BenchTriad(Bench *b)
{
  PetscReal *const restrict a = b->triad[0];
  const PetscReal *const restrict x = b->triad[1], *const restrict y = b->triad[2];
  const double begin = BenchSeconds();

#pragma omp parallel for schedule(static)
  for (size_t k = 0; k < b->triad_length; k++) a[k] = x[k] + 3. * y[k];
  b->bandwidth = PetscMax(b->bandwidth, 3. * sizeof(PetscReal) * (double)b->triad_length / (BenchSeconds() - begin));
}

/* Four times the last cache per array, unless the user says otherwise. */
static PetscErrorCode TriadCreate(const Options *options, Bench *b)
{
  const long cache = sysconf(_SC_LEVEL3_CACHE_SIZE);
  const size_t mib = options->triad_mib > 0 ? (size_t)options->triad_mib : PetscMax(256, 4 * (size_t)cache >> 20);

  PetscFunctionBegin;
  b->triad_length = (mib << 20) / sizeof(PetscReal);
  for (int k = 0; k < 3; k++) PetscCall(PetscMalloc1(b->triad_length, &b->triad[k]));
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < b->triad_length; i++) b->triad[0][i] = b->triad[1][i] = b->triad[2][i] = 1.;
  PetscFunctionReturn(0);
}

/* ---- the mesh */

void BenchCellLaplacian(void *context, PetscInt cell, PetscReal *matrix)
{
  const PetscReal *const w = (const PetscReal *)context + 3 * cell;

  for (PetscInt a = 0; a < 3; a++) {
    for (PetscInt b = 0; b < 3; b++) matrix[3 * a + b] = a == b ? w[(a + 1) % 3] + w[(a + 2) % 3] : -w[3 - a - b];
  }
}

static PetscErrorCode FillArrays(Bench *b)
{
  const EqmMesh mesh = b->mesh;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(b->domain, &b->place));
  PetscCall(PetscMalloc4(2 * mesh->num_local, &b->velocity, 2 * mesh->num_local, &b->acceleration, 2 * mesh->num_local,
                         &b->gradient, 2 * mesh->num_local, &b->applied));
  PetscCall(PetscMalloc5(mesh->num_local_cells, &b->image, mesh->num_local_cells, &b->slope, mesh->num_local_cells,
                         &b->first, mesh->num_local_cells, &b->second, 3 * mesh->num_local_cells, &b->weights));
  for (PetscInt k = 0; k < 2 * mesh->num_local; k++) {
    b->place.x[k] = mesh->position[3 * (k / 2) + k % 2]; /* seen from above: any map will do */
    b->velocity[k] = PetscSinReal((PetscReal)k);
    b->acceleration[k] = PetscCosReal((PetscReal)k);
  }
  PetscCall(PetscArraycpy(b->slope, mesh->weight, mesh->num_local_cells));
  PetscCall(EqmImageMeasure(b->domain, &b->place, b->image));
  PetscCall(EqmLaplacianWeights(b->domain, EQM_LAPLACIAN_COTANGENT, NULL, b->weights));
  PetscFunctionReturn(0);
}

/* The scalar Laplacian, its lower triangle as the direct solvers take it, and its factor. */
static PetscErrorCode MakeMatrix(Bench *b)
{
  const EqmMesh mesh = b->mesh;
  const PetscReal definite = 1.001; /* of the diagonal: the Laplacian alone is singular */
  EqmUnknowns unknowns = {.num_owned = mesh->num_owned, .first = mesh->vertex_start, .start = mesh->global};
  PetscBool success;
  MatInfo info;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local, &b->ones));
  for (PetscInt v = 0; v < mesh->num_local; v++) b->ones[v] = 1;
  unknowns.count = b->ones;
  PetscCall(EqmAssemblyCreate(mesh, &unknowns, EQM_STORE_LOWER, &b->assembly));
  PetscCall(EqmAssemblyGetMat(b->assembly, &matrix));
  PetscCall(MatGetInfo(matrix, MAT_LOCAL, &info));
  b->nonzeros = info.nz_used;
  PetscCall(EqmOrderingCreate(mesh, &b->ordering));
  PetscCall(EqmLinearCreate(mesh, b->ordering, &unknowns, EQM_MATRIX_SCALAR, &b->linear));
  PetscCall(EqmLinearFactor(b->linear, BenchCellLaplacian, b->weights, definite, &success));
  PetscCheck(success && b->linear->estimate.nonzeros > 0., PETSC_COMM_WORLD, PETSC_ERR_LIB, "there is no factor");
  b->factor_nonzeros = b->linear->estimate.nonzeros;
  PetscFunctionReturn(0);
}

PetscErrorCode BenchCreate(const Options *options, EqmLedger ledger, EqmSoup *soup, Bench *b)
{
  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, options->shape, options->n, 1, soup));
  PetscCall(EqmMeshCreate(*soup, ledger, &b->mesh));
  PetscCall(EqmDomainCreateDisk(b->mesh, &b->domain));
  PetscCall(FillArrays(b));
  PetscCall(MakeMatrix(b));
  PetscCall(TriadCreate(options, b));
  PetscFunctionReturn(0);
}

PetscErrorCode BenchDestroy(Bench *b)
{
  PetscFunctionBegin;
  for (int k = 0; k < 3; k++) PetscCall(PetscFree(b->triad[k]));
  PetscCall(EqmLinearDestroy(&b->linear));
  PetscCall(EqmOrderingDestroy(&b->ordering));
  PetscCall(EqmAssemblyDestroy(&b->assembly));
  PetscCall(PetscFree(b->ones));
  PetscCall(PetscFree5(b->image, b->slope, b->first, b->second, b->weights));
  PetscCall(PetscFree4(b->velocity, b->acceleration, b->gradient, b->applied));
  PetscCall(EqmPlaceDestroy(&b->place));
  PetscCall(EqmDomainDestroy(&b->domain));
  PetscCall(EqmMeshDestroy(&b->mesh));
  PetscFunctionReturn(0);
}
