/* The page and its parts. Lengths are in page units. */
#ifndef EQM_PAGE_H
#define EQM_PAGE_H

#include "picture/plot.h"

/* The page's width in its own units; a picture of any size is a scaled page. */
#define EQM_PAGE_WIDTH  1600.0
#define EQM_PAGE_MARGIN 44.0

/* How high a page is; draw it. Pictures in it get `pixels_per_unit`. */
PETSC_INTERN double EqmPageHeight(const EqmPage *page);
PETSC_INTERN PetscErrorCode EqmDrawPage(cairo_t *cairo, const EqmPage *page, double pixels_per_unit);

/* A row of pictures, `width` wide: the surface or solid, a pattern pulled back to it, its image. */
PETSC_INTERN double EqmViewsHeight(const EqmPage *page, const EqmResult *result, double width);
PETSC_INTERN PetscErrorCode EqmDrawViews(cairo_t *cairo, const EqmPage *page, const EqmResult *result, EqmBox box,
                                         double pixels_per_unit);

/* Name and numbers of result k, its baseline at y; how it ended, below. */
PETSC_INTERN void EqmDrawHeading(cairo_t *cairo, const EqmPage *page, PetscInt k, double y, double size);
/* The bar of a scale's colours, with its values and what it stands for. */
PETSC_INTERN void EqmDrawColorBar(cairo_t *cairo, const EqmPage *page, EqmBox box);
PETSC_INTERN void EqmDrawDistanceBar(cairo_t *cairo, const EqmPage *page, EqmBox box);

/* One result: bars of the distribution of ratios or angle errors, curves of the energy. */
PETSC_INTERN void EqmDrawHistogram(cairo_t *cairo, const EqmPage *page, EqmBox box);
PETSC_INTERN void EqmDrawConvergence(cairo_t *cairo, const EqmPage *page, EqmBox by_iteration, EqmBox by_time);
/* Several results: the curves of all of them. */
PETSC_INTERN void EqmDrawAllCurves(cairo_t *cairo, const EqmPage *page, EqmBox by_iteration, EqmBox by_time);

/* The figures of all results: one row per figure and a column per result. */
PETSC_INTERN double EqmTableHeight(const EqmPage *page);
PETSC_INTERN void EqmDrawTable(cairo_t *cairo, const EqmPage *page, EqmBox box);

#endif
