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
  if (!strcmp(result->command, "cube")) return EQM_PATTERN_CUBE;
  if (result->dim == 3) return conformal ? EQM_PATTERN_SPHERE_SQUARES : EQM_PATTERN_SPHERE;
  if (conformal) return EQM_PATTERN_DISK_SQUARES;
  return strcmp(result->command, "square") ? EQM_PATTERN_DISK : EQM_PATTERN_SQUARE;
}

static EqmScene SceneOf(const EqmPage *page, const EqmView *view)
{
  const EqmResult *const result = view->result;
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

PetscErrorCode EqmPaintView(cairo_t *cairo, const EqmPage *page, const EqmView *view, EqmBox box, int size)
{
  const EqmScene scene = SceneOf(page, view);
  EqmRaster raster;

  PetscFunctionBegin;
  PetscCall(EqmRasterCreate(OVERSAMPLING * size, &raster));
  PetscCall(EqmRasterDraw(&raster, &view->camera, view->faces, view->points, view->result->num_vertices));
  PetscCall(PaintRaster(cairo, &raster, &scene, box, size));
  if (view->lined) EqmDrawLines(cairo, view, &raster, box);
  if (view->marked) EqmDrawMarks(cairo, view, &raster, box);
  if (view->landmarks) PetscCall(EqmDrawLandmarks(cairo, view, &raster, box));
  PetscCall(EqmRasterDestroy(&raster));
  PetscFunctionReturn(0);
}
#endif
