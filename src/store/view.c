/* What a map is worth, in words. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include <string.h>

/* What cells that are far off, which hold next to nothing of the measure, add to the unweighted figures. */
static PetscErrorCode ViewOutliers(EqmMap map)
{
  const EqmWeightedRatio *const w = &map->distortion.weighted_ratio;

  PetscFunctionBegin;
  if (w->outliers == 0) PetscFunctionReturn(0);
  PetscCall(PetscPrintf(map->soup->comm,
                        "  outliers      %" PetscInt64_FMT
                        " cells that hold %.1e of the %s are off by more than 10 sd; "
                        "without them sd %.3e over cells\n",
                        w->outliers, (double)w->outlier_share, map->soup->cell_size == 4 ? "volume" : "area",
                        (double)w->cell_sd_without));
  PetscFunctionReturn(0);
}

/* The stretch energy and what it cannot fall below (002 Corollary 3.4, for a mesh scaled to the image's measure). */
static PetscErrorCode ViewStretch(EqmMap map)
{
  const EqmDistortion *const d = &map->distortion;

  PetscFunctionBegin;
  if (!strcmp(map->command, "conformal")) PetscFunctionReturn(0); /* its energy is another */
  PetscCall(PetscPrintf(map->soup->comm, "  stretch       energy %.9g, at least the image's %s %.9g\n",
                        (double)(d->energy + d->image_measure), map->soup->cell_size == 4 ? "volume" : "area",
                        (double)d->image_measure));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapViewRatios(EqmMap map)
{
  const EqmDistortion *const d = &map->distortion;
  const char *const measure = map->soup->cell_size == 4 ? "volume" : "area";
  char name[32];

  PetscFunctionBegin;
  PetscCall(ViewStretch(map));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s ratio", measure));
  PetscCall(PetscPrintf(map->soup->comm, "  %-12s  sd %.3e by %s   90 %% of it from 1%+.1e to 1%+.1e\n", name,
                        (double)d->weighted_ratio.sd, measure, (double)(d->weighted_ratio.p05 - 1.),
                        (double)(d->weighted_ratio.p95 - 1.)));
  PetscCall(PetscPrintf(map->soup->comm, "  %-12s  sd %.3e over cells   min %.4g   median %.6g   max %.4g\n", "",
                        (double)d->ratio.sd, (double)d->ratio.min, (double)d->ratio.p50, (double)d->ratio.max));
  PetscCall(ViewOutliers(map));
  PetscFunctionReturn(0);
}
