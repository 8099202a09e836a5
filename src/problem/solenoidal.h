/* Smooth motions of the unit ball that keep volumes: a coarse space for the Gauss-Newton matrix of solids. Multigrid on
   aggregates has no such fields, as what is without divergence between vertices is not between aggregates; their
   stiffness comes out too large on each coarser level, and they take most of the iterations. Curls of vector potentials
   have no divergence wherever they are taken (auxiliary spaces: R. Hiptmair, J. Xu, SIAM J. Numer. Anal. 45, 2007):

     curl((1 - |x|^2) phi e_k), k = 1, 2, 3, and curl(phi x), phi the quadratic B-splines of a fixed grid.

   On the unit sphere both are tangential, so that boundary vertices stay on it. */
#ifndef EQM_SOLENOIDAL_H
#define EQM_SOLENOIDAL_H

#include "problem/problem.h"

typedef struct _p_EqmSolenoidal *EqmSolenoidal;

/* Of problems whose domain is the ball, with boundary vertices in frames. Not collective. */
PETSC_INTERN PetscErrorCode EqmSolenoidalCreate(EqmProblem problem, EqmSolenoidal *space);
PETSC_INTERN PetscErrorCode EqmSolenoidalDestroy(EqmSolenoidal *space);
/* The Galerkin matrix, factored, of sum g g^T / w + share L, g the gradients of the cells' volumes at `place`, w the
   mesh's weights, L the Laplacian with `weights` (per local cell and edge) in each coordinate of space. Smooth fields'
   share of L is summed over some of the cells. Collective. */
PETSC_INTERN PetscErrorCode EqmSolenoidalFactor(EqmSolenoidal space, const EqmPlace *place, const PetscReal *weights,
                                                PetscReal share);
/* c = (P^T A P)^-1 P^T g, P the fields at the vertices of `place`, the last factor's, to whose frames the vector
   belongs. Collective. */
PETSC_INTERN PetscErrorCode EqmSolenoidalSolve(EqmSolenoidal space, const EqmPlace *place, Vec g);
/* h += P c, with what was solved last, at the same place. Not collective. */
PETSC_INTERN PetscErrorCode EqmSolenoidalAdd(EqmSolenoidal space, const EqmPlace *place, Vec h);

#endif
