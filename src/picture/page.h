/* The page and its parts. */
#ifndef EQM_PAGE_H
#define EQM_PAGE_H

#include "plot.h"

/* The page's width in its own units; a picture of any size is a scaled page. */
#define EQM_PAGE_WIDTH 1600.0

PETSC_INTERN double EqmPageHeight(const EqmResult *result);
PETSC_INTERN double EqmViewsHeight(const EqmResult *result, double width);
PETSC_INTERN PetscErrorCode EqmDrawPage(cairo_t *page, const EqmResult *result, double pixels_per_unit);
PETSC_INTERN PetscErrorCode EqmDrawViews(cairo_t *page, const EqmResult *result, EqmColorScale scale, EqmBox box,
                                         double pixels_per_unit);
PETSC_INTERN PetscErrorCode EqmDrawHistogram(cairo_t *page, const EqmResult *result, EqmColorScale scale, EqmBox box);
PETSC_INTERN void EqmDrawConvergence(cairo_t *page, const EqmResult *result, EqmBox by_iteration, EqmBox by_time);

#endif
