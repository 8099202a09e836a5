/* Points as CSV and NPY. */
#include "fuzz.h"
#include <equimap/base.h>
#include "format/points.h"

void EqmFuzzPoints(const char *name, const uint8_t *bytes, size_t length)
{
  EqmPoints points;
  char error[512] = "";
  PetscErrorCode code;
  volatile PetscReal last = 0.0;

  (void)EqmPointsRecognise("points.xyz", (const char *)bytes, length);
  code = EqmPointsParse((const char *)bytes, length, &points, error, sizeof(error));
  if (code) {
    CLAIM((code == EQM_ERR_IO && error[0]) || code == PETSC_ERR_MEM);
    return;
  }
  CLAIM(points.dim == 2 || points.dim == 3);
  if (points.num) last = points.values[(size_t)points.dim * (size_t)points.num - 1];
  (void)last;
  CLAIM(!PetscFree(points.values));
}
