/* The answer: where every input vertex goes, how good that is, how it was found. In input numbering, in the slabs of
   the soup it belongs to. */
#ifndef EQUIMAP_MAP_H
#define EQUIMAP_MAP_H

#include <equimap/soup.h>

/* Longest description of a linear solver, terminating zero included. */
#define EQM_LINEAR_TEXT 192

typedef struct {
  PetscReal mean, sd, min, max, p25, p50, p75, p95;
} EqmStatistics;

/* Bins of the histogram of angle errors, a quarter of a degree each. */
enum { EQM_NUM_ANGLE_BINS = 720 };

/* Distortion as the papers measure it (unweighted over cells unless said otherwise). */
typedef struct {
  PetscReal energy;                               /* normalised authalic / isovolumetric energy A sum (w/W) (r - 1)^2 */
  PetscReal image_measure;                        /* A */
  PetscReal mesh_measure;                         /* W, density included */
  EqmStatistics ratio;                            /* r = (a/w) (W/A) */
  EqmStatistics ratio_error;                      /* |r - 1| */
  EqmStatistics angle_error;                      /* degrees per corner; p50 is the median; triangles only */
  PetscInt64 angle_histogram[EQM_NUM_ANGLE_BINS]; /* corners whose angle error lies in the bin; triangles only */
  EqmStatistics quasiconformal;                   /* ratio of singular values, >= 1; triangles only */
  PetscInt64 folds;
} EqmDistortion;

/* One row per iteration. Row 0 is the start. */
typedef struct {
  PetscInt iteration;
  PetscReal energy; /* E of the map (conformal: the Dirichlet energy) */
  PetscReal sd;     /* standard deviation of the ratio */
  PetscInt64 folds;
  PetscReal step;          /* accepted step length, 0 in row 0 */
  PetscReal gradient_norm; /* of the function that the method minimises; -1 where the method has none */
  EqmWork work;            /* so far */
  PetscReal seconds;       /* since the program's start */
} EqmHistoryRow;

/* An array that belongs to a result: rows dealt to the ranks in contiguous slabs. */
typedef struct {
  char path[128];               /* in the result file */
  PetscInt total, start, count; /* rows of all ranks, this rank's first, this rank's */
  PetscInt width;               /* entries per row; 0 makes the array one-dimensional */
  PetscBool is_real;
  PetscReal *reals;
  PetscInt64 *integers;
} EqmMapArray;

/* A number or a text that belongs to a result. */
typedef struct {
  char key[96]; /* dots make groups in the summary: "landmarks.error.max" */
  PetscBool is_text;
  PetscReal value;
  char text[PETSC_MAX_PATH_LEN];
} EqmMapFigure;

typedef struct _p_EqmMap *EqmMap;
struct _p_EqmMap {
  EqmSoup soup;                /* the input mesh; referenced, not owned */
  PetscInt dim;                /* coordinates per vertex: 2 or 3 */
  PetscBool in_space;          /* triangles lie on a surface in space, not on the sphere: areas have no sign */
  PetscReal *coordinates;      /* dim * slab of vertices */
  PetscReal *cell_ratio;       /* r per cell of the slab */
  PetscReal *vertex_ratio;     /* mean of r over the cells around a vertex, weighted by w; per vertex of the slab */
  PetscReal *quasi_conformal;  /* ratio of singular values per cell of the slab; triangles only */
  PetscReal *conformal_factor; /* log (share of the image's area / share of the surface's) of the cells around a vertex,
                                  per vertex of the slab; triangles only */
  EqmDistortion distortion;
  PetscReal energy_initial, energy_final;
  PetscInt iterations, num_history;
  EqmHistoryRow *history; /* num_history rows, the same on every rank */
  EqmWork work;
  EqmStatus status;
  char message[EQM_MESSAGE_MAX]; /* how the run ended, in plain words */
  char command[64], method[64];
  char linear_solver[EQM_LINEAR_TEXT]; /* what solved with matrices, and what it took */
  PetscInt ranks, threads;
  PetscReal phase_seconds[EQM_NUM_PHASES], event_seconds[EQM_NUM_EVENTS], total_seconds;
  PetscInt64 memory_max_per_rank, memory_total, num_boundary_vertices;
  PetscInt64 boundary_folds;        /* maps to the ball: triangles of the boundary that do not look outward */
  PetscInt num_hessian_eigenvalues; /* where they were asked for: the smallest of the Hessian at the result */
  PetscReal *hessian_eigenvalues;
  EqmMap mended;          /* where the input was mended first: the map of the mended mesh; referenced, not owned */
  const PetscInt *parent; /* with `mended`: per cell of its soup's slab the input cell it comes from; referenced */
  EqmRepair repair;       /* with `mended`: what was mended */
  PetscInt num_arrays, num_figures; /* what a command adds to the result */
  EqmMapArray *arrays;
  EqmMapFigure *figures;
};

PETSC_EXTERN PetscErrorCode EqmMapCreate(EqmSoup soup, PetscInt dim, EqmMap *map);
PETSC_EXTERN PetscErrorCode EqmMapDestroy(EqmMap *map);
/* Bring the map of a mended mesh back onto the input that EqmSoupRepair mended: places and vertex ratios of the input's
   vertices, per input cell the mean ratio of what became of it, weighted by `cell_weight` (per cell of the mended
   slab), 1 where it was removed. Distortion, history and work are those of the mended map. `mended` and `parent` must
   outlive the map, which writes them into a result file. Vertices that no cell uses stay at zero. Collective. */
PETSC_EXTERN PetscErrorCode EqmMapOntoInput(EqmMap mended, EqmSoup input, const PetscInt *parent,
                                            const PetscReal *cell_weight, EqmMap *map);

/* Add an array to the result file (the map takes `values` over; PetscMalloc'ed, count * max(1, width)), or a figure to
   the result file's attributes and the summary. Figures are the same on every rank. Not collective. */
PETSC_EXTERN PetscErrorCode EqmMapAddReals(EqmMap map, const char *path, PetscInt total, PetscInt start, PetscInt count,
                                           PetscInt width, PetscReal *values);
PETSC_EXTERN PetscErrorCode EqmMapAddIntegers(EqmMap map, const char *path, PetscInt total, PetscInt start,
                                              PetscInt count, PetscInt width, PetscInt64 *values);
PETSC_EXTERN PetscErrorCode EqmMapAddFigure(EqmMap map, const char *key, PetscReal value);
PETSC_EXTERN PetscErrorCode EqmMapAddText(EqmMap map, const char *key, const char *text);

/* Write a result: every name in the comma-separated `files`, format by suffix; .h5 holds everything and gets an .xmf
   beside it. tmp -> fsync -> rename; a file that was there survives a failure. Errors: EQM_ERR_USAGE (suffix),
   EQM_ERR_IO. Collective. */
PETSC_EXTERN PetscErrorCode EqmMapWrite(EqmMap map, const char *files);
/* Look before a long run whether `files` can be written: suffixes known, directories there and writable. Collective. */
PETSC_EXTERN PetscErrorCode EqmMapCheckWritable(MPI_Comm comm, const char *files);
/* Read the coordinates of a map of the mesh `soup`: .h5 (/map/coordinates), or any mesh format whose vertices are the
   images (with z = 0 everywhere: a planar map). Errors: EQM_ERR_IO, EQM_ERR_MESH (vertex count differs). Collective. */
PETSC_EXTERN PetscErrorCode EqmMapRead(EqmSoup soup, const char *file, EqmMap *map);
/* The summary as JSON (INTERFACE.md's keys) and the history as CSV. Collective; rank 0 writes. */
PETSC_EXTERN PetscErrorCode EqmMapWriteSummary(EqmMap map, const char *file);
PETSC_EXTERN PetscErrorCode EqmMapWriteHistory(EqmMap map, const char *file);
/* The histogram of angle errors as CSV: from, to (degrees), corners. Collective; rank 0 writes. */
PETSC_EXTERN PetscErrorCode EqmMapWriteHistogram(EqmMap map, const char *file);

#endif
