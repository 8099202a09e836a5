/* One picture: faces, their colours, marks. */
#ifdef EQM_HAVE_CAIRO
#include "picture/view.h"
#include <math.h>
#include <string.h>

enum { OVERSAMPLING = 2, MANY_FACES = 12000 };

static EqmPattern PatternOf(const EqmResult *result)
{
  const PetscBool conformal = (PetscBool)!strcmp(result->command, "conformal");

  if (result->target) return result->target_dim == 3 ? EQM_PATTERN_SPHERE : EQM_PATTERN_DISK;
  if (result->dim == 3) return conformal ? EQM_PATTERN_SPHERE_SQUARES : EQM_PATTERN_SPHERE;
  if (conformal) return EQM_PATTERN_DISK_SQUARES;
  return strcmp(result->command, "square") ? EQM_PATTERN_DISK : EQM_PATTERN_SQUARE;
}

static EqmScene SceneOf(const EqmPage *page, const EqmResult *result, const EqmView *view)
{
  EqmScene scene = {.result = result,
                    .faces = view->faces,
                    .normals = view->normals,
                    .camera = view->camera,
                    .scale = view->paint == EQM_PAINT_DISTANCE ? page->distances : page->scale,
                    .pattern = PatternOf(result),
                    .relief = 1.0};

  if (view->paint == EQM_PAINT_CELLS) scene.cell_values = EqmPageValues(page, result);
  if (view->paint == EQM_PAINT_DISTANCE) scene.vertex_values = result->distance;
  if (view->points == result->images && !result->target)
    scene.relief = 0.5; /* colours count for more than shape there */
  if (view->paint != EQM_PAINT_PATTERN && view->faces->num_faces < MANY_FACES) scene.edges = 0.25;
  return scene;
}

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

/* The worst cells with their numbers in the input, those that are seen. */
static void DrawMarks(cairo_t *cairo, const EqmResult *result, const EqmView *view, const EqmRaster *raster, EqmBox box)
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
      if (fabs(place[k][0] - x) < 45 && fabs(place[k][1] - place[drawn][1]) < 14) {
        place[drawn][1] = place[k][1] + 14;
        k = -1;
      }
    }
    MarkPoint(cairo, x, y, place[drawn++][1], result->mark[m]);
  }
}

static PetscErrorCode PaintRaster(cairo_t *cairo, const EqmRaster *raster, const EqmScene *scene, EqmBox box, int size)
{
  cairo_surface_t *const image = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, size, size);

  PetscFunctionBegin;
  if (cairo_surface_status(image) == CAIRO_STATUS_SUCCESS) {
    cairo_surface_flush(image);
    PetscCall(EqmShade(raster, scene, OVERSAMPLING, cairo_image_surface_get_data(image),
                       cairo_image_surface_get_stride(image)));
    cairo_surface_mark_dirty(image);
    cairo_save(cairo);
    cairo_translate(cairo, box.x, box.y);
    cairo_scale(cairo, box.width / size, box.height / size);
    cairo_set_source_surface(cairo, image, 0, 0);
    cairo_paint(cairo);
    cairo_restore(cairo);
  }
  cairo_surface_destroy(image);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPaintView(cairo_t *cairo, const EqmPage *page, const EqmResult *result, const EqmView *view,
                            EqmBox box, int size)
{
  const EqmScene scene = SceneOf(page, result, view);
  EqmRaster raster;

  PetscFunctionBegin;
  PetscCall(EqmRasterCreate(OVERSAMPLING * size, &raster));
  PetscCall(EqmRasterDraw(&raster, &view->camera, view->faces, view->points, result->num_vertices));
  PetscCall(PaintRaster(cairo, &raster, &scene, box, size));
  if (view->marked) DrawMarks(cairo, result, view, &raster, box);
  PetscCall(EqmRasterDestroy(&raster));
  PetscFunctionReturn(0);
}
#endif
