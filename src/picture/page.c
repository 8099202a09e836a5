/* The page of a result: title, pictures, colour bar, charts, numbers. */
#ifdef EQM_HAVE_CAIRO
#include "page.h"
#include <math.h>
#include <string.h>

static const double margin = 44.0, top = 122.0, below_views = 388.0;

static const char *BaseName(const char *path)
{
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

static void DrawTitle(cairo_t *page, const EqmResult *result)
{
  const PetscBool has_other = (PetscBool)(result->other_file[0] != '\0');
  char title[128];
  char vertices[48], cells[48], line[512];
  double x;

  (void)snprintf(title, sizeof(title), "%.60s%s%.40s", result->mesh_file[0] ? BaseName(result->mesh_file) : "a map",
                 has_other ? " → " : "", has_other ? BaseName(result->other_file) : "");
  EqmDrawText(page, margin, 62, 30, PETSC_TRUE, EQM_LEFT, EQM_INK, title);
  x = margin + EqmTextWidth(page, 30, PETSC_TRUE, title) + 22;
  EqmCountText(result->num_vertices, vertices, sizeof(vertices));
  EqmCountText(result->num_cells, cells, sizeof(cells));
  (void)snprintf(line, sizeof(line), "%s%s%s", result->command, result->command[0] && result->method[0] ? ", " : "",
                 result->method);
  EqmDrawText(page, x, 62, 20, PETSC_FALSE, EQM_LEFT, EQM_GREY, line);
  (void)snprintf(line, sizeof(line), "%s vertices, %s %s", vertices, cells,
                 result->cell_size == 3 ? "triangles" : "tetrahedra");
  EqmDrawText(page, EQM_PAGE_WIDTH - margin, 62, 20, PETSC_FALSE, EQM_RIGHT, EQM_INK, line);
  (void)snprintf(line, sizeof(line), "%s%s%.300s", result->status, result->status[0] && result->message[0] ? ": " : "",
                 result->message);
  EqmDrawText(page, margin, 92, 15, PETSC_FALSE, EQM_LEFT,
              strncmp(result->status, "converged", 9) ? EQM_ORANGE : EQM_GREY, line);
}

/* A bar of colours from the smallest to the largest ratio that has its own, labelled with ratios. */
static void DrawColorBar(cairo_t *page, const EqmResult *result, EqmColorScale scale, EqmBox box)
{
  enum { STRIPES = 256 };
  const int digits = 1 + (int)ceil(-log10(scale.limit - 1.0) - 1e-9); /* enough to tell the ticks apart */

  for (int k = 0; k < STRIPES; k++) {
    double rgb[3];
    EqmColorOfRatio(scale, pow(scale.limit, 2.0 * (k + 0.5) / STRIPES - 1.0), rgb);
    cairo_set_source_rgb(page, rgb[0], rgb[1], rgb[2]);
    cairo_rectangle(page, box.x + k * box.width / STRIPES, box.y, box.width / STRIPES + 0.6, box.height);
    cairo_fill(page);
  }
  cairo_rectangle(page, box.x, box.y, box.width, box.height);
  cairo_set_line_width(page, 0.8);
  EqmSetInk(page, EQM_GREY);
  cairo_stroke(page);
  for (int k = -2; k <= 2; k++) {
    char text[48];
    if (scale.limit > 1.15)
      (void)snprintf(text, sizeof(text), "%.3g", pow(scale.limit, 0.5 * k));
    else
      (void)snprintf(text, sizeof(text), "%.*f", digits, pow(scale.limit, 0.5 * k));
    EqmDrawText(page, box.x + box.width * (0.5 + 0.25 * k), box.y + box.height + 17, 12, PETSC_FALSE, EQM_CENTER,
                EQM_GREY, text);
  }
  EqmDrawText(page, box.x - 14, box.y + box.height - 1, 13, PETSC_FALSE, EQM_RIGHT, EQM_INK,
              result->cell_size == 3 ? "area ratio r: shrunk" : "volume ratio r: shrunk");
  EqmDrawText(page, box.x + box.width + 14, box.y + box.height - 1, 13, PETSC_FALSE, EQM_LEFT, EQM_INK,
              result->folds > 0 ? "grown;  folded cells magenta" : "grown");
}

static double DrawRow(cairo_t *page, EqmBox box, double y, const char *name, const char *value)
{
  EqmDrawText(page, box.x, y, 14, PETSC_FALSE, EQM_LEFT, EQM_GREY, name);
  EqmDrawText(page, box.x + box.width, y, 14, PETSC_TRUE, EQM_RIGHT, EQM_INK, value);
  cairo_set_line_width(page, 1.0);
  EqmSetInk(page, EQM_PALE);
  cairo_move_to(page, box.x, y + 8.5);
  cairo_line_to(page, box.x + box.width, y + 8.5);
  cairo_stroke(page);
  return y + 26;
}

static void DrawNumbers(cairo_t *page, const EqmResult *result, EqmBox box)
{
  char text[128], other[48];
  double y = box.y + 6;

  EqmNumberText(result->energy_final, text, sizeof(text));
  y = DrawRow(page, box, y, "energy E", text);
  EqmNumberText(result->ratio_statistics.sd, text, sizeof(text));
  y = DrawRow(page, box, y, "SD of r", text);
  EqmNumberText(result->ratio_statistics.min, text, sizeof(text));
  EqmNumberText(result->ratio_statistics.max, other, sizeof(other));
  (void)PetscStrlcat(text, " … ", sizeof(text));
  (void)PetscStrlcat(text, other, sizeof(text));
  y = DrawRow(page, box, y, "r from … to", text);
  EqmCountText(result->folds, text, sizeof(text));
  y = DrawRow(page, box, y, "folds", text);
  if (result->cell_size == 3) {
    (void)snprintf(text, sizeof(text), "%.1f° / %.1f°", result->angle_mean, result->angle_median);
    y = DrawRow(page, box, y, "angle error, mean / median", text);
  }
  EqmCountText(result->iterations, text, sizeof(text));
  y = DrawRow(page, box, y, "iterations", text);
  EqmNumberText(result->seconds, text, sizeof(text));
  y = DrawRow(page, box, y, "seconds", text);
  (void)snprintf(text, sizeof(text), "%" PetscInt64_FMT " × %" PetscInt64_FMT, result->ranks, result->threads);
  (void)DrawRow(page, box, y, "ranks × threads", text);
}

/* How high the page of a result is, in page units. Not collective. */
double EqmPageHeight(const EqmResult *result)
{
  return top + EqmViewsHeight(result, EQM_PAGE_WIDTH - 2 * margin) + below_views;
}

static void DrawFooter(cairo_t *page, const EqmResult *result)
{
  char line[512];

  (void)snprintf(line, sizeof(line), "equimap %s (%s)   %s", result->version, result->commit, result->date);
  EqmDrawText(page, EQM_PAGE_WIDTH - margin, EqmPageHeight(result) - 18, 11, PETSC_FALSE, EQM_RIGHT, EQM_GREY, line);
}

/* Draw the page of a result, EQM_PAGE_WIDTH by EqmPageHeight units; pictures in it get `pixels_per_unit`. Not
   collective. */
PetscErrorCode EqmDrawPage(cairo_t *page, const EqmResult *result, double pixels_per_unit)
{
  const EqmColorScale scale = EqmColorScaleOf(result->ratio, result->num_cells);
  const double inner = EQM_PAGE_WIDTH - 2 * margin, bottom = EqmPageHeight(result), charts = bottom - 276;
  const EqmBox views = {margin, top, inner, bottom - below_views - top};
  const EqmBox bar = {0.5 * EQM_PAGE_WIDTH - 220, bottom - 370, 440, 14}, histogram = {margin + 36, charts, 350, 190};
  const EqmBox by_iteration = {530, charts, 330, 190}, by_time = {890, charts, 300, 190};
  const EqmBox numbers = {1240, charts - 4, EQM_PAGE_WIDTH - margin - 1240, 200};

  PetscFunctionBegin;
  cairo_set_source_rgb(page, 1, 1, 1);
  cairo_paint(page);
  DrawTitle(page, result);
  PetscCall(EqmDrawViews(page, result, scale, views, pixels_per_unit));
  DrawColorBar(page, result, scale, bar);
  PetscCall(EqmDrawHistogram(page, result, scale, histogram));
  EqmDrawConvergence(page, result, by_iteration, by_time);
  DrawNumbers(page, result, numbers);
  DrawFooter(page, result);
  PetscFunctionReturn(0);
}
#endif
