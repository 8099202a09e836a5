/* The point of a simplex that is closest to a given one, in barycentric coordinates. */
#ifndef EQM_CLOSEST_H
#define EQM_CLOSEST_H

#include <equimap/register.h>

/* Fill `barycentric` (one number per corner, none negative, sum one) and return the squared distance, 0 for a point of
   the simplex itself. Not collective. */
PETSC_INTERN PetscReal EqmClosestOnTriangle(const PetscReal y[3], const PetscReal *a, const PetscReal *b,
                                            const PetscReal *c, PetscReal barycentric[3]);
PETSC_INTERN PetscReal EqmClosestOnCell(EqmImageKind kind, PetscInt cell_size, const PetscReal y[3],
                                        const PetscReal *const corner[4], PetscReal barycentric[4]);
/* Area or volume of a cell, negative where it is seen from behind (on the sphere by its determinant). */
PETSC_INTERN PetscReal EqmSignedMeasure(EqmImageKind kind, PetscInt cell_size, const PetscReal *const corner[4]);

#endif
