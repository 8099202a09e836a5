/* Bounds on the gaps between neighbours on a disk's boundary loop. */
#ifndef EQM_LOOPGAPS_H
#define EQM_LOOPGAPS_H

#include "method/loop.h"

/* The boundary's order is kept gap by gap, as an active set of bounds (Bertsekas 1982): were steps shortened until no
   gap closes, one pair of neighbours that the energy draws together would hold up all the others. */
typedef struct _p_EqmGaps *EqmGaps;
/* With the gaps of places x, two reals per local vertex, as the measure: none may become shorter than a hundredth
   of what it is there, or than `least`. The loop must outlive it. Collective. */
PETSC_INTERN PetscErrorCode EqmGapsCreate(EqmLoop loop, const PetscReal *x, PetscReal least, EqmGaps *gaps);
PETSC_INTERN PetscErrorCode EqmGapsDestroy(EqmGaps *gaps);
/* The present places. Collective. */
PETSC_INTERN PetscErrorCode EqmGapsSet(EqmGaps gaps, const PetscReal *x);
/* Project a direction, an angle per owned boundary vertex, to those that close no gap at its bound. Collective. */
PETSC_INTERN PetscErrorCode EqmGapsProject(EqmGaps gaps, Vec direction);
/* Change a direction so that its full step, or nearly that, closes no gap. Collective. */
PETSC_INTERN PetscErrorCode EqmGapsClip(EqmGaps gaps, Vec direction);
/* The largest t in (0, 1] for which t times the direction keeps all gaps above their bounds, with a margin.
   Collective. */
PETSC_INTERN PetscErrorCode EqmGapsLongestStep(EqmGaps gaps, Vec direction, PetscReal *t);

#endif
