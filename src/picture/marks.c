/* What is marked in a picture: cells, landmarks, lines. */
#ifdef EQM_HAVE_CAIRO
#include "picture/view.h"
#include <math.h>

/* A ring around the place. */
static void DrawRing(cairo_t *cairo, double x, double y)
{
  cairo_new_path(cairo);
  cairo_set_line_width(cairo, 3.5);
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_arc(cairo, x, y, 5.0, 0.0, 2 * PETSC_PI);
  cairo_stroke_preserve(cairo);
  cairo_set_line_width(cairo, 1.4);
  EqmSetInk(cairo, EQM_INK);
  cairo_stroke(cairo);
}

/* Its number to the right. */
static void DrawLabel(cairo_t *cairo, double x, double y, PetscInt cell)
{
  char text[32];

  (void)snprintf(text, sizeof(text), "%" PetscInt_FMT, cell);
  cairo_set_source_rgba(cairo, 1, 1, 1, 0.75);
  cairo_rectangle(cairo, x + 8, y - 6, EqmTextWidth(cairo, 11, PETSC_FALSE, text) + 4, 13);
  cairo_fill(cairo);
  EqmDrawText(cairo, x + 10, y + 4, 11, PETSC_FALSE, EQM_LEFT, EQM_INK, text);
}

/* Nothing in front of it: nearer in the raster by more than a hundredth of the picture. */
static PetscBool IsSeen(const EqmRaster *raster, const double at[3])
{
  const int x = (int)at[0], y = (int)at[1];

  if (x < 0 || y < 0 || x >= raster->size || y >= raster->size) return PETSC_FALSE;
  return (PetscBool)(raster->depth[(size_t)y * (size_t)raster->size + (size_t)x] < at[2] + 0.01 * raster->size);
}

/* A marked cell that is seen: where its ring is, and its number. */
typedef struct {
  double x, y, label_x, label_y;
  PetscInt cell;
} Mark;

static int CollectMarks(const EqmView *view, const EqmRaster *raster, EqmBox box, Mark marks[EQM_NUM_MARKS])
{
  const EqmResult *const result = view->result;
  int count = 0;

  for (PetscInt m = 0; m < result->num_marks; m++) {
    const PetscInt *const v = result->cells + result->cell_size * result->mark[m];
    double centroid[3] = {0, 0, 0}, at[3];
    for (PetscInt k = 0; k < 3 * result->cell_size; k++)
      centroid[k % 3] += view->points[3 * v[k / 3] + k % 3] / result->cell_size;
    EqmCameraProject(&view->camera, raster->size, centroid, at);
    if (!IsSeen(raster, at)) continue;
    const double x = box.x + at[0] * box.width / raster->size, y = box.y + at[1] * box.height / raster->size;
    marks[count++] = (Mark){x, y, x, y, result->mark[m]};
  }
  return count;
}

/* Numbers hide neither each other nor rings close by: each stands to the right of these, below the ones before. */
static void SpreadLabels(int count, Mark marks[])
{
  const double width = 45.0, height = 14.0;

  for (int k = 0; k < count; k++) {
    Mark *const mark = &marks[k];
    for (int j = 0; j < count; j++) {
      const double right = marks[j].x - mark->label_x;
      if (right <= 0.0 || right >= width || fabs(marks[j].y - mark->y) >= height) continue;
      mark->label_x = marks[j].x;
      j = -1; /* from the beginning, at the new place */
    }
    for (int j = 0; j < k; j++) {
      if (fabs(marks[j].label_x - mark->label_x) >= width || fabs(marks[j].label_y - mark->label_y) >= height - 0.5)
        continue;
      mark->label_y = marks[j].label_y + height;
      j = -1;
    }
  }
}

void EqmDrawMarks(cairo_t *cairo, const EqmView *view, const EqmRaster *raster, EqmBox box)
{
  Mark marks[EQM_NUM_MARKS];
  const int count = CollectMarks(view, raster, box, marks);

  SpreadLabels(count, marks);
  for (int k = 0; k < count; k++) DrawRing(cairo, marks[k].x, marks[k].y);
  for (int k = 0; k < count; k++) DrawLabel(cairo, marks[k].label_x, marks[k].label_y, marks[k].cell);
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

/* The part of a straight piece that is seen, in steps of some samples. */
static void AddPiece(cairo_t *cairo, const EqmView *view, const EqmRaster *raster, EqmBox box, const PetscReal *from,
                     const PetscReal *to)
{
  const double step = 4.0, scale = box.width / raster->size;
  double a[3], b[3];
  int steps;

  EqmCameraProject(&view->camera, raster->size, from, a);
  EqmCameraProject(&view->camera, raster->size, to, b);
  steps = 1 + (int)fmin(hypot(b[0] - a[0], b[1] - a[1]) / step, raster->size);
  for (int k = 0; k < steps; k++) {
    double ends[2][3], middle[3];
    for (int d = 0; d < 3; d++) {
      for (int e = 0; e < 2; e++) ends[e][d] = a[d] + (b[d] - a[d]) * (k + e) / steps;
      middle[d] = 0.5 * (ends[0][d] + ends[1][d]);
    }
    if (!IsSeen(raster, middle)) continue;
    cairo_move_to(cairo, box.x + scale * ends[0][0], box.y + scale * ends[0][1]);
    cairo_line_to(cairo, box.x + scale * ends[1][0], box.y + scale * ends[1][1]);
  }
}

void EqmDrawLines(cairo_t *cairo, const EqmView *view, const EqmRaster *raster, EqmBox box)
{
  const EqmResult *const result = view->result;

  cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
  for (PetscInt first = 0, next; first < result->num_lines; first = next) {
    const PetscInt curve = result->line[3 * first + 2];
    cairo_new_path(cairo);
    for (next = first; next < result->num_lines && result->line[3 * next + 2] == curve; next++)
      AddPiece(cairo, view, raster, box, view->points + 3 * result->line[3 * next],
               view->points + 3 * result->line[3 * next + 1]);
    cairo_set_line_width(cairo, curve < 0 ? 2.0 : 4.5);
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_stroke_preserve(cairo);
    cairo_set_line_width(cairo, curve < 0 ? 1.0 : 2.5);
    EqmSetInk(cairo, curve < 0 ? EQM_INK : EqmInkOf(curve + 2));
    cairo_stroke(cairo);
  }
  cairo_set_line_cap(cairo, CAIRO_LINE_CAP_BUTT);
}

/* Join the landmarks of each curve, in their order, as far as they are seen; `at` is the landmarks' places, 3 each. */
static void DrawCurves(cairo_t *cairo, const EqmView *view, const EqmRaster *raster, EqmBox box, const PetscReal *at,
                       PetscBool broken)
{
  const EqmResult *const result = view->result;
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

PetscErrorCode EqmDrawLandmarks(cairo_t *cairo, const EqmView *view, const EqmRaster *raster, EqmBox box)
{
  const EqmResult *const result = view->result;
  PetscReal *places;

  PetscFunctionBegin;
  PetscCall(PlacesOfLandmarks(result, view->points, &places));
  if (result->curve) DrawCurves(cairo, view, raster, box, places, PETSC_FALSE);
  if (result->curve && view->goals) DrawCurves(cairo, view, raster, box, view->goals, PETSC_TRUE);
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
