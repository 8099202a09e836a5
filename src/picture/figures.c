/* The figures of a result as text. Those that slivers hardly change come first. */
#ifdef EQM_HAVE_CAIRO
#include "picture/figures.h"
#include "picture/plot.h"
#include <math.h>

typedef void (*Teller)(const EqmResult *result, char *text, size_t length);

/* Two digits. */
static void ShortText(double value, char *text, size_t length)
{
  const double unit = pow(10.0, floor(log10(fmax(value, 1e-300))) - 1.0);

  EqmNumberText(unit * round(value / unit), text, length);
}

/* "a … b", with digits enough to tell both from one. */
static void RangeText(double from, double to, char *text, size_t length)
{
  char low[48], high[48];

  EqmNumberText(from, low, sizeof(low));
  EqmNumberText(to, high, sizeof(high));
  if (fabs(from - 1.0) < 1e-2 && fabs(to - 1.0) < 1e-2) {
    ShortText(fabs(from - 1.0), low, sizeof(low));
    ShortText(fabs(to - 1.0), high, sizeof(high));
    (void)snprintf(text, length, "1 %s %s … 1 %s %s", from < 1.0 ? "−" : "+", low, to < 1.0 ? "−" : "+", high);
  } else {
    (void)snprintf(text, length, "%s … %s", low, high);
  }
}

static void Energy(const EqmResult *r, char *text, size_t length)
{
  EqmNumberText(r->energy_final, text, length);
}

static void StartEnergy(const EqmResult *r, char *text, size_t length)
{
  EqmNumberText(r->energy_initial, text, length);
}

static void WeightedDeviation(const EqmResult *r, char *text, size_t length)
{
  EqmNumberText(r->weighted.sd, text, length);
}

static void WeightedRange(const EqmResult *r, char *text, size_t length)
{
  RangeText(r->weighted.p05, r->weighted.p95, text, length);
}

static void CellDeviation(const EqmResult *r, char *text, size_t length)
{
  EqmNumberText(r->ratio_statistics.sd, text, length);
}

static void CellRange(const EqmResult *r, char *text, size_t length)
{
  RangeText(r->ratio_statistics.min, r->ratio_statistics.max, text, length);
}

static void Outliers(const EqmResult *r, char *text, size_t length)
{
  char count[32], share[48];

  if (r->weighted.outliers == 0) return;
  EqmCountText(r->weighted.outliers, count, sizeof(count));
  ShortText(100 * r->weighted.outlier_share, share, sizeof(share));
  (void)snprintf(text, length, "%s cells, %s %%", count, share);
}

static void DeviationWithout(const EqmResult *r, char *text, size_t length)
{
  if (r->weighted.outliers > 0) EqmNumberText(r->weighted.cell_sd_without, text, length);
}

static void Folds(const EqmResult *r, char *text, size_t length)
{
  EqmCountText(r->folds, text, length);
}

static void AngleErrors(const EqmResult *r, char *text, size_t length)
{
  if (r->cell_size == 3 && isfinite(r->angle_mean))
    (void)snprintf(text, length, "%.3g° / %.3g°", r->angle_mean, r->angle_median);
}

static void ThreeNumbers(double a, double b, double c, char *text, size_t length)
{
  char one[48], two[48], three[48];

  EqmNumberText(a, one, sizeof(one));
  EqmNumberText(b, two, sizeof(two));
  EqmNumberText(c, three, sizeof(three));
  (void)snprintf(text, length, "%s / %s / %s", one, two, three);
}

static void Stretches(const EqmResult *r, char *text, size_t length)
{
  if (r->cell_size == 3 && isfinite(r->quasi_mean))
    ThreeNumbers(r->quasi_mean, r->quasi_median, r->quasi_max, text, length);
}

static void Worst(const EqmResult *r, char *text, size_t length)
{
  size_t used = 0;

  for (PetscInt m = 0; m < r->num_marks && used < length; m++)
    used += (size_t)snprintf(text + used, length - used, "%s%" PetscInt_FMT, m ? ", " : "", r->mark[m]);
}

static void Iterations(const EqmResult *r, char *text, size_t length)
{
  EqmCountText(r->iterations, text, length);
}

static void Seconds(const EqmResult *r, char *text, size_t length)
{
  EqmNumberText(r->seconds, text, length);
}

static void Parallel(const EqmResult *r, char *text, size_t length)
{
  (void)snprintf(text, length, "%" PetscInt64_FMT " × %" PetscInt64_FMT, r->ranks, r->threads);
}

static const struct {
  const char *surface, *solid;
  Teller tell;
} figures[] = {{"energy at the end", NULL, Energy},
               {"energy at the start", NULL, StartEnergy},
               {"SD of r, by area", "SD of r, by volume", WeightedDeviation},
               {"90 % of the area, r", "90 % of the volume, r", WeightedRange},
               {"SD of r, over cells", NULL, CellDeviation},
               {"off by more than 10 SD, of the area", "off by more than 10 SD, of the volume", Outliers},
               {"SD of r, over the other cells", NULL, DeviationWithout},
               {"r, all cells", NULL, CellRange},
               {"angle error, mean / median", NULL, AngleErrors},
               {"stretch, mean / median / most", NULL, Stretches},
               {"folds", NULL, Folds},
               {"worst cells", NULL, Worst},
               {"iterations", NULL, Iterations},
               {"seconds", NULL, Seconds},
               {"ranks × threads", NULL, Parallel}};

int EqmNumFigures(void)
{
  return (int)PETSC_STATIC_ARRAY_LENGTH(figures);
}

const char *EqmFigureName(const EqmResult *result, int figure)
{
  return result->cell_size == 4 && figures[figure].solid ? figures[figure].solid : figures[figure].surface;
}

void EqmFigureText(const EqmResult *result, int figure, char *text, size_t length)
{
  text[0] = '\0';
  figures[figure].tell(result, text, length);
}
#endif
