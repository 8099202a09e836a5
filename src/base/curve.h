/* Points in the order of Hilbert's curve through space: what is near in that order is near in space, and the order does
   not depend on how the points are dealt to the ranks. */
#ifndef EQM_CURVE_H
#define EQM_CURVE_H

#include <petscsys.h>
#include <stdint.h>

/* A cube of space. */
typedef struct {
  PetscReal low[3], width;
} EqmCube;

/* A place along the curve; where two are the same, the number decides. */
typedef struct {
  uint64_t key;
  PetscInt number;
} EqmCurvePlace;

/* The least cube from the lower corner on that holds the points, three reals each, of all ranks. Collective. */
PETSC_INTERN PetscErrorCode EqmCurveBox(MPI_Comm comm, PetscInt num, const PetscReal *points, EqmCube *cube);
/* How far along the curve through the cube a point of it is. Not collective. */
PETSC_INTERN uint64_t EqmCurveKey(const EqmCube *cube, const PetscReal *point);
/* For qsort and bsearch: -1, 0 or 1. Not collective. */
PETSC_INTERN int EqmCurveCompare(const void *left, const void *right);
/* Cut the curve where so many of the places of all ranks come before: cut[k] is the last place with no more than
   before[k]. `sorted`: the places of this rank, in order, no two the same on any ranks. Collective. */
PETSC_INTERN PetscErrorCode EqmCurveCut(MPI_Comm comm, PetscInt num, const EqmCurvePlace *sorted, PetscMPIInt num_cuts,
                                        const PetscInt64 *before, EqmCurvePlace *cut);

#endif
