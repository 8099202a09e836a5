/* Energies of maps: loops over image simplices, the normalised authalic energy, Laplacians, the angle energy.

   Notation: w cell weight (sums to one over the mesh), a signed image measure, A = sum a, ratio r =
   (a/w)/A. All loops are owner-computes over fixed blocks: the same bits for any number of threads. */
#ifndef EQUIMAP_ENERGY_H
#define EQUIMAP_ENERGY_H

#include <equimap/domain.h>

/* Sums over the cells of a map. */
typedef struct {
  PetscReal total;    /* A */
  PetscReal energy;   /* A sum w (r - 1)^2 */
  PetscReal sd;       /* unweighted standard deviation of r over the cells */
  PetscReal smallest; /* min a/w: not positive where the map folds */
  PetscInt64 folds;   /* cells with a <= 0 */
} EqmImageTotals;

/* Image measure a of every local cell. Not collective. */
PETSC_EXTERN PetscErrorCode EqmImageMeasure(EqmDomain domain, const EqmPlace *place, PetscReal *a);
/* The same for another measure than the domain's own. Not collective. */
PETSC_EXTERN PetscErrorCode EqmImageMeasureOf(EqmDomain domain, EqmMeasureKind kind, const EqmPlace *place,
                                              PetscReal *a);
/* Sums over all cells from their image measures. Collective. */
PETSC_EXTERN PetscErrorCode EqmImageSum(EqmMesh mesh, const PetscReal *a, EqmImageTotals *totals);
/* gradient_i = sum over cells of slope_cell * d a_cell / d x_i, for owned vertices; `slope` per local cell, `gradient`
   dim per owned vertex. Not collective. */
PETSC_EXTERN PetscErrorCode EqmImageGradient(EqmDomain domain, const EqmPlace *place, const PetscReal *slope,
                                             PetscReal *gradient);
PETSC_EXTERN PetscErrorCode EqmImageGradientOf(EqmDomain domain, EqmMeasureKind kind, const EqmPlace *place,
                                               const PetscReal *slope, PetscReal *gradient);
/* First and second derivative of a along the curve with the given ambient velocity and acceleration (NULL: zero), per
   local cell. Either output may be NULL. Not collective. */
PETSC_EXTERN PetscErrorCode EqmImageDerivatives(EqmDomain domain, const EqmPlace *place, const PetscReal *velocity,
                                                const PetscReal *acceleration, PetscReal *first, PetscReal *second);
/* The same of another measure than the domain's own. Not collective. */
PETSC_EXTERN PetscErrorCode EqmImageDerivativesOf(EqmDomain domain, EqmMeasureKind kind, const EqmPlace *place,
                                                  const PetscReal *velocity, const PetscReal *acceleration,
                                                  PetscReal *first, PetscReal *second);
/* How many cells of the map are folded: measure not positive, or on the sphere det not positive. `scratch` per local
   cell. Collective. */
PETSC_EXTERN PetscErrorCode EqmImageFolds(EqmDomain domain, const EqmPlace *place, PetscReal *scratch,
                                          PetscInt64 *folds);
/* How many triangles of the boundary of a map to the ball or cube do not look outward, seen from its centre. The
   volumes inside need not tell. Collective. */
PETSC_EXTERN PetscErrorCode EqmImageBoundaryFolds(EqmDomain domain, const EqmPlace *place, PetscInt64 *folds);

/* The normalised authalic energy E = A sum w (r - 1)^2 (000 (4), in a form free of cancellation) and, if wanted, its
   gradient in degrees of freedom, from dE/da = 2 (r - 1) - E/A. Where A <= 0, beyond a pole of E from where it falls
   without end, it is infinite. `a` (per local cell) is scratch that returns the image
   measures. Collective. */
PETSC_EXTERN PetscErrorCode EqmAuthalicEnergy(EqmDomain domain, const EqmPlace *place, PetscReal *a, PetscReal *energy,
                                              Vec gradient);

/* The conformal energy E_D - A, E_D = 1/2 tr f^T L f for the Laplacian with `weights` (3 per local cell), plus |c|^2/2
   of the mass centre c = sum m_v f_v unless `mass` (per owned vertex, adding up to one) is NULL; and, if wanted, its
   gradient in degrees of freedom. `a` (per local cell) returns the image measures. Summed cell by cell, so that E_D and
   A do not cancel as wholes. Collective. */
PETSC_EXTERN PetscErrorCode EqmConformalEnergy(EqmDomain domain, const PetscReal *weights, const PetscReal *mass,
                                               const EqmPlace *place, PetscReal *a, PetscReal *energy, Vec gradient);

/* Weights of a Laplacian: per local cell and edge, in the order of EqmCellEdge. */
typedef enum {
  EQM_LAPLACIAN_UNIFORM,   /* 1/2: every inner edge of a surface one */
  EQM_LAPLACIAN_COTANGENT, /* of the mesh: Dirichlet energy (000 L_S(id)) */
  EQM_LAPLACIAN_STRETCH    /* of the present image: L_S (000 (2d)), of solids L_V (003 (3), corrected) */
} EqmLaplacianKind;
/* The weights of a Laplacian of that kind; `place` is used by EQM_LAPLACIAN_STRETCH only. Not collective. */
PETSC_EXTERN PetscErrorCode EqmLaplacianWeights(EqmDomain domain, EqmLaplacianKind kind, const EqmPlace *place,
                                                PetscReal *weights);
/* y = L x for `width` components; x per local vertex, y per owned vertex. Not collective. */
PETSC_EXTERN PetscErrorCode EqmLaplacianApply(EqmMesh mesh, const PetscReal *weights, PetscInt width,
                                              const PetscReal *x, PetscReal *y);
/* E_D = 1/2 sum x^T L x over all components. Collective. */
PETSC_EXTERN PetscErrorCode EqmLaplacianEnergy(EqmMesh mesh, const PetscReal *weights, PetscInt width,
                                               const PetscReal *x, PetscReal *energy);

#endif
