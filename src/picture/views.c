/* The pictures of the surface and of its image. */
#ifdef EQM_HAVE_CAIRO
#include "page.h"
#include <math.h>
#include <string.h>

/* What one view shows. */
typedef struct {
  const char *title;
  const EqmFaces *faces;
  const PetscReal *points;
  const float *normals;
  EqmCamera camera;
  PetscBool pulled_back;
} View;

enum { OVERSAMPLING = 2, MANY_FACES = 12000 };

static PetscBool IsConformal(const EqmResult *result)
{
  return (PetscBool)!strcmp(result->command, "conformal");
}

static EqmPattern PatternOf(const EqmResult *result)
{
  if (result->target) return result->target_dim == 3 ? EQM_PATTERN_SPHERE : EQM_PATTERN_DISK;
  if (result->dim == 3) return IsConformal(result) ? EQM_PATTERN_SPHERE_SQUARES : EQM_PATTERN_SPHERE;
  if (IsConformal(result)) return EQM_PATTERN_DISK_SQUARES;
  return strcmp(result->command, "square") ? EQM_PATTERN_DISK : EQM_PATTERN_SQUARE;
}

static PetscErrorCode PaintView(cairo_t *page, const EqmResult *result, EqmColorScale scale, const View *view,
                                EqmBox box, int size)
{
  EqmScene scene = {result, view->faces, view->normals, view->camera, scale, view->pulled_back, PatternOf(result),
                    1.0,    0.0};
  EqmRaster raster;
  cairo_surface_t *image;

  PetscFunctionBegin;
  if (view->points == result->images && !result->target)
    scene.relief = 0.5; /* colours count for more than shape there */
  if (!view->pulled_back && view->faces->num_faces < MANY_FACES) scene.edges = 0.25;
  PetscCall(EqmRasterCreate(OVERSAMPLING * size, &raster));
  PetscCall(EqmRasterDraw(&raster, &view->camera, view->faces, view->points, result->num_vertices));
  image = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, size, size);
  if (cairo_surface_status(image) == CAIRO_STATUS_SUCCESS) {
    cairo_surface_flush(image);
    PetscCall(EqmShade(&raster, &scene, OVERSAMPLING, cairo_image_surface_get_data(image),
                       cairo_image_surface_get_stride(image)));
    cairo_surface_mark_dirty(image);
    cairo_save(page);
    cairo_translate(page, box.x, box.y);
    cairo_scale(page, box.width / size, box.height / size);
    cairo_set_source_surface(page, image, 0, 0);
    cairo_paint(page);
    cairo_restore(page);
  }
  cairo_surface_destroy(image);
  PetscCall(EqmRasterDestroy(&raster));
  PetscFunctionReturn(0);
}

static int NumViews(const EqmResult *result)
{
  return result->dim == 2 ? 3 : 4;
}

/* The views are square and stand in one row, a title above each. */
static double SideOf(const EqmResult *result, double width)
{
  return fmin(width / NumViews(result) - 24.0, 466.0);
}

/* How high a row of views is that is `width` wide. Not collective. */
double EqmViewsHeight(const EqmResult *result, double width)
{
  return SideOf(result, width) + 34.0;
}

static PetscErrorCode PaintRow(cairo_t *page, const EqmResult *result, EqmColorScale scale, const View *views,
                               EqmBox box, double pixels_per_unit)
{
  const int count = NumViews(result);
  const double side = SideOf(result, box.width);

  PetscFunctionBegin;
  for (int k = 0; k < count; k++) {
    const double middle = box.x + (k + 0.5) * box.width / count;
    const EqmBox place = {middle - 0.5 * side, box.y + 34.0, side, side};
    EqmDrawText(page, middle, box.y + 14, 15, PETSC_TRUE, EQM_CENTER, EQM_INK, views[k].title);
    PetscCall(PaintView(page, result, scale, &views[k], place, (int)(side * pixels_per_unit + 0.5)));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode DrawPlanar(cairo_t *page, const EqmResult *result, EqmColorScale scale, EqmBox box,
                                 double pixels_per_unit)
{
  EqmFaces faces;
  EqmCamera front, flat = EqmCameraFlat();
  float *normals;

  PetscFunctionBegin;
  PetscCall(EqmFacesOfSurface(result, &faces));
  PetscCall(EqmFacesNormals(&faces, result->vertices, result->num_vertices, &normals));
  front = EqmCameraGuess(&faces, result->vertices);
  EqmCameraFit(&flat, &faces, result->images);
  const View views[] = {{"Surface, coloured by area ratio", &faces, result->vertices, normals, front, PETSC_FALSE},
                        {IsConformal(result) ? "Squares, pulled back" : "Checkerboard of equal areas, pulled back",
                         &faces, result->vertices, normals, front, PETSC_TRUE},
                        {"Image, coloured by area ratio", &faces, result->images, NULL, flat, PETSC_FALSE}};
  PetscCall(PaintRow(page, result, scale, views, box, pixels_per_unit));
  PetscCall(PetscFree(normals));
  PetscCall(EqmFacesReset(&faces));
  PetscFunctionReturn(0);
}

/* An eye beside the unit sphere, a little above its equator. */
static EqmCamera SphereCamera(double azimuth)
{
  static const double pole[3] = {0, 0, 1}, front[3] = {1, 0, 0};
  return EqmCameraTurned(pole, front, azimuth, 15.0);
}

static PetscErrorCode DrawSphere(cairo_t *page, const EqmResult *result, EqmColorScale scale, EqmBox box,
                                 double pixels_per_unit)
{
  EqmFaces faces;
  EqmCamera front, near = SphereCamera(20.0), far = SphereCamera(200.0);
  float *normals, *image_normals;

  PetscFunctionBegin;
  PetscCall(EqmFacesOfSurface(result, &faces));
  PetscCall(EqmFacesNormals(&faces, result->vertices, result->num_vertices, &normals));
  PetscCall(EqmFacesNormals(&faces, result->images, result->num_vertices, &image_normals));
  front = EqmCameraGuess(&faces, result->vertices);
  const View views[] = {{"Surface, coloured by area ratio", &faces, result->vertices, normals, front, PETSC_FALSE},
                        {IsConformal(result) ? "Squares, pulled back" : "Patches of equal area, pulled back", &faces,
                         result->vertices, normals, front, PETSC_TRUE},
                        {"Image, one side", &faces, result->images, image_normals, near, PETSC_FALSE},
                        {"Image, other side", &faces, result->images, image_normals, far, PETSC_FALSE}};
  PetscCall(PaintRow(page, result, scale, views, box, pixels_per_unit));
  PetscCall(PetscFree(normals));
  PetscCall(PetscFree(image_normals));
  PetscCall(EqmFacesReset(&faces));
  PetscFunctionReturn(0);
}

static PetscErrorCode DrawBall(cairo_t *page, const EqmResult *result, EqmColorScale scale, EqmBox box,
                               double pixels_per_unit)
{
  static const PetscReal cut_direction[3] = {1, 0, 0};
  EqmFaces skin, cut;
  EqmCamera front, near = SphereCamera(20.0);
  float *normals, *ball_normals, *cut_normals;

  PetscFunctionBegin;
  PetscCall(EqmFacesOfSurface(result, &skin));
  PetscCall(EqmFacesOfCut(result, cut_direction, &cut));
  PetscCall(EqmFacesNormals(&skin, result->vertices, result->num_vertices, &normals));
  PetscCall(EqmFacesNormals(&skin, result->images, result->num_vertices, &ball_normals));
  PetscCall(EqmFacesNormals(&cut, result->images, result->num_vertices, &cut_normals));
  front = EqmCameraGuess(&skin, result->vertices);
  const View views[] = {{"Solid, coloured by volume ratio", &skin, result->vertices, normals, front, PETSC_FALSE},
                        {"Graticule of the ball, pulled back", &skin, result->vertices, normals, front, PETSC_TRUE},
                        {"Image", &skin, result->images, ball_normals, near, PETSC_FALSE},
                        {"Image, cut open", &cut, result->images, cut_normals, near, PETSC_FALSE}};
  PetscCall(PaintRow(page, result, scale, views, box, pixels_per_unit));
  PetscCall(PetscFree(normals));
  PetscCall(PetscFree(ball_normals));
  PetscCall(PetscFree(cut_normals));
  PetscCall(EqmFacesReset(&skin));
  PetscCall(EqmFacesReset(&cut));
  PetscFunctionReturn(0);
}

/* A registration: A and the same on B, with a pattern of the target, which tells what corresponds, and with the ratio.
 */
static PetscErrorCode DrawRegistered(cairo_t *page, const EqmResult *result, EqmColorScale scale, EqmBox box,
                                     double pixels_per_unit)
{
  EqmFaces faces;
  EqmCamera of_a, of_b;
  float *normals_a, *normals_b;

  PetscFunctionBegin;
  PetscCall(EqmFacesOfSurface(result, &faces));
  PetscCall(EqmFacesNormals(&faces, result->vertices, result->num_vertices, &normals_a));
  PetscCall(EqmFacesNormals(&faces, result->images, result->num_vertices, &normals_b));
  of_a = EqmCameraGuess(&faces, result->vertices);
  of_b = of_a; /* seen from the same side, so that what differs is the shape */
  EqmCameraFit(&of_b, &faces, result->images);
  const View views[] = {{"A, coloured by ratio", &faces, result->vertices, normals_a, of_a, PETSC_FALSE},
                        {"A, with a pattern", &faces, result->vertices, normals_a, of_a, PETSC_TRUE},
                        {"The pattern carried to B", &faces, result->images, normals_b, of_b, PETSC_TRUE},
                        {"A on B, coloured by ratio", &faces, result->images, normals_b, of_b, PETSC_FALSE}};
  PetscCall(PaintRow(page, result, scale, views, box, pixels_per_unit));
  PetscCall(PetscFree(normals_a));
  PetscCall(PetscFree(normals_b));
  PetscCall(EqmFacesReset(&faces));
  PetscFunctionReturn(0);
}

/* Draw the row of pictures: the surface or solid, a pattern pulled back to it, its image. Not collective. */
PetscErrorCode EqmDrawViews(cairo_t *page, const EqmResult *result, EqmColorScale scale, EqmBox box,
                            double pixels_per_unit)
{
  PetscFunctionBegin;
  if (result->target)
    PetscCall(DrawRegistered(page, result, scale, box, pixels_per_unit));
  else if (result->dim == 2)
    PetscCall(DrawPlanar(page, result, scale, box, pixels_per_unit));
  else if (result->cell_size == 3)
    PetscCall(DrawSphere(page, result, scale, box, pixels_per_unit));
  else
    PetscCall(DrawBall(page, result, scale, box, pixels_per_unit));
  PetscFunctionReturn(0);
}
#endif
