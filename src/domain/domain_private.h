/* Shared by the files of this folder. */
#ifndef EQM_DOMAIN_PRIVATE_H
#define EQM_DOMAIN_PRIVATE_H

#include <equimap/domain.h>

/* A planar domain without kinds of vertices yet, with the arc length of the boundary. Collective. */
PETSC_INTERN PetscErrorCode EqmDomainCreatePlanar(EqmMesh mesh, const char *name, EqmDomain *domain);
/* Number the degrees of freedom once motions and kinds are known: each rank's in the order of its vertices. Collective.
 */
PETSC_INTERN PetscErrorCode EqmDomainNumber(EqmDomain domain);
/* The retraction of kinds without degrees of freedom. Not collective. */
PETSC_INTERN void EqmRetractNowhere(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t,
                                    const PetscScalar *dofs, PetscReal *y, PetscReal *new_stored);

/* held-disk, its angles from the file that the options name. Collective. */
PETSC_INTERN PetscErrorCode EqmDomainReadHeldDisk(EqmMesh mesh, const EqmDomainOptions *options, EqmDomain *domain);

/* Boundary vertices to the angles 2 pi arc_length of the unit circle (disk.c). Collective. */
PETSC_INTERN PetscErrorCode EqmDomainPlaceOnCircle(EqmDomain domain, EqmPlace *place);

#endif
