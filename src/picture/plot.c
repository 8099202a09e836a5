/* Axes and curves. */
#ifdef EQM_HAVE_CAIRO
#include "picture/plot.h"
#include <math.h>

enum { MAX_TICKS = 64 };

/* An axis that holds all finite (on a log scale: positive) values, with a little air. Not collective. */
EqmAxis EqmAxisOf(const double *values, PetscInt count, PetscBool logarithmic, const char *label)
{
  EqmAxis axis = {HUGE_VAL, -HUGE_VAL, logarithmic, label, PETSC_FALSE, 0.0};
  double air;

  for (PetscInt k = 0; k < count; k++) {
    if (!isfinite(values[k]) || (logarithmic && values[k] <= 0.0)) continue;
    axis.low = fmin(axis.low, values[k]);
    axis.high = fmax(axis.high, values[k]);
  }
  if (!(axis.low <= axis.high)) axis.low = axis.high = 1.0;
  if (logarithmic) {
    air = fmax(0.06 * log(axis.high / axis.low), 0.1);
    axis.low *= exp(-air);
    axis.high *= exp(air);
  } else if (axis.low == axis.high) {
    axis.high = axis.low + 1.0;
  }
  return axis;
}

/* Where on the axis a value lies: 0 at the low end, 1 at the high end. Not collective. */
double EqmAxisPlace(const EqmAxis *axis, double value)
{
  if (axis->logarithmic) return log(value / axis->low) / log(axis->high / axis->low);
  return (value - axis->low) / (axis->high - axis->low);
}

/* 1, 2 or 5 times a power of ten, so that about `wanted` steps fill the axis. */
static double EvenStep(double span, int wanted)
{
  const double rough = span / wanted, power = pow(10.0, floor(log10(rough)));

  if (rough <= power) return power;
  if (rough <= 2 * power) return 2 * power;
  return rough <= 5 * power ? 5 * power : 10 * power;
}

static int LinearTicks(const EqmAxis *axis, double *ticks)
{
  const double step = EvenStep(axis->high - axis->low, 5);
  int count = 0;

  for (double k = ceil(axis->low / step - 1e-9); k * step <= axis->high + 1e-9 * step && count < MAX_TICKS; k++)
    ticks[count++] = k * step;
  return count;
}

/* Powers of ten, every few of them if there are many; 1, 2, 5 where there are few. */
static int LogarithmicTicks(const EqmAxis *axis, double *ticks)
{
  static const double factors[] = {1, 2, 5};
  const double decades = log10(axis->high / axis->low);
  const int fine = decades <= 2.0, stride = (int)fmax(1.0, ceil(decades / 7.0));
  int count = 0;

  for (int e = (int)floor(log10(axis->low)); e <= (int)ceil(log10(axis->high)); e++) {
    if (!fine && ((e % stride) + stride) % stride) continue;
    for (int f = 0; f < (fine ? 3 : 1); f++) {
      const double tick = factors[f] * pow(10.0, e);
      if (tick >= axis->low && tick <= axis->high && count < MAX_TICKS) ticks[count++] = tick;
    }
  }
  return count < 2 ? LinearTicks(axis, ticks) : count;
}

/* A tick's number: on an axis of many decades the power of ten, on a linear one as many decimals as tell ticks apart.
 */
static void TickText(const EqmAxis *axis, double tick, char *text, size_t length)
{
  const double span = axis->high - axis->low, largest = fmax(fabs(axis->low), fabs(axis->high));
  const double value = fabs(tick) < 1e-12 * span ? 0.0 : tick;
  const int decimals = (int)fmax(0.0, -floor(log10(EvenStep(span, 5)) + 1e-9));

  if (axis->logarithmic && axis->high > 100.0 * axis->low)
    EqmPowerText(tick, text, length);
  else if (axis->logarithmic || largest < 1e-3 || largest >= 1e5)
    EqmNumberText(value, text, length);
  else
    (void)snprintf(text, length, "%.*f", decimals, value);
}

static int Ticks(const EqmAxis *axis, double *ticks)
{
  return axis->logarithmic ? LogarithmicTicks(axis, ticks) : LinearTicks(axis, ticks);
}

static void Line(cairo_t *page, double x0, double y0, double x1, double y1)
{
  cairo_move_to(page, x0, y0);
  cairo_line_to(page, x1, y1);
  cairo_stroke(page);
}

static void DrawAcross(cairo_t *page, EqmBox box, const EqmAxis *axis)
{
  double ticks[MAX_TICKS];
  const int count = Ticks(axis, ticks);

  for (int k = 0; k < count; k++) {
    const double x = box.x + box.width * EqmAxisPlace(axis, ticks[k]);
    char text[48];
    EqmSetInk(page, EQM_GREY);
    Line(page, x, box.y + box.height, x, box.y + box.height + 4);
    TickText(axis, ticks[k], text, sizeof(text));
    if (!axis->bare) EqmDrawText(page, x, box.y + box.height + 18, 12, PETSC_FALSE, EQM_CENTER, EQM_GREY, text);
  }
  if (axis->label)
    EqmDrawText(page, box.x + 0.5 * box.width, box.y + box.height + 38, 13, PETSC_FALSE, EQM_CENTER, EQM_INK,
                axis->label);
}

static void DrawAlong(cairo_t *page, EqmBox box, const EqmAxis *axis)
{
  double ticks[MAX_TICKS];
  const int count = Ticks(axis, ticks);

  for (int k = 0; k < count; k++) {
    const double y = box.y + box.height * (1.0 - EqmAxisPlace(axis, ticks[k]));
    char text[48];
    EqmSetInk(page, EQM_PALE);
    Line(page, box.x, y, box.x + box.width, y);
    TickText(axis, ticks[k], text, sizeof(text));
    if (!axis->bare) EqmDrawText(page, box.x - 7 - axis->gap, y + 4, 12, PETSC_FALSE, EQM_RIGHT, EQM_GREY, text);
  }
  if (axis->label) EqmDrawText(page, box.x, box.y - 10, 13, PETSC_FALSE, EQM_LEFT, EQM_INK, axis->label);
}

/* Draw the grid, the ticks with their numbers, and the labels: below the box, and above its left corner. Not
   collective. */
void EqmDrawAxes(cairo_t *page, EqmBox box, const EqmAxis *across, const EqmAxis *along)
{
  cairo_set_line_width(page, 1.0);
  DrawAlong(page, box, along);
  DrawAcross(page, box, across);
  EqmSetInk(page, EQM_GREY);
  Line(page, box.x, box.y + box.height, box.x + box.width, box.y + box.height);
}

/* Draw a curve through the finite points, with dots while there are few. Not collective. */
void EqmDrawCurve(cairo_t *page, EqmBox box, const EqmAxis *across, const EqmAxis *along, PetscInt count,
                  const double *x, const double *y, EqmInk ink)
{
  PetscBool drawing = PETSC_FALSE;

  EqmSetInk(page, ink);
  cairo_set_line_width(page, 2.0);
  cairo_set_line_join(page, CAIRO_LINE_JOIN_ROUND);
  for (PetscInt k = 0; k < count; k++) {
    const double px = box.x + box.width * EqmAxisPlace(across, x[k]);
    const double py = box.y + box.height * (1.0 - EqmAxisPlace(along, y[k]));
    if (!isfinite(px) || !isfinite(py)) continue;
    if (drawing)
      cairo_line_to(page, px, py);
    else
      cairo_move_to(page, px, py);
    drawing = PETSC_TRUE;
  }
  cairo_stroke(page);
  for (PetscInt k = 0; k < count && count <= 60; k++) {
    const double px = box.x + box.width * EqmAxisPlace(across, x[k]);
    const double py = box.y + box.height * (1.0 - EqmAxisPlace(along, y[k]));
    if (!isfinite(px) || !isfinite(py)) continue;
    cairo_arc(page, px, py, 3.0, 0.0, 2 * PETSC_PI);
    cairo_fill(page);
  }
}
#endif
