/* The page as a file. */
#include "picture/picture.h"
#include "store/store.h"

#ifdef EQM_HAVE_CAIRO
#include "base/atomicfile.h"
#include "picture/page.h"
#include "picture/html.h"
#include "picture/surface.h"
#include <cairo-pdf.h>
#include <cairo-svg.h>

static cairo_status_t Append(void *closure, const unsigned char *bytes, unsigned int length)
{
  EqmAtomicFile *file = (EqmAtomicFile *)closure;

  EqmAtomicWrite(file, bytes, length);
  return file->error_number ? CAIRO_STATUS_WRITE_ERROR : CAIRO_STATUS_SUCCESS;
}

static PetscErrorCode DrawVectors(const EqmPage *page, EqmAtomicFile *file, PetscBool svg, int width,
                                  cairo_status_t *status)
{
  const double height = EqmPageHeight(page);
  cairo_surface_t *surface =
      svg ? cairo_svg_surface_create_for_stream(Append, file, EQM_PAGE_WIDTH, height)
          : cairo_pdf_surface_create_for_stream(Append, file, 0.5 * EQM_PAGE_WIDTH, 0.5 * height);

  PetscFunctionBegin;
  PetscCall(EqmDrawOn(surface, page, svg ? 1.0 : 0.5, width / EQM_PAGE_WIDTH));
  cairo_surface_finish(surface);
  *status = cairo_surface_status(surface);
  cairo_surface_destroy(surface);
  PetscFunctionReturn(0);
}

static PetscErrorCode DrawFile(const EqmPage *page, EqmAtomicFile *file, int width, cairo_status_t *status)
{
  PetscFunctionBegin;
  if (EqmHasSuffix(file->path, ".png"))
    PetscCall(EqmPageToPng(page, width, Append, file, status));
  else if (EqmHasSuffix(file->path, ".html"))
    PetscCall(EqmWriteHtml(page, width, file, status));
  else
    PetscCall(DrawVectors(page, file, EqmHasSuffix(file->path, ".svg"), width, status));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPictureWrite(const EqmPage *page, const char *name, char *error, size_t length)
{
  cairo_status_t status = CAIRO_STATUS_SUCCESS;
  EqmAtomicFile file;
  PetscErrorCode code;

  if (!EqmHasSuffix(name, ".png") && !EqmHasSuffix(name, ".pdf") && !EqmHasSuffix(name, ".svg") &&
      !EqmHasSuffix(name, ".html")) {
    (void)snprintf(error, length, "cannot write '%.1000s': a report is a .png, .pdf, .svg or .html", name);
    return EQM_ERR_USAGE;
  }
  code = EqmAtomicOpen(name, &file, error, length);
  if (code) return code;
  code = DrawFile(page, &file, (int)page->options.width, &status);
  if (code || (status != CAIRO_STATUS_SUCCESS && !file.error_number)) {
    EqmAtomicAbort(&file);
    (void)snprintf(error, length, "cannot draw '%.1000s': %s", name, cairo_status_to_string(status));
    return code ? code : EQM_ERR_IO;
  }
  return EqmAtomicCommit(&file, error, length);
}

#else

/* Without cairo there is nothing to draw with. Not collective. Errors: EQM_ERR_USAGE, quiet. */
PetscErrorCode EqmPictureWrite(const EqmPage *page, const char *name, char *error, size_t length)
{
  (void)page;
  (void)snprintf(
      error, length,
      "cannot draw '%.1000s': this equimap was built without cairo; install it (Debian: libcairo2-dev) and build again",
      name);
  return EQM_ERR_USAGE;
}
#endif
