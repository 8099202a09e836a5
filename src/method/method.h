/* What the loop and the methods know of each other. */
#ifndef EQM_METHOD_H
#define EQM_METHOD_H

#include <equimap/solver.h>
#include "energy/cellframe.h"
#include "linalg/linalg.h"
#include "method/landmarks.h"
#include "method/problem.h"
#include "method/objective.h"
#include "method/checkpoint.h"
#include "method/state.h"

/* A barrier against folds of maps to the ball (src/unfold/barrier.c). */
typedef struct _p_EqmBarrier *EqmBarrier;

/* What a step came to. */
typedef enum {
  EQM_STEP_TAKEN,
  EQM_STEP_CONVERGED, /* the method's own test is met */
  EQM_STEP_STALLED    /* no step decreases the function any more */
} EqmStep;

/* A method: one file; problem.c says which problems offer it. */
struct EqmMethod {
  const char *name, *purpose;
  PetscErrorCode (*options)(EqmSolver, PetscOptionItems *); /* may be NULL */
  PetscErrorCode (*set_up)(EqmSolver);                      /* solver->place holds the start */
  PetscErrorCode (*step)(EqmSolver, EqmStep *); /* leaves place, image, step_length, gradient_norm, objective */
  PetscErrorCode (*state)(EqmSolver, EqmState); /* what a checkpoint must hold beside the map: state.h; may be NULL */
  PetscErrorCode (*destroy)(EqmSolver);
  PetscBool takes_landmarks;
};

typedef struct {
  char method[32], start[32];
  PetscInt max_it, max_factorizations, start_steps;
  PetscReal energy_rtol, ratio_tol, energy_target, gradient_tol, wall_time, balance;
  PetscInt stagnation; /* iterations over which energy_rtol is looked at */
  PetscBool quiet, has_corners, center_start;
  PetscInt corners[4];
  char checkpoint[PETSC_MAX_PATH_LEN], restart[PETSC_MAX_PATH_LEN]; /* empty: none */
  PetscInt checkpoint_every;                                        /* iterations; 0: only at the end */
  PetscInt lm_inner;                                                /* lm: quasi-Newton steps on a factor */
  /* ncg */
  PetscInt ncg_refresh;
  PetscEnum ncg_beta; /* an EqmNcgBeta */
  PetscBool ncg_guard;
  /* ball */
  PetscBool anisotropic_scaling;
  char boundary_method[32], boundary_start[32]; /* of the map of the surface to the sphere; empty: the sphere's own */
  PetscInt boundary_max_it;                     /* -1: the method's own */
  /* lbfgs, rgd */
  PetscInt lbfgs_refresh, lbfgs_memory;
  PetscEnum lbfgs_line_search; /* an EqmLbfgsLineSearch */
  PetscEnum rgd_line_search;   /* an EqmRgdLineSearch */
  /* conformal: the Mobius map at the end */
  PetscEnum moebius;
  PetscBool has_fix, align_rigid;
  PetscInt fix[3];
  PetscReal fix_points[9];
  char align[PETSC_MAX_PATH_LEN];
  /* euler-explicit, euler-implicit, qiem */
  PetscReal flow_step, flow_tol;
  PetscBool flow_moebius;
  char qiem_phase1[8], qiem_phase2[8]; /* letters of the strategies in use */
  PetscReal qiem_factor, qiem_rise;
} EqmSettings;

struct _p_EqmSolver {
  MPI_Comm comm;
  EqmMesh mesh;
  EqmDomain domain;
  EqmOrdering ordering;
  EqmLinear scalar; /* one unknown per vertex: Laplacians of all kinds */
  unsigned char *scalar_count;
  PetscBool holds_fixed_metric; /* `scalar` has the factor of the objective's fixed metric */
  char target[16];
  EqmSettings settings;
  const EqmProblem *problem;
  const EqmMethod *method;
  void *data; /* the method's own */

  PetscReal *first_map; /* given from outside, first_map_dim per owned vertex; NULL: -start makes it */
  PetscInt first_map_dim;
  EqmLandmarks landmarks;

  EqmPlace place;                         /* the present map */
  PetscReal *image;                       /* its image measures, per local cell */
  PetscReal *angle_weights, *vertex_mass; /* of EqmAngleWeights and EqmVertexMass; NULL until the first need */
  EqmImageTotals totals;                  /* and their sums */
  PetscInt iteration;
  PetscReal step_length, gradient_norm;
  PetscReal objective;   /* what the method minimises; convergence is judged by it */
  PetscReal *objectives; /* of every iteration, num_history long */
  EqmHistoryRow *history;
  PetscInt num_history, most_history;
  PetscReal last_shown;                  /* seconds when the last row was printed */
  PetscInt rows_shown;                   /* num_history at that time */
  PetscInt64 unfolded_from, unfolded_to; /* folds before and after the last unfolding; 0, 0: none was needed */
  EqmBarrier barrier;                    /* ball: added to the energy while folds are mended; else NULL */
  EqmStatus status;
  char message[EQM_MESSAGE_MAX];
  char linear_solver[EQM_LINEAR_TEXT]; /* what solves with the method's matrices */
  EqmCheckpoints checkpoints;
};

/* The domain's degrees of freedom as unknowns of a matrix; the arrays are the domain's. Not collective. */
static inline EqmUnknowns EqmDomainUnknowns(EqmDomain domain)
{
  return (EqmUnknowns){.num_owned = domain->num_dofs,
                       .first = domain->dof_first,
                       .start = domain->dof_start,
                       .count = domain->dof_count};
}

/* ---- matrices of all degrees of freedom (coupled.c) */
PETSC_INTERN PetscErrorCode EqmSolverCreateLinear(EqmSolver solver, EqmMatrixUse use, EqmLinear *linear);
PETSC_INTERN PetscErrorCode EqmSolverSetFields(EqmSolver solver, const EqmPlace *place, EqmLinear linear,
                                               PetscInt count,
                                               void (*field)(PetscInt which, const PetscReal *x, PetscReal *velocity));

PETSC_INTERN const EqmMethod EqmMethodFixedPoint, EqmMethodNcg, EqmMethodLbfgs, EqmMethodRgd, EqmMethodLm,
    EqmMethodRiemann, EqmMethodCovering, EqmMethodQiem, EqmMethodEulerExplicit, EqmMethodEulerImplicit, EqmMethodNewton;
typedef enum { EQM_SEARCH_ARMIJO, EQM_SEARCH_WOLFE } EqmLbfgsLineSearch;
/* lbfgs, once set up, begins anew at the present map, whose objective may have changed: without its pairs, with a
   metric from here. Collective. */
PETSC_INTERN PetscErrorCode EqmLbfgsRestart(EqmSolver solver);
PETSC_INTERN PetscErrorCode EqmSettingsDefault(EqmSettings *settings);

/* Domain, ordering, first map. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverBegin(EqmSolver solver);
/* Refresh solver->image and solver->totals from solver->place. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverLook(EqmSolver solver);
/* Refresh solver->totals, where solver->image is up to date already. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverSum(EqmSolver solver);
/* A trial becomes the present map: its place, image and value, and the length of the step to it. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverAccept(EqmSolver solver, const EqmPlace *trial, const PetscReal *image,
                                            PetscReal objective, PetscReal step_length);
/* What was given from outside: first map, landmarks. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverTakeGiven(EqmSolver solver);
/* Refuse landmarks for a method that has no use for them. Errors: EQM_ERR_USAGE. */
PETSC_INTERN PetscErrorCode EqmSolverCheckDraws(EqmSolver solver);
PETSC_INTERN PetscErrorCode EqmSolverLandmarksReached(EqmSolver solver, PetscBool *reached);
PETSC_INTERN PetscErrorCode EqmMonitorBegin(EqmSolver solver);
PETSC_INTERN PetscErrorCode EqmMonitorReserve(EqmSolver solver, PetscInt rows);
PETSC_INTERN PetscErrorCode EqmMonitorRow(EqmSolver solver);
PETSC_INTERN PetscErrorCode EqmMonitorEnd(EqmSolver solver);
PETSC_INTERN PetscErrorCode EqmMonitorUnfolded(EqmSolver solver, const char *when);

/* ---- scalar Laplacians on groups of vertices (src/start/dirichlet.c) */
enum { EQM_GROUP_FIXED = -1 };
/* Factor the Laplacian with the given weights (per local cell and edge), restricted to groups: entries between vertices
   of different groups are dropped, rows of fixed vertices are identities. `group` per local vertex; `mass` per local
   cell or NULL goes to the diagonal. Collective. */
PETSC_INTERN PetscErrorCode EqmGroupFactor(EqmSolver solver, const PetscReal *weights, const signed char *group,
                                           const PetscReal *mass);
/* Solve with the factored Laplacian; columns of num_owned each. Collective. */
PETSC_INTERN PetscErrorCode EqmGroupSolve(EqmSolver solver, PetscInt num_rhs, PetscReal *columns);
/* The same as a metric needs it: the factor, or one multigrid cycle (EqmLinearApply). Collective. */
PETSC_INTERN PetscErrorCode EqmGroupApply(EqmSolver solver, PetscInt num_rhs, PetscReal *columns);
/* Solve L z = 0 on the vertices that are not held, in `width` columns: z (per local vertex, `width` each) holds the
   held values on entry, all values on return. Counts a factorisation. Collective. */
PETSC_INTERN PetscErrorCode EqmHeldSolve(EqmSolver solver, const PetscReal *weights, const signed char *group,
                                         PetscInt width, PetscReal *z);
/* The same once EqmGroupFactor has factored these weights and groups. Collective. */
PETSC_INTERN PetscErrorCode EqmHeldExtend(EqmSolver solver, const PetscReal *weights, const signed char *group,
                                          PetscInt width, PetscReal *z);
/* Bring z nearer to that solution, from the values that it has: where the solver is an iteration, until the error is
   down to `tolerance` of what it was (energy norm); an exact factor solves. Factors. Collective. */
PETSC_INTERN PetscErrorCode EqmHeldImprove(EqmSolver solver, const PetscReal *weights, const signed char *group,
                                           PetscInt width, PetscReal tolerance, PetscReal *z);
/* Planar: coordinates that are free of constraint solve L x = 0 with all others held: the discrete harmonic map for
   `weights`. `to` gets the result; ghosts up to date. Collective. */
PETSC_INTERN PetscErrorCode EqmHarmonicMap(EqmSolver solver, const PetscReal *weights, const EqmPlace *from,
                                           EqmPlace *to);

/* ---- the Laplacian metric (src/method/metric.c): turns gradients of the objective into directions */
typedef struct _p_EqmMetric *EqmMetric;
PETSC_INTERN PetscErrorCode EqmMetricCreate(EqmSolver solver, EqmMetric *metric);
PETSC_INTERN PetscErrorCode EqmMetricDestroy(EqmMetric *metric);
/* Take the Laplacian that suits the problem's objective at the present map; nothing to do where it is fixed and has
   been taken. Counts a factorisation. Collective. */
PETSC_INTERN PetscErrorCode EqmMetricRefresh(EqmSolver solver, EqmMetric metric);
/* h = M^-1 g; both in degrees of freedom at the present map; may be the same. Collective. */
PETSC_INTERN PetscErrorCode EqmMetricApply(EqmSolver solver, EqmMetric metric, Vec g, Vec h);
/* For the `state` of a method that keeps a metric over several steps. Collective. */
PETSC_INTERN PetscErrorCode EqmMetricState(EqmSolver solver, EqmMetric metric, EqmState state);

/* ---- first maps (src/start/start.c) */
/* Fail with EQM_ERR_USAGE if the problem has no start of this name. Collective. */
PETSC_INTERN PetscErrorCode EqmStartFind(const EqmProblem *problem, const char *name);
/* The names of all starts of a family, separated by commas. Not collective. */
PETSC_INTERN PetscErrorCode EqmStartNames(EqmStartFamily family, char *text, size_t length);
PETSC_INTERN PetscErrorCode EqmStart(EqmSolver solver);
/* ---- first maps to the sphere (src/start/sphere.c) */
/* Laplacian linearisation (001 section 6): one triangle pinned in the plane, the rest harmonic, onto the sphere. With
   `dipole` the triangle's places are sources instead, and the metric of the problem, which must be fixed, is factored
   for that. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereLinear(EqmSolver solver, PetscBool dipole);
/* L z = b, b zero but at three vertices (global numbers; two numbers each, which add up to zero); z two per local
   vertex. Collective. */
PETSC_INTERN PetscErrorCode EqmDipoleSolve(EqmSolver solver, const PetscInt corner[3], const PetscReal charge[6],
                                           PetscReal *z);
/* Tutte's map by two hemispheres (004 section 5.1), with equal weights; may fold along the equator. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereTutte(EqmSolver solver);
/* The Gauss map (004 Definition 5.1); with `steps` > 0 smoothed by as many steps of heat flow as it takes to lose its
 * folds, `steps` at most, and unfolded. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereGauss(EqmSolver solver, PetscInt steps);
/* The linear map, followed by as few fixed-point steps, `most_steps` at most, as it takes for unfolding to lose all
   folds and for the arithmetic to resolve all triangles; else that or Tutte's, whichever folds less. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereGuarded(EqmSolver solver, PetscInt most_steps);
/* One step of 001 Algorithm 2 with inversion radius 1.2 around the pole that `step` (counted from 0) has its turn.
 * Collective. */
PETSC_INTERN PetscErrorCode EqmSphereFixedPointStep(EqmSolver solver, PetscInt step, PetscReal *weights);
/* The same with weights that are given: solve for the cap around a pole with its rim held. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereCapStep(EqmSolver solver, PetscInt step, const PetscReal *weights);
/* Half determinants from here on up have a sign whatever the order in which they are computed. */
PETSC_INTERN const PetscReal EqmSmallestImage;
/* The smallest half determinant of a cell's corners, whatever its sign. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereSmallestImage(EqmSolver solver, PetscReal *smallest);
/* The harmonic map for the angle weights, cap by cap, centred; where cells would become too small for the arithmetic,
   with a conductivity that falls towards the tips of limbs, which solver->angle_weights keep. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereResolved(EqmSolver solver);
/* Turn a map over that is mirrored for the most part. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereOrient(EqmSolver solver);

/* ---- first map to the ball (src/start/ball.c) */
/* The boundary by the sphere's solver, the interior by 1 + `steps` volumetric stretch steps (003 section 4).
 * Collective.
 */
PETSC_INTERN PetscErrorCode EqmBallStart(EqmSolver solver, PetscInt steps);

/* ---- bijectivity repair (src/unfold) */
/* Each tries to unfold solver->place and keeps the map with the fewest folds; `before` and `after` count them.
   Collective. */
PETSC_INTERN PetscErrorCode EqmDiskUnfold(EqmSolver solver, PetscInt64 *before, PetscInt64 *after);
PETSC_INTERN PetscErrorCode EqmBallUnfold(EqmSolver solver, PetscInt64 *before, PetscInt64 *after);
PETSC_INTERN PetscErrorCode EqmSphereUnfold(EqmSolver solver, PetscInt64 *before, PetscInt64 *after);

/* A step in (0, 1] along a straight motion that keeps cells of positive area well away from zero: the whole one if it
   ends short of the first zero by a margin, else half the way there. (To go nearly all the way saves little and leaves
   a triangle so flat that the last digits of its corners decide on what follows.) `velocity` per local vertex.
   Collective. */
PETSC_INTERN PetscErrorCode EqmStepToFold(EqmSolver solver, const PetscReal *velocity, PetscReal *step);

#endif
