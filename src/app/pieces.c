/* Every piece of a mesh mapped on its own. */
#include "pieces.h"
#include "base/quiet.h"
#include "base/rows.h"
#include "mesh/soup_private.h"
#include "store/map_private.h"
#include <math.h>
#include <string.h>

static PetscInt CellsOf(EqmSoup soup)
{
  return soup->cell_end - soup->cell_start;
}

/* Take images and marks of the cells of a piece over into the whole. */
static PetscErrorCode Take(const EqmIntake *intake, EqmMap found, EqmPiece *piece, PetscInt *mark, EqmPieces *pieces)
{
  const EqmSoup given = intake->given;
  const PetscInt num_cells = CellsOf(given), dim = pieces->map->dim;
  PetscInt *fate, *corner, *number, num = 0;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(num_cells, &fate, 3 * num_cells, &corner, 3 * num_cells, &number));
  PetscCall(EqmIntakeMarkCells(intake, fate));
  piece->cells = 0;
  for (PetscInt c = 0; c < num_cells; c++) {
    if (fate[c] == EQM_CELL_LEFT_OUT) continue;
    mark[c] = fate[c];
    pieces->cell[c] = piece->number;
    piece->cells++;
    for (PetscInt a = 0; a < 3 && fate[c] != EQM_CELL_CUT; a++) { /* vertices of cut cells may be another piece's */
      corner[num] = given->cells[3 * c + a];
      number[num++] = piece->number;
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &piece->cells, 1, MPIU_INT64, MPI_SUM, given->comm));
  PetscCall(EqmRowsCreateSF(given->comm, given->vertex_end - given->vertex_start, num, corner, &sf));
  PetscCall(PetscSFReduceBegin(sf, MPIU_INT, number, pieces->vertex, MPI_MAX));
  PetscCall(PetscSFReduceEnd(sf, MPIU_INT, number, pieces->vertex, MPI_MAX));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscFree3(fate, corner, number));
  for (PetscInt v = 0; v < given->vertex_end - given->vertex_start; v++) {
    for (PetscInt k = 0; k < dim && pieces->vertex[v] == piece->number; k++)
      pieces->map->coordinates[dim * v + k] = found->coordinates[dim * v + k];
  }
  PetscFunctionReturn(0);
}

/* What the run has found, as figures of the piece. */
static void Note(EqmMap map, EqmPiece *piece)
{
  piece->status = map->status;
  piece->folds = map->distortion.folds;
  piece->measure = map->distortion.mesh_measure;
  piece->image = map->distortion.image_measure;
  piece->energy = map->energy_final;
  piece->sd = map->distortion.weighted_ratio.sd;
}

/* Map one prepared piece. */
static PetscErrorCode SolvePiece(const char *command, const EqmIntakeOptions *options, const EqmIntake *intake,
                                 const EqmStopFile *stop_file, EqmLedger ledger, EqmPiece *piece, PetscInt *mark,
                                 EqmPieces *pieces)
{
  EqmMapRun run;
  EqmIntake whole;

  PetscFunctionBegin;
  PetscCall(EqmMapRunSolve(command, intake, stop_file, ledger, &run));
  PetscCall(EqmMapRunWithoutSplits(command, options, intake, stop_file, ledger, &run, &whole));
  if (!pieces->map) {
    PetscCall(EqmMapCreate(intake->given, run.map->dim, &pieces->map));
    PetscCall(EqmMapSetCommand(pieces->map, run.map->command));
    PetscCall(PetscStrncpy(pieces->map->method, run.map->method, sizeof(pieces->map->method)));
    PetscCall(PetscStrncpy(pieces->map->linear_solver, run.map->linear_solver, sizeof(pieces->map->linear_solver)));
  }
  if (run.map->dim == pieces->map->dim) {
    Note(run.map, piece);
    PetscCall(Take(intake, run.map, piece, mark, pieces));
  } else {
    PetscCall(PetscStrncpy(piece->message, "its image has another dimension than that of the first piece",
                           sizeof(piece->message)));
  }
  PetscCall(EqmMapRunDestroy(&run));
  PetscCall(EqmPreparationReset(&whole.preparation));
  PetscFunctionReturn(0);
}

/* Prepare a piece and map it, or keep the reason why not; `num_pieces` of the whole mesh. */
static PetscErrorCode TryPiece(const char *command, const EqmIntakeOptions *options, const EqmIntake *input,
                               const EqmStopFile *stop_file, EqmLedger ledger, EqmPiece *piece, PetscInt *num_pieces,
                               PetscInt *mark, EqmPieces *pieces)
{
  EqmIntakeOptions one = *options;
  PetscErrorCode error = 0;
  EqmIntake intake;
  PetscBool can;

  PetscFunctionBegin;
  piece->status = EQM_STATUS_MESH;
  one.prepare.piece = piece->number;
  PetscCall(EqmIntakePiece(&one, input, &intake, num_pieces, &can, piece->message, sizeof(piece->message)));
  if (can) {
    piece->message[0] = '\0';
    PetscCall(PetscPushErrorHandler(EqmKeepMessage, piece->message));
    error = SolvePiece(command, &one, &intake, stop_file, ledger, piece, mark, pieces);
    PetscCall(PetscPopErrorHandler());
    if (error && error != EQM_ERR_MESH) PetscCall(EqmAgree(input->given->comm, error, piece->message));
  }
  if (piece->message[0])
    PetscCall(
        PetscPrintf(input->given->comm, "piece %" PetscInt_FMT ": not mapped: %s\n", piece->number, piece->message));
  else
    PetscCall(PetscPrintf(input->given->comm,
                          "piece %" PetscInt_FMT ": %" PetscInt64_FMT
                          " cells, %s, energy %.3e, sd %.3e, %" PetscInt64_FMT " folds\n",
                          piece->number, piece->cells, EqmStatusName(piece->status), (double)piece->energy,
                          (double)piece->sd, piece->folds));
  PetscCall(EqmPreparationReset(&intake.preparation));
  PetscFunctionReturn(0);
}

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
  const PetscInt count = CellsOf(given), n = pieces->num_pieces;
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

/* With -prepare auto seams are welded, unless the largest piece is refused then and taken without: where parts of a
   model touch, welding may join them to what nothing takes. The same for all pieces, as it decides what they are. */
static PetscErrorCode ChooseWelding(const EqmIntake *input, EqmIntakeOptions *options)
{
  char reason[EQM_MESSAGE_MAX];
  PetscInt num_pieces;
  PetscBool can;

  PetscFunctionBegin;
  options->prepare.piece = 1;
  for (int k = 0; k < 2; k++) {
    EqmIntake piece;

    options->prepare.without_weld = (PetscBool)(k == 1);
    PetscCall(EqmIntakePiece(options, input, &piece, &num_pieces, &can, reason, sizeof(reason)));
    PetscCall(EqmPreparationReset(&piece.preparation));
    if (can || strcmp(options->prepare.steps, "auto")) PetscFunctionReturn(0);
  }
  options->prepare.without_weld = PETSC_FALSE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPiecesSolve(const char *command, const EqmIntakeOptions *options, const EqmIntake *input,
                              const EqmStopFile *stop_file, EqmLedger ledger, EqmPieces *pieces)
{
  const EqmSoup given = input->given;
  EqmIntakeOptions chosen = *options;
  PetscInt *mark, most = 1;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(pieces, sizeof(*pieces)));
  PetscCall(ChooseWelding(input, &chosen));
  PetscCall(PetscCalloc1(CellsOf(given) + 1, &mark));
  PetscCall(PetscCalloc2(given->vertex_end - given->vertex_start, &pieces->vertex, CellsOf(given), &pieces->cell));
  for (PetscInt p = 0; p < most; p++) {
    PetscCall(PetscRealloc((size_t)most * sizeof(EqmPiece), &pieces->piece));
    pieces->piece[p] = (EqmPiece){.number = p + 1};
    PetscCall(TryPiece(command, &chosen, input, stop_file, ledger, &pieces->piece[p], &most, mark, pieces));
    pieces->num_mapped += !pieces->piece[p].message[0];
    pieces->num_pieces++;
  }
  if (!pieces->num_mapped)
    EqmFail(given->comm, EQM_ERR_MESH,
            "%s: none of its %" PetscInt_FMT " pieces can be mapped to the %s; the largest: %s", given->file,
            pieces->num_pieces, command, pieces->piece[0].message);
  PetscCall(MeasureAll(given, ledger, mark, pieces));
  PetscCall(SetEnergy(command, pieces));
  PetscCall(Judge(pieces));
  PetscCall(AddArrays(given, input->unit, mark, pieces));
  PetscCall(PetscFree(mark));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPiecesDestroy(EqmPieces *pieces)
{
  PetscFunctionBegin;
  PetscCall(EqmMapDestroy(&pieces->map));
  PetscCall(PetscFree(pieces->piece));
  PetscCall(PetscFree2(pieces->vertex, pieces->cell));
  PetscFunctionReturn(0);
}
