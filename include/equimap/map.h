/* The result of a run: the image of every input vertex, how good the map is, and how it was found. Everything per
   vertex and per cell is in the numbering of the input, in the slabs of the soup that the map belongs to: this rank
   holds the vertices soup->vertex_start ... soup->vertex_end - 1 and the cells soup->cell_start ... soup->cell_end - 1.

   A map is opaque. Arrays that an EqmMapGet function returns belong to the map and live as long as it does. Get and Set
   functions are not collective and raise no errors of their own unless it is said otherwise. */
#ifndef EQUIMAP_MAP_H
#define EQUIMAP_MAP_H

#include <equimap/mesh.h>

/* The image of a mesh. */
typedef struct _p_EqmMap *EqmMap;

/* Longest description of a linear solver, terminating zero included. */
#define EQM_LINEAR_TEXT 192

/* Of a sample: mean, standard deviation (divided by the number of entries), extremes, quantiles. */
typedef struct {
  PetscReal mean, sd, min, max, p25, p50, p75, p95;
} EqmStatistics;

/* Ratios weighted by the measure of their cells, which slivers hardly change. The mean is 1. */
typedef struct {
  PetscReal sd;                      /* sqrt(sum w (r - 1)^2 / sum w), which is sqrt(energy / image_measure) */
  PetscReal p05, p25, p50, p75, p95; /* the ratio up to which that share of the measure lies */
  PetscInt64 outliers;               /* cells with |r - 1| > 10 sd */
  PetscReal outlier_share;           /* their share of the measure, at most 1/100 */
  PetscReal cell_sd_without;         /* standard deviation over all other cells, unweighted */
} EqmWeightedRatio;

/* Bins of the histogram of ratios: equal ones from 1 - reach to 1 + reach, with the first and the last for what lies
   below and above. `reach` is 10 weighted standard deviations, rounded up to 1, 2 or 5 times a power of ten, at least
   1e-12. */
enum { EQM_NUM_RATIO_BINS = 202 };

/* The histogram of ratios, the same on every rank. */
typedef struct {
  PetscReal reach;
  PetscInt64 cells[EQM_NUM_RATIO_BINS]; /* how many cells have a ratio in the bin */
  PetscReal share[EQM_NUM_RATIO_BINS];  /* their share of the mesh's measure */
} EqmRatioHistogram;

/* Bins of the histogram of angle errors, a quarter of a degree each. */
enum { EQM_NUM_ANGLE_BINS = 720 };

/* Distortion as the papers measure it (unweighted over cells unless said otherwise). */
typedef struct {
  PetscReal energy;                               /* normalised authalic / isovolumetric energy A sum (w/W) (r - 1)^2 */
  PetscReal image_measure;                        /* A */
  PetscReal mesh_measure;                         /* W, density included */
  EqmStatistics ratio;                            /* r = (a/w) (W/A) */
  EqmStatistics ratio_error;                      /* |r - 1| */
  EqmWeightedRatio weighted_ratio;                /* r, weighted by w */
  EqmRatioHistogram ratio_histogram;              /* r, by cells and by w */
  EqmStatistics angle_error;                      /* degrees per corner; p50 is the median; triangles only */
  PetscInt64 angle_histogram[EQM_NUM_ANGLE_BINS]; /* corners whose angle error lies in the bin; triangles only */
  EqmStatistics quasiconformal;                   /* ratio of singular values, >= 1; triangles only */
  PetscInt64 folds;                               /* cells of negative image measure */
} EqmDistortion;

/* One row per iteration; row 0 is the start. Where folds were mended at the end another row follows for that map, with
   the number of the last iteration. A figure that the method does not have is -1. */
typedef struct {
  PetscInt iteration;
  PetscReal energy; /* E of the map (conformal: the Dirichlet energy) */
  PetscReal sd;     /* standard deviation of the ratio */
  PetscInt64 folds;
  PetscReal step;                /* accepted step length, 0 in row 0 */
  PetscReal gradient_norm;       /* of the function that the method minimises; -1 where the method has none */
  EqmWork work;                  /* so far */
  PetscReal seconds;             /* since the program's start */
  PetscReal stretch;             /* stretch energy sum a^2/w of the mesh scaled to the image's measure; conformal: -1 */
  PetscReal image_measure;       /* A, the stretch energy's lower bound (002 Corollary 3.4) */
  PetscInt64 unfolded_from;      /* folds before they were mended, which led to this map; 0: nothing was mended */
  PetscReal preconditioned_norm; /* sqrt(g^T M^-1 g), M the method's preconditioner */
  PetscReal wolfe_decrease; /* of the step that led here: (E_new - E) / (step g^T p), at least c1 of (22a) of 000 */
  PetscReal wolfe_slope;    /* |g_new^T p| / |g^T p|, at most c2 of (22b) */
  PetscReal change;         /* Euler methods: ||f_new - f||_F, ||f||_F being one (004 (17)) */
  PetscInt64 phase;         /* of a method in phases, from 1 */
} EqmHistoryRow;

/* What a run took. */
typedef struct {
  PetscInt ranks, threads;
  EqmWork work;
  PetscReal total_seconds, phase_seconds[EQM_NUM_PHASES], event_seconds[EQM_NUM_EVENTS];
  PetscInt64 memory_max_per_rank, memory_total; /* peak, in bytes */
} EqmMapCost;

/* ---- life */

/* EqmMapCreate - a map of the mesh `soup`, which must outlive it, with `dim` (2 or 3) coordinates per vertex;
   coordinates and ratios are zero. Collective. Errors: PETSC_ERR_ARG_OUTOFRANGE. */
PETSC_EXTERN PetscErrorCode EqmMapCreate(EqmSoup soup, PetscInt dim, EqmMap *map);
/* EqmMapDestroy - free a map and set it to NULL; nothing happens if it is NULL. Collective. */
PETSC_EXTERN PetscErrorCode EqmMapDestroy(EqmMap *map);
/* EqmMapOntoInput - bring the map of a repaired or prepared mesh back onto the input that it was made of.

   Collective. parent - per cell of the repaired soup's slab, the input cell it comes from, -1 for an added one; vertex
   - per vertex of the input's slab, the vertex of the repaired soup that stands for it, NULL: that of the same number;
   cell_weight - per cell of the repaired slab, its weight w, in any unit; map - the new map, of `input`. The input's
   vertices get the images and vertex ratios of those that stand for them, an input cell the weighted mean of the ratios
   of its children, 1 if it has none. Vertices that no cell uses stay at zero. Distortion, history and cost are those of
   the repaired map. `repaired` and `parent` are referenced, are written into a result file, and must outlive `map`. */
PETSC_EXTERN PetscErrorCode EqmMapOntoInput(EqmMap repaired, EqmSoup input, const PetscInt *parent,
                                            const PetscInt *vertex, const PetscReal *cell_weight, EqmMap *map);
/* EqmMapAddPrepared - note a step of the preparation that changed the input: `count` things, and `what` in words, for
   the summary's list `prepared` and the result file's attribute of that name. Not collective. */
PETSC_EXTERN PetscErrorCode EqmMapAddPrepared(EqmMap map, const char *step, PetscInt64 count, const char *what);
/* EqmMapRead - read the map of the mesh `soup` from a file: a result (.h5, /map/coordinates), a mesh of any format
   whose vertices are the images (or, if they repeat the mesh, its texture coordinates), a CSV or NPY file with two or
   three coordinates per vertex; with one z everywhere it is a planar map. Ratios and distortion stay zero until
   EqmMapMeasure. Collective. Errors: EQM_ERR_IO, EQM_ERR_MESH (the vertex counts differ). */
PETSC_EXTERN PetscErrorCode EqmMapRead(EqmSoup soup, const char *file, EqmMap *map);
/* EqmMapRestoreUnit - the map's mesh was brought into range (EqmSoupBringIntoRange): its coordinates and measure in the
   file's unit again. What was made of the mesh, such as an EqmMesh, keeps its own. Not collective. */
PETSC_EXTERN PetscErrorCode EqmMapRestoreUnit(EqmMap map, PetscInt exponent);
/* EqmMapMeasure - compute distortion, ratios and folds of `map` from coordinates alone.

   Collective. mesh - the distributed mesh made of the map's soup; x - the images of its local vertices, ghosts
   included, dim reals each. Fills everything that EqmMapGetDistortion, EqmMapGetRatios, EqmMapGetQuasiConformal and
   EqmMapGetConformalFactor return. Images of cells are flat triangles and tetrahedra; of a mirrored map the signs are
   turned first. With r = (a/w)(W/A) the energy is A sum (w/W)(r - 1)^2, which is the normalised authalic energy of
   [000] and [001] and the isovolumetric energy of [003 (2)]; angle errors and quasi-conformal distortion are those of
   the affine map of each triangle. */
PETSC_EXTERN PetscErrorCode EqmMapMeasure(EqmMap map, EqmMesh mesh, const PetscReal *x);

/* ---- what a map holds */

/* The mesh that the map belongs to, and its coordinates per vertex. */
PETSC_EXTERN PetscErrorCode EqmMapGetSoup(EqmMap map, EqmSoup *soup);
PETSC_EXTERN PetscErrorCode EqmMapGetDimension(EqmMap map, PetscInt *dim);
/* The images: dim reals per vertex of the slab; may be written to. */
PETSC_EXTERN PetscErrorCode EqmMapGetCoordinates(EqmMap map, PetscReal **coordinates);
/* Ratios r = (share of the image's measure) / (share of the mesh's measure): one per cell of the slab, and one per
   vertex of the slab, the mean over the cells around it weighted by their measure. Either pointer may be NULL. */
PETSC_EXTERN PetscErrorCode EqmMapGetRatios(EqmMap map, const PetscReal **per_cell, const PetscReal **per_vertex);
/* Surfaces only, NULL for solids: per cell of the slab the ratio of the two singular values of the triangle's affine
   map, at least 1; per vertex of the slab log(share of the image's area / share of the surface's area) of the cells
   around. */
PETSC_EXTERN PetscErrorCode EqmMapGetQuasiConformal(EqmMap map, const PetscReal **per_cell);
PETSC_EXTERN PetscErrorCode EqmMapGetConformalFactor(EqmMap map, const PetscReal **per_vertex);
/* Figures of the whole map, the same on every rank. */
PETSC_EXTERN PetscErrorCode EqmMapGetDistortion(EqmMap map, const EqmDistortion **distortion);
/* Maps to the ball: triangles of the boundary that face inward. */
PETSC_EXTERN PetscErrorCode EqmMapGetBoundaryFolds(EqmMap map, PetscInt64 *folds);
/* The energy of the first map and of the last; of `conformal` the Dirichlet energy. Either pointer may be NULL. */
PETSC_EXTERN PetscErrorCode EqmMapGetEnergies(EqmMap map, PetscReal *initial, PetscReal *final);
PETSC_EXTERN PetscErrorCode EqmMapSetEnergies(EqmMap map, PetscReal initial, PetscReal final);
/* One row per iteration, the same on every rank; `num_rows` is 0 for a map that was read. */
PETSC_EXTERN PetscErrorCode EqmMapGetHistory(EqmMap map, PetscInt *num_rows, const EqmHistoryRow **rows);
/* How the run ended, as a status and in words; `message` may be NULL. */
PETSC_EXTERN PetscErrorCode EqmMapGetStatus(EqmMap map, EqmStatus *status, const char **message);
PETSC_EXTERN PetscErrorCode EqmMapSetStatus(EqmMap map, EqmStatus status, const char *message);
/* The target or command, the method, and what solved with matrices. Each pointer may be NULL. */
PETSC_EXTERN PetscErrorCode EqmMapGetProvenance(EqmMap map, const char **command, const char **method,
                                                const char **linear_solver);
PETSC_EXTERN PetscErrorCode EqmMapSetCommand(EqmMap map, const char *command);
/* What the run took so far; EqmMapSetCost takes threads, seconds and memory from the ledger and the system
   (collective). The work is that of the map's history. */
PETSC_EXTERN PetscErrorCode EqmMapGetCost(EqmMap map, const EqmMapCost **cost);
PETSC_EXTERN PetscErrorCode EqmMapSetCost(EqmMap map, EqmLedger ledger);
/* The smallest eigenvalues of the Hessian at the result, ascending; `num` is 0 where they were not computed. */
PETSC_EXTERN PetscErrorCode EqmMapGetHessianEigenvalues(EqmMap map, PetscInt *num, const PetscReal **values);
PETSC_EXTERN PetscErrorCode EqmMapSetHessianEigenvalues(EqmMap map, PetscInt num, const PetscReal *values);

/* ---- what a program adds to a result file and to the summary */

/* Add an array to the result file. The map takes `values` over, which must be PetscMalloc'ed and holds
   count * max(1, width) entries. path - in the result file; total - rows of all ranks; start, count - this rank's rows;
   width - entries per row, 0 makes the array one-dimensional. */
PETSC_EXTERN PetscErrorCode EqmMapAddReals(EqmMap map, const char *path, PetscInt total, PetscInt start, PetscInt count,
                                           PetscInt width, PetscReal *values);
PETSC_EXTERN PetscErrorCode EqmMapAddIntegers(EqmMap map, const char *path, PetscInt total, PetscInt start,
                                              PetscInt count, PetscInt width, PetscInt64 *values);
/* Add a real number, a count or a text to the result file's attributes and to the summary, the same on every rank. Dots
   in a key make groups in the summary: "landmarks.error.max". */
PETSC_EXTERN PetscErrorCode EqmMapAddFigure(EqmMap map, const char *key, PetscReal value);
PETSC_EXTERN PetscErrorCode EqmMapAddCount(EqmMap map, const char *key, PetscInt64 value);
PETSC_EXTERN PetscErrorCode EqmMapAddText(EqmMap map, const char *key, const char *text);

/* ---- files */

/* EqmMapWrite - write a result to every name in the comma-separated `files`, the format by suffix. .h5 holds everything
   and gets .xmf files for ParaView beside it; the mesh formats hold the mesh with its vertices at their images (z = 0
   for planar maps) and, where the format can, the fields; NAME.vtu gets NAME.surface.vtu beside it, which holds the
   input mesh with the map as fields. Each file appears whole or not at all, and one that was there survives a failure.
   Collective. Errors: EQM_ERR_USAGE (unknown suffix; then nothing is written), EQM_ERR_IO. */
PETSC_EXTERN PetscErrorCode EqmMapWrite(EqmMap map, const char *files);
/* EqmMapSetImageScale - mesh formats get the images multiplied by this factor (default 1), result files as they are.
   Not collective. Errors: EQM_ERR_USAGE (not positive and finite). */
PETSC_EXTERN PetscErrorCode EqmMapSetImageScale(EqmMap map, PetscReal scale);
/* EqmMapWriteTexture - write the surface itself with its map as texture coordinates, to OBJ or PLY.

   Collective. The unit disk goes to the square [0, 1]^2 by (1 + x)/2, the unit square is the texture as it is; a point
   of the sphere has its longitude and latitude, each in [0, 1], and triangles that the seam runs through have corners
   beyond 1. Errors: EQM_ERR_USAGE (another format, a solid), EQM_ERR_IO. */
PETSC_EXTERN PetscErrorCode EqmMapWriteTexture(EqmMap map, const char *file);
/* EqmMapCheckWritable - can `files` be written? For before a long run. Suffixes must be known, directories there and
   writable. Collective. Errors: EQM_ERR_USAGE, EQM_ERR_IO. */
PETSC_EXTERN PetscErrorCode EqmMapCheckWritable(MPI_Comm comm, const char *files);
/* EqmMapWriteSummary - the figures of a run as JSON. Collective; rank 0 writes. Errors: EQM_ERR_IO. */
PETSC_EXTERN PetscErrorCode EqmMapWriteSummary(EqmMap map, const char *file);
/* EqmMapViewRatios - print the lines of a table on how far the ratios are from one: weighted by
   measure first, then over cells, and what slivers add. Collective; rank 0 prints. */
PETSC_EXTERN PetscErrorCode EqmMapViewRatios(EqmMap map);
/* EqmMapWriteHistory - a row per iteration as CSV with a header, all digits. Collective; rank 0 writes. Errors:
   EQM_ERR_IO. */
PETSC_EXTERN PetscErrorCode EqmMapWriteHistory(EqmMap map, const char *file);
/* EqmMapWriteHistogram - the histogram of angle errors as CSV: from, to (degrees), corners. Collective; rank 0 writes.
   Errors: EQM_ERR_IO. */
PETSC_EXTERN PetscErrorCode EqmMapWriteHistogram(EqmMap map, const char *file);
/* EqmMapWriteRatioHistogram - the histogram of the ratios as CSV: from, to, cells, share (of the mesh's measure). The
   first bin begins at the smallest ratio, the last ends at the largest. Collective; rank 0 writes. Errors: EQM_ERR_IO.
 */
PETSC_EXTERN PetscErrorCode EqmMapWriteRatioHistogram(EqmMap map, const char *file);

#endif
