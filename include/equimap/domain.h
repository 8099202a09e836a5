/* Where vertices may go: free in the plane or in space, on the unit circle or sphere, along a side, fixed.

   Each vertex lives on a manifold of its own. Its degrees of freedom are coordinates in an orthonormal frame of the
   tangent space at its present place; a step follows the geodesic of that velocity and carries the frame along by
   parallel transport. So vectors of degrees of freedom keep their meaning from one iterate to the next: conjugate
   directions and L-BFGS pairs need no transport of their own, and a method is written once for all domains. */
#ifndef EQUIMAP_DOMAIN_H
#define EQUIMAP_DOMAIN_H

#include <petscvec.h>
#include <equimap/mesh.h>
#include <equimap/simplex.h>

/* The manifold that a vertex lives on. */
typedef enum {
  EQM_VERTEX_FREE,   /* anywhere in R^dim */
  EQM_VERTEX_CIRCLE, /* on the unit circle: one degree of freedom, the angle */
  EQM_VERTEX_SIDE_X, /* along a horizontal side: the first coordinate */
  EQM_VERTEX_SIDE_Y, /* along a vertical side: the second coordinate */
  EQM_VERTEX_SPHERE, /* on the unit sphere: two degrees of freedom in the place's own frame */
  EQM_VERTEX_ANGLES, /* on the unit sphere: its spherical coordinates, polar angle and azimuth */
  EQM_VERTEX_FIXED   /* nowhere else */
} EqmVertexKind;

/* A configuration: the place of every local vertex, ghosts included and up to date. */
typedef struct {
  PetscReal *x;     /* dim * num_local */
  PetscReal *frame; /* of vertices on the sphere, 3 * num_local: the first tangent vector, the second is place x first;
                       of EQM_VERTEX_ANGLES the two angles; NULL where there are none such */
} EqmPlace;

/* Where each vertex of a mesh may go, and how it gets there. */
typedef struct _p_EqmDomain *EqmDomain;
/* The fields of a domain; read-only after creation. */
struct _p_EqmDomain {
  EqmMesh mesh;
  const char *name;
  EqmMeasureKind measure; /* of image cells */
  PetscBool
      curved_image; /* image cells can fold without a change of sign of their measure: look at EQM_MEASURE_HALF_DET */
  PetscBool spherical_coordinates; /* vertices on the sphere move by their angles */
  PetscInt dim;                    /* coordinates of a place: 2 or 3 */
  unsigned char *kind;             /* EqmVertexKind per local vertex */
  PetscInt *dof_start;             /* per local vertex: place of its first degree of freedom in the global vector */
  unsigned char *dof_count;        /* per local vertex */
  PetscInt num_dofs, dof_first;    /* owned degrees of freedom, and the global number of the first */
  EqmVertexKind kind_of_boundary;  /* where boundary vertices live: the circle, or the sides of the square */
  PetscReal target_measure;        /* of the ideal image: pi, 1, 4 pi, 4 pi / 3 */
  PetscReal boundary_length;       /* of the target: 2 pi, 4 */
  PetscReal corner_arc[4];         /* square: arc lengths of the corners */
  PetscErrorCode (*place_boundary)(EqmDomain, EqmPlace *);
  PetscReal *arc_length; /* per local vertex: arc length along the boundary loop in [0, 1), -1 inside (disk, square) */
};

/* The unit disk: boundary vertices on the circle, the others free (000 (6), (7)). The mesh must be of disk type.
   Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateDisk(EqmMesh mesh, EqmDomain *domain);
/* The unit square: four corners fixed, side vertices slide, the others free (002 section 4.1). `corners`: four input
   vertex numbers on the boundary, in any rotation of the boundary's order, the first goes to (0,0); NULL: at quarters
   of the boundary's arc length. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateSquare(EqmMesh mesh, const PetscInt corners[4], EqmDomain *domain);
/* The unit sphere: every vertex on it (001 (2.1)). The mesh must be closed, of genus 0. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateSphere(EqmMesh mesh, EqmDomain *domain);
/* The unit ball: boundary vertices on the sphere, the others free in space (003 section 3). The mesh must be a solid.
   Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateBall(EqmMesh mesh, EqmDomain *domain);
/* Let the vertices on the sphere move by their spherical coordinates (003 (4), (5)): no isometry, but the coordinates
   that 003 Algorithm 1 is written in. To be called before any place is made. Not collective. */
PETSC_EXTERN PetscErrorCode EqmDomainTakeSphericalCoordinates(EqmDomain domain);
/* Free a domain. Collective; NULL is fine. */
PETSC_EXTERN PetscErrorCode EqmDomainDestroy(EqmDomain *domain);

/* A place for every local vertex of the domain's mesh, at zero; free it again; copy one into another of the same
   domain. Not collective. */
PETSC_EXTERN PetscErrorCode EqmPlaceCreate(EqmDomain domain, EqmPlace *place);
PETSC_EXTERN PetscErrorCode EqmPlaceDestroy(EqmPlace *place);
PETSC_EXTERN PetscErrorCode EqmPlaceCopy(EqmDomain domain, const EqmPlace *from, EqmPlace *to);
/* A vector of degrees of freedom. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateVec(EqmDomain domain, Vec *v);
/* Choose frames for places that were set from outside (sphere; nothing to do elsewhere). Not collective. */
PETSC_EXTERN PetscErrorCode EqmPlaceMakeFrames(EqmDomain domain, EqmPlace *place);
/* Put boundary vertices at their first places, by arc length; the others keep theirs. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainPlaceBoundary(EqmDomain domain, EqmPlace *place);
/* Move along the geodesic of velocity `step` for time `t`: to = exp_from(t step). Ghosts of `to` are up to date. `from`
   and `to` may be the same. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainMove(EqmDomain domain, const EqmPlace *from, PetscReal t, Vec step, EqmPlace *to);
/* From a gradient in ambient coordinates (dim per owned vertex) to degrees of freedom. Not collective. */
PETSC_EXTERN PetscErrorCode EqmDomainProject(EqmDomain domain, const EqmPlace *place, const PetscReal *ambient,
                                             Vec dofs);
/* From degrees of freedom to ambient velocities of all local vertices, ghosts included. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainExpand(EqmDomain domain, const EqmPlace *place, Vec dofs, PetscReal *ambient);
/* Second derivative of the geodesics with the given ambient velocities: zero but on curved parts. Not collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCurvature(EqmDomain domain, const EqmPlace *place, const PetscReal *velocity,
                                               PetscReal *acceleration);
/* Are the boundary vertices in their order along the boundary, strictly, and winding once? Always where the boundary is
   no curve. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainBoundaryInOrder(EqmDomain domain, const EqmPlace *place, PetscBool *in_order);
/* ---- Mobius maps of the sphere (src/domain/moebius.c); they choose new frames */
/* x -> (1 - |c|^2) (x + c) / |x + c|^2 + c for |c| < 1: conformal, pulls everything towards c / |c|. Not collective. */
PETSC_EXTERN PetscErrorCode EqmPlaceShift(EqmDomain domain, const PetscReal c[3], EqmPlace *place);
/* x -> (x - center) / |x - center| for owned vertices, ghosts from their owners (004 Algorithm 5.1, lines 10 and 18):
   no Mobius map. A vertex at the centre goes to the north pole. Collective. */
PETSC_EXTERN PetscErrorCode EqmPlaceOntoSphere(EqmDomain domain, const PetscReal center[3], EqmPlace *place);
/* sum m_v x_v over all vertices; `mass` per owned vertex. Collective. */
PETSC_EXTERN PetscErrorCode EqmPlaceMassCenter(EqmDomain domain, const PetscReal *mass, const EqmPlace *place,
                                               PetscReal center[3]);
/* The Mobius map, unique up to rotations, that brings the mass centre (004 Definition 2.3, (41)) to the sphere's:
   Newton steps, which one projection of f - c is not and leaves 1e-4. `mass` per owned vertex, adding up to one;
   `offset`: what is left of the centre's distance, rounding unless half of the mass is in one spot. Collective. */
PETSC_EXTERN PetscErrorCode EqmPlaceCenter(EqmDomain domain, const PetscReal *mass, EqmPlace *place, PetscReal *offset);

/* The frame of local vertex v at `place`: column k of the dim x count matrix is frame[dim k .. dim k + dim - 1]. */
PETSC_EXTERN PetscInt EqmDomainFrame(EqmDomain domain, const EqmPlace *place, PetscInt v, PetscReal frame[9]);

#endif
