/* What a page shows of its results. */
#include "picture/picture.h"

const PetscReal *EqmPageValues(const EqmPage *page, const EqmResult *result)
{
  return page->conformal ? result->quasi_conformal : result->ratio;
}

/* One kind of curve for all results, so that they can be compared. */
static EqmCurve ChooseCurve(const EqmPage *page)
{
  if (page->options.curve != EQM_CURVE_AUTO) return (EqmCurve)page->options.curve;
  if (!page->conformal) return EQM_CURVE_ENERGY;
  for (PetscInt k = 0; k < page->num; k++)
    if (!EqmResultHasGradient(&page->results[k])) return EQM_CURVE_EXCESS;
  return EQM_CURVE_GRADIENT;
}

static void WidenScale(EqmPage *page, const EqmResult *result)
{
  page->scale =
      EqmColorScaleJoin(page->scale, EqmColorScaleOf(page->scale.kind, EqmPageValues(page, result), result->num_cells));
}

EqmPage EqmPageOf(PetscInt num_results, const EqmResult *results, const EqmResult *start,
                  const EqmReportOptions *options)
{
  EqmPage page = {.num = num_results, .results = results, .conformal = PETSC_TRUE, .start = start, .options = *options};

  for (PetscInt k = 0; k < num_results; k++)
    page.conformal = (PetscBool)(page.conformal && EqmResultIsConformal(&results[k]));
  if (start && !start->quasi_conformal) page.conformal = PETSC_FALSE;
  page.curve = ChooseCurve(&page);
  page.scale = (EqmColorScale){page.conformal ? EQM_SCALE_STRETCH : EQM_SCALE_RATIO, 1.};
  page.distances = (EqmColorScale){EQM_SCALE_DISTANCE, 0.};
  if (start) WidenScale(&page, start);
  for (PetscInt k = 0; k < num_results; k++) {
    const EqmResult *const r = &results[k];
    WidenScale(&page, r);
    if (r->distance)
      page.distances =
          EqmColorScaleJoin(page.distances, EqmColorScaleOf(EQM_SCALE_DISTANCE, r->distance, r->num_vertices));
  }
  return page;
}
