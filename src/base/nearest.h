/* Of a mistyped name, the one that was meant. */
#ifndef EQM_NEAREST_H
#define EQM_NEAREST_H

#include <petscsys.h>

/* EqmDidYouMean - " (did you mean NAME?)", or "" where no name is near.

   Not collective. names - words with blanks or commas between. The nearest is the one that differs from `word` by the
   fewest letters inserted, dropped, changed or swapped with their neighbour, whatever their case; by more than one
   letter and a third of the word it is not near. text - of `length` characters. */
PETSC_INTERN PetscErrorCode EqmDidYouMean(const char *word, const char *names, char *text, size_t length);

#endif
