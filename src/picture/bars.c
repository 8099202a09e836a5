/* Colour bars: the legends of the pictures. */
#ifdef EQM_HAVE_CAIRO
#include "picture/page.h"
#include <math.h>

static void DrawBar(cairo_t *cairo, EqmColorScale scale, EqmBox box)
{
  enum { STRIPES = 256 };

  for (int k = 0; k < STRIPES; k++) {
    double rgb[3];
    EqmColorOf(scale, EqmColorScaleValue(scale, (k + 0.5) / STRIPES), rgb);
    cairo_set_source_rgb(cairo, rgb[0], rgb[1], rgb[2]);
    cairo_rectangle(cairo, box.x + k * box.width / STRIPES, box.y, box.width / STRIPES + 0.6, box.height);
    cairo_fill(cairo);
  }
  cairo_rectangle(cairo, box.x, box.y, box.width, box.height);
  cairo_set_line_width(cairo, 0.8);
  EqmSetInk(cairo, EQM_GREY);
  cairo_stroke(cairo);
  for (int k = 0; k <= 4; k++) {
    const double value = EqmColorScaleValue(scale, 0.25 * k);
    char text[48];
    if (scale.kind == EQM_SCALE_DISTANCE)
      EqmNumberText(value, text, sizeof(text));
    else if (scale.limit > 1.15)
      (void)snprintf(text, sizeof(text), "%.3g", value);
    else /* enough digits to tell the ticks apart */
      (void)snprintf(text, sizeof(text), "%.*f", 1 + (int)ceil(-log10(scale.limit - 1.0) - 1e-9), value);
    EqmDrawText(cairo, box.x + 0.25 * k * box.width, box.y + box.height + 17, 12, PETSC_FALSE, EQM_CENTER, EQM_GREY,
                text);
  }
}

static void DrawEnds(cairo_t *cairo, EqmBox box, const char *left, const char *right)
{
  EqmDrawText(cairo, box.x - 14, box.y + box.height - 1, 13, PETSC_FALSE, EQM_RIGHT, EQM_INK, left);
  EqmDrawText(cairo, box.x + box.width + 14, box.y + box.height - 1, 13, PETSC_FALSE, EQM_LEFT, EQM_INK, right);
}

/* The ratio or stretch farthest from one. */
static double Farthest(const EqmPage *page)
{
  double farthest = 0.0;

  for (PetscInt k = 0; k < page->num; k++) {
    const EqmResult *const r = &page->results[k];
    const double here =
        page->conformal ? r->quasi_max - 1.0 : fmax(r->ratio_statistics.max - 1.0, 1.0 - r->ratio_statistics.min);
    farthest = fmax(farthest, here);
  }
  return farthest;
}

/* To one digit. */
static double RoundUp(double value)
{
  const double power = pow(10.0, floor(log10(fmax(value, 1e-16))));

  return power * ceil(value / power);
}

void EqmDrawColorBar(cairo_t *cairo, const EqmPage *page, EqmBox box)
{
  const double farthest = Farthest(page);
  PetscInt64 folds = 0;
  char within[96] = "", right[160], number[48];

  for (PetscInt k = 0; k < page->num; k++) folds += page->results[k].folds;
  if (!page->start &&
      farthest < fmin(0.01, page->scale.limit - 1.0)) { /* a map that is better than the smallest scale shows */
    EqmNumberText(RoundUp(farthest), number, sizeof(number));
    (void)snprintf(within, sizeof(within), "; all within %s of 1", number);
  }
  (void)snprintf(right, sizeof(right), "%s%s%s", page->conformal ? "stretched" : "grown", within,
                 folds > 0 ? "; folded cells magenta" : "");
  DrawBar(cairo, page->scale, box);
  DrawEnds(cairo, box,
           page->conformal                   ? "ratio of a triangle's two stretches: its angles kept"
           : page->results[0].cell_size == 3 ? "area ratio r: shrunk"
                                             : "volume ratio r: shrunk",
           right);
}

void EqmDrawDistanceBar(cairo_t *cairo, const EqmPage *page, EqmBox box)
{
  DrawBar(cairo, page->distances, box);
  EqmDrawText(cairo, box.x + 0.5 * box.width, box.y - 6, 13, PETSC_FALSE, EQM_CENTER, EQM_INK,
              "distance from a point of A to its point on B");
}
#endif
