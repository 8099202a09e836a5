/* The conformal energy of a map to the unit disk, as a function of the boundary's angles alone. */
#ifndef EQM_RIEMANN_H
#define EQM_RIEMANN_H

#include "method/method.h"
#include "method/loop.h"

/* The interior follows the boundary harmonically, z_I = -L_II^-1 L_IB z_B, so that with z_B = e^{i theta}

       E(theta) = 1/2 z^H L z - 1/2 sum sin(theta_{j+1} - theta_j) + 1/2 |h . z_B|^2,  h = m_B - L_BI L_II^-1 m_I.

   The first two terms are the Dirichlet energy less the area that the boundary encloses, zero for conformal maps alone.
   The last fixes the mass centre c = sum m z = h . z_B (m: lumped mass, one in all) at the disk's: conformal maps of
   the disk to itself change the first two terms only by the discretisation error, so that without it the iterates would
   drift. */
typedef struct _p_EqmRiemann *EqmRiemann;
/* Gaps between neighbours on the circle that the arithmetic tells from none. */
#define EQM_RIEMANN_LEAST_GAP 1e-9
struct _p_EqmRiemann {
  PetscInt num_boundary; /* owned vertices on the boundary */
  PetscInt *boundary;    /* their local numbers */
  EqmLoop loop;
  PetscReal *centre;  /* h, per entry of `boundary` */
  PetscInt pole;      /* the vertex deepest inside, on the rank that owns it; elsewhere -1 */
  PetscReal *weights; /* cotangents, per local cell */
  signed char *group; /* per local vertex: EQM_GROUP_FIXED on the boundary, 0 inside */
  PetscReal *scratch; /* two per owned vertex */
  Vec move;           /* degrees of freedom of the domain: zero inside */
};

/* Factors L_II, the one factorisation. Collective. */
PETSC_INTERN PetscErrorCode EqmRiemannCreate(EqmProblem problem, EqmRiemann *riemann);
PETSC_INTERN PetscErrorCode EqmRiemannDestroy(EqmRiemann *riemann);
/* A vector of boundary angles. Collective. */
PETSC_INTERN PetscErrorCode EqmRiemannCreateVec(EqmProblem problem, EqmRiemann riemann, Vec *angles);
/* Add t times `angles` to the boundary's angles; the interior is not moved. Collective. */
PETSC_INTERN PetscErrorCode EqmRiemannMove(EqmProblem problem, EqmRiemann riemann, const EqmPlace *from, PetscReal t,
                                           Vec angles, EqmPlace *to);
/* The smallest gap between neighbours on the boundary; not positive where they are out of order. Collective. */
PETSC_INTERN PetscErrorCode EqmRiemannSmallestGap(EqmProblem problem, const EqmPlace *place, PetscReal *smallest);
/* E and its gradient with respect to the angles for the boundary of `place`; moves the interior to its harmonic images.
   Two solves, one evaluation. Collective. */
PETSC_INTERN PetscErrorCode EqmRiemannEnergy(EqmProblem problem, EqmRiemann riemann, EqmPlace *place, PetscReal *energy,
                                             Vec gradient);
/* The boundary where the Riemann map that takes the pole to the centre has it, up to the discretisation: by harmonic
   measure. `crowded`: it brings neighbours too close together for the arithmetic, and they are held apart. One solve.
   Collective. */
PETSC_INTERN PetscErrorCode EqmRiemannPlaceByMeasure(EqmProblem problem, EqmRiemann riemann, EqmPlace *place,
                                                     PetscBool *crowded);
/* Bring the mass centre to the disk's centre by a Moebius map of the disk to itself, applied to the boundary.
   Collective. */
PETSC_INTERN PetscErrorCode EqmRiemannCentre(EqmProblem problem, EqmRiemann riemann, EqmPlace *place);

#endif
