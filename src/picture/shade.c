/* From samples to pixels: colour, light, edges, smoothing. */
#include "picture/picture.h"
#include <math.h>

/* A key light over the left shoulder, a fill from the right, and what is left everywhere; in the eye's frame. */
static double Light(const EqmScene *scene, const PetscInt v[3], const double weight[3])
{
  static const double key[3] = {-0.424, 0.566, 0.707}, fill[3] = {0.802, 0.267, 0.535};
  const double *axis[3] = {scene->camera.right, scene->camera.up, scene->camera.toward};
  double normal[3] = {0, 0, 0}, seen[3] = {0, 0, 0}, length, side;

  for (int k = 0; k < 9; k++) normal[k % 3] += weight[k / 3] * scene->normals[3 * v[k / 3] + k % 3];
  for (int k = 0; k < 9; k++) seen[k / 3] += normal[k % 3] * axis[k / 3][k % 3];
  length = sqrt(seen[0] * seen[0] + seen[1] * seen[1] + seen[2] * seen[2]);
  if (!(length > 0.0)) return 0.7;
  side = seen[2] < 0.0 ? -1.0 : 1.0; /* the inside of an open surface is lit as well, more dimly */
  for (int d = 0; d < 3; d++) seen[d] *= side / length;
  const double k = fmax(0.0, seen[0] * key[0] + seen[1] * key[1] + seen[2] * key[2]);
  const double f = fmax(0.0, seen[0] * fill[0] + seen[1] * fill[1] + seen[2] * fill[2]);
  return (0.36 + 0.56 * k + 0.16 * f) * (side < 0.0 ? 0.7 : 1.0);
}

/* Distance to the nearest edge of the face in samples, from the weights' change between neighbouring samples. */
static double EdgeDistance(const EqmRaster *raster, int x, int y, size_t s)
{
  const int32_t face = raster->face[s];
  const int inside_x = x + 1 < raster->size && raster->face[s + 1] == face;
  const int inside_y = y + 1 < raster->size && raster->face[s + (size_t)raster->size] == face;
  const float *w = &raster->corner[2 * s], *wx = inside_x ? w + 2 : w, *wy = inside_y ? w + 2 * raster->size : w;
  const double here[3] = {w[0], w[1], 1.0 - w[0] - w[1]};
  const double right[3] = {wx[0], wx[1], 1.0 - wx[0] - wx[1]}, below[3] = {wy[0], wy[1], 1.0 - wy[0] - wy[1]};
  double nearest = HUGE_VAL;

  if (!inside_x || !inside_y) return 0.0;
  for (int k = 0; k < 3; k++) {
    const double slope = hypot(right[k] - here[k], below[k] - here[k]);
    if (slope > 0.0) nearest = fmin(nearest, here[k] / slope);
  }
  return nearest;
}

/* Nothing is seen within `reach` samples: the outline of what is drawn. */
static PetscBool IsOutline(const EqmRaster *raster, int x, int y, int reach)
{
  const int place[4][2] = {{x - reach, y}, {x + reach, y}, {x, y - reach}, {x, y + reach}};

  for (int k = 0; k < 4; k++) {
    const int px = place[k][0], py = place[k][1];
    if (px < 0 || py < 0 || px >= raster->size || py >= raster->size) continue;
    if (raster->face[(size_t)py * (size_t)raster->size + (size_t)px] < 0) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static void ColorSample(const EqmRaster *raster, const EqmScene *scene, int x, int y, int oversampling, double rgb[3])
{
  const size_t s = (size_t)y * (size_t)raster->size + (size_t)x;
  const PetscInt *v = &scene->faces->vertices[3 * (PetscInt)raster->face[s]];
  const double weight[3] = {raster->corner[2 * s], raster->corner[2 * s + 1],
                            1.0 - raster->corner[2 * s] - raster->corner[2 * s + 1]};
  double light = 1.0;

  if (!scene->cell_values && !scene->vertex_values) {
    const PetscReal *const places = scene->result->target ? scene->result->target : scene->result->images;
    double image[3] = {0, 0, 0};
    for (int k = 0; k < 9; k++) image[k % 3] += weight[k / 3] * places[3 * v[k / 3] + k % 3];
    EqmColorOfPattern(scene->pattern, image, rgb);
  } else {
    double value = 0.0;
    if (scene->cell_values)
      value = scene->cell_values[scene->faces->cell[raster->face[s]]];
    else
      for (int k = 0; k < 3; k++) value += weight[k] * scene->vertex_values[v[k]];
    EqmColorOf(scene->scale, value, rgb);
    if (scene->cell_values && !(scene->result->ratio[scene->faces->cell[raster->face[s]]] > 0.0))
      EqmColorOf((EqmColorScale){EQM_SCALE_RATIO, 2.0}, -1.0, rgb); /* folded */
  }
  if (scene->normals) light = 1.0 - scene->relief * (1.0 - Light(scene, v, weight));
  if (scene->edges > 0.0 && EdgeDistance(raster, x, y, s) < 0.5 * oversampling) light *= 1.0 - scene->edges;
  if (IsOutline(raster, x, y, oversampling)) light *= 0.6;
  for (int c = 0; c < 3; c++) rgb[c] = fmin(1.0, rgb[c] * light);
}

static uint32_t Pixel(const EqmRaster *raster, const EqmScene *scene, int x, int y, int oversampling)
{
  const double samples = (double)oversampling * oversampling;
  double sum[4] = {0, 0, 0, 0};
  uint32_t byte[4];

  for (int k = 0; k < oversampling * oversampling; k++) {
    const int sx = oversampling * x + k % oversampling, sy = oversampling * y + k / oversampling;
    double rgb[3];
    if (raster->face[(size_t)sy * (size_t)raster->size + (size_t)sx] < 0) continue;
    ColorSample(raster, scene, sx, sy, oversampling, rgb);
    for (int c = 0; c < 3; c++) sum[c] += rgb[c];
    sum[3] += 1.0;
  }
  for (int c = 0; c < 4; c++) byte[c] = (uint32_t)(255.0 * sum[c] / samples + 0.5);
  return byte[3] << 24 | byte[0] << 16 | byte[1] << 8 | byte[2];
}

PetscErrorCode EqmShade(const EqmRaster *raster, const EqmScene *scene, int oversampling, unsigned char *pixels,
                        int stride)
{
  const int size = raster->size / oversampling;

  PetscFunctionBegin;
  for (int y = 0; y < size; y++) {
    uint32_t *row = (uint32_t *)(void *)(pixels + (size_t)y * (size_t)stride);
    for (int x = 0; x < size; x++) row[x] = Pixel(raster, scene, x, y, oversampling);
  }
  PetscFunctionReturn(0);
}
