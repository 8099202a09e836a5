/* Landmarks, vertices with target positions: lambda sum w_i |x(v_i) - q_i|^2 beside the energy (000 (46); with a weight
   of each landmark's own, lambda_i = lambda w_i, 001 section 6.6). */
#ifndef EQM_LANDMARKS_H
#define EQM_LANDMARKS_H

#include <equimap/domain.h>

typedef struct {
  /* as given, the same on every rank */
  PetscInt num_total; /* 0: the term is absent */
  PetscInt dim;
  PetscInt *input_vertex;
  PetscReal *target;           /* dim each */
  PetscReal *given_weight;     /* w_i */
  PetscReal lambda, tolerance; /* no map is done before its landmarks are closer than the tolerance */
  /* made of it for a domain */
  PetscInt num;     /* of vertices that this rank owns */
  PetscInt *vertex; /* local numbers */
  PetscReal *place; /* dim each */
  PetscReal *weight;
  PetscReal *share; /* per local vertex: weights of this rank's landmarks there over the number of its cells */
} EqmLandmarks;

/* Copy the lists; `weights` NULL: all 1. Not collective. */
PETSC_INTERN PetscErrorCode EqmLandmarksGive(EqmLandmarks *landmarks, PetscInt num, PetscInt dim,
                                             const PetscInt *vertices, const PetscReal *places,
                                             const PetscReal *weights);

PETSC_INTERN PetscErrorCode EqmLandmarksReset(EqmLandmarks *landmarks);
/* Find those whose vertices this rank owns, and prepare the shares. Not collective. */
PETSC_INTERN PetscErrorCode EqmLandmarksSetUp(EqmLandmarks *landmarks, EqmDomain domain);
/* sum w_i |x(v_i) - q_i|^2, of the places moved along `velocity` if that is not NULL. Collective. */
PETSC_INTERN PetscErrorCode EqmLandmarksSquares(const EqmLandmarks *landmarks, EqmDomain domain, const PetscReal *x,
                                                const PetscReal *velocity, PetscReal *squares);
/* The largest |x(v_i) - q_i|. Collective. */
PETSC_INTERN PetscErrorCode EqmLandmarksLargest(const EqmLandmarks *landmarks, EqmDomain domain, const PetscReal *x,
                                                PetscReal *largest);
/* gradient += factor w_i (x(v_i) - q_i), dim per owned vertex. Not collective. */
PETSC_INTERN void EqmLandmarksAddGradient(const EqmLandmarks *landmarks, EqmDomain domain, const PetscReal *x,
                                          PetscReal factor, PetscReal *gradient);

#endif
