/* Surface and image of a result to turn in a browser. */
#ifndef EQM_TURN_H
#define EQM_TURN_H

#include "base/atomicfile.h"
#include "picture/picture.h"

/* Write a block of HTML that turns result k of the page with its image by WebGL 2, without a network; hidden where the
   browser has no WebGL 2. More faces than a browser likes are thinned out by joining close vertices. Not collective. */
PETSC_INTERN PetscErrorCode EqmWriteTurning(const EqmPage *page, PetscInt k, EqmAtomicFile *file);
/* The script that all blocks share; once, before them. Not collective. */
PETSC_INTERN void EqmWriteTurningScript(EqmAtomicFile *file);

#endif
