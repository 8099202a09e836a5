/* Sparse matrices of meshes and what solves with them. */
#ifndef EQM_LINALG_H
#define EQM_LINALG_H

#include <petscmat.h>
#include <equimap/mesh.h>

/* Rows of a matrix, or vertices of a mesh, that may be gathered on one rank of several. */
enum { EQM_MOST_ON_ONE_RANK = 1000000 };

/* ---- unknowns: how many each vertex has and where they stand in the global vector */
typedef struct {
  PetscInt num_owned;         /* unknowns of this rank */
  PetscInt first;             /* global number of the first */
  const PetscInt *start;      /* per local vertex: global number of its first unknown */
  const unsigned char *count; /* per local vertex */
} EqmUnknowns;

/* ---- assembly */
/* Fill the dense symmetric matrix of one cell, row by row over the unknowns of its corners in order. Called by several
   threads at once, for different cells. */
typedef void (*EqmCellMatrix)(void *context, PetscInt cell, PetscReal *matrix);
enum { EQM_MOST_CELL_UNKNOWNS = 12 };

/* Direct solvers take the lower triangle, multigrid needs both. */
typedef enum { EQM_STORE_LOWER, EQM_STORE_FULL } EqmStorage;

typedef struct _p_EqmAssembly *EqmAssembly;
PETSC_INTERN PetscErrorCode EqmAssemblyCreate(EqmMesh mesh, const EqmUnknowns *unknowns, EqmStorage storage,
                                              EqmAssembly *assembly);
PETSC_INTERN PetscErrorCode EqmAssemblyDestroy(EqmAssembly *assembly);
PETSC_INTERN PetscErrorCode EqmAssemblyFill(EqmAssembly assembly, EqmCellMatrix cell_matrix, void *context);
PETSC_INTERN PetscErrorCode EqmAssemblyGetMat(EqmAssembly assembly, Mat *matrix);

/* The two sequential blocks of a matrix, as compressed rows with their values. */
typedef struct {
  Mat block[2]; /* columns of this rank, columns of others; the second NULL on one rank */
  const PetscInt *global_column, *start[2], *column[2];
  PetscInt num_global_columns; /* global_column: of the second block's columns, ascending */
  PetscScalar *value[2];
} EqmBlocks;
PETSC_INTERN PetscErrorCode EqmBlocksGet(Mat matrix, EqmBlocks *blocks);
PETSC_INTERN PetscErrorCode EqmBlocksRestore(EqmBlocks *blocks);

/* ---- fill-reducing order of the vertices, by METIS, made once for a mesh and shared by all its matrices */
typedef struct _p_EqmOrdering *EqmOrdering;
PETSC_INTERN PetscErrorCode EqmOrderingCreate(EqmMesh mesh, EqmOrdering *ordering);
PETSC_INTERN PetscErrorCode EqmOrderingDestroy(EqmOrdering *ordering);
/* On rank 0 (NULL elsewhere): position of every unknown in the elimination, global numbering; PetscFree it. Collective.
 */
PETSC_INTERN PetscErrorCode EqmOrderingOfUnknowns(EqmOrdering ordering, const EqmUnknowns *unknowns,
                                                  PetscInt **position);

/* How the ranks' shares of the mesh fall apart: without the separators no cell has vertices of two ranks. */
typedef struct {
  PetscInt num_inner, *inner;       /* owned vertices that are no separators, in elimination order */
  PetscInt num_separators, *vertex; /* separators among the local vertices, ghosts too, by global number */
  PetscInt *span;                   /* per separator: lowest and highest rank that sees it */
  PetscInt *links;                  /* per owned separator: separators that share a cell with it, itself included */
} EqmSeparation;
/* Made at the first call and kept by the ordering. Collective. */
PETSC_INTERN PetscErrorCode EqmOrderingGetSeparation(EqmOrdering ordering, const EqmSeparation **separation);
PETSC_INTERN PetscErrorCode EqmSeparationCreate(EqmMesh mesh, EqmSeparation **separation);
PETSC_INTERN PetscErrorCode EqmSeparationDestroy(EqmSeparation **separation);

/* ---- solvers */
typedef enum {
  EQM_SOLVER_AUTO,
  EQM_SOLVER_CHOLMOD,
  EQM_SOLVER_MULTIFRONTAL,
  EQM_SOLVER_SUBSTRUCTURE,
  EQM_SOLVER_MUMPS,
  EQM_SOLVER_MULTIGRID,
  EQM_SOLVER_PETSC,
  EQM_SOLVER_HIERARCHY
} EqmSolverKind;
PETSC_INTERN const char *const EqmSolverKinds[];

/* Of the factors of EQM_MATRIX_STEP; all others are double. Auto: single where that saves time. */
typedef enum { EQM_PRECISION_AUTO, EQM_PRECISION_SINGLE, EQM_PRECISION_DOUBLE } EqmPrecision;
PETSC_INTERN const char *const EqmPrecisions[];

/* What a factorisation takes, known before there are numbers; zero for multigrid and PETSc's solvers. */
typedef struct {
  PetscReal nonzeros, flops; /* of the factor, all ranks together */
  PetscReal bytes_on_rank;   /* on this rank at most at once: factor, fronts and work space, not the matrix itself */
  PetscReal most_bytes_on_rank, bytes; /* of the rank that needs most; of all */
  PetscInt largest_front;              /* substructuring: unknowns of the largest dense matrix */
  PetscInt largest_front_on_one;       /* of the largest that one rank has alone */
  PetscInt front_ranks;                /* ranks that share one, at most */
} EqmEstimate;
/* Bytes that this rank may use for factors. Option: -memory_limit. Collective. */
PETSC_INTERN PetscErrorCode EqmMemoryLimit(MPI_Comm comm, PetscReal *bytes);

/* What a matrix is for, which decides between a factor and multigrid. */
typedef enum {
  EQM_MATRIX_SCALAR,  /* one unknown per vertex, easy for multigrid */
  EQM_MATRIX_COUPLED, /* several, hard for multigrid: factored wherever that fits */
  EQM_MATRIX_STEP,    /* the same; solutions are steps to try, for which factors in single precision will do */
  EQM_MATRIX_METRIC   /* several, only applied, where one cycle will do as well; stiff where a barrier is in it */
} EqmMatrixUse;

/* A solver for one symmetric positive definite matrix whose values change and whose pattern stays. */
typedef struct _p_EqmLinear *EqmLinear;
struct _p_EqmLinear {
  EqmMesh mesh;
  EqmSolverKind kind;
  EqmMatrixUse use;
  PetscInt num_owned, num_unknowns;
  EqmUnknowns unknowns;
  EqmUnknowns rows;     /* of the matrix: the unknowns, unless the kind wants others */
  EqmAssembly assembly; /* NULL: the kind assembles by itself */
  PetscReal diagonal_factor;
  EqmCellMatrix cell_matrix, padded_cell; /* the caller's, during a filling; the kind's own over it, or NULL */
  void *context;
  PetscBool is_single; /* factors are kept in single precision, where the kind has a choice */
  PetscBool inexact;   /* an iteration may stop early */
  PetscReal tolerance; /* of an iteration: residual over right-hand side, if inexact in the energy norm */
  PetscBool keeps_coarse_spaces;
  PetscInt num_fields;
  EqmEstimate estimate;
  void *data;
  PetscErrorCode (*analyse)(EqmLinear, EqmOrdering);
  PetscErrorCode (*factor)(EqmLinear, PetscBool *success);
  PetscErrorCode (*set_fields)(EqmLinear, PetscInt count, const PetscReal *fields);                 /* may be NULL */
  PetscErrorCode (*set_image)(EqmLinear, PetscInt dim, const PetscReal *x, const PetscReal *frame); /* may be NULL */
  PetscErrorCode (*solve)(EqmLinear, PetscInt num_rhs, const PetscReal *b, PetscReal *x, PetscBool *success);
  PetscErrorCode (*apply)(EqmLinear, PetscInt num_rhs, const PetscReal *b, PetscReal *x); /* NULL: solve */
  PetscErrorCode (*destroy)(EqmLinear);
};

/* List the options of linear solvers, with help: -linear_solver, -linear_shared_front, -linear_precision,
   -linear_gather, -memory_limit. */
PETSC_INTERN PetscErrorCode EqmLinearHelpOptions(PetscOptionItems *PetscOptionsObject);
/* Fronts of more unknowns are shared between ranks. Option: -linear_shared_front. Collective. Errors: EQM_ERR_USAGE. */
PETSC_INTERN PetscErrorCode EqmLinearGetSharedFront(MPI_Comm comm, PetscInt *unknowns);
/* Copy these options to an inner run, which has a database of its own. */
PETSC_INTERN PetscErrorCode EqmLinearPassOptions(PetscOptions options);
/* Until EqmOptionsPopDefaults, options that are not given have the values of `defaults` (pairs of name and value). The
   caller's database is not written to; what has been used meanwhile counts as used there, too. Collective. */
PETSC_INTERN PetscErrorCode EqmOptionsPushDefaults(const char *const defaults[][2], PetscInt count,
                                                   PetscOptions *options);
PETSC_INTERN PetscErrorCode EqmOptionsPopDefaults(PetscOptions *options);
PETSC_INTERN PetscErrorCode EqmLinearCreate(EqmMesh mesh, EqmOrdering ordering, const EqmUnknowns *unknowns,
                                            EqmMatrixUse use, EqmLinear *linear);
/* What -linear_solver says. Collective. */
PETSC_INTERN PetscErrorCode EqmLinearWantedKind(EqmSolverKind *kind);
/* A solver of no kind yet, for the functions that create one. Collective. */
PETSC_INTERN PetscErrorCode EqmLinearBegin(EqmMesh mesh, const EqmUnknowns *unknowns, EqmMatrixUse use,
                                           EqmLinear *linear);
PETSC_INTERN PetscErrorCode EqmLinearDescribe(EqmLinear linear, char *text, size_t length);
PETSC_INTERN PetscErrorCode EqmLinearDestroy(EqmLinear *linear);
PETSC_INTERN PetscErrorCode EqmLinearFactor(EqmLinear linear, EqmCellMatrix cell_matrix, void *context,
                                            PetscReal diagonal_factor, PetscBool *success);
PETSC_INTERN PetscErrorCode EqmLinearSolve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x);
PETSC_INTERN PetscErrorCode EqmLinearTrySolve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x,
                                              PetscBool *success);
PETSC_INTERN PetscErrorCode EqmLinearApply(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x);
PETSC_INTERN PetscErrorCode EqmLinearSolveStep(EqmLinear linear, PetscReal *x);
PETSC_INTERN PetscErrorCode EqmLinearSetInexact(EqmLinear linear, PetscReal tolerance);
PETSC_INTERN PetscErrorCode EqmLinearSetExact(EqmLinear linear);
PETSC_INTERN PetscErrorCode EqmLinearKeepCoarseSpaces(EqmLinear linear, PetscBool keep);
PETSC_INTERN PetscBool EqmLinearHasCoarseSpaces(EqmLinear linear);
PETSC_INTERN PetscErrorCode EqmLinearSetFields(EqmLinear linear, PetscInt count, const PetscReal *fields);
/* The map whose motions the unknowns are: `dim` coordinates per owned vertex, and `frame`, 2 dim: the directions of its
   unknowns, orthonormal; NULL in the plane, where they follow from the place. For the factorisations to come; kinds
   that need no image leave it alone. Collective. */
PETSC_INTERN PetscErrorCode EqmLinearSetImage(EqmLinear linear, PetscInt dim, const PetscReal *x,
                                              const PetscReal *frame);

/* The kinds fill in the operations. */
PETSC_INTERN PetscErrorCode EqmLinearSetUpCholmod(EqmLinear linear);
PETSC_INTERN PetscErrorCode EqmLinearSetUpMultifrontal(EqmLinear linear);
PETSC_INTERN PetscErrorCode EqmLinearSetUpSubstructure(EqmLinear linear);
PETSC_INTERN PetscErrorCode EqmLinearSetUpMumps(EqmLinear linear);
PETSC_INTERN PetscErrorCode EqmLinearSetUpMultigrid(EqmLinear linear);
PETSC_INTERN PetscErrorCode EqmLinearSetUpPetsc(EqmLinear linear);

/* ---- square matrices that are not positive definite (general.c) */
typedef struct _p_EqmGeneral *EqmGeneral;
/* `symmetric`: L D L^T with pivots, else L U; `coupled`: counts as a coupled factorisation. The arrays of `unknowns`
   must outlive it. Collective. */
PETSC_INTERN PetscErrorCode EqmGeneralCreate(EqmMesh mesh, const EqmUnknowns *unknowns, PetscBool symmetric,
                                             PetscBool coupled, EqmGeneral *general);
PETSC_INTERN PetscErrorCode EqmGeneralDestroy(EqmGeneral *general);
/* Assemble the cells' matrices (here they may be unsymmetric), add `shift` to the diagonal and factor. `success` is
   false on every rank if the matrix is singular. Counts a factorisation. Collective. */
PETSC_INTERN PetscErrorCode EqmGeneralFactor(EqmGeneral general, EqmCellMatrix cell_matrix, void *context,
                                             PetscReal shift, PetscBool *success);
/* Solve in place for right-hand sides that are stored one after the other. Collective. */
PETSC_INTERN PetscErrorCode EqmGeneralSolve(EqmGeneral general, PetscInt num_rhs, PetscReal *columns);

/* LU of a matrix that is not symmetric; up to so many rows sequential, and the same in every run (lu.c). */
typedef struct _p_EqmLu *EqmLu;
PETSC_INTERN PetscErrorCode EqmLuCreate(Mat matrix, const char *prefix, EqmLu *lu);
PETSC_INTERN PetscErrorCode EqmLuDestroy(EqmLu *lu);
PETSC_INTERN PetscErrorCode EqmLuRefresh(EqmLu lu);
PETSC_INTERN PetscErrorCode EqmLuSolve(EqmLu lu, Vec b, Vec x);

#endif
