/* Equal points become one. */
#ifndef EQM_FORMAT_WELD_H
#define EQM_FORMAT_WELD_H

#include <stdint.h>
#include <equimap/base.h>

PETSC_INTERN PetscErrorCode EqmWeld(size_t num_points, PetscReal *points, size_t *num_distinct, PetscInt *number);
/* EqmWeldHash - equal points have equal hashes: 0 and -0 are equal, and a NaN equals the same NaN. Not collective. */
PETSC_INTERN uint64_t EqmWeldHash(const PetscReal *point);
/* EqmWeldParts - the same for points that the ranks hold, in rank order: the first among all that are equal counts,
   wherever it is. Collective.

   num_points - of this rank; afterwards how many of them are first, which are the first 3 * num_points of `points`
   number - per point that was given: the distinct point among those of all ranks
   success - false on every rank if there are more points than PetscInt can count */
PETSC_INTERN PetscErrorCode EqmWeldParts(MPI_Comm comm, size_t *num_points, PetscReal *points, PetscInt *number,
                                         PetscBool *success);

#endif
