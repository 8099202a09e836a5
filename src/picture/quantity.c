/* What a page shows of its results. */
#include "picture/picture.h"

const PetscReal *EqmPageValues(const EqmPage *page, const EqmResult *result)
{
  return page->conformal ? result->quasi_conformal : result->ratio;
}

EqmPage EqmPageOf(PetscInt num_results, const EqmResult *results, const EqmReportOptions *options)
{
  EqmPage page = {.num = num_results, .results = results, .conformal = PETSC_TRUE, .options = *options};

  for (PetscInt k = 0; k < num_results; k++)
    page.conformal = (PetscBool)(page.conformal && EqmResultIsConformal(&results[k]));
  page.scale = (EqmColorScale){page.conformal ? EQM_SCALE_STRETCH : EQM_SCALE_RATIO, 1.};
  page.distances = (EqmColorScale){EQM_SCALE_DISTANCE, 0.};
  for (PetscInt k = 0; k < num_results; k++) {
    const EqmResult *const r = &results[k];
    page.scale = EqmColorScaleJoin(page.scale, EqmColorScaleOf(page.scale.kind, EqmPageValues(&page, r), r->num_cells));
    if (r->distance)
      page.distances =
          EqmColorScaleJoin(page.distances, EqmColorScaleOf(EQM_SCALE_DISTANCE, r->distance, r->num_vertices));
  }
  return page;
}
