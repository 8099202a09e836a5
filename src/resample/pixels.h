/* Pixels of a geometry image as a file; for one rank. */
#ifndef EQM_PIXELS_H
#define EQM_PIXELS_H

#include "base/atomicfile.h"

typedef struct {
  int size, channels;      /* size x size pixels of 1 to 4 numbers */
  const PetscReal *values; /* rows from below, as the square's vertices are numbered */
  const char *quantity;    /* what they are */
} EqmPixels;

/* Does the name end as one of a TIFF? */
PETSC_INTERN PetscBool EqmIsTiff(const char *file);
/* The library that is missing for such a file, or NULL. */
PETSC_INTERN const char *EqmPixelsMissing(const char *file);
/* Errors, quiet, with a sentence in `message`: EQM_ERR_IO, EQM_ERR_USAGE (no library). */
PETSC_INTERN PetscErrorCode EqmPixelsToPng(const EqmPixels *pixels, EqmAtomicFile *file, char *message, size_t length);
PETSC_INTERN PetscErrorCode EqmPixelsToTiff(const EqmPixels *pixels, const char *path, char *message, size_t length);

#endif
