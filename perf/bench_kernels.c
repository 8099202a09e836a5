/* How close the loops over cells, and solves, come to the memory's bandwidth: bench_kernels [-n 1000000] [-shape hills]
   [-only NAME] [-max_threads N] [-repetitions 7] [-triad_mib M] [-json FILE]

   The bandwidth is that of the triad a = b + s c (McCalpin's STREAM), on arrays much larger than the last cache, by the
   same number of threads as the kernel. A kernel's traffic is the compulsory one: every array it must read counts once,
   every array it must write counts once, as STREAM counts them (no write-allocate). What comes back from the cache, as
   a vertex does for its six triangles, is free; what is fetched twice is the kernel's own fault and lowers its figure.

   Before every timed repetition the triad's arrays are swept, so that nothing of the mesh is left in a large cache: a
   mesh of a million vertices fits in the last cache of a server. The best repetition counts. With one thread the
   seconds are the processor's, so that a busy machine lengthens them less. */
#include "bench.h"
#include "mesh/mesh_private.h"
#include <cjson/cJSON.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Compulsory bytes per cell, per vertex, per visit of a cell by a block of vertices (its entry in the block's list),
   per nonzero of the assembled matrix, and of its factor. */
typedef struct {
  double cell, vertex, visit, nonzero, factor;
} Traffic;

typedef struct {
  const char *name;
  PetscErrorCode (*run)(Bench *);
  Traffic traffic;
} Kernel;

static PetscErrorCode RunMeasure(Bench *b)
{
  PetscFunctionBegin;
  PetscCall(EqmImageMeasure(b->domain, &b->place, b->image));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunSum(Bench *b)
{
  EqmImageTotals totals;

  PetscFunctionBegin;
  PetscCall(EqmImageSum(b->mesh, b->image, &totals));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunGradient(Bench *b)
{
  PetscFunctionBegin;
  PetscCall(EqmImageGradient(b->domain, &b->place, b->slope, b->gradient));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunDerivatives(Bench *b)
{
  PetscFunctionBegin;
  PetscCall(EqmImageDerivatives(b->domain, &b->place, b->velocity, b->acceleration, b->first, b->second));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunCotangents(Bench *b)
{
  PetscFunctionBegin;
  PetscCall(EqmLaplacianWeights(b->domain, EQM_LAPLACIAN_COTANGENT, NULL, b->weights));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunStretch(Bench *b)
{
  PetscFunctionBegin;
  PetscCall(EqmLaplacianWeights(b->domain, EQM_LAPLACIAN_STRETCH, &b->place, b->weights));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunApply(Bench *b)
{
  PetscFunctionBegin;
  PetscCall(EqmLaplacianApply(b->mesh, b->weights, 2, b->place.x, b->applied));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunAssembly(Bench *b)
{
  PetscFunctionBegin;
  PetscCall(EqmAssemblyFill(b->assembly, BenchCellLaplacian, b->weights));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunSolveOne(Bench *b)
{
  PetscFunctionBegin;
  PetscCall(EqmLinearSolve(b->linear, 1, b->velocity, b->applied));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunSolveTwo(Bench *b)
{
  PetscFunctionBegin;
  PetscCall(EqmLinearSolve(b->linear, 2, b->velocity, b->applied));
  PetscFunctionReturn(0);
}

/* Bytes of an index, a real, a point in the plane, a point in space, a count of matrix entries. */
enum {
  INDEX = sizeof(PetscInt),
  REAL = sizeof(PetscReal),
  PLANE = 2 * REAL,
  SPACE = 3 * REAL,
  COUNT = sizeof(PetscCount)
};

static const Kernel kernels[] = {
    /* cells, a | x */
    {"EqmImageMeasure", RunMeasure, {.cell = 3 * INDEX + REAL, .vertex = PLANE}},
    /* a, weight; a is read twice, and counted once */
    {"EqmImageSum", RunSum, {.cell = 2 * REAL}},
    /* cells, slope | x, gradient | block's list */
    {"EqmImageGradient", RunGradient, {.cell = 3 * INDEX + REAL, .vertex = 2 * PLANE, .visit = INDEX}},
    /* cells, first, second | x, velocity, acceleration */
    {"EqmImageDerivatives", RunDerivatives, {.cell = 3 * INDEX + 2 * REAL, .vertex = 3 * PLANE}},
    /* cells, shape, three weights | position */
    {"EqmLaplacianWeights/cotangent", RunCotangents, {.cell = 3 * INDEX + REAL + 3 * REAL, .vertex = SPACE}},
    /* cells, weight, three weights | x */
    {"EqmLaplacianWeights/stretch", RunStretch, {.cell = 3 * INDEX + REAL + 3 * REAL, .vertex = PLANE}},
    /* cells, three weights | x, y | block's list */
    {"EqmLaplacianApply", RunApply, {.cell = 3 * INDEX + 3 * REAL, .vertex = 2 * PLANE, .visit = INDEX}},
    /* cells, three weights, cell_start, six entries written, read, and found by a permutation | start, count | matrix
       entry written, its range among the entries */
    {"EqmAssemblyFill",
     RunAssembly,
     {.cell = 3 * INDEX + 3 * REAL + INDEX + 6 * (2 * REAL + COUNT), .vertex = INDEX + 1, .nonzero = REAL + COUNT}},
    /* the factor forwards and backwards | right-hand side, solution */
    {"EqmLinearSolve/1", RunSolveOne, {.vertex = 2 * REAL, .factor = 2 * REAL}},
    {"EqmLinearSolve/2", RunSolveTwo, {.vertex = 4 * REAL, .factor = 2 * REAL}},
};
enum { NUM_KERNELS = sizeof(kernels) / sizeof(kernels[0]) };

static double Bytes(const Bench *b, const Traffic *traffic)
{
  const EqmMesh mesh = b->mesh;

  return traffic->cell * mesh->num_local_cells + traffic->vertex * mesh->num_local +
         traffic->visit * mesh->block_start[mesh->num_blocks] + traffic->nonzero * b->nonzeros +
         traffic->factor * b->factor_nonzeros;
}

/* ---- the machine */

/* ---- the mesh */

/* ---- the measurement */

static PetscErrorCode TimeKernel(Bench *b, const Kernel *kernel, PetscInt repetitions, double *seconds)
{
  PetscFunctionBegin;
  *seconds = PETSC_MAX_REAL;
  for (PetscInt r = 0; r < repetitions; r++) {
    BenchTriad(b);
    const double begin = BenchSeconds();
    PetscCall(kernel->run(b));
    *seconds = PetscMin(*seconds, BenchSeconds() - begin);
  }
  PetscFunctionReturn(0);
}

/* One kernel's figures, on the screen and as a row of the file. */
static PetscErrorCode Report(const Bench *b, const Kernel *kernel, double seconds, cJSON *rows)
{
  const double bytes = Bytes(b, &kernel->traffic), cells = b->mesh->num_local_cells;
  const double share = bytes / seconds / b->bandwidth;
  cJSON *const row = cJSON_CreateObject();

  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  %-30s %10.2f %10.1f %8.2f %10.1f\n", kernel->name, 1e9 * seconds / cells,
                        bytes / cells, 1e-9 * bytes / seconds, 100. * share));
  cJSON_AddItemToArray(rows, row);
  (void)cJSON_AddStringToObject(row, "kernel", kernel->name);
  (void)cJSON_AddNumberToObject(row, "threads", omp_get_max_threads());
  (void)cJSON_AddNumberToObject(row, "triad_bytes_per_second", b->bandwidth);
  (void)cJSON_AddNumberToObject(row, "seconds", seconds);
  (void)cJSON_AddNumberToObject(row, "ns_per_cell", 1e9 * seconds / cells);
  (void)cJSON_AddNumberToObject(row, "bytes_per_cell", bytes / cells);
  (void)cJSON_AddNumberToObject(row, "share_of_triad", share);
  PetscFunctionReturn(0);
}

/* All kernels with the present number of threads. The load tells whether the figures are worth anything. */
static PetscErrorCode RunAll(Bench *b, const Options *options, cJSON *rows)
{
  const int threads = omp_get_max_threads();
  double seconds[NUM_KERNELS], load = -1.;

  PetscFunctionBegin;
  b->bandwidth = 0.;
  for (int k = 0; k < NUM_KERNELS; k++) {
    if (strstr(kernels[k].name, options->only))
      PetscCall(TimeKernel(b, &kernels[k], options->repetitions, &seconds[k]));
  }
  (void)getloadavg(&load, 1);
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "\n%d thread%s: triad %.1f GB/s; load %.1f on %ld cores\n", threads,
                        threads > 1 ? "s" : "", 1e-9 * b->bandwidth, load, sysconf(_SC_NPROCESSORS_ONLN)));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  %-30s %10s %10s %8s %10s\n", "kernel", "ns/cell", "bytes/cell", "GB/s",
                        "% of triad"));
  for (int k = 0; k < NUM_KERNELS; k++) {
    if (strstr(kernels[k].name, options->only)) PetscCall(Report(b, &kernels[k], seconds[k], rows));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode WriteJson(const char *name, cJSON *root)
{
  char *const text = cJSON_Print(root);
  FILE *const file = fopen(name, "w");

  PetscFunctionBegin;
  PetscCheck(text && file, PETSC_COMM_WORLD, PETSC_ERR_FILE_OPEN, "cannot write %s", name);
  const PetscBool written = (PetscBool)(fprintf(file, "%s\n", text) > 0);
  PetscCheck(!fclose(file) && written, PETSC_COMM_WORLD, PETSC_ERR_FILE_WRITE, "cannot write %s", name);
  cJSON_free(text);
  PetscFunctionReturn(0);
}

static PetscErrorCode AskOptions(Options *options)
{
  PetscFunctionBegin;
  *options = (Options){.shape = "hills", .n = 1000000, .repetitions = 7, .max_threads = omp_get_max_threads()};
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "Kernel benchmark", NULL);
  PetscCall(PetscOptionsString("-shape", "a shape of disk type that equimap generate knows", NULL, options->shape,
                               options->shape, sizeof(options->shape), NULL));
  PetscCall(PetscOptionsInt("-n", "vertices, about", NULL, options->n, &options->n, NULL));
  PetscCall(PetscOptionsInt("-repetitions", "the best of so many counts", NULL, options->repetitions,
                            &options->repetitions, NULL));
  PetscCall(PetscOptionsString("-only", "kernels with this in their name", NULL, options->only, options->only,
                               sizeof(options->only), NULL));
  PetscCall(PetscOptionsInt("-max_threads", "1, 2, 4, ... and this many threads", NULL, options->max_threads,
                            &options->max_threads, NULL));
  PetscCall(PetscOptionsInt("-triad_mib", "MiB per array of the triad (0: four times the last cache)", NULL,
                            options->triad_mib, &options->triad_mib, NULL));
  PetscCall(PetscOptionsString("-json", "write the figures to this file", NULL, options->json, options->json,
                               sizeof(options->json), NULL));
  PetscOptionsEnd();
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Options options;
  Bench bench = {0};
  EqmLedger ledger;
  EqmSoup soup;
  PetscMPIInt size;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCheck(size == 1, PETSC_COMM_WORLD, PETSC_ERR_SUP, "the benchmark runs on one rank, with threads");
  PetscCall(AskOptions(&options));
  PetscCall(EqmLedgerCreate(PETSC_COMM_WORLD, &ledger));
  PetscCall(BenchCreate(&options, ledger, &soup, &bench));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s: %d vertices, %d cells, %d visits by %d blocks; triad arrays of %d MiB\n",
                        options.shape, (int)bench.mesh->num_vertices, (int)bench.mesh->num_cells,
                        (int)bench.mesh->block_start[bench.mesh->num_blocks], (int)bench.mesh->num_blocks,
                        (int)(bench.triad_length * sizeof(PetscReal) >> 20)));
  cJSON *const root = cJSON_CreateObject(), *const rows = cJSON_AddArrayToObject(root, "kernels");
  (void)cJSON_AddStringToObject(root, "equimap", EqmVersion());
  (void)cJSON_AddStringToObject(root, "git_commit", EqmCommit());
  (void)cJSON_AddNumberToObject(root, "vertices", bench.mesh->num_vertices);
  (void)cJSON_AddNumberToObject(root, "cells", bench.mesh->num_cells);
  for (PetscInt threads = 1;; threads = PetscMin(2 * threads, options.max_threads)) {
    omp_set_num_threads((int)threads);
    PetscCall(RunAll(&bench, &options, rows));
    if (threads >= options.max_threads) break;
  }
  if (options.json[0]) PetscCall(WriteJson(options.json, root));
  cJSON_Delete(root);
  PetscCall(BenchDestroy(&bench));
  PetscCall(EqmSoupDestroy(&soup));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
