/* The report as a page for a browser. */
#ifndef EQM_HTML_H
#define EQM_HTML_H

#include <cairo.h>
#include "base/atomicfile.h"
#include "picture/picture.h"

/* Write the report, its picture inside; what cairo says of the picture is in `status`. Not collective. */
PETSC_INTERN PetscErrorCode EqmWriteHtml(const EqmPage *page, int width, EqmAtomicFile *file, cairo_status_t *status);

#endif
