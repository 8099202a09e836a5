/* Colours: a diverging scale for ratios, patterns for maps. Both stay apart for colour-blind eyes. */
#include "picture.h"
#include <math.h>
#include <stdlib.h>

/* From blue (shrunk) over near-white (kept) to red-brown (grown), in even steps of lightness. */
static const double diverging[][3] = {{0.020, 0.188, 0.380}, {0.130, 0.400, 0.674}, {0.262, 0.576, 0.765},
                                      {0.572, 0.773, 0.871}, {0.820, 0.898, 0.941}, {0.969, 0.965, 0.957},
                                      {0.992, 0.859, 0.780}, {0.957, 0.647, 0.510}, {0.839, 0.376, 0.302},
                                      {0.698, 0.094, 0.168}, {0.404, 0.000, 0.122}};
enum { NUM_STOPS = sizeof(diverging) / sizeof(diverging[0]) };

static int CompareDoubles(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* A scale on which all but about a twentieth of the ratios have a colour of their own. Not collective. */
EqmColorScale EqmColorScaleOf(const PetscReal *ratio, PetscInt count)
{
  static const double limits[] = {1.0001, 1.0002, 1.0005, 1.001, 1.002, 1.005, 1.01, 1.02, 1.05,
                                  1.1,    1.2,    1.5,    2,     4,     8,     16,   64,   256};
  enum { NUM_LIMITS = sizeof(limits) / sizeof(limits[0]), SAMPLES = 4096 };
  const PetscInt step = PetscMax(1, count / SAMPLES);
  EqmColorScale scale = {limits[0]};
  double deviation[2 * SAMPLES];
  int taken = 0, k = 0;

  for (PetscInt j = 0; j < count && taken < 2 * SAMPLES; j += step) {
    if (ratio[j] > 0.0) deviation[taken++] = fabs(log(ratio[j]));
  }
  if (taken == 0) return scale;
  qsort(deviation, (size_t)taken, sizeof(deviation[0]), CompareDoubles);
  while (k + 1 < NUM_LIMITS && log(limits[k]) < deviation[(int)(0.95 * (taken - 1))]) k++;
  scale.limit = limits[k];
  return scale;
}

/* The colour of a ratio; magenta for folded cells. Not collective. */
void EqmColorOfRatio(EqmColorScale scale, double ratio, double rgb[3])
{
  double place;
  int stop;

  if (!(ratio > 0.0)) {
    rgb[0] = 0.9, rgb[1] = 0.0, rgb[2] = 0.9;
    return;
  }
  place = 0.5 + 0.5 * log(ratio) / log(scale.limit);
  place = fmin(fmax(place, 0.0), 1.0) * (NUM_STOPS - 1);
  stop = (int)fmin(floor(place), NUM_STOPS - 2);
  for (int c = 0; c < 3; c++)
    rgb[c] = diverging[stop][c] + (place - stop) * (diverging[stop + 1][c] - diverging[stop][c]);
}

static int Modulo2(double x)
{
  return (int)(fmod(floor(x), 2.0) + 2.0) % 2;
}

/* Where a point lies on the board, in patches, and whether its patch is one of those that show how the board lies. */
static PetscBool OnBoard(EqmPattern pattern, const double image[3], double *along, double *across)
{
  const double turn = atan2(image[1], image[0]) / (2 * PETSC_PI) + 1.0;
  const double radius = hypot(hypot(image[0], image[1]), image[2]);
  const double height = radius > 0.0 ? image[2] / radius : 0.0;

  switch (pattern) {
  case EQM_PATTERN_SQUARE:
  case EQM_PATTERN_DISK_SQUARES:
    *along = (pattern == EQM_PATTERN_SQUARE ? 16 : 8) * image[0];
    *across = (pattern == EQM_PATTERN_SQUARE ? 16 : 8) * image[1];
    return (PetscBool)(floor(*along) == 0.0 || floor(*across) == 0.0);
  case EQM_PATTERN_DISK:
    *across = 10 * (image[0] * image[0] + image[1] * image[1]);
    break;
  case EQM_PATTERN_SPHERE:
    *across = 12 * (1.0 + height) / 2;
    break;
  case EQM_PATTERN_SPHERE_SQUARES: /* Mercator's; a cap of one colour where they would become too small to see */
    *across = 24 * atanh(height) / (2 * PETSC_PI);
    if (fabs(*across) < 12.0) break;
    *along = *across = 0.0;
    return PETSC_FALSE;
  }
  *along = 24 * turn;
  return (PetscBool)(floor(*along) == 24.0);
}

/* The colour of a point of the image under a checkerboard. Not collective. */
void EqmColorOfPattern(EqmPattern pattern, const double image[3], double rgb[3])
{
  static const double tones[2][3] = {{0.957, 0.945, 0.910}, {0.227, 0.404, 0.545}};
  static const double marked[2][3] = {{0.988, 0.812, 0.545}, {0.855, 0.420, 0.114}};
  double along, across;
  const PetscBool mark = OnBoard(pattern, image, &along, &across);
  const int odd = Modulo2(along) ^ Modulo2(across);

  for (int c = 0; c < 3; c++) rgb[c] = mark ? marked[odd][c] : tones[odd][c];
}
