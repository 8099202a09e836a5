/* The figures of a result that a page lists, as formatted text. */
#ifndef EQM_FIGURES_H
#define EQM_FIGURES_H

#include "picture/picture.h"

enum { EQM_MOST_FIGURES = 32, EQM_FIGURE_TEXT_LENGTH = 192 };

/* How many figures there are; the name of one of them for a kind of result; its text, empty where the result has none.
 */
PETSC_INTERN int EqmNumFigures(void);
PETSC_INTERN const char *EqmFigureName(const EqmResult *result, int figure);
PETSC_INTERN void EqmFigureText(const EqmResult *result, int figure, char *text, size_t length);

#endif
