/* Distributions and curves. */
#ifdef EQM_HAVE_CAIRO
#include "picture/page.h"
#include <math.h>

enum { BINS = 72 };

/* Shares of what lies in equal bins between the ends of an axis, and below and above them, in percent. */
typedef struct {
  EqmAxis across;
  double bins[BINS], below, above, highest;
  double limit; /* of a colour scale of ratios */
} Distribution;

static double ValueAt(const EqmAxis *axis, double place)
{
  return axis->logarithmic ? axis->low * pow(axis->high / axis->low, place)
                           : axis->low + place * (axis->high - axis->low);
}

/* Ratios, by the measure of the cells: slivers do not count for more than they are. */
static void CollectRatios(const EqmPage *page, Distribution *d)
{
  const EqmResult *const result = page->results;
  const double limit = EqmColorScaleOf(EQM_SCALE_RATIO, result->ratio, result->num_cells).limit;
  const double reach = fmin(0.999, 1.25 * (limit - 1.0));
  const PetscBool wide = (PetscBool)(limit > 2.0);
  double total = 0.0;

  d->limit = limit;
  d->across = (EqmAxis){wide ? 1.0 / limit : 1.0 - reach,
                        wide ? limit : 1.0 + reach,
                        wide,
                        result->cell_size == 3 ? "area ratio r" : "volume ratio r",
                        PETSC_FALSE,
                        0.0};
  for (PetscInt c = 0; c < result->num_cells; c++) total += result->weight[c];
  for (PetscInt c = 0; c < result->num_cells; c++) {
    const double share = 100.0 * result->weight[c] / total, r = result->ratio[c];
    const double place = r > 0.0 ? BINS * EqmAxisPlace(&d->across, r) : -1.0;
    if (place < 0.0)
      d->below += share;
    else if (place >= BINS)
      d->above += share;
    else
      d->bins[(int)place] += share;
  }
}

/* Angle errors, by corners: from the stored bins, up to where nineteen twentieths of them lie. */
static void CollectAngles(const EqmPage *page, Distribution *d)
{
  static const int width[] = {1, 2, 4, 6, 10}; /* stored bins in a bar */
  const EqmResult *const result = page->results;
  double total = 0.0, sum = 0.0;
  int last = 0, step = 0;

  for (int k = 0; k < EQM_NUM_ANGLE_BINS; k++) total += (double)result->angle_histogram[k];
  while (last < EQM_NUM_ANGLE_BINS && sum < 0.95 * total) sum += (double)result->angle_histogram[last++];
  while (step < 4 && BINS * width[step] < last) step++;
  d->across =
      (EqmAxis){0.0, 180.0 / EQM_NUM_ANGLE_BINS * BINS * width[step], PETSC_FALSE, "angle error, degrees", PETSC_FALSE,
                0.0};
  for (int k = 0; k < EQM_NUM_ANGLE_BINS; k++) {
    const double share = 100.0 * (double)result->angle_histogram[k] / fmax(total, 1.0);
    if (k / width[step] < BINS)
      d->bins[k / width[step]] += share;
    else
      d->above += share;
  }
}

static void DrawBarAt(cairo_t *cairo, EqmBox box, double x, double width, double height, const double rgb[3])
{
  if (!(height > 0.0)) return;
  cairo_rectangle(cairo, x, box.y + box.height - height, width, height);
  cairo_set_source_rgb(cairo, 0.9 * rgb[0], 0.9 * rgb[1], 0.9 * rgb[2]);
  cairo_fill_preserve(cairo);
  cairo_set_line_width(cairo, 0.4);
  EqmSetInk(cairo, EQM_GREY);
  cairo_stroke(cairo);
}

/* What lies off the axis: a bar of its own beside the plot, with its share. */
static void DrawOverflow(cairo_t *cairo, EqmBox box, const EqmAxis *along, double share, PetscBool above)
{
  static const double grey[3] = {0.75, 0.76, 0.78};
  const double x = above ? box.x + box.width + 6 : box.x - 12, height = box.height * EqmAxisPlace(along, share);
  char text[64];

  if (!(share > 0.0)) return;
  DrawBarAt(cairo, box, x, 7, fmin(height, box.height), grey);
  (void)snprintf(text, sizeof(text), "%s %.2g %%", above ? "beyond:" : "below:", share);
  EqmDrawText(cairo, above ? box.x + box.width - 2 : box.x + 4, box.y + 12, 11, PETSC_FALSE,
              above ? EQM_RIGHT : EQM_LEFT, EQM_GREY, text);
}

static void DrawCaption(cairo_t *cairo, const EqmPage *page, PetscBool angles, EqmBox box)
{
  const EqmResult *const result = page->results;
  char mean[48], sd[48], text[160];

  EqmNumberText(angles ? result->angle_mean : result->weighted.p50, mean, sizeof(mean));
  EqmNumberText(angles ? result->angle_median : result->weighted.sd, sd, sizeof(sd));
  (void)snprintf(text, sizeof(text), angles ? "mean %s°,  median %s°" : "median %s,  SD %s", mean, sd);
  EqmDrawText(cairo, box.x + box.width, box.y - 10, 13, PETSC_FALSE, EQM_RIGHT, EQM_INK, text);
}

void EqmDrawHistogram(cairo_t *cairo, const EqmPage *page, EqmBox box)
{
  const PetscBool angles = (PetscBool)(page->conformal && page->results->has_angles);
  const char *const what = angles ? "corners, %" : page->results->cell_size == 3 ? "area, %" : "volume, %";
  EqmAxis along = {0.0, 1.0, PETSC_FALSE, what, PETSC_FALSE, 12.0};
  Distribution d = {.below = 0.0};

  if (angles)
    CollectAngles(page, &d);
  else
    CollectRatios(page, &d);
  for (int b = 0; b < BINS; b++) d.highest = fmax(d.highest, d.bins[b]);
  along.high = fmax(1e-9, 1.12 * fmax(d.highest, fmin(3 * d.highest, fmax(d.below, d.above))));
  EqmDrawAxes(cairo, box, &d.across, &along);
  for (int b = 0; b < BINS; b++) {
    double rgb[3] = {0.106, 0.533, 0.522};
    if (!angles)
      EqmColorOf(page->conformal ? (EqmColorScale){EQM_SCALE_RATIO, d.limit} : page->scale,
                 ValueAt(&d.across, (b + 0.5) / BINS), rgb);
    DrawBarAt(cairo, box, box.x + b * box.width / BINS, box.width / BINS, box.height * EqmAxisPlace(&along, d.bins[b]),
              rgb);
  }
  DrawOverflow(cairo, box, &along, d.below, PETSC_FALSE);
  DrawOverflow(cairo, box, &along, d.above, PETSC_TRUE);
  DrawCaption(cairo, page, angles, box);
}

/* How the run went over the iterations and over the seconds, on one log scale. */
void EqmDrawConvergence(cairo_t *cairo, const EqmPage *page, EqmBox by_iteration, EqmBox by_time)
{
  const EqmResult *const result = page->results;
  const PetscInt count = result->num_history;
  EqmAxis iteration = EqmAxisOf(result->iteration, count, PETSC_FALSE, "iteration");
  EqmAxis elapsed = EqmAxisOf(result->elapsed, count, PETSC_FALSE, "seconds since the program's start");
  EqmAxis energy;
  double *values;

  if (count == 0 || PetscMalloc1(count, &values)) {
    EqmDrawText(cairo, by_iteration.x, by_iteration.y + 20, 13, PETSC_FALSE, EQM_LEFT, EQM_GREY,
                "the result holds no history of iterations");
    return;
  }
  EqmResultCurve(result, page->curve, values);
  energy = EqmAxisOf(values, count, PETSC_TRUE, EqmCurveName(page->curve));
  EqmDrawAxes(cairo, by_iteration, &iteration, &energy);
  EqmDrawCurve(cairo, by_iteration, &iteration, &energy, count, result->iteration, values, EQM_BLUE);
  energy.bare = PETSC_TRUE;
  energy.label = NULL;
  elapsed.low = 0.0;
  EqmDrawAxes(cairo, by_time, &elapsed, &energy);
  EqmDrawCurve(cairo, by_time, &elapsed, &energy, count, result->elapsed, values, EQM_ORANGE);
  (void)PetscFree(values);
}

/* An axis that holds both. */
static EqmAxis JoinAxes(EqmAxis a, EqmAxis b)
{
  a.low = fmin(a.low, b.low);
  a.high = fmax(a.high, b.high);
  return a;
}

void EqmDrawAllCurves(cairo_t *cairo, const EqmPage *page, EqmBox by_iteration, EqmBox by_time)
{
  EqmAxis iteration, elapsed, energy;
  double *values[EQM_MOST_RESULTS] = {NULL};
  PetscBool any = PETSC_FALSE;

  for (PetscInt k = 0; k < page->num; k++) {
    const EqmResult *const r = &page->results[k];
    if (r->num_history == 0 || PetscMalloc1(r->num_history, &values[k])) continue;
    EqmResultCurve(r, page->curve, values[k]);
    const EqmAxis axes[] = {EqmAxisOf(r->iteration, r->num_history, PETSC_FALSE, "iteration"),
                            EqmAxisOf(r->elapsed, r->num_history, PETSC_FALSE, "seconds since the program's start"),
                            EqmAxisOf(values[k], r->num_history, PETSC_TRUE, EqmCurveName(page->curve))};
    iteration = any ? JoinAxes(iteration, axes[0]) : axes[0];
    elapsed = any ? JoinAxes(elapsed, axes[1]) : axes[1];
    energy = any ? JoinAxes(energy, axes[2]) : axes[2];
    any = PETSC_TRUE;
  }
  if (!any) return;
  elapsed.low = 0.0;
  EqmDrawAxes(cairo, by_iteration, &iteration, &energy);
  EqmDrawAxes(cairo, by_time, &elapsed, &energy);
  for (PetscInt k = 0; k < page->num; k++) {
    const EqmResult *const r = &page->results[k];
    if (!values[k]) continue;
    EqmDrawCurve(cairo, by_iteration, &iteration, &energy, r->num_history, r->iteration, values[k], EqmInkOf(k));
    EqmDrawCurve(cairo, by_time, &elapsed, &energy, r->num_history, r->elapsed, values[k], EqmInkOf(k));
    (void)PetscFree(values[k]);
  }
}
#endif
