/* One picture of a row. */
#ifndef EQM_VIEW_H
#define EQM_VIEW_H

#include "picture/page.h"

typedef enum { EQM_PAINT_CELLS, EQM_PAINT_PATTERN, EQM_PAINT_DISTANCE } EqmPaint;

typedef struct {
  const char *title;
  const EqmFaces *faces;
  const PetscReal *points;
  const float *normals; /* NULL: flat colours */
  EqmCamera camera;
  EqmPaint paint;
  PetscBool marked;    /* the worst cells are marked with their numbers */
  PetscBool landmarks; /* landmarks are drawn */
} EqmView;

/* Paint the view into a square box, `size` pixels wide. */
PETSC_INTERN PetscErrorCode EqmPaintView(cairo_t *cairo, const EqmPage *page, const EqmResult *result,
                                         const EqmView *view, EqmBox box, int size);

/* The worst cells with their numbers in the input, those that are seen. */
PETSC_INTERN void EqmDrawMarks(cairo_t *cairo, const EqmResult *result, const EqmView *view, const EqmRaster *raster,
                               EqmBox box);
/* The landmarks of a registration that are seen: on A a dot each; on B a dot where it went, a ring where it should. */
PETSC_INTERN void EqmDrawLandmarks(cairo_t *cairo, const EqmResult *result, const EqmView *view,
                                   const EqmRaster *raster, EqmBox box);

#endif
