/* Of a mistyped name, the one that was meant. */
#ifndef EQM_NEAREST_H
#define EQM_NEAREST_H

#include <petscsys.h>

/* The name among `num` that differs from `word` by the fewest letters inserted, dropped, changed or swapped with their
   neighbour, whatever their case, or NULL if none comes within one letter and a third of the word. Not collective. */
PETSC_INTERN const char *EqmNearestName(const char *word, const char *const names[], int num);

/* " (did you mean NAME?)" of the nearest name, or "". Not collective. */
PETSC_INTERN PetscErrorCode EqmDidYouMean(const char *word, const char *const names[], int num, char *text,
                                          size_t length);

#endif
