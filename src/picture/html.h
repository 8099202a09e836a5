/* The report as a page for a browser. */
#ifndef EQM_HTML_H
#define EQM_HTML_H

#include <cairo.h>
#include "base/atomicfile.h"
#include "picture.h"

PETSC_INTERN PetscErrorCode EqmWriteHtml(const EqmResult *result, int width, EqmAtomicFile *file,
                                         cairo_status_t *status);

#endif
