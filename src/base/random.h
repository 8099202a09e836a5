/* Random numbers that depend on the vertex or cell and not on the rank: the same on any number of ranks. */
#ifndef EQM_RANDOM_H
#define EQM_RANDOM_H

#include <petscsys.h>

/* A number in [0, 1), evenly distributed, that depends on its arguments alone: `index` says which object it belongs to,
   `channel` which of its numbers. Not collective. */
PETSC_INTERN PetscReal EqmHashUniform(PetscInt seed, PetscInt index, PetscInt channel);

#endif
