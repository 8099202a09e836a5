/* Text, axes, curves and bars on a cairo page. */
#ifndef EQM_PLOT_H
#define EQM_PLOT_H

#include <cairo.h>
#include "picture/picture.h"

typedef struct {
  double x, y, width, height;
} EqmBox;

typedef struct {
  double low, high;
  PetscBool logarithmic;
  const char *label; /* NULL: no label */
  PetscBool bare;    /* no numbers beside the ticks */
  double gap;        /* between the axis and its numbers, beyond what is usual */
} EqmAxis;

typedef enum { EQM_LEFT, EQM_CENTER, EQM_RIGHT } EqmAlignment;
typedef enum {
  EQM_INK,
  EQM_GREY,
  EQM_PALE,
  EQM_BLUE,
  EQM_ORANGE,
  EQM_GREEN,
  EQM_VIOLET,
  EQM_SKY,
  EQM_YELLOW,
  EQM_BROWN,
  EQM_NUM_INKS
} EqmInk;

/* The colour of what is drawn next. */
PETSC_INTERN void EqmSetInk(cairo_t *page, EqmInk ink);
/* The colour of a result among several. */
PETSC_INTERN EqmInk EqmInkOf(PetscInt number);
PETSC_INTERN void EqmDrawText(cairo_t *page, double x, double y, double size, PetscBool bold, EqmAlignment alignment,
                              EqmInk ink, const char *text);
PETSC_INTERN double EqmTextWidth(cairo_t *page, double size, PetscBool bold, const char *text);
PETSC_INTERN void EqmNumberText(double value, char *text, size_t length);
PETSC_INTERN void EqmPowerText(double value, char *text, size_t length);
PETSC_INTERN void EqmCountText(PetscInt64 count, char *text, size_t length);

PETSC_INTERN EqmAxis EqmAxisOf(const double *values, PetscInt count, PetscBool logarithmic, const char *label);
PETSC_INTERN double EqmAxisPlace(const EqmAxis *axis, double value);
PETSC_INTERN void EqmDrawAxes(cairo_t *page, EqmBox box, const EqmAxis *across, const EqmAxis *along);
PETSC_INTERN void EqmDrawCurve(cairo_t *page, EqmBox box, const EqmAxis *across, const EqmAxis *along, PetscInt count,
                               const double *x, const double *y, EqmInk ink);

#endif
