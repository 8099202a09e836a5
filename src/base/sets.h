/* Disjoint sets of numbers: set[i] is a member nearer to the root of i's set, and i itself at a root. */
#ifndef EQM_SETS_H
#define EQM_SETS_H

#include <petscsys.h>

/* The root of i's set; ways to it are halved. Not collective. */
static inline PetscInt EqmSetRoot(PetscInt *set, PetscInt i)
{
  while (set[i] != i) i = set[i] = set[set[i]];
  return i;
}

/* Join two sets under the lower root; false if they were one. Not collective. */
static inline PetscBool EqmSetJoin(PetscInt *set, PetscInt a, PetscInt b)
{
  a = EqmSetRoot(set, a);
  b = EqmSetRoot(set, b);
  if (a == b) return PETSC_FALSE;
  set[PetscMax(a, b)] = PetscMin(a, b);
  return PETSC_TRUE;
}

#endif
