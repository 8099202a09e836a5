/* The page as a file. */
#include "picture.h"
#include "store/store.h"

#ifdef EQM_HAVE_CAIRO
#include "base/atomicfile.h"
#include "page.h"
#include "html.h"
#include "picture/surface.h"
#include <cairo-pdf.h>
#include <cairo-svg.h>

static cairo_status_t Append(void *closure, const unsigned char *bytes, unsigned int length)
{
  EqmAtomicFile *file = (EqmAtomicFile *)closure;

  EqmAtomicWrite(file, bytes, length);
  return file->error_number ? CAIRO_STATUS_WRITE_ERROR : CAIRO_STATUS_SUCCESS;
}

static PetscErrorCode DrawVectors(const EqmResult *result, EqmAtomicFile *file, PetscBool svg, int width,
                                  cairo_status_t *status)
{
  const double height = EqmPageHeight(result);
  cairo_surface_t *surface =
      svg ? cairo_svg_surface_create_for_stream(Append, file, EQM_PAGE_WIDTH, height)
          : cairo_pdf_surface_create_for_stream(Append, file, 0.5 * EQM_PAGE_WIDTH, 0.5 * height);

  PetscFunctionBegin;
  PetscCall(EqmDrawOn(surface, result, svg ? 1.0 : 0.5, width / EQM_PAGE_WIDTH));
  cairo_surface_finish(surface);
  *status = cairo_surface_status(surface);
  cairo_surface_destroy(surface);
  PetscFunctionReturn(0);
}

static PetscErrorCode DrawFile(const EqmResult *result, EqmAtomicFile *file, int width, cairo_status_t *status)
{
  PetscFunctionBegin;
  if (EqmHasSuffix(file->path, ".png"))
    PetscCall(EqmPageToPng(result, width, Append, file, status));
  else if (EqmHasSuffix(file->path, ".html"))
    PetscCall(EqmWriteHtml(result, width, file, status));
  else
    PetscCall(DrawVectors(result, file, EqmHasSuffix(file->path, ".svg"), width, status));
  PetscFunctionReturn(0);
}

/* Draw the page of a result into a file, whole or not at all; .png .pdf .svg .html by suffix; pictures are made for a
   page of `width` pixels. Not collective. Errors: EQM_ERR_USAGE, EQM_ERR_IO; quiet, the reason is in `error`. */
PetscErrorCode EqmPictureWrite(const EqmResult *result, const char *name, int width, char *error, size_t length)
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
  code = DrawFile(result, &file, width, &status);
  if (code || (status != CAIRO_STATUS_SUCCESS && !file.error_number)) {
    EqmAtomicAbort(&file);
    (void)snprintf(error, length, "cannot draw '%.1000s': %s", name, cairo_status_to_string(status));
    return code ? code : EQM_ERR_IO;
  }
  return EqmAtomicCommit(&file, error, length);
}

#else

/* Without cairo there is nothing to draw with. Not collective. Errors: EQM_ERR_USAGE, quiet. */
PetscErrorCode EqmPictureWrite(const EqmResult *result, const char *name, int width, char *error, size_t length)
{
  (void)result;
  (void)width;
  (void)snprintf(
      error, length,
      "cannot draw '%.1000s': this equimap was built without cairo; install it (Debian: libcairo2-dev) and build again",
      name);
  return EQM_ERR_USAGE;
}
#endif
