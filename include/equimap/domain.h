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

/* How vertices of one kind move: operations on one vertex, x its place, `stored` its three reals in EqmPlace's frame
   (NULL where the domain keeps none). A new kind is one such row in a file of its own. Called by several threads at
   once. */
typedef struct {
  const char *name;
  PetscInt num_dofs; /* EQM_DOFS_OF_SPACE: as many as the space has dimensions */
  /* The directions of the degrees of freedom as columns, dim reals each; orthonormal unless `stored` are angles. */
  void (*frame)(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal *frame);
  /* Follow the geodesic of the velocity `dofs` for time t: to y and new_stored, which may be x and stored. */
  void (*retract)(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t, const PetscScalar *dofs,
                  PetscReal *y, PetscReal *new_stored);
  void (*choose_frame)(const PetscReal *x, PetscReal *stored); /* for a place from outside; NULL: nothing is stored */
  /* Progress from p to its neighbour q along the boundary; NULL: the boundary is no curve. */
  PetscReal (*advance)(const PetscReal *p, const PetscReal *q);
  PetscReal curvature;  /* geodesics of unit speed have the acceleration -curvature x */
  PetscBool is_free[3]; /* is this coordinate free, independently of the others? */
} EqmVertexMotion;
enum { EQM_DOFS_OF_SPACE = -1, EQM_MAX_MOTIONS = 8 };

/* The kinds that the library comes with. */
PETSC_EXTERN const EqmVertexMotion EqmMotionFree;         /* anywhere in R^dim */
PETSC_EXTERN const EqmVertexMotion EqmMotionCircle;       /* on the unit circle: one degree of freedom, the angle */
PETSC_EXTERN const EqmVertexMotion EqmMotionHeldOnCircle; /* at its place on the unit circle */
PETSC_EXTERN const EqmVertexMotion EqmMotionSideX;        /* along a horizontal side: the first coordinate */
PETSC_EXTERN const EqmVertexMotion EqmMotionSideY;        /* along a vertical side: the second coordinate */
PETSC_EXTERN const EqmVertexMotion EqmMotionCorner;       /* at its corner of the square */
PETSC_EXTERN const EqmVertexMotion EqmMotionFace[3];      /* in a face of the cube normal to that axis */
PETSC_EXTERN const EqmVertexMotion EqmMotionEdge[3];      /* along an edge of the cube in direction of that axis */
PETSC_EXTERN const EqmVertexMotion EqmMotionCubeCorner;   /* at its corner of the cube */
PETSC_EXTERN const EqmVertexMotion EqmMotionSphere; /* on the unit sphere: two degrees of freedom in its own frame */
PETSC_EXTERN const EqmVertexMotion EqmMotionAngles; /* on the unit sphere: polar angle and azimuth (003 (4), (5)) */

/* A configuration: the place of every local vertex, ghosts included and up to date. */
typedef struct {
  PetscReal *x;     /* dim * num_local */
  PetscReal *frame; /* of vertices on the sphere, 3 * num_local: the first tangent vector, the second is place x first;
                       of EqmMotionAngles the two angles; NULL where there are none such */
} EqmPlace;

/* The manifold of each vertex of a mesh, and motions on it. */
typedef struct _p_EqmDomain *EqmDomain;

/* Settings of a new domain; each kind of domain uses its own. */
typedef struct {
  const PetscInt *corners;      /* square: four input vertex numbers; NULL: at quarters of the boundary's arc length */
  const char *boundary_angles;  /* disk: a CSV file of boundary vertices and the angles that hold them; NULL: none */
  const PetscReal *held_angles; /* disk: these angles per local vertex, as of EqmDomainCreateHeldDisk; NULL: none */
  const PetscReal *cube_places; /* cube: places of the boundary vertices, as of EqmDomainCreateCube */
} EqmDomainOptions;
/* The type of a domain: a name, and a function that creates it for a mesh. */
typedef struct {
  const char *name;
  PetscErrorCode (*create)(EqmMesh, const EqmDomainOptions *, EqmDomain *);
} EqmDomainType;
/* Register a domain; `type` must outlive the program's use of it. Not collective. */
PETSC_EXTERN PetscErrorCode EqmDomainRegister(const EqmDomainType *type);
/* A domain by name, for a mesh; `options` may be NULL. Errors: EQM_ERR_USAGE (no such domain), EQM_ERR_MESH.
 * Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreate(EqmMesh mesh, const char *name, const EqmDomainOptions *options,
                                            EqmDomain *domain);

/* "disk", the unit disk: boundary vertices on the circle, the others free (000 (6), (7)). The mesh must be of disk
   type. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateDisk(EqmMesh mesh, EqmDomain *domain);
/* "held-disk": the same with boundary vertices held at given angles, per local vertex, which must grow once round along
   the boundary (000 section 6, h_B = R f_B). Errors: EQM_ERR_USAGE (they do not). Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateHeldDisk(EqmMesh mesh, const PetscReal *angle, EqmDomain *domain);
/* "square", the unit square: four corners fixed, side vertices slide, the others free (002 section 4.1). `corners`:
   four input vertex numbers on the boundary, in any rotation of the boundary's order, the first goes to (0,0); NULL: at
   quarters of the boundary's arc length. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateSquare(EqmMesh mesh, const PetscInt corners[4], EqmDomain *domain);
/* "sphere", the unit sphere: every vertex on it (001 (2.1)). The mesh must be closed, of genus 0. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateSphere(EqmMesh mesh, EqmDomain *domain);
/* "ball", the unit ball: boundary vertices on the sphere, the others free in space (003 section 3); with `angles`, as
   "spherical-ball", their degrees of freedom are spherical coordinates (003 (4), (5)): no isometry, but the coordinates
   that 003 Algorithm 1 is written in. The mesh must be a solid. Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateBall(EqmMesh mesh, PetscBool angles, EqmDomain *domain);
/* "cube", the unit cube [0, 1]^3: boundary vertices slide in their face or along their edge, corners are fixed, the
   others are free. `places`: three coordinates per local vertex; those of boundary vertices that are exactly 0 or 1
   stay so, and the others are the first places. The mesh must be a solid. Errors: EQM_ERR_MESH (tetrahedra with four
   vertices in one face). Collective. */
PETSC_EXTERN PetscErrorCode EqmDomainCreateCube(EqmMesh mesh, const PetscReal *places, EqmDomain *domain);
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
/* The same, added to what `dofs` has. Not collective. */
PETSC_EXTERN PetscErrorCode EqmDomainAddProjected(EqmDomain domain, const EqmPlace *place, const PetscReal *ambient,
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
/* x -> (1 - |c|^2) (x + c) / |x + c|^2 + c for |c| < 1: conformal, moves everything towards c / |c|. Not collective. */
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

/* EqmDomainGetDimension - coordinates of a place: 2 or 3. Not collective. */
PETSC_EXTERN PetscErrorCode EqmDomainGetDimension(EqmDomain domain, PetscInt *dim);

#endif
