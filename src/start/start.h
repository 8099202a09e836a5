/* First maps: the starts that -start names, by the family of domains that they map to.

   A start is one function with a name and a one-line description; EqmStartRegister registers it. */
#ifndef EQM_START_H
#define EQM_START_H

#include "problem/problem.h"

/* The sets of starts: each formulation has one. */
typedef enum { EQM_STARTS_PLANE, EQM_STARTS_SPHERE, EQM_STARTS_BALL } EqmStartFamily;

/* Map a closed surface to the sphere: x, three per local vertex of `surface`, ghosts up to date; `folds` of the map.
   A callback of the ball's start. Collective. */
typedef PetscErrorCode (*EqmMapSurface)(void *context, EqmMesh surface, PetscReal *x, PetscInt64 *folds);

/* How each vertex of a hemisphere is the mean of its neighbours (004 section 5.1). */
typedef enum {
  EQM_HEMISPHERE_UNIFORM,
  EQM_HEMISPHERE_HARMONIC,
  EQM_HEMISPHERE_MEAN_VALUE,
  EQM_HEMISPHERE_SEMI_COTANGENT
} EqmHemisphereWeights;

/* Settings of a start. */
typedef struct {
  char name[PETSC_MAX_PATH_LEN];           /* of a start or a file; empty: the target's own for the method */
  PetscInt steps;                          /* fixed-point steps after the first map; -1: the start's default */
  EqmHemisphereWeights hemisphere_weights; /* sphere: of the start tutte */
  PetscBool center;              /* sphere: bring the mass centre to the sphere's by a Moebius map at the end */
  PetscBool anisotropic_scaling; /* ball: turn and scale the solid to fill a cube first (003 (11)) */
  EqmMapSurface map_surface;     /* of solids; NULL: the domain itself has the places of its boundary */
  void *context;                 /* of map_surface */
} EqmStartOptions;

typedef struct {
  EqmStartFamily family;
  const char *name, *purpose;
  PetscInt steps;                                                         /* unless the options say otherwise */
  PetscErrorCode (*run)(EqmProblem, EqmIterate, const EqmStartOptions *); /* options->steps is not negative */
} EqmStartType;

/* Register a start; `type` must outlive the program's use of it. Not collective. */
PETSC_EXTERN PetscErrorCode EqmStartRegister(const EqmStartType *type);
/* Is this the name of a file, not of a start? Not collective. */
PETSC_INTERN PetscBool EqmStartIsFile(const char *name);
/* If it is, the file must be there. Errors: EQM_ERR_IO. Collective. */
PETSC_INTERN PetscErrorCode EqmStartRequireFile(MPI_Comm comm, const char *name);
/* The start of a name, or for a file the start that reads it. `place` names the target in the error message. Errors:
   EQM_ERR_USAGE. Collective. */
PETSC_INTERN PetscErrorCode EqmStartFind(MPI_Comm comm, EqmStartFamily family, const char *place, const char *name,
                                         const EqmStartType **type);
/* The names of all starts of a family, separated by commas. Not collective. */
PETSC_INTERN PetscErrorCode EqmStartNames(EqmStartFamily family, char *text, size_t length);
/* Defaults, then the options of a family: -start, -start_steps, ... Collective. */
PETSC_INTERN PetscErrorCode EqmStartOptionsDefault(EqmStartOptions *options);
PETSC_INTERN PetscErrorCode EqmStartSetFromOptions(EqmStartFamily family, EqmStartOptions *options,
                                                   PetscOptionItems *PetscOptionsObject);
/* The first map, with frames; image and totals are not made. Collective. */
PETSC_INTERN PetscErrorCode EqmStartRun(const EqmStartType *type, EqmProblem problem, EqmIterate iterate,
                                        const EqmStartOptions *options);

/* The starts of this folder. */
PETSC_INTERN const EqmStartType EqmStartPlaneHarmonic, EqmStartPlaneFixedPoint, EqmStartPlaneTutte,
    EqmStartPlaneGuarded, EqmStartPlaneArcLength, EqmStartSphereLinearType, EqmStartSphereFixedPoint,
    EqmStartSphereDescending, EqmStartSphereGuarded, EqmStartSphereConformal, EqmStartSphereResolved,
    EqmStartSphereNormals, EqmStartSphereGauss, EqmStartSphereTutte, EqmStartBallHarmonic, EqmStartBallFixedPoint,
    EqmStartBallGuarded, EqmStartPlaneCascade, EqmStartSphereCascade, EqmStartSphereSolidAngle, EqmStartFilePlane,
    EqmStartFileSphere, EqmStartFileBall;

/* Map the boundary of a solid as its first maps do, by options->map_surface: x, three per local vertex, of boundary
   vertices. Collective. */
PETSC_INTERN PetscErrorCode EqmStartPlaceBoundary(EqmMesh solid, const EqmStartOptions *options, PetscReal *x,
                                                  PetscInt64 *folds);
/* Is a solid's boundary that of a box, however it stands? Then x, three per local vertex, are its places stretched to
   the unit cube. Collective. */
PETSC_INTERN PetscErrorCode EqmCubeFromBox(EqmMesh solid, PetscReal *x, PetscBool *is_box);
/* From places of a closed surface on the sphere to places on the boundary of the unit cube, three per local vertex.
   Errors: EQM_ERR_MESH (the surface is too coarse). Collective. */
PETSC_INTERN PetscErrorCode EqmCubeFromSphere(EqmMesh surface, PetscReal *x);
/* The boundary of the map to the cube that a file holds, snapped to the cube, as of EqmDomainCreateCube. Errors:
   EQM_ERR_USAGE (it holds none), EQM_ERR_IO. Collective. */
PETSC_INTERN PetscErrorCode EqmCubeFromFile(EqmMesh solid, const char *file, PetscReal *x);

/* ---- parts that several starts use */
/* A step in (0, 1] along a straight motion that keeps cells of positive area well away from zero: the whole one if it
   ends short of the first zero by a margin, else half the way there. (To go nearly all the way saves little and leaves
   a triangle so flat that the last digits of its corners decide on what follows.) `velocity` per local vertex.
   Collective. */
PETSC_INTERN PetscErrorCode EqmStepToFold(EqmProblem problem, const EqmPlace *place, const PetscReal *velocity,
                                          PetscReal *step);
/* Laplacian linearisation (001 section 6): one triangle pinned in the plane, the rest harmonic, onto the sphere. With
   `dipole` the triangle's places are sources instead, and the metric of the objective, which must be fixed, is factored
   for that. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereLinear(EqmProblem problem, EqmIterate iterate, PetscBool dipole);
/* L z = b, b zero but at three vertices (global numbers; two numbers each, which add up to zero); z two per local
   vertex. Collective. */
PETSC_INTERN PetscErrorCode EqmDipoleSolve(EqmProblem problem, const EqmPlace *place, const PetscInt corner[3],
                                           const PetscReal charge[6], PetscReal *z);
/* Tutte's map by two hemispheres (004 section 5.1); may fold along the equator. Where no closed
   curve was `found` that cuts the surface in two, the map is as it was. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereTutte(EqmProblem problem, EqmIterate iterate, EqmHemisphereWeights kind,
                                           PetscBool *found);
/* Vertex normals (004 Definition 5.1), smoothed by heat flow for as long as triangles fold, `steps` times at most.
   Collective. */
PETSC_INTERN PetscErrorCode EqmSphereGauss(EqmProblem problem, EqmIterate iterate, PetscInt steps);
/* The harmonic map for the angle weights, cap by cap, centred; where cells would become too small for the arithmetic,
   with a conductivity that falls towards the tips of limbs, which the problem's angle weights keep. Collective. */
PETSC_INTERN PetscErrorCode EqmSphereResolved(EqmProblem problem, EqmIterate iterate);

#endif
