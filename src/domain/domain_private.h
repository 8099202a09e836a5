/* Shared by the files of this room. */
#ifndef EQM_DOMAIN_PRIVATE_H
#define EQM_DOMAIN_PRIVATE_H

#include <equimap/domain.h>

PETSC_INTERN PetscErrorCode EqmDomainCreatePlanar(EqmMesh mesh, const char *name, EqmDomain *domain,
                                                  PetscInt **loop_place);
PETSC_INTERN PetscErrorCode EqmDomainNumber(EqmDomain domain);
PETSC_INTERN void EqmFromAngles(const PetscReal angle[2], PetscReal x[3], PetscReal by_polar[3],
                                PetscReal by_azimuth[3]);
PETSC_INTERN void EqmToAngles(const PetscReal x[3], PetscReal angle[2]);
PETSC_INTERN PetscReal EqmSquareAdvance(const PetscReal p[2], const PetscReal q[2]);

#endif
