/* A problem instance, and an iterate of its solution.

   A problem is a mesh, the domain that its vertices move in, the objective that is minimised, and what all of them
   share: the elimination order, the scalar Laplacian, cotangent weights, lumped masses. An iterate is a map and what is
   known of it. First maps, metrics, unfolding and methods take these two; none of them knows the solver. */
#ifndef EQM_PROBLEM_H
#define EQM_PROBLEM_H

#include <equimap/energy.h>
#include "domain/domain_private.h"
#include <equimap/map.h>
#include "linalg/linalg.h"
#include "problem/landmarks.h"

typedef struct _p_EqmIterate *EqmIterate;
typedef struct _p_EqmProblem *EqmProblem;
typedef struct EqmObjective EqmObjective;

/* What the history tells of a step beyond the map; -1 where the method does not know it, phase 0 where it has none. */
typedef struct {
  PetscReal preconditioned_norm, wolfe_decrease, wolfe_slope, change;
  PetscInt64 phase;
} EqmStepFigures;
#define EQM_STEP_UNKNOWN ((EqmStepFigures){-1., -1., -1., -1., 0})

/* What is done about folds: this program's best, the correction that the paper prints (001 section 6.2), nothing. */
typedef enum { EQM_UNFOLD_AUTO, EQM_UNFOLD_PAPER, EQM_UNFOLD_NONE } EqmUnfolding;

struct _p_EqmIterate {
  EqmPlace place;
  PetscReal *image;      /* image measures, per local cell */
  EqmImageTotals totals; /* and their sums */
  PetscReal objective;   /* what the method minimises; convergence is judged by it */
  PetscReal gradient_norm;
  PetscReal step_length;                 /* of the step that led here */
  PetscInt number;                       /* of the iteration */
  EqmStepFigures figures;                /* of that step; unknown before each */
  PetscInt64 unfolded_from, unfolded_to; /* folds before and after the unfolding that led here; 0 before: there was
                                            none */
};

struct _p_EqmProblem {
  MPI_Comm comm;
  char prefix[32];  /* of options that are read while the problem is being solved */
  EqmMesh mesh;     /* the caller's */
  EqmDomain domain; /* the problem's own from here on */
  const EqmObjective *objective;
  EqmUnfolding unfolding;
  EqmOrdering ordering;
  EqmLandmarks landmarks;
  struct _p_EqmTerm *terms; /* added to the objective (term.h); NULL: none */

  struct EqmLevels *levels; /* coarser meshes (levels.h); NULL before the first use */
  EqmLinear scalar;         /* one unknown per vertex: Laplacians of all kinds; NULL before the first use */
  unsigned char *scalar_count;
  PetscBool holds_fixed_metric; /* `scalar` has the factor of the objective's fixed metric */
  PetscReal *angle_weights,
      *vertex_mass;                    /* of EqmProblemGetAngleWeights, ...GetVertexMass; NULL before the first use */
  char linear_solver[EQM_LINEAR_TEXT]; /* what solves with the matrices */

  PetscErrorCode (*notify)(void *context, const char *text); /* a line of text for the user; NULL: not reported */
  PetscErrorCode (*stop_requested)(void *context, PetscBool *stop); /* NULL: never */
  void *context;                                                    /* of both */
};

/* A problem on `domain`, which it owns from then on, without landmarks. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemCreate(EqmDomain domain, const EqmObjective *objective, EqmProblem *problem);
PETSC_INTERN PetscErrorCode EqmProblemDestroy(EqmProblem *problem);
/* Report a line of text, which ends in a newline, to the user. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemNotify(EqmProblem problem, const char *format, ...);
/* Has a stop of the run been requested? Collective. */
PETSC_INTERN PetscErrorCode EqmProblemStopRequested(EqmProblem problem, PetscBool *stop);
/* Cotangent weights of the mesh, 3 per local cell; made at the first need and kept. A start may have lowered those of
   limb tips (EqmSphereResolved). Collective. */
PETSC_INTERN PetscErrorCode EqmProblemGetAngleWeights(EqmProblem problem, const PetscReal **weights);
/* Lumped weights of the owned vertices, which add up to one; made at the first need and kept. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemGetVertexMass(EqmProblem problem, const PetscReal **mass);

/* ---- iterates (iterate.c) */
/* All places zero. Collective. */
PETSC_INTERN PetscErrorCode EqmIterateCreate(EqmProblem problem, EqmIterate *iterate);
PETSC_INTERN PetscErrorCode EqmIterateDestroy(EqmIterate *iterate);
/* Compute image and totals from the place. Collective. */
PETSC_INTERN PetscErrorCode EqmIterateUpdate(EqmProblem problem, EqmIterate iterate);
/* E per measure of the image: the mean square of how far ratios are off. Not collective. */
PETSC_INTERN PetscReal EqmIterateMeanEnergy(EqmIterate iterate);
/* Compute the totals alone, where the image is up to date already. Collective. */
PETSC_INTERN PetscErrorCode EqmIterateUpdateTotals(EqmProblem problem, EqmIterate iterate);
/* A trial becomes the iterate: its place, image and value, and the length of the step to it. Collective. */
PETSC_INTERN PetscErrorCode EqmIterateAccept(EqmProblem problem, EqmIterate iterate, const EqmPlace *trial,
                                             const PetscReal *image, PetscReal objective, PetscReal step_length);
/* The Moebius map that brings the mass centre of a map to the sphere to the sphere's own, 004 Definition 2.3.
   Collective. */
PETSC_INTERN PetscErrorCode EqmIterateCenter(EqmProblem problem, EqmIterate iterate);

/* ---- matrices of all degrees of freedom (coupled.c) */
/* The domain's degrees of freedom as unknowns of a matrix; the arrays are the domain's. Not collective. */
static inline EqmUnknowns EqmDomainUnknowns(EqmDomain domain)
{
  return (EqmUnknowns){.num_owned = domain->num_dofs,
                       .first = domain->dof_first,
                       .start = domain->dof_start,
                       .count = domain->dof_count};
}
/* Destroy the problem's levels, if there are any; they are made again at the next need (levels.c). Collective. */
PETSC_INTERN PetscErrorCode EqmProblemDropLevels(EqmProblem problem);
/* A linear solver with the domain's degrees of freedom as unknowns. The scalar one and the levels, which take memory
   and are of no more use, are destroyed. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemCreateLinear(EqmProblem problem, EqmMatrixUse use, EqmLinear *linear);
/* Give `linear`, if it has a use for them, fields that the matrix hardly sees: `field` gives the velocity of the field
   of number `which` at the place x of a vertex, in space. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemSetFields(EqmProblem problem, const EqmPlace *place, EqmLinear linear,
                                                PetscInt count,
                                                void (*field)(PetscInt which, const PetscReal *x, PetscReal *velocity));

/* Give `linear`, if it has a use for it, the map whose motions the unknowns are. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemSetImage(EqmProblem problem, const EqmPlace *place, EqmLinear linear);

/* ---- scalar Laplacians on groups of vertices (laplace.c) */
enum { EQM_GROUP_FIXED = -1 };
/* Factor the Laplacian with the given weights (per local cell and edge), restricted to groups: entries between vertices
   of different groups are dropped, rows of fixed vertices are identities. `group` per local vertex; `mass` per local
   cell or NULL goes to the diagonal. Errors: EQM_ERR_MESH (not positive definite). Collective. */
PETSC_INTERN PetscErrorCode EqmGroupFactor(EqmProblem problem, const PetscReal *weights, const signed char *group,
                                           const PetscReal *mass);
/* The same with `share` (per local vertex) added to a vertex's diagonal by each cell around it. Collective. */
PETSC_INTERN PetscErrorCode EqmGroupFactorWithShares(EqmProblem problem, const PetscReal *weights,
                                                     const signed char *group, const PetscReal *share);
/* Solve with the factored Laplacian; columns of num_owned each. Collective. */
PETSC_INTERN PetscErrorCode EqmGroupSolve(EqmProblem problem, PetscInt num_rhs, PetscReal *columns);
/* The same as a metric needs it: the factor, or one multigrid cycle (EqmLinearApply). Collective. */
PETSC_INTERN PetscErrorCode EqmGroupApply(EqmProblem problem, PetscInt num_rhs, PetscReal *columns);
/* Solve L z = 0 on the vertices that are not held, in `width` columns: z (per local vertex, `width` each) holds the
   held values on entry, all values on return. Counts a factorisation. Collective. */
PETSC_INTERN PetscErrorCode EqmHeldSolve(EqmProblem problem, const PetscReal *weights, const signed char *group,
                                         PetscInt width, PetscReal *z);
/* The same once EqmGroupFactor has factored these weights and groups. Collective. */
PETSC_INTERN PetscErrorCode EqmHeldExtend(EqmProblem problem, const PetscReal *weights, const signed char *group,
                                          PetscInt width, PetscReal *z);
/* Bring z nearer to that solution, from the values that it has: where the solver is an iteration, until the error is
   down to `tolerance` of what it was (energy norm); an exact factor solves. Factors. Collective. */
PETSC_INTERN PetscErrorCode EqmHeldImprove(EqmProblem problem, const PetscReal *weights, const signed char *group,
                                           PetscInt width, PetscReal tolerance, PetscReal *z);
/* Planar: coordinates that are free of constraint solve L x = 0 with all others held: the discrete harmonic map for
   `weights`. `to` gets the result; ghosts up to date. Collective. */
PETSC_INTERN PetscErrorCode EqmHarmonicMap(EqmProblem problem, const PetscReal *weights, const EqmPlace *from,
                                           EqmPlace *to);

/* ---- stereographic caps of maps to the sphere (caps.c) */
/* One step of 001 Algorithm 2 with inversion radius 1.2 around the pole that `step` (counted from 0) has its turn;
   `weights` (3 per local cell) are scratch. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereFixedPointStep(EqmProblem problem, EqmIterate iterate, PetscInt step,
                                                    PetscReal *weights);
/* The same with weights that are given: solve for the cap around a pole with its rim held. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereCapStep(EqmProblem problem, EqmIterate iterate, PetscInt step,
                                             const PetscReal *weights);
/* Stereographic projection of n points of the plane (two reals each) to the sphere, seen from the pole `up` = +1
   (north) or -1. Not collective. */
PETSC_INTERN void EqmPlaneToSphere(PetscInt n, PetscReal up, const PetscReal *z, PetscReal *x);
/* Divide places in the plane (two reals per local vertex) by their median modulus. Collective. */
PETSC_INTERN PetscErrorCode EqmDivideByMedian(EqmMesh mesh, PetscReal *z);
/* Turn a map over that is mirrored for the most part. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereOrient(EqmProblem problem, EqmIterate iterate);
/* Half determinants from here on up have a sign whatever the order in which they are computed. */
PETSC_INTERN const PetscReal EqmSmallestImage;
/* The smallest half determinant of a cell's corners, whatever its sign. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereSmallestImage(EqmProblem problem, const EqmPlace *place, PetscReal *smallest);

#endif
