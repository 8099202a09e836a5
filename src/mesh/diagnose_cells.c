/* Cells one by one: existing, distinct and flat vertices, twins, size and quality, tetrahedra turned inside out. */
#include "mesh/diagnose.h"
#include "mesh/soup_private.h"
#include "geometry/simplex.h"

/* Area of a triangle, or volume of a tetrahedron, negative if it is turned inside out. `quality` is 0 for a flat cell
   and 1 for an equilateral one: 4 sqrt(3) area / (sum of squared edges), or 12 (3 volume)^(2/3) / (sum of squared
   edges). Not collective. */
PetscReal EqmCellMeasure(const EqmVicinity *vicinity, PetscInt cell, PetscReal *quality)
{
  const PetscInt cs = vicinity->cell_size, *const vertex = vicinity->cells + cs * cell;
  PetscReal side[3][3], normal[3], measure, squares = 0.0;

  for (PetscInt a = 1; a < cs; a++) {
    for (int k = 0; k < 3; k++) {
      side[a - 1][k] = vicinity->position[3 * vertex[a] + k] - vicinity->position[3 * vertex[0] + k];
    }
    squares += EqmDot3(side[a - 1], side[a - 1]);
    for (PetscInt b = 1; b < a; b++) {
      const PetscReal across[3] = {side[a - 1][0] - side[b - 1][0], side[a - 1][1] - side[b - 1][1],
                                   side[a - 1][2] - side[b - 1][2]};

      squares += EqmDot3(across, across);
    }
  }
  EqmCross(side[0], side[1], normal);
  if (cs == 3) {
    measure = 0.5 * PetscSqrtReal(EqmDot3(normal, normal));
    *quality = squares > 0.0 ? 4.0 * PetscSqrtReal(3.0) * measure / squares : 0.0;
  } else {
    const PetscReal root = PetscPowReal(PetscAbsReal(measure = EqmDot3(normal, side[2]) / 6.0) * 3.0, 1.0 / 3.0);

    *quality = squares > 0.0 ? 12.0 * root * root / squares : 0.0;
  }
  return measure;
}

/* Vertices in use whose coordinates are not finite. Programs that mask points leave NaN in vertices that no cell uses:
   these do no harm. */
static void FindNotFinite(const EqmVicinity *vicinity, EqmFinding *finding)
{
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    const PetscReal *const x = vicinity->position + 3 * v;

    if (vicinity->star_start[v] == vicinity->star_start[v + 1]) continue;
    if (PetscIsInfOrNanReal(x[0]) || PetscIsInfOrNanReal(x[1]) || PetscIsInfOrNanReal(x[2]))
      EqmFindingAdd(finding, vicinity->input[v], -1, -1, -1);
  }
}

/* Cells of this slab that cannot be used. */
static void DiagnoseSlab(EqmSoup soup, EqmDiagnosis *diagnosis)
{
  for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) {
    const EqmCellUse use = EqmSoupCellUse(soup, soup->cells + soup->cell_size * (c - soup->cell_start));

    if (use == EQM_CELL_BAD_INDEX) EqmFindingAdd(&diagnosis->finding[EQM_FINDING_BAD_INDEX], c, -1, -1, -1);
    if (use == EQM_CELL_REPEATED_VERTEX) {
      EqmFindingAdd(&diagnosis->finding[EQM_FINDING_DEGENERATE_CELL], c, -1, -1, -1);
    }
  }
}

/* Tetrahedra whose volume has the sign `sign`. */
static void FindInverted(const EqmVicinity *vicinity, int sign, EqmFinding *finding)
{
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    if (EqmVicinityCellOwnerVertex(vicinity, c) >= vicinity->num_owned) continue;
    if (vicinity->side[c] == sign) EqmFindingAdd(finding, vicinity->cell_input[c], -1, -1, -1);
  }
}

static PetscErrorCode ReduceMeasures(MPI_Comm comm, EqmDiagnosis *diagnosis)
{
  PetscReal least[3] = {diagnosis->smallest_cell, -diagnosis->largest_cell, diagnosis->worst_cell_quality};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &diagnosis->measure, 1, MPIU_REAL, MPIU_SUM, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, least, 3, MPIU_REAL, MPIU_MIN, comm));
  diagnosis->smallest_cell = least[0] < PETSC_MAX_REAL ? least[0] : 0.0;
  diagnosis->largest_cell = -least[1];
  diagnosis->worst_cell_quality = least[2] <= 1.0 ? least[2] : 0.0;
  PetscFunctionReturn(0);
}

/* Fill in what single vertices and cells tell: not finite, bad index, degenerate, inside out (the minority of
   tetrahedra), and the measures. The findings are this rank's, not yet merged. Collective. */
PetscErrorCode EqmDiagnoseCells(EqmSoup soup, const EqmVicinity *vicinity, EqmDiagnosis *diagnosis)
{
  const PetscReal flat = vicinity->cell_size == 3 ? EQM_FLAT_TRIANGLE : EQM_FLAT_TETRAHEDRON;
  PetscInt64 signs[2] = {0, 0};

  PetscFunctionBegin;
  FindNotFinite(vicinity, &diagnosis->finding[EQM_FINDING_NOT_FINITE]);
  DiagnoseSlab(soup, diagnosis);
  diagnosis->measure = diagnosis->largest_cell = 0.0;
  diagnosis->smallest_cell = PETSC_MAX_REAL;
  diagnosis->worst_cell_quality = 2.0;
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    PetscReal quality, measure;

    if (EqmVicinityCellOwnerVertex(vicinity, c) >= vicinity->num_owned) continue;
    measure = EqmCellMeasure(vicinity, c, &quality);
    if (PetscIsInfOrNanReal(measure) || PetscIsInfOrNanReal(quality)) continue;
    if (quality <= flat) {
      EqmFindingAdd(&diagnosis->finding[EQM_FINDING_DEGENERATE_CELL], vicinity->cell_input[c], -1, -1, -1);
    }
    if (measure != 0.0) signs[measure < 0.0]++;
    measure = PetscAbsReal(measure);
    diagnosis->measure += measure;
    diagnosis->smallest_cell = PetscMin(diagnosis->smallest_cell, measure);
    diagnosis->largest_cell = PetscMax(diagnosis->largest_cell, measure);
    diagnosis->worst_cell_quality = PetscMin(diagnosis->worst_cell_quality, PetscMin(quality, 1.0));
  }
  PetscCall(ReduceMeasures(vicinity->comm, diagnosis));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, signs, 2, MPIU_INT64, MPI_SUM, vicinity->comm));
  if (signs[0] && signs[1]) {
    FindInverted(vicinity, signs[0] >= signs[1] ? -1 : 1, &diagnosis->finding[EQM_FINDING_INCONSISTENT_ORIENTATION]);
  }
  PetscFunctionReturn(0);
}
