/* The page: headings, pictures, colour bars, charts, figures. */
#ifdef EQM_HAVE_CAIRO
#include "picture/page.h"
#include <math.h>
#include <string.h>

static const double inner = EQM_PAGE_WIDTH - 2 * EQM_PAGE_MARGIN;
static const double top = 122.0, between = 74.0, bar_room = 76.0, charts_height = 250.0, footer = 40.0;

static const char *BaseName(const char *path)
{
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

void EqmDrawHeading(cairo_t *cairo, const EqmPage *page, PetscInt k, double y, double size)
{
  const EqmResult *const result = &page->results[k];
  const PetscBool has_other = (PetscBool)(result->other_file[0] != '\0');
  char title[128], vertices[48], cells[48], line[512];
  double x;

  (void)snprintf(title, sizeof(title), "%.60s%s%.40s", result->mesh_file[0] ? BaseName(result->mesh_file) : "a map",
                 has_other ? " → " : "", has_other ? BaseName(result->other_file) : "");
  EqmDrawText(cairo, EQM_PAGE_MARGIN, y, size, PETSC_TRUE, EQM_LEFT, EQM_INK, title);
  x = EQM_PAGE_MARGIN + EqmTextWidth(cairo, size, PETSC_TRUE, title) + 0.75 * size;
  EqmCountText(result->num_vertices, vertices, sizeof(vertices));
  EqmCountText(result->num_cells, cells, sizeof(cells));
  (void)snprintf(line, sizeof(line), "%s%s%s%s%.80s", result->command,
                 result->command[0] && result->method[0] ? ", " : "", result->method, page->num > 1 ? ",  " : "",
                 page->num > 1 ? BaseName(result->file) : "");
  EqmDrawText(cairo, x, y, fmax(14.0, 0.66 * size), PETSC_FALSE, EQM_LEFT, EQM_GREY, line);
  (void)snprintf(line, sizeof(line), "%s vertices, %s %s", vertices, cells,
                 result->cell_size == 3 ? "triangles" : "tetrahedra");
  EqmDrawText(cairo, EQM_PAGE_WIDTH - EQM_PAGE_MARGIN, y, fmax(14.0, 0.66 * size), PETSC_FALSE, EQM_RIGHT, EQM_INK,
              line);
  (void)snprintf(line, sizeof(line), "%s%s%.300s", result->status, result->status[0] && result->message[0] ? ": " : "",
                 result->message);
  EqmDrawText(cairo, EQM_PAGE_MARGIN, y + size, 15, PETSC_FALSE, EQM_LEFT,
              strncmp(result->status, "converged", 9) ? EQM_ORANGE : EQM_GREY, line);
}

/* Of several results each has a number, in its colour. */
static void DrawNumber(cairo_t *cairo, PetscInt k, double y)
{
  char text[16];

  (void)snprintf(text, sizeof(text), "%d", (int)k + 1);
  EqmDrawText(cairo, EQM_PAGE_MARGIN - 12, y, 20, PETSC_TRUE, EQM_RIGHT, EqmInkOf(k), text);
}

static PetscErrorCode DrawRows(cairo_t *cairo, const EqmPage *page, double pixels_per_unit, double *y)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < page->num; k++) {
    const EqmResult *const result = &page->results[k];
    const double height = EqmViewsHeight(page, result, inner);
    EqmDrawHeading(cairo, page, k, *y, page->num > 1 ? 20.0 : 30.0);
    if (page->num > 1) DrawNumber(cairo, k, *y);
    *y += page->num > 1 ? between - 20.0 : top - 62.0;
    PetscCall(EqmDrawViews(cairo, page, result, (EqmBox){EQM_PAGE_MARGIN, *y, inner, height}, pixels_per_unit));
    *y += height + (page->num > 1 ? 30.0 : 0.0);
  }
  PetscFunctionReturn(0);
}

static void DrawBars(cairo_t *cairo, const EqmPage *page, double y)
{
  const PetscBool two = (PetscBool)(page->distances.limit > 0.0);

  EqmDrawColorBar(cairo, page, (EqmBox){0.5 * EQM_PAGE_WIDTH - 220 - (two ? 150 : 0), y, two ? 340 : 440, 14});
  if (two) EqmDrawDistanceBar(cairo, page, (EqmBox){EQM_PAGE_WIDTH - EQM_PAGE_MARGIN - 340, y, 310, 14});
}

static double ChartsHeight(const EqmPage *page)
{
  return page->num == 1 ? fmax(charts_height, EqmTableHeight(page) + 10.0)
                        : charts_height + EqmTableHeight(page) + 30.0;
}

/* One result: charts and figures beside each other; several: the figures below. */
static void DrawCharts(cairo_t *cairo, const EqmPage *page, double y)
{
  const EqmBox by_iteration = {520, y, 270, 180}, by_time = {830, y, 240, 180};

  if (page->num == 1) {
    EqmDrawHistogram(cairo, page, (EqmBox){EQM_PAGE_MARGIN + 36, y, 350, 180});
    EqmDrawConvergence(cairo, page, by_iteration, by_time);
    EqmDrawTable(cairo, page, (EqmBox){1120, y - 14, EQM_PAGE_WIDTH - EQM_PAGE_MARGIN - 1120, 0});
    return;
  }
  EqmDrawAllCurves(cairo, page, (EqmBox){EQM_PAGE_MARGIN + 60, y, 640, 180},
                   (EqmBox){EQM_PAGE_MARGIN + 780, y, 640, 180});
  EqmDrawTable(cairo, page, (EqmBox){EQM_PAGE_MARGIN, y + charts_height, inner, 0});
}

double EqmPageHeight(const EqmPage *page)
{
  double height = 62.0 + bar_room + ChartsHeight(page) + footer;

  for (PetscInt k = 0; k < page->num; k++)
    height += EqmViewsHeight(page, &page->results[k], inner) + (page->num > 1 ? between + 10.0 : top - 62.0);
  return height;
}

static void DrawFooter(cairo_t *cairo, const EqmPage *page)
{
  const EqmResult *const result = page->results;
  char line[512];

  (void)snprintf(line, sizeof(line), "equimap %s (%s)   %s", result->version, result->commit, result->date);
  EqmDrawText(cairo, EQM_PAGE_WIDTH - EQM_PAGE_MARGIN, EqmPageHeight(page) - 18, 11, PETSC_FALSE, EQM_RIGHT, EQM_GREY,
              line);
}

PetscErrorCode EqmDrawPage(cairo_t *cairo, const EqmPage *page, double pixels_per_unit)
{
  double y = 62.0;

  PetscFunctionBegin;
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
  PetscCall(DrawRows(cairo, page, pixels_per_unit, &y));
  DrawBars(cairo, page, y + 18.0);
  DrawCharts(cairo, page, y + bar_room + 20.0);
  DrawFooter(cairo, page);
  PetscFunctionReturn(0);
}
#endif
