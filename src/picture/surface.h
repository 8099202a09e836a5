/* The page of a result on a cairo surface. */
#ifndef EQM_SURFACE_H
#define EQM_SURFACE_H

#include <cairo.h>
#include "picture/picture.h"

/* Draw the page; `scale` is the length of a page unit in units of the surface, pictures in the page get
   `pixels_per_unit` pixels per page unit. Not collective. */
PETSC_INTERN PetscErrorCode EqmDrawOn(cairo_surface_t *surface, const EqmPage *page, double scale,
                                      double pixels_per_unit);
/* Draw the page as a PNG that is `width` pixels wide and hand it piece by piece to `write`; what cairo says of it is in
   `status`. Not collective. */
PETSC_INTERN PetscErrorCode EqmPageToPng(const EqmPage *page, int width, cairo_write_func_t write, void *closure,
                                         cairo_status_t *status);

#endif
