/* The fields of a domain, read-only after creation, and what the files of this folder share. */
#ifndef EQM_DOMAIN_PRIVATE_H
#define EQM_DOMAIN_PRIVATE_H

#include <equimap/domain.h>
#include "mesh/mesh_private.h"

struct _p_EqmDomain {
  EqmMesh mesh;
  const char *name;
  EqmMeasureKind measure;          /* of image cells */
  PetscBool curved_image;          /* image cells can fold without a change of sign of their measure: folds are those of
                                      EQM_MEASURE_HALF_DET */
  PetscBool spherical_coordinates; /* vertices on the sphere move by their angles */
  PetscInt dim;                    /* coordinates of a place: 2 or 3 */
  const EqmVertexMotion *motion[EQM_MAX_MOTIONS]; /* the kinds of vertices, NULL behind the last */
  unsigned char *kind;                            /* per local vertex: its place in `motion` */
  PetscInt *dof_start;          /* per local vertex: place of its first degree of freedom in the global vector */
  unsigned char *dof_count;     /* per local vertex */
  PetscInt num_dofs, dof_first; /* owned degrees of freedom, and the global number of the first */
  PetscBool has_frames;         /* some kind stores three reals per vertex */
  PetscReal target_measure;     /* of the ideal image: pi, 1, 4 pi, 4 pi / 3 */
  PetscReal boundary_length;    /* of the target: 2 pi, 4 */
  PetscReal center[3];          /* of maps of solids: a point inside, from which every face is seen */
  PetscReal corner_arc[4];      /* square: arc lengths of the corners */
  PetscErrorCode (*place_boundary)(EqmDomain, EqmPlace *);
  PetscReal *boundary_place; /* cube: first places, three per local vertex; NULL elsewhere */
  PetscReal *arc_length; /* per local vertex: arc length along the boundary loop in [0, 1), -1 inside (disk, square) */
};

/* The kind of a local vertex. Not collective. */
static inline const EqmVertexMotion *EqmDomainMotion(EqmDomain domain, PetscInt v)
{
  return domain->motion[domain->kind[v]];
}

/* A planar domain without kinds of vertices yet, with the arc length of the boundary. Collective. */
PETSC_INTERN PetscErrorCode EqmDomainCreatePlanar(EqmMesh mesh, const char *name, EqmDomain *domain);
/* Number the degrees of freedom once motions and kinds are known: each rank's in the order of its vertices. Collective.
 */
PETSC_INTERN PetscErrorCode EqmDomainNumber(EqmDomain domain);
/* The retraction of kinds without degrees of freedom. Not collective. */
PETSC_INTERN void EqmRetractNowhere(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t,
                                    const PetscScalar *dofs, PetscReal *y, PetscReal *new_stored);

/* The sides of the unit cube that a place is on, as bits: 2k for coordinate k zero, 2k + 1 for one. Not collective. */
PETSC_INTERN PetscInt EqmCubeSides(const PetscReal place[3]);

/* The domain held-disk, with angles from the file in the options. Collective. */
PETSC_INTERN PetscErrorCode EqmDomainReadHeldDisk(EqmMesh mesh, const EqmDomainOptions *options, EqmDomain *domain);

/* Boundary vertices to the angles 2 pi arc_length of the unit circle (disk.c). Collective. */
PETSC_INTERN PetscErrorCode EqmDomainPlaceOnCircle(EqmDomain domain, EqmPlace *place);

/* This rank's share of the sums that EqmDomainBoundaryInOrder judges by, for callers with a reduction of their own: the
   length along the boundary, the number of steps that are not forward. Not collective. */
enum { EQM_BOUNDARY_SUMS = 2 };
PETSC_INTERN void EqmDomainSumBoundary(EqmDomain domain, const EqmPlace *place, PetscReal sum[EQM_BOUNDARY_SUMS]);
/* From the sums over all ranks. Not collective. */
PETSC_INTERN PetscBool EqmDomainIsInOrder(EqmDomain domain, const PetscReal sum[EQM_BOUNDARY_SUMS]);

/* EqmDomainExpand without the ghosts. Not collective. */
PETSC_INTERN PetscErrorCode EqmDomainExpandOwned(EqmDomain domain, const EqmPlace *place, Vec dofs, PetscReal *ambient);

#endif
