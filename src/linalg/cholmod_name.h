/* CHOLMOD's functions for PETSc's width of integers. */
#ifndef EQM_CHOLMOD_NAME_H
#define EQM_CHOLMOD_NAME_H

#include <petscsys.h>
#include <cholmod.h>

#if defined(PETSC_USE_64BIT_INDICES)
#define CHOLMOD(name) cholmod_l_##name
#else
#define CHOLMOD(name) cholmod_##name
#endif

#endif
