/* Figures of a mesh whose pieces have been mapped one by one. */
#include "pieces.h"
#include "mesh/soup_private.h"
#include "store/map_private.h"
#include <math.h>
#include <string.h>

/* Images scaled such that their areas are in proportion to those of the pieces: then ratios of the whole are those of
   the pieces. The mean of the images' areas, weighted by the pieces', stays what it is. */
static PetscErrorCode MeasureAll(EqmSoup given, EqmLedger ledger, const PetscInt *mark, EqmPieces *pieces)
{
  const PetscInt dim = pieces->map->dim, num = given->vertex_end - given->vertex_start;
  PetscReal *scaled, *scale, whole = 0., mean = 0.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(dim * num, &scaled, pieces->num_pieces + 1, &scale));
  for (PetscInt p = 0; p < pieces->num_pieces; p++) {
    whole += pieces->piece[p].measure;
    mean += pieces->piece[p].measure * pieces->piece[p].image;
  }
  scale[0] = 0.;
  for (PetscInt p = 0; p < pieces->num_pieces; p++) {
    const EqmPiece *const piece = &pieces->piece[p];
    scale[p + 1] = piece->image > 0. ? PetscSqrtReal(piece->measure * mean / (whole * whole * piece->image)) : 0.;
  }
  for (PetscInt k = 0; k < dim * num; k++) scaled[k] = scale[pieces->vertex[k / dim]] * pieces->map->coordinates[k];
  PetscCall(EqmIntakeMeasureCells(given, ledger, mark, scaled, pieces->map));
  PetscCall(PetscFree2(scaled, scale));
  PetscFunctionReturn(0);
}

/* The worst end of a piece is that of the whole. */
static PetscErrorCode Judge(EqmPieces *pieces)
{
  const EqmStatus order[] = {EQM_STATUS_CONVERGED, EQM_STATUS_NOT_CONVERGED, EQM_STATUS_FOLDS, EQM_STATUS_STOPPED};
  PetscInt worst = 0;
  char message[EQM_MESSAGE_MAX];

  PetscFunctionBegin;
  for (PetscInt p = 0; p < pieces->num_pieces; p++) {
    for (PetscInt k = worst; k < 4; k++) {
      if (!pieces->piece[p].message[0] && pieces->piece[p].status == order[k]) worst = k;
    }
  }
  PetscCall(PetscSNPrintf(message, sizeof(message),
                          "%" PetscInt_FMT " of %" PetscInt_FMT " pieces mapped; the worst: %s", pieces->num_mapped,
                          pieces->num_pieces, EqmStatusName(order[worst])));
  PetscCall(EqmMapSetStatus(pieces->map, order[worst], message));
  PetscFunctionReturn(0);
}

/* Figures of the pieces, a row each on rank 0, and the piece of every cell; areas in the unit of the file, 2^-unit of
   the mesh's. */
static PetscErrorCode AddArrays(EqmSoup given, PetscInt unit, const PetscInt *mark, EqmPieces *pieces)
{
  const PetscInt count = given->cell_end - given->cell_start, n = pieces->num_pieces;
  PetscInt64 *number, *mapped, *cells, *folds, *code;
  PetscReal *measure, *energy;
  PetscMPIInt rank;
  PetscInt mine;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(given->comm, &rank));
  mine = rank == 0 ? n : 0;
  PetscCall(PetscMalloc1(count + 1, &number));
  PetscCall(PetscMalloc1(count + 1, &mapped));
  for (PetscInt c = 0; c < count; c++) {
    number[c] = pieces->cell[c];
    mapped[c] = mark[c] == EQM_CELL_LEFT_OUT ? 0 : mark[c] == EQM_CELL_CUT ? 2 : 1;
  }
  PetscCall(EqmMapAddIntegers(pieces->map, "/cell/piece", given->num_cells, given->cell_start, count, 0, number));
  PetscCall(EqmMapAddIntegers(pieces->map, "/cell/mapped", given->num_cells, given->cell_start, count, 0, mapped));
  PetscCall(PetscMalloc1(n, &cells));
  PetscCall(PetscMalloc1(n, &folds));
  PetscCall(PetscMalloc1(n, &code));
  PetscCall(PetscMalloc1(n, &measure));
  PetscCall(PetscMalloc1(n, &energy));
  for (PetscInt p = 0; p < n; p++) {
    cells[p] = pieces->piece[p].cells;
    folds[p] = pieces->piece[p].folds;
    code[p] = pieces->piece[p].status;
    measure[p] = ldexp(pieces->piece[p].measure, 2 * (int)unit);
    energy[p] = pieces->piece[p].energy;
  }
  PetscCall(EqmMapAddIntegers(pieces->map, "/piece/cells", n, rank == 0 ? 0 : n, mine, 0, cells));
  PetscCall(EqmMapAddIntegers(pieces->map, "/piece/folds", n, rank == 0 ? 0 : n, mine, 0, folds));
  PetscCall(EqmMapAddIntegers(pieces->map, "/piece/exit_code", n, rank == 0 ? 0 : n, mine, 0, code));
  PetscCall(EqmMapAddReals(pieces->map, "/piece/measure", n, rank == 0 ? 0 : n, mine, 0, measure));
  PetscCall(EqmMapAddReals(pieces->map, "/piece/energy", n, rank == 0 ? 0 : n, mine, 0, energy));
  PetscCall(EqmMapAddCount(pieces->map, "pieces.all", n));
  PetscCall(EqmMapAddCount(pieces->map, "pieces.mapped", pieces->num_mapped));
  PetscFunctionReturn(0);
}

/* Energies of the whole: of angles the sum, of areas the mean, which the measured one is. */
static PetscErrorCode SetEnergy(const char *command, EqmPieces *pieces)
{
  PetscReal sum = 0.;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < pieces->num_pieces; p++) sum += pieces->piece[p].energy;
  if (strcmp(command, "conformal")) sum = pieces->map->distortion.energy;
  PetscCall(EqmMapSetEnergies(pieces->map, sum, sum));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPiecesMeasure(const char *command, const EqmIntake *input, EqmLedger ledger, const PetscInt *mark,
                                EqmPieces *pieces)
{
  PetscFunctionBegin;
  PetscCall(MeasureAll(input->given, ledger, mark, pieces));
  PetscCall(SetEnergy(command, pieces));
  PetscCall(Judge(pieces));
  PetscCall(AddArrays(input->given, input->unit, mark, pieces));
  PetscFunctionReturn(0);
}
