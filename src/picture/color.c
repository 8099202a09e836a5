/* Colours: scales for values, patterns for maps. All stay apart for colour-blind eyes. */
#include "picture/picture.h"
#include "base/sort.h"
#include <math.h>
#include <stdlib.h>

/* From blue (shrunk) over near-white (kept) to red-brown (grown), in even steps of lightness. */
static const double diverging[][3] = {{0.020, 0.188, 0.380}, {0.130, 0.400, 0.674}, {0.262, 0.576, 0.765},
                                      {0.572, 0.773, 0.871}, {0.820, 0.898, 0.941}, {0.969, 0.965, 0.957},
                                      {0.992, 0.859, 0.780}, {0.957, 0.647, 0.510}, {0.839, 0.376, 0.302},
                                      {0.698, 0.094, 0.168}, {0.404, 0.000, 0.122}};
enum { NUM_STOPS = sizeof(diverging) / sizeof(diverging[0]) };

/* From near-white (kept) to a dark green, in even steps of lightness; no green or magenta in the other scale. */
static const double sequential[][3] = {{0.969, 0.965, 0.957}, {0.827, 0.913, 0.855}, {0.647, 0.836, 0.741},
                                       {0.443, 0.745, 0.647}, {0.245, 0.643, 0.580}, {0.106, 0.533, 0.522},
                                       {0.035, 0.427, 0.455}, {0.016, 0.325, 0.376}, {0.008, 0.228, 0.290},
                                       {0.004, 0.145, 0.208}, {0.000, 0.075, 0.133}};

static int CompareDoubles(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The smallest limit that holds a value: 1, 2 or 5 times a power of ten. */
static double RoundUp(double value)
{
  const double power = pow(10.0, floor(log10(value)));

  if (!(value > 0.0)) return 1.0;
  if (value <= power) return power;
  if (value <= 2 * power) return 2 * power;
  return value <= 5 * power ? 5 * power : 10 * power;
}

/* The deviation up to which nineteen twentieths of the values lie: of their logarithms, or of distances themselves. */
static double LargeDeviation(EqmScaleKind kind, const PetscReal *values, PetscInt count)
{
  enum { SAMPLES = 4096 };
  const PetscInt step = PetscMax(1, count / SAMPLES);
  double deviation[2 * SAMPLES];
  int taken = 0;

  for (PetscInt j = 0; j < count && taken < 2 * SAMPLES; j += step) {
    if (values[j] > 0.0) deviation[taken++] = kind == EQM_SCALE_DISTANCE ? values[j] : fabs(log(values[j]));
  }
  EqmSort(deviation, (size_t)taken, sizeof(deviation[0]), CompareDoubles);
  return taken ? deviation[(int)(0.95 * (taken - 1))] : 0.0;
}

EqmColorScale EqmColorScaleOf(EqmScaleKind kind, const PetscReal *values, PetscInt count)
{
  static const double limits[] = {1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2, 4, 8, 16, 64, 256};
  enum { NUM_LIMITS = sizeof(limits) / sizeof(limits[0]) };
  const double deviation = LargeDeviation(kind, values, count);
  EqmColorScale scale = {kind, limits[0]};

  if (kind == EQM_SCALE_DISTANCE) {
    scale.limit = RoundUp(deviation);
    return scale;
  }
  for (int k = 0; k < NUM_LIMITS; k++) {
    scale.limit = limits[k];
    if (log(limits[k]) >= deviation) break;
  }
  return scale;
}

EqmColorScale EqmColorScaleJoin(EqmColorScale a, EqmColorScale b)
{
  return a.limit >= b.limit ? a : b;
}

double EqmColorScaleValue(EqmColorScale scale, double place)
{
  if (scale.kind == EQM_SCALE_RATIO) return pow(scale.limit, 2.0 * place - 1.0);
  return scale.kind == EQM_SCALE_STRETCH ? pow(scale.limit, place) : scale.limit * place;
}

/* Where a value lies on the scale, 0 ... 1 for those that have a colour of their own. */
static double PlaceOf(EqmColorScale scale, double value)
{
  if (scale.kind == EQM_SCALE_RATIO) return 0.5 + 0.5 * log(value) / log(scale.limit);
  return scale.kind == EQM_SCALE_STRETCH ? log(value) / log(scale.limit) : value / scale.limit;
}

void EqmColorOf(EqmColorScale scale, double value, double rgb[3])
{
  const double(*const stops)[3] = scale.kind == EQM_SCALE_RATIO ? diverging : sequential;
  double place;
  int stop;

  if (scale.kind == EQM_SCALE_RATIO && !(value > 0.0)) {
    rgb[0] = 0.9, rgb[1] = 0.0, rgb[2] = 0.9;
    return;
  }
  place = fmin(fmax(PlaceOf(scale, value), 0.0), 1.0) * (NUM_STOPS - 1);
  stop = (int)fmin(floor(place), NUM_STOPS - 2);
  for (int c = 0; c < 3; c++) rgb[c] = stops[stop][c] + (place - stop) * (stops[stop + 1][c] - stops[stop][c]);
}

static int Modulo2(double x)
{
  return (int)(fmod(floor(x), 2.0) + 2.0) % 2;
}

/* Small cubes in the unit cube, those along one edge marked. Points of a face are moved inwards by rounding's measure,
   so that all lie on one side of its plane. */
static PetscBool InCubes(const double image[3], double *number)
{
  const double count = 6.0, inward = 1e-6;
  double place[3];

  for (int k = 0; k < 3; k++) place[k] = floor(count * fmin(fmax(image[k], inward), 1.0 - inward));
  *number = place[0] + place[1] + place[2];
  return (PetscBool)(place[1] == 0.0 && place[2] == 0.0);
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
  case EQM_PATTERN_CUBE:
    *across = 0.0;
    return InCubes(image, along);
  case EQM_PATTERN_SPHERE_SQUARES: /* Mercator's; a cap of one colour where they would become too small to see */
    *across = 24 * atanh(height) / (2 * PETSC_PI);
    if (fabs(*across) < 12.0) break;
    *along = *across = 0.0;
    return PETSC_FALSE;
  }
  *along = 24 * turn;
  return (PetscBool)(floor(*along) == 24.0);
}

void EqmColorOfPattern(EqmPattern pattern, const double image[3], double rgb[3])
{
  static const double tones[2][3] = {{0.957, 0.945, 0.910}, {0.227, 0.404, 0.545}};
  static const double marked[2][3] = {{0.988, 0.812, 0.545}, {0.855, 0.420, 0.114}};
  double along, across;
  const PetscBool mark = OnBoard(pattern, image, &along, &across);
  const int odd = Modulo2(along) ^ Modulo2(across);

  for (int c = 0; c < 3; c++) rgb[c] = mark ? marked[odd][c] : tones[odd][c];
}
