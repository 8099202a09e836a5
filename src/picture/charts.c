/* The histogram of the ratios and the curves of the convergence. */
#ifdef EQM_HAVE_CAIRO
#include "page.h"
#include <math.h>

enum { BINS = 81 };

/* The value at a place between the ends, 0 ... 1. */
static double ValueAt(const EqmAxis *axis, double place)
{
  return axis->logarithmic ? axis->low * pow(axis->high / axis->low, place)
                           : axis->low + place * (axis->high - axis->low);
}

/* Ratios that lie off the axis are counted into its first and last bin. */
static double FillBins(const EqmResult *result, const EqmAxis *axis, double bins[BINS])
{
  double highest = 0.0;

  for (int b = 0; b < BINS; b++) bins[b] = 0.0;
  for (PetscInt j = 0; j < result->num_cells; j++) {
    const double place = result->ratio[j] > 0.0 ? BINS * EqmAxisPlace(axis, result->ratio[j]) : 0.0;
    bins[(int)fmin(fmax(place, 0.0), BINS - 1)] += 1.0;
  }
  for (int b = 0; b < BINS; b++) {
    bins[b] *= 100.0 / fmax(1.0, (double)result->num_cells);
    highest = fmax(highest, bins[b]);
  }
  return highest;
}

/* Draw how many cells have which ratio. Not collective. */
PetscErrorCode EqmDrawHistogram(cairo_t *page, const EqmResult *result, EqmColorScale scale, EqmBox box)
{
  const EqmStatistics *statistics = &result->ratio_statistics;
  const PetscBool wide = (PetscBool)(scale.limit > 2.0);
  const double reach = fmin(0.999, 1.25 * (scale.limit - 1.0));
  EqmAxis across = {wide ? 1.0 / scale.limit : 1.0 - reach, wide ? scale.limit : 1.0 + reach, wide,
                    result->cell_size == 3 ? "area ratio r" : "volume ratio r", PETSC_FALSE};
  EqmAxis along = {0.0, 1.0, PETSC_FALSE, "cells, %", PETSC_FALSE};
  double bins[BINS];
  char mean[48], sd[48], text[160];

  PetscFunctionBegin;
  along.high = fmax(1e-9, 1.12 * FillBins(result, &across, bins));
  EqmDrawAxes(page, box, &across, &along);
  for (int b = 0; b < BINS; b++) {
    const double height = box.height * EqmAxisPlace(&along, bins[b]), width = box.width / BINS;
    double rgb[3];
    EqmColorOfRatio(scale, ValueAt(&across, (b + 0.5) / BINS), rgb);
    cairo_rectangle(page, box.x + b * width, box.y + box.height - height, width, height);
    cairo_set_source_rgb(page, 0.9 * rgb[0], 0.9 * rgb[1], 0.9 * rgb[2]);
    cairo_fill_preserve(page);
    cairo_set_line_width(page, 0.4);
    EqmSetInk(page, EQM_GREY);
    if (bins[b] > 0.0)
      cairo_stroke(page);
    else
      cairo_new_path(page);
  }
  EqmNumberText(statistics->mean, mean, sizeof(mean));
  EqmNumberText(statistics->sd, sd, sizeof(sd));
  (void)snprintf(text, sizeof(text), "mean %s,  SD %s", mean, sd);
  EqmDrawText(page, box.x + box.width, box.y - 10, 13, PETSC_FALSE, EQM_RIGHT, EQM_INK, text);
  PetscFunctionReturn(0);
}

/* Draw the energy over the iterations and over the seconds, on one log scale. Not collective. */
void EqmDrawConvergence(cairo_t *page, const EqmResult *result, EqmBox by_iteration, EqmBox by_time)
{
  const PetscInt count = result->num_history;
  EqmAxis energy = EqmAxisOf(result->energy, count, PETSC_TRUE, "energy E");
  EqmAxis iteration = EqmAxisOf(result->iteration, count, PETSC_FALSE, "iteration");
  EqmAxis elapsed = EqmAxisOf(result->elapsed, count, PETSC_FALSE, "seconds since the program's start");

  if (count == 0) {
    EqmDrawText(page, by_iteration.x, by_iteration.y + 20, 13, PETSC_FALSE, EQM_LEFT, EQM_GREY,
                "no history: this map was not made by iteration");
    return;
  }
  EqmDrawAxes(page, by_iteration, &iteration, &energy);
  EqmDrawCurve(page, by_iteration, &iteration, &energy, count, result->iteration, result->energy, EQM_BLUE);
  energy.bare = PETSC_TRUE;
  energy.label = NULL;
  elapsed.low = 0.0;
  EqmDrawAxes(page, by_time, &elapsed, &energy);
  EqmDrawCurve(page, by_time, &elapsed, &energy, count, result->elapsed, result->energy, EQM_ORANGE);
}
#endif
