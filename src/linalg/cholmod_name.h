/* CHOLMOD's functions for PETSc's width of integers, and what its two users share. */
#ifndef EQM_CHOLMOD_NAME_H
#define EQM_CHOLMOD_NAME_H

#include "linalg/linalg.h"
#include <cholmod.h>

#if defined(PETSC_USE_64BIT_INDICES)
#define CHOLMOD(name) cholmod_l_##name
#else
#define CHOLMOD(name) cholmod_##name
#endif

PETSC_INTERN void EqmEstimateCholmod(const cholmod_factor *factor, const cholmod_common *common, EqmEstimate *estimate);

#endif
