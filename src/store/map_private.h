/* What a map consists of. */
#ifndef EQM_MAP_PRIVATE_H
#define EQM_MAP_PRIVATE_H

#include <equimap/map.h>

/* An array that belongs to a result: rows dealt to the ranks in contiguous slabs. */
typedef struct {
  char path[128];               /* in the result file */
  PetscInt total, start, count; /* rows of all ranks, this rank's first, this rank's */
  PetscInt width;               /* entries per row; 0 makes the array one-dimensional */
  PetscBool is_real;
  PetscReal *reals;
  PetscInt64 *integers;
} EqmMapArray;

typedef enum { EQM_FIGURE_REAL, EQM_FIGURE_COUNT, EQM_FIGURE_TEXT } EqmFigureKind;

/* A number or a text that belongs to a result. */
typedef struct {
  char key[96]; /* dots make groups in the summary: "landmarks.error.max" */
  EqmFigureKind kind;
  PetscReal real;
  PetscInt64 count;
  char text[PETSC_MAX_PATH_LEN];
} EqmMapFigure;

/* A step of the preparation that changed the input. */
typedef struct {
  char step[32], what[192];
  PetscInt64 count;
} EqmPreparedFigure;

struct _p_EqmMap {
  EqmSoup soup;                /* the input mesh; referenced, not owned */
  PetscInt dim;                /* coordinates per vertex: 2 or 3 */
  PetscBool in_space;          /* triangles lie on a surface in space, not on the sphere: areas have no sign */
  PetscReal *coordinates;      /* dim per vertex of the slab */
  PetscReal *cell_ratio;       /* r per cell of the slab */
  PetscReal *vertex_ratio;     /* mean of r over the cells around a vertex, weighted by w; per vertex of the slab */
  PetscReal *quasi_conformal;  /* ratio of singular values per cell of the slab; NULL for solids */
  PetscReal *conformal_factor; /* log (share of the image's area / share of the surface's) of the cells around a vertex,
                                  per vertex of the slab; NULL for solids */
  EqmDistortion distortion;
  PetscReal energy_initial, energy_final;
  PetscInt iterations, num_history;
  EqmHistoryRow *history; /* num_history rows, the same on every rank */
  EqmStatus status;
  PetscBool poor;                /* not converged, and far from equal areas */
  char message[EQM_MESSAGE_MAX]; /* how the run ended, in words */
  char command[64], method[64];
  char linear_solver[EQM_LINEAR_TEXT]; /* what solved with matrices, and what it took */
  EqmMapCost cost;
  PetscInt64 num_boundary_vertices;
  PetscInt64 boundary_folds;        /* maps to the ball: triangles of the boundary that face inward */
  PetscInt num_hessian_eigenvalues; /* where they were computed: the smallest of the Hessian at the result */
  PetscReal *hessian_eigenvalues;
  EqmMap repaired;        /* where the input was repaired first: the map of the repaired mesh; referenced, not owned */
  const PetscInt *parent; /* with `repaired`: per cell of its soup's slab the input cell it comes from; referenced */
  EqmRepair repair;       /* with `repaired`: what was done */
  PetscReal image_scale;  /* of the images in mesh formats */
  PetscInt num_prepared;  /* what was done to the input before that */
  EqmPreparedFigure *prepared;
  PetscInt num_arrays, num_figures; /* what a program adds to the result */
  EqmMapArray *arrays;
  EqmMapFigure *figures;
};

/* Where the input has faces of more than three corners: /polygon/ratio, the ratio of each of its faces. Collective. */
PETSC_INTERN PetscErrorCode EqmMapAddPolygons(EqmMap map);

#endif
