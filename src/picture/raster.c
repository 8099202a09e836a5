/* A z-buffer that remembers which face is seen in each sample, and where in the face. */
#include "picture/picture.h"
#include <math.h>

PetscErrorCode EqmRasterCreate(int size, EqmRaster *raster)
{
  const size_t samples = (size_t)size * (size_t)size;

  PetscFunctionBegin;
  raster->size = size;
  PetscCall(PetscMalloc3(samples, &raster->face, samples, &raster->depth, 2 * samples, &raster->corner));
  for (size_t s = 0; s < samples; s++) {
    raster->face[s] = -1;
    raster->depth[s] = -HUGE_VALF;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRasterDestroy(EqmRaster *raster)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(raster->face, raster->depth, raster->corner));
  raster->size = 0;
  PetscFunctionReturn(0);
}

static void Project(const EqmCamera *camera, int size, const PetscReal *points, PetscInt num_points, float *projected)
{
  for (PetscInt i = 0; i < num_points; i++) {
    double x[3];
    EqmCameraProject(camera, size, points + 3 * i, x);
    for (int d = 0; d < 3; d++) projected[3 * i + d] = (float)x[d];
  }
}

/* Half-open in neither direction: a shared edge may be drawn twice, at the same depth, which does not show. */
static void DrawFace(EqmRaster *raster, int32_t face, const float *a, const float *b, const float *c)
{
  const float area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  const int last = raster->size - 1;
  const int x0 = (int)fmaxf(0.0f, floorf(fminf(a[0], fminf(b[0], c[0])) - 0.5f));
  const int y0 = (int)fmaxf(0.0f, floorf(fminf(a[1], fminf(b[1], c[1])) - 0.5f));
  const int x1 = (int)fminf((float)last, ceilf(fmaxf(a[0], fmaxf(b[0], c[0]))));
  const int y1 = (int)fminf((float)last, ceilf(fmaxf(a[1], fmaxf(b[1], c[1]))));

  if (!(fabsf(area) > 1e-12f)) return; /* seen edge-on, or not a number */
  for (int y = y0; y <= y1; y++) {
    for (int x = x0; x <= x1; x++) {
      const float px = (float)x + 0.5f, py = (float)y + 0.5f;
      const float wa = ((b[0] - px) * (c[1] - py) - (b[1] - py) * (c[0] - px)) / area;
      const float wb = ((c[0] - px) * (a[1] - py) - (c[1] - py) * (a[0] - px)) / area;
      const float wc = 1.0f - wa - wb;
      const float z = wa * a[2] + wb * b[2] + wc * c[2];
      const size_t s = (size_t)y * (size_t)raster->size + (size_t)x;
      if (wa < 0.0f || wb < 0.0f || wc < 0.0f || z <= raster->depth[s]) continue;
      raster->depth[s] = z;
      raster->face[s] = face;
      raster->corner[2 * s] = wa;
      raster->corner[2 * s + 1] = wb;
    }
  }
}

PetscErrorCode EqmRasterDraw(EqmRaster *raster, const EqmCamera *camera, const EqmFaces *faces, const PetscReal *points,
                             PetscInt num_points)
{
  float *projected;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * num_points, &projected));
  Project(camera, raster->size, points, num_points, projected);
  for (PetscInt f = 0; f < faces->num_faces; f++) {
    const PetscInt *v = &faces->vertices[3 * f];
    DrawFace(raster, (int32_t)f, &projected[3 * v[0]], &projected[3 * v[1]], &projected[3 * v[2]]);
  }
  PetscCall(PetscFree(projected));
  PetscFunctionReturn(0);
}
