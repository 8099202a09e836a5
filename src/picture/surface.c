/* The page on a cairo surface; as a PNG. */
#ifdef EQM_HAVE_CAIRO
#include "picture/surface.h"
#include "picture/page.h"

PetscErrorCode EqmDrawOn(cairo_surface_t *surface, const EqmPage *page, double scale, double pixels_per_unit)
{
  cairo_t *cairo = cairo_create(surface);

  PetscFunctionBegin;
  cairo_scale(cairo, scale, scale);
  PetscCall(EqmDrawPage(cairo, page, pixels_per_unit));
  cairo_show_page(cairo);
  cairo_destroy(cairo);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPageToPng(const EqmPage *page, int width, cairo_write_func_t write, void *closure,
                            cairo_status_t *status)
{
  const double scale = width / EQM_PAGE_WIDTH;
  cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, (int)(scale * EqmPageHeight(page)));

  PetscFunctionBegin;
  PetscCall(EqmDrawOn(surface, page, scale, scale));
  *status = cairo_surface_write_to_png_stream(surface, write, closure);
  cairo_surface_destroy(surface);
  PetscFunctionReturn(0);
}
#endif
