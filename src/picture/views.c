/* The pictures of a result: the surface or solid, a pattern pulled back to it, its image. */
#ifdef EQM_HAVE_CAIRO
#include "picture/view.h"
#include <math.h>
#include <string.h>

enum { MOST_VIEWS = 6, MOST_CUTS = 4 };

/* A row, and what its views point to. */
typedef struct {
  int count;
  EqmView view[MOST_VIEWS];
  EqmFaces surface, cut[MOST_CUTS];
  float *normals[MOST_VIEWS];
  char start_title[96];
} Row;

/* Feature curves, which are drawn in the target, too (000 figure 6). */
static PetscBool HasCurves(const EqmResult *result)
{
  return (PetscBool)(result->curve && result->landmark_target && result->cell_size == 3);
}

static int NumViews(const EqmPage *page, const EqmResult *result)
{
  if (result->target) return HasCurves(result) ? 5 : 4;
  return (result->cell_size == 4 ? 5 : result->dim == 2 ? 3 : 4) + (page->start ? 1 : 0);
}

/* The views are square and stand in one row, a title above each. */
static double SideOf(const EqmPage *page, const EqmResult *result, double width)
{
  return fmin(width / NumViews(page, result) - 24.0, 466.0);
}

double EqmViewsHeight(const EqmPage *page, const EqmResult *result, double width)
{
  return SideOf(page, result, width) + 34.0;
}

static PetscErrorCode ResetRow(Row *row)
{
  PetscFunctionBegin;
  for (int k = 0; k < MOST_VIEWS; k++) PetscCall(PetscFree(row->normals[k]));
  PetscCall(EqmFacesReset(&row->surface));
  for (int k = 0; k < MOST_CUTS; k++) PetscCall(EqmFacesReset(&row->cut[k]));
  PetscFunctionReturn(0);
}

/* Faces at some points, shaded. */
static PetscErrorCode AddView(const EqmResult *result, const char *title, const EqmFaces *faces,
                              const PetscReal *points, EqmCamera camera, EqmPaint paint, Row *row)
{
  float **const normals = &row->normals[row->count];

  PetscFunctionBegin;
  PetscCall(EqmFacesNormals(faces, points, result->num_vertices, normals));
  row->view[row->count++] = (EqmView){.result = result,
                                      .title = title,
                                      .faces = faces,
                                      .points = points,
                                      .normals = *normals,
                                      .camera = camera,
                                      .paint = paint,
                                      .lined = (PetscBool)(faces == &row->surface)};
  PetscFunctionReturn(0);
}

/* Beside the unit sphere, a little above its equator. */
static EqmCamera SphereCamera(double azimuth)
{
  static const double pole[3] = {0, 0, 1}, front[3] = {1, 0, 0};
  return EqmCameraTurned(pole, front, azimuth, 15.0);
}

static PetscErrorCode AddSurface(const EqmPage *page, const EqmResult *result, EqmCamera camera, Row *row)
{
  const PetscBool conformal = (PetscBool)!strcmp(result->command, "conformal");
  const char *const pattern = conformal          ? "Squares, pulled back"
                              : result->dim == 2 ? "Checkerboard of equal areas, pulled back"
                                                 : "Patches of equal area, pulled back";

  PetscFunctionBegin;
  PetscCall(AddView(result, page->conformal ? "Surface, coloured by stretch" : "Surface, coloured by area ratio",
                    &row->surface, result->vertices, camera, EQM_PAINT_CELLS, row));
  row->view[row->count - 1].marked = PETSC_TRUE;
  PetscCall(AddView(result, pattern, &row->surface, result->vertices, camera, EQM_PAINT_PATTERN, row));
  PetscFunctionReturn(0);
}

/* An image in the plane, from above. */
static void AddFlat(const EqmResult *result, const char *title, Row *row)
{
  EqmCamera flat = EqmCameraFlat();

  EqmCameraFit(&flat, &row->surface, result->images);
  row->view[row->count++] = (EqmView){.result = result,
                                      .title = title,
                                      .faces = &row->surface,
                                      .points = result->images,
                                      .camera = flat,
                                      .paint = EQM_PAINT_CELLS,
                                      .lined = PETSC_TRUE};
}

static PetscErrorCode AddImage(const EqmResult *result, Row *row)
{
  PetscFunctionBegin;
  if (result->dim == 2) {
    AddFlat(result, "Image, worst cells numbered", row);
    row->view[row->count - 1].marked = PETSC_TRUE;
    PetscFunctionReturn(0);
  }
  PetscCall(
      AddView(result, "Image, one side", &row->surface, result->images, SphereCamera(20.0), EQM_PAINT_CELLS, row));
  row->view[row->count - 1].marked = PETSC_TRUE;
  PetscCall(
      AddView(result, "Image, other side", &row->surface, result->images, SphereCamera(200.0), EQM_PAINT_CELLS, row));
  row->view[row->count - 1].marked = PETSC_TRUE;
  PetscFunctionReturn(0);
}

/* A cut through what a camera sees: the half that is farther away stays, turned by some degrees so that the cut shows.
 */
static PetscErrorCode AddCut(const EqmResult *result, const char *title, const PetscReal *points, EqmCamera camera,
                             const double across[3], int number, Row *row)
{
  const PetscReal direction[3] = {across[0], across[1], across[2]};

  PetscFunctionBegin;
  PetscCall(EqmFacesOfCut(result, points, direction, &row->cut[number]));
  PetscCall(AddView(result, title, &row->cut[number], points, camera, EQM_PAINT_CELLS, row));
  PetscFunctionReturn(0);
}

static PetscBool IsCube(const EqmResult *result)
{
  return (PetscBool)!strcmp(result->command, "cube");
}

/* The image of a solid: the ball, or the cube as it fits into the picture. */
static EqmCamera ImageCamera(const EqmResult *result, const Row *row, double azimuth)
{
  EqmCamera camera = SphereCamera(azimuth);

  if (IsCube(result)) EqmCameraFit(&camera, &row->surface, result->images);
  return camera;
}

/* The other map, as the image is seen. */
static PetscErrorCode AddStart(const EqmPage *page, Row *row)
{
  static const double x[3] = {1, 0, 0};
  const EqmResult *const start = page->start;
  char energy[48];

  PetscFunctionBegin;
  if (!start) PetscFunctionReturn(0);
  EqmNumberText(start->energy_final, energy, sizeof(energy));
  if (strcmp(start->command, page->results->command)) /* its energy is another one */
    (void)snprintf(row->start_title, sizeof(row->start_title), "Beside it: %.30s, %.30s", start->command,
                   start->method);
  else
    (void)snprintf(row->start_title, sizeof(row->start_title), "Start, energy %s", energy);
  if (start->cell_size == 4)
    PetscCall(AddCut(start, row->start_title, start->images, ImageCamera(start, row, 20.0), x, MOST_CUTS - 1, row));
  else if (start->dim == 2)
    AddFlat(start, row->start_title, row);
  else
    PetscCall(AddView(start, row->start_title, &row->surface, start->images, SphereCamera(20.0), EQM_PAINT_CELLS, row));
  PetscFunctionReturn(0);
}

/* The boundary, and cuts: one of the solid, two of the ball; of the cube the whole and one. */
static PetscErrorCode AddSolid(const EqmPage *page, const EqmResult *result, EqmCamera camera, Row *row)
{
  static const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
  const PetscBool is_cube = IsCube(result);
  const EqmCamera of_image = ImageCamera(result, row, 30.0);

  PetscFunctionBegin;
  PetscCall(AddView(result, "Solid, coloured by volume ratio", &row->surface, result->vertices, camera, EQM_PAINT_CELLS,
                    row));
  row->view[row->count - 1].marked = PETSC_TRUE;
  PetscCall(AddView(result, is_cube ? "Small cubes, pulled back" : "Graticule of the ball, pulled back", &row->surface,
                    result->vertices, camera, EQM_PAINT_PATTERN, row));
  PetscCall(AddCut(result, "Solid, cut open", result->vertices, camera, camera.toward, 0, row));
  PetscCall(AddStart(page, row));
  if (is_cube) {
    PetscCall(AddView(result, "Image", &row->surface, result->images, of_image, EQM_PAINT_CELLS, row));
    PetscCall(AddCut(result, "Image, cut at x = 1/2", result->images, of_image, x, 1, row));
    PetscFunctionReturn(0);
  }
  PetscCall(AddCut(result, "Image, cut at x = 0", result->images, SphereCamera(20.0), x, 1, row));
  PetscCall(AddCut(result, "Image, cut at y = 0", result->images, SphereCamera(70.0), y, 2, row));
  PetscFunctionReturn(0);
}

/* The curves in the target: on a disk, or on the side of the sphere where they are. */
static PetscErrorCode AddCurves(const EqmResult *result, Row *row)
{
  static const double pole[3] = {0, 0, 1};
  const PetscBool is_disk = (PetscBool)(result->target_dim == 2);
  double middle[3] = {1e-9, 0, 0};
  EqmCamera camera = EqmCameraFlat();

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * result->num_landmarks; k++) middle[k % 3] += result->landmark_target[k];
  if (!is_disk)
    camera = EqmCameraTurned(pole, middle, 0.0, atan2(middle[2], hypot(middle[0], middle[1])) * 180.0 / PETSC_PI);
  PetscCall(AddView(result, is_disk ? "The curves in the disk" : "The curves on the sphere", &row->surface,
                    result->target, camera, EQM_PAINT_PATTERN, row));
  row->view[row->count - 1].landmarks = PETSC_TRUE;
  row->view[row->count - 1].goals = result->landmark_target;
  PetscFunctionReturn(0);
}

/* A registration: A and the same on B, seen from the same side, so that what differs is the shape; with a pattern of
   the target, which tells what corresponds, and with the ratio or the distance. */
static PetscErrorCode AddRegistered(const EqmResult *result, EqmCamera camera, Row *row)
{
  const PetscBool is_disk = (PetscBool)(!result->other_file[0] && result->target_dim == 2); /* it stands for B */
  const char *const pattern = is_disk ? "The pattern on the target" : "The pattern carried to B";
  const char *const image = result->distance ? "On B: the distance from A"
                            : is_disk        ? "A on the target, coloured by ratio"
                                             : "A on B, coloured by ratio";
  EqmCamera of_b = is_disk ? EqmCameraFlat() : camera;

  PetscFunctionBegin;
  EqmCameraFit(&of_b, &row->surface, result->images);
  PetscCall(AddView(result, "A, coloured by ratio", &row->surface, result->vertices, camera, EQM_PAINT_CELLS, row));
  row->view[row->count - 1].marked = PETSC_TRUE;
  PetscCall(AddView(result, "A, with a pattern", &row->surface, result->vertices, camera, EQM_PAINT_PATTERN, row));
  PetscCall(AddView(result, pattern, &row->surface, result->images, of_b, EQM_PAINT_PATTERN, row));
  PetscCall(AddView(result, image, &row->surface, result->images, of_b,
                    result->distance ? EQM_PAINT_DISTANCE : EQM_PAINT_CELLS, row));
  row->view[1].landmarks = row->view[2].landmarks = PETSC_TRUE;
  row->view[2].goals = result->landmark_goal;
  if (HasCurves(result)) PetscCall(AddCurves(result, row));
  PetscFunctionReturn(0);
}

static PetscErrorCode MakeRow(const EqmPage *page, const EqmResult *result, Row *row)
{
  EqmCamera camera;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(row, sizeof(*row)));
  PetscCall(EqmFacesOfSurface(result, &row->surface));
  camera = EqmCameraChoose(&row->surface, result->vertices, &page->options);
  if (result->target) {
    PetscCall(AddRegistered(result, camera, row));
  } else if (result->cell_size == 4) {
    PetscCall(AddSolid(page, result, camera, row));
  } else {
    PetscCall(AddSurface(page, result, camera, row));
    PetscCall(AddStart(page, row));
    PetscCall(AddImage(result, row));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDrawViews(cairo_t *cairo, const EqmPage *page, const EqmResult *result, EqmBox box,
                            double pixels_per_unit)
{
  const double side = SideOf(page, result, box.width);
  Row row;

  PetscFunctionBegin;
  PetscCall(MakeRow(page, result, &row));
  for (int k = 0; k < row.count; k++) {
    const double middle = box.x + (k + 0.5) * box.width / row.count;
    const EqmBox place = {middle - 0.5 * side, box.y + 34.0, side, side};
    EqmDrawText(cairo, middle, box.y + 14, side < 320 ? 13 : 15, PETSC_TRUE, EQM_CENTER, EQM_INK, row.view[k].title);
    PetscCall(EqmPaintView(cairo, page, &row.view[k], place, (int)(side * pixels_per_unit + 0.5)));
  }
  PetscCall(ResetRow(&row));
  PetscFunctionReturn(0);
}
#endif
