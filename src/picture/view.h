/* One picture of a row. */
#ifndef EQM_VIEW_H
#define EQM_VIEW_H

#include "picture/page.h"

typedef enum { EQM_PAINT_CELLS, EQM_PAINT_PATTERN, EQM_PAINT_DISTANCE } EqmPaint;

typedef struct {
  const EqmResult *result;
  const char *title;
  const EqmFaces *faces;
  const PetscReal *points;
  const float *normals; /* NULL: flat colours */
  EqmCamera camera;
  EqmPaint paint;
  PetscBool marked;       /* the worst cells are marked with their numbers */
  PetscBool landmarks;    /* landmarks are drawn, */
  const PetscReal *goals; /* and where they should go, 3 each, unless NULL */
  PetscBool lined;        /* lines of the user's and sharp edges are drawn */
} EqmView;

/* Paint the view into a square box, `size` pixels wide. */
PETSC_INTERN PetscErrorCode EqmPaintView(cairo_t *cairo, const EqmPage *page, const EqmView *view, EqmBox box,
                                         int size);

/* The worst cells with their numbers in the input, those that are seen. */
PETSC_INTERN void EqmDrawMarks(cairo_t *cairo, const EqmView *view, const EqmRaster *raster, EqmBox box);
/* The landmarks of a registration that are seen: a dot each where it is, a ring where it should be; neighbours on a
   feature curve (000 figure 6) are joined by a line, where they should be by a broken one. */
PETSC_INTERN PetscErrorCode EqmDrawLandmarks(cairo_t *cairo, const EqmView *view, const EqmRaster *raster, EqmBox box);
/* Lines of the user's and sharp edges, as far as nothing is in front of them; each line in a colour of its own. */
PETSC_INTERN void EqmDrawLines(cairo_t *cairo, const EqmView *view, const EqmRaster *raster, EqmBox box);

#endif
