/* What the kernel benchmark is made of: a mesh with everything that a kernel may read or write, and the triad beside.
 */
#ifndef EQM_BENCH_H
#define EQM_BENCH_H

#include <equimap.h>
#include "linalg/linalg.h"

typedef struct {
  char shape[32], only[32], json[PETSC_MAX_PATH_LEN];
  PetscInt n, repetitions, max_threads, triad_mib;
} Options;

/* Everything that a kernel may read or write. */
typedef struct {
  EqmMesh mesh;
  EqmDomain domain;
  EqmPlace place;
  EqmAssembly assembly;
  EqmOrdering ordering;
  EqmLinear linear; /* the same matrix, factored */
  unsigned char *ones;
  PetscReal *image, *slope, *first, *second;               /* per local cell */
  PetscReal *weights;                                      /* 3 per local cell */
  PetscReal *velocity, *acceleration, *gradient, *applied; /* 2 per local vertex */
  double nonzeros, factor_nonzeros;                        /* of the assembled matrix, of its factor */
  size_t triad_length;
  PetscReal *triad[3];
  double bandwidth; /* of the triad, bytes per second */
} Bench;

/* The mesh, its arrays filled, its Laplacian assembled and factored, the triad's arrays. */
PetscErrorCode BenchCreate(const Options *options, EqmLedger ledger, EqmSoup *soup, Bench *b);
PetscErrorCode BenchDestroy(Bench *b);
/* One sweep of the triad; the best of the sweeps with as many threads gives the bandwidth. */
void BenchTriad(Bench *b);
/* Seconds of the clock; with one thread, of the processor, which others on the machine do not lengthen. */
double BenchSeconds(void);
/* The matrix of a cell for weights (context) per cell and corner. */
void BenchCellLaplacian(void *context, PetscInt cell, PetscReal *matrix);

#endif
