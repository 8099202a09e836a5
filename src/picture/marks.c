/* What is marked in a picture: cells, landmarks. */
#ifdef EQM_HAVE_CAIRO
#include "picture/view.h"
#include <math.h>

/* A ring around the place, its number beside it at `label`. */
static void MarkPoint(cairo_t *cairo, double x, double y, double label, PetscInt cell)
{
  char text[32];

  (void)snprintf(text, sizeof(text), "%" PetscInt_FMT, cell);
  cairo_new_path(cairo);
  cairo_set_line_width(cairo, 3.5);
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_arc(cairo, x, y, 5.0, 0.0, 2 * PETSC_PI);
  cairo_stroke_preserve(cairo);
  cairo_set_line_width(cairo, 1.4);
  EqmSetInk(cairo, EQM_INK);
  cairo_stroke(cairo);
  cairo_set_source_rgba(cairo, 1, 1, 1, 0.75);
  cairo_rectangle(cairo, x + 8, label - 6, EqmTextWidth(cairo, 11, PETSC_FALSE, text) + 4, 13);
  cairo_fill(cairo);
  EqmDrawText(cairo, x + 10, label + 4, 11, PETSC_FALSE, EQM_LEFT, EQM_INK, text);
}

/* Nothing in front of it: nearer in the raster by more than a hundredth of the picture. */
static PetscBool IsSeen(const EqmRaster *raster, const double at[3])
{
  const int x = (int)at[0], y = (int)at[1];

  if (x < 0 || y < 0 || x >= raster->size || y >= raster->size) return PETSC_FALSE;
  return (PetscBool)(raster->depth[(size_t)y * (size_t)raster->size + (size_t)x] < at[2] + 0.01 * raster->size);
}

void EqmDrawMarks(cairo_t *cairo, const EqmResult *result, const EqmView *view, const EqmRaster *raster, EqmBox box)
{
  double place[EQM_NUM_MARKS][2];
  int drawn = 0;

  for (PetscInt m = 0; m < result->num_marks; m++) {
    const PetscInt *const v = result->cells + result->cell_size * result->mark[m];
    double centroid[3] = {0, 0, 0}, at[3];
    for (PetscInt k = 0; k < 3 * result->cell_size; k++)
      centroid[k % 3] += view->points[3 * v[k / 3] + k % 3] / result->cell_size;
    EqmCameraProject(&view->camera, raster->size, centroid, at);
    if (!IsSeen(raster, at)) continue;
    const double x = box.x + at[0] * box.width / raster->size, y = box.y + at[1] * box.height / raster->size;
    place[drawn][0] = x;
    place[drawn][1] = y;
    for (int k = 0; k < drawn; k++) { /* numbers do not hide each other */
      if (fabs(place[k][0] - x) < 45 && fabs(place[k][1] - place[drawn][1]) < 13.5) {
        place[drawn][1] = place[k][1] + 14;
        k = -1;
      }
    }
    MarkPoint(cairo, x, y, place[drawn++][1], result->mark[m]);
  }
}

/* Where a point of the scene is in the box; false if something is in front of it. */
static PetscBool PlaceOf(const EqmView *view, const EqmRaster *raster, EqmBox box, const PetscReal *point, double *x,
                         double *y)
{
  double at[3];

  EqmCameraProject(&view->camera, raster->size, point, at);
  *x = box.x + at[0] * box.width / raster->size;
  *y = box.y + at[1] * box.height / raster->size;
  return IsSeen(raster, at);
}

static void DrawDot(cairo_t *cairo, double x, double y, double radius, EqmInk ink, PetscBool filled)
{
  cairo_new_path(cairo);
  cairo_arc(cairo, x, y, radius, 0.0, 2 * PETSC_PI);
  cairo_set_line_width(cairo, 3.0);
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_stroke_preserve(cairo);
  EqmSetInk(cairo, ink);
  cairo_set_line_width(cairo, 1.5);
  if (filled)
    cairo_fill(cairo);
  else
    cairo_stroke(cairo);
}

/* Join the landmarks of each curve, in their order, as far as they are seen; `at` is the landmarks' places, 3 each. */
static void DrawCurves(cairo_t *cairo, const EqmResult *result, const EqmView *view, const EqmRaster *raster,
                       EqmBox box, const PetscReal *at, PetscBool broken)
{
  const double dash[] = {4.0, 3.0};

  cairo_save(cairo);
  cairo_new_path(cairo);
  for (PetscInt k = 1; k < result->num_landmarks; k++) {
    double x, y, to_x, to_y;
    if (result->curve[k] < 0 || result->curve[k] != result->curve[k - 1]) continue;
    if (!PlaceOf(view, raster, box, at + 3 * (k - 1), &x, &y) || !PlaceOf(view, raster, box, at + 3 * k, &to_x, &to_y))
      continue;
    cairo_move_to(cairo, x, y);
    cairo_line_to(cairo, to_x, to_y);
  }
  if (!broken) { /* on a white ground, so that it is seen on any pattern */
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_set_line_width(cairo, 4.5);
    cairo_stroke_preserve(cairo);
  }
  EqmSetInk(cairo, broken ? EQM_INK : EQM_ORANGE);
  cairo_set_line_width(cairo, broken ? 1.2 : 2.2);
  if (broken) cairo_set_dash(cairo, dash, 2, 0.0);
  cairo_stroke(cairo);
  cairo_restore(cairo);
}

/* The places of the landmarks' vertices, 3 each; to be freed with PetscFree. */
static PetscErrorCode PlacesOfLandmarks(const EqmResult *result, const PetscReal *points, PetscReal **places)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * result->num_landmarks, places));
  for (PetscInt k = 0; k < 3 * result->num_landmarks; k++) (*places)[k] = points[3 * result->landmark[k / 3] + k % 3];
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDrawLandmarks(cairo_t *cairo, const EqmResult *result, const EqmView *view, const EqmRaster *raster,
                                EqmBox box)
{
  PetscReal *places;

  PetscFunctionBegin;
  PetscCall(PlacesOfLandmarks(result, view->points, &places));
  if (result->curve) DrawCurves(cairo, result, view, raster, box, places, PETSC_FALSE);
  if (result->curve && view->goals) DrawCurves(cairo, result, view, raster, box, view->goals, PETSC_TRUE);
  for (PetscInt k = 0; k < result->num_landmarks; k++) {
    double x, y, goal_x, goal_y;
    const PetscBool seen = PlaceOf(view, raster, box, places + 3 * k, &x, &y);
    const PetscBool alone = (PetscBool)(!result->curve || result->curve[k] < 0);
    if (!alone) continue;
    if (view->goals && PlaceOf(view, raster, box, view->goals + 3 * k, &goal_x, &goal_y)) {
      if (seen) {
        EqmSetInk(cairo, EQM_INK);
        cairo_set_line_width(cairo, 1.2);
        cairo_move_to(cairo, x, y);
        cairo_line_to(cairo, goal_x, goal_y);
        cairo_stroke(cairo);
      }
      DrawDot(cairo, goal_x, goal_y, 6.5, EQM_INK, PETSC_FALSE);
    }
    if (seen) DrawDot(cairo, x, y, 4.0, EQM_ORANGE, PETSC_TRUE);
  }
  PetscCall(PetscFree(places));
  PetscFunctionReturn(0);
}
#endif
