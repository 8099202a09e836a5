/* The page as a file. */
#include "picture.h"
#include "store/store.h"

#ifdef EQM_HAVE_CAIRO
#include "base/atomicfile.h"
#include "page.h"
#include "html.h"
#include <cairo-pdf.h>
#include <cairo-svg.h>

static cairo_status_t Append(void *closure, const unsigned char *bytes, unsigned int length)
{
  EqmAtomicFile *file = (EqmAtomicFile *)closure;

  EqmAtomicWrite(file, bytes, length);
  return file->error_number ? CAIRO_STATUS_WRITE_ERROR : CAIRO_STATUS_SUCCESS;
}

/* Draw on a surface and take both apart; `scale` page units to the surface's own. */
static PetscErrorCode DrawOn(cairo_surface_t *surface, const EqmResult *result, double scale, double pixels_per_unit)
{
  cairo_t *page = cairo_create(surface);

  PetscFunctionBegin;
  cairo_scale(page, scale, scale);
  PetscCall(EqmDrawPage(page, result, pixels_per_unit));
  cairo_show_page(page);
  cairo_destroy(page);
  PetscFunctionReturn(0);
}

/* Draw the page as a PNG of `width` pixels and hand it piece by piece to `write`. Not collective. */
PetscErrorCode EqmPageToPng(const EqmResult *result, int width, cairo_write_func_t write, void *closure,
                            cairo_status_t *status)
{
  const double scale = width / EQM_PAGE_WIDTH;
  cairo_surface_t *surface =
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, (int)(scale * EqmPageHeight(result)));

  PetscFunctionBegin;
  PetscCall(DrawOn(surface, result, scale, scale));
  *status = cairo_surface_write_to_png_stream(surface, write, closure);
  cairo_surface_destroy(surface);
  PetscFunctionReturn(0);
}

static PetscErrorCode DrawVectors(const EqmResult *result, EqmAtomicFile *file, PetscBool svg, int width,
                                  cairo_status_t *status)
{
  const double height = EqmPageHeight(result);
  cairo_surface_t *surface =
      svg ? cairo_svg_surface_create_for_stream(Append, file, EQM_PAGE_WIDTH, height)
          : cairo_pdf_surface_create_for_stream(Append, file, 0.5 * EQM_PAGE_WIDTH, 0.5 * height);

  PetscFunctionBegin;
  PetscCall(DrawOn(surface, result, svg ? 1.0 : 0.5, width / EQM_PAGE_WIDTH));
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
