/* Camera positions. */
#include "picture/picture.h"
#include <math.h>

static double Dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void Cross(const double a[3], const double b[3], double c[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

static void Normalise(double a[3])
{
  const double length = sqrt(Dot(a, a));

  for (int d = 0; d < 3; d++) a[d] = length > 0.0 ? a[d] / length : 0.0;
}

EqmCamera EqmCameraFlat(void)
{
  const EqmCamera camera = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}, 1.03};
  return camera;
}

EqmCamera EqmCameraTurned(const double pole[3], const double front[3], double azimuth, double elevation)
{
  const double a = azimuth * PETSC_PI / 180.0, e = elevation * PETSC_PI / 180.0;
  double up[3] = {pole[0], pole[1], pole[2]}, side[3], ahead[3];
  EqmCamera camera = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}, 1.03};

  Normalise(up);
  Cross(up, front, side);
  Normalise(side);
  Cross(side, up, ahead);
  for (int d = 0; d < 3; d++) camera.toward[d] = cos(e) * (cos(a) * ahead[d] + sin(a) * side[d]) + sin(e) * up[d];
  Cross(up, camera.toward, camera.right);
  Normalise(camera.right);
  Cross(camera.toward, camera.right, camera.up);
  return camera;
}

/* Sum of the faces' area vectors over their total area: zero for closed surfaces, a unit vector for flat ones; an open
   surface's points away from its opening. */
static void MeanNormal(const EqmFaces *faces, const PetscReal *points, double mean[3])
{
  double total = 0.0;

  mean[0] = mean[1] = mean[2] = 0.0;
  for (PetscInt f = 0; f < faces->num_faces; f++) {
    const PetscReal *p[3];
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++) p[k] = &points[3 * faces->vertices[3 * f + k]];
    for (int d = 0; d < 3; d++) u[d] = p[1][d] - p[0][d], v[d] = p[2][d] - p[0][d];
    Cross(u, v, n);
    total += sqrt(Dot(n, n));
    for (int d = 0; d < 3; d++) mean[d] += n[d];
  }
  for (int d = 0; d < 3; d++) mean[d] = total > 0.0 ? mean[d] / total : 0.0;
}

static int LargestComponent(const double a[3])
{
  int largest = 0;

  for (int d = 1; d < 3; d++) {
    if (fabs(a[d]) > fabs(a[largest])) largest = d;
  }
  return largest;
}

/* Long meshes are seen from their long side: is the mesh much longer along z than along x? */
static PetscBool IsLong(const EqmFaces *faces, const PetscReal *points)
{
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

  for (PetscInt k = 0; k < 3 * faces->num_faces; k++) {
    for (int d = 0; d < 3; d++) {
      low[d] = fmin(low[d], points[3 * faces->vertices[k] + d]);
      high[d] = fmax(high[d], points[3 * faces->vertices[k] + d]);
    }
  }
  return (PetscBool)(high[2] - low[2] > 1.4 * (high[0] - low[0]));
}

/* Choose the up axis, the front, and the view direction of a mesh. */
typedef struct {
  double pole[3], front[3], azimuth, elevation;
} Stand;

/* In scans y is up and z is the front. A surface that is open on one side, as a scan cut at its neck, has the opening
   below; a relief, whose normals point to one side, is seen from that side. */
static Stand Guess(const EqmFaces *faces, const PetscReal *points)
{
  Stand stand = {{0, 1, 0}, {0, 0, 1}, 25.0, 12.0};
  double mean[3], bias;
  int axis;

  MeanNormal(faces, points, mean);
  bias = sqrt(Dot(mean, mean));
  axis = LargestComponent(mean);
  if (bias > 0.4 || (bias > 0.01 && axis != 1)) {
    stand.pole[1] = 0.0;
    stand.pole[axis] = mean[axis] > 0 ? 1.0 : -1.0;
    stand.front[2] = 0.0;
    if (bias > 0.4)
      stand.front[axis == 1 ? 2 : 1] = axis == 2 ? -1.0 : 1.0;
    else
      stand.front[axis == 0 ? 2 : 1] = axis == 0 ? 1.0 : -1.0;
  } else if (bias > 0.01 && mean[1] < 0) {
    stand.pole[1] = -1.0;
  }
  if (bias > 0.4) {
    stand.azimuth = 20.0;
    stand.elevation = 50.0;
  } else if (stand.pole[1] > 0.0 && IsLong(faces, points)) {
    stand.azimuth = 65.0;
  }
  return stand;
}

/* The axis that the user wants up. */
static void SetUp(const char *up, Stand *stand)
{
  const char *const letter = up[0] == '-' ? up + 1 : up;
  const int axis = *letter - 'x';

  for (int d = 0; d < 3; d++) stand->pole[d] = stand->front[d] = 0.0;
  stand->pole[axis] = up[0] == '-' ? -1.0 : 1.0;
  stand->front[axis == 2 ? 1 : 2] = axis == 2 ? -1.0 : 1.0; /* with z up one looks along y */
}

EqmCamera EqmCameraChoose(const EqmFaces *faces, const PetscReal *points, const EqmReportOptions *options)
{
  Stand stand = Guess(faces, points);
  EqmCamera camera;

  if (options->up[0]) SetUp(options->up, &stand);
  if (options->has_eye) {
    stand.azimuth = options->azimuth;
    stand.elevation = options->elevation;
  }
  camera = EqmCameraTurned(stand.pole, stand.front, stand.azimuth, stand.elevation);
  EqmCameraFit(&camera, faces, points);
  return camera;
}

void EqmCameraProject(const EqmCamera *camera, double size, const double point[3], double projected[3])
{
  const double scale = 0.5 * size / camera->half_width;
  double offset[3];

  for (int d = 0; d < 3; d++) offset[d] = point[d] - camera->center[d];
  projected[0] = 0.5 * size + scale * Dot(offset, camera->right);
  projected[1] = 0.5 * size - scale * Dot(offset, camera->up);
  projected[2] = scale * Dot(offset, camera->toward);
}

void EqmCameraFit(EqmCamera *camera, const EqmFaces *faces, const PetscReal *points)
{
  const double *axis[3] = {camera->right, camera->up, camera->toward};
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

  for (PetscInt k = 0; k < 3 * faces->num_faces; k++) {
    for (int d = 0; d < 3; d++) {
      const double x = Dot(&points[3 * faces->vertices[k]], axis[d]);
      low[d] = fmin(low[d], x);
      high[d] = fmax(high[d], x);
    }
  }
  if (!(low[0] <= high[0])) return; /* nothing to see */
  for (int d = 0; d < 3; d++) {
    camera->center[d] = 0.0;
    for (int k = 0; k < 3; k++) camera->center[d] += 0.5 * (low[k] + high[k]) * axis[k][d];
  }
  camera->half_width = 0.515 * fmax(fmax(high[0] - low[0], high[1] - low[1]), 1e-300);
}
