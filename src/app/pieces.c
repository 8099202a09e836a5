/* Every piece of a mesh mapped on its own. */
#include "pieces.h"
#include "base/quiet.h"
#include "base/rows.h"
#include "mesh/soup_private.h"
#include "store/map_private.h"
#include <string.h>

static PetscInt CellsOf(EqmSoup soup)
{
  return soup->cell_end - soup->cell_start;
}

/* What becomes of the whole while its pieces are mapped. */
typedef struct {
  const EqmComponents *components;
  PetscInt *mark;   /* fate of the cells of the file, per cell of the slab */
  PetscInt *vertex; /* per vertex of the slab of the prepared mesh: number of the piece that has it, 0: none */
  PetscReal *image; /* its image, of pieces->map->dim coordinates */
} Whole;

/* The vertices of a piece whose images are those of the file's: of cells that are cut apart they may be another
   piece's. */
static PetscErrorCode MarkVertices(EqmSoup given, const PetscInt *fate, PetscInt *marked)
{
  PetscInt *corner, *one, num = 0;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * CellsOf(given), &corner, 3 * CellsOf(given), &one));
  for (PetscInt k = 0; k < 3 * CellsOf(given); k++) {
    if (fate[k / 3] == EQM_CELL_LEFT_OUT || fate[k / 3] == EQM_CELL_CUT) continue;
    corner[num] = given->cells[k];
    one[num++] = 1;
  }
  PetscCall(EqmRowsCreateSF(given->comm, given->vertex_end - given->vertex_start, num, corner, &sf));
  PetscCall(PetscSFReduceBegin(sf, MPIU_INT, one, marked, MPI_MAX));
  PetscCall(PetscSFReduceEnd(sf, MPIU_INT, one, marked, MPI_MAX));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscFree2(corner, one));
  PetscFunctionReturn(0);
}

/* Take images and marks of the cells of a piece over into the whole. */
static PetscErrorCode Take(const EqmIntake *intake, EqmMap found, EqmPiece *piece, Whole *whole, EqmPieces *pieces)
{
  const EqmSoup given = intake->given;
  const EqmComponents *const all = whole->components;
  const PetscInt *const cell = all->given_cell.row + all->given_cell.start[intake->piece];
  const PetscInt *const vertex = all->vertex.row + all->vertex.start[intake->piece];
  const PetscInt num_vertices = given->vertex_end - given->vertex_start, dim = pieces->map->dim;
  PetscInt *fate, *marked;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(CellsOf(given), &fate));
  PetscCall(PetscCalloc1(num_vertices, &marked));
  PetscCall(EqmIntakeMarkCells(intake, fate));
  PetscCall(MarkVertices(given, fate, marked));
  piece->cells = 0;
  for (PetscInt c = 0; c < CellsOf(given); c++) {
    if (fate[c] == EQM_CELL_LEFT_OUT) continue;
    whole->mark[cell[c]] = fate[c];
    pieces->cell[cell[c]] = piece->number;
    piece->cells++;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &piece->cells, 1, MPIU_INT64, MPI_SUM, given->comm));
  for (PetscInt v = 0; v < num_vertices; v++) {
    if (!marked[v]) continue;
    whole->vertex[vertex[v]] = piece->number;
    PetscCall(PetscArraycpy(whole->image + dim * vertex[v], found->coordinates + dim * v, dim));
  }
  PetscCall(PetscFree(fate));
  PetscCall(PetscFree(marked));
  PetscFunctionReturn(0);
}

/* The images of all pieces at the vertices of the file, whose numbers are the first ones of the prepared mesh. */
static PetscErrorCode Gather(const Whole *whole, EqmPieces *pieces)
{
  const EqmSoup given = whole->components->given, soup = whole->components->whole.soup;
  const PetscInt num = given->vertex_end - given->vertex_start, num_prepared = soup->vertex_end - soup->vertex_start;

  PetscFunctionBegin;
  PetscCall(
      EqmFetchSlab(given->comm, num_prepared, num, given->vertex_start, MPIU_INT, 1, whole->vertex, pieces->vertex));
  PetscCall(EqmFetchSlab(given->comm, num_prepared, num, given->vertex_start, MPIU_REAL, pieces->map->dim, whole->image,
                         pieces->map->coordinates));
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
                                 const EqmStopFile *stop_file, EqmLedger ledger, EqmPiece *piece, Whole *whole,
                                 EqmPieces *pieces)
{
  const EqmSoup prepared = whole->components->whole.soup;
  EqmMapRun run;
  EqmIntake unsplit;

  PetscFunctionBegin;
  PetscCall(EqmMapRunSolve(command, intake, stop_file, ledger, &run));
  PetscCall(EqmMapRunWithoutSplits(command, options, intake, stop_file, ledger, &run, &unsplit));
  if (!pieces->map) {
    PetscCall(EqmMapCreate(whole->components->given, run.map->dim, &pieces->map));
    PetscCall(EqmMapSetCommand(pieces->map, run.map->command));
    PetscCall(PetscStrncpy(pieces->map->method, run.map->method, sizeof(pieces->map->method)));
    PetscCall(PetscStrncpy(pieces->map->linear_solver, run.map->linear_solver, sizeof(pieces->map->linear_solver)));
    PetscCall(PetscCalloc1(run.map->dim * (prepared->vertex_end - prepared->vertex_start), &whole->image));
  }
  if (run.map->dim == pieces->map->dim) {
    Note(run.map, piece);
    PetscCall(Take(intake, run.map, piece, whole, pieces));
  } else {
    PetscCall(PetscStrncpy(piece->message, "its image has another dimension than that of the first piece",
                           sizeof(piece->message)));
  }
  PetscCall(EqmMapRunDestroy(&run));
  PetscCall(EqmPreparationReset(&unsplit.preparation));
  PetscFunctionReturn(0);
}

/* Prepare a piece and map it, or keep the reason why not. */
static PetscErrorCode TryPiece(const char *command, const EqmIntakeOptions *options, const EqmStopFile *stop_file,
                               EqmLedger ledger, EqmPiece *piece, Whole *whole, EqmPieces *pieces)
{
  MPI_Comm comm = whole->components->given->comm;
  PetscErrorCode error = 0;
  EqmIntake intake;
  PetscBool can;

  PetscFunctionBegin;
  piece->status = EQM_STATUS_MESH;
  PetscCall(EqmIntakePiece(options, whole->components, piece->number - 1, &intake, &can, piece->message,
                           sizeof(piece->message)));
  if (can) {
    piece->message[0] = '\0';
    PetscCall(PetscPushErrorHandler(EqmKeepMessage, piece->message));
    error = SolvePiece(command, options, &intake, stop_file, ledger, piece, whole, pieces);
    PetscCall(PetscPopErrorHandler());
    if (error && error != EQM_ERR_MESH) PetscCall(EqmAgree(comm, error, piece->message));
  }
  if (piece->message[0])
    PetscCall(PetscPrintf(comm, "piece %" PetscInt_FMT ": not mapped: %s\n", piece->number, piece->message));
  else
    PetscCall(PetscPrintf(comm,
                          "piece %" PetscInt_FMT ": %" PetscInt64_FMT
                          " cells, %s, energy %.3e, sd %.3e, %" PetscInt64_FMT " folds\n",
                          piece->number, piece->cells, EqmStatusName(piece->status), (double)piece->energy,
                          (double)piece->sd, piece->folds));
  PetscCall(EqmIntakeDestroy(&intake));
  PetscFunctionReturn(0);
}

/* The mesh cut into its pieces. With -prepare auto seams are welded, unless the largest piece is refused then and taken
   without: where parts of a model touch, welding may join them to what nothing takes. The same for all pieces, as it
   decides what they are. */
static PetscErrorCode Cut(const EqmIntake *input, const EqmIntakeOptions *options, EqmComponents *components)
{
  EqmIntakeOptions chosen = *options;
  char reason[EQM_MESSAGE_MAX];
  EqmIntake piece;
  PetscBool can;

  PetscFunctionBegin;
  for (int k = 0; k < 2; k++) {
    chosen.prepare.without_weld = (PetscBool)(k == 1);
    PetscCall(EqmIntakeCut(&chosen, input, components));
    PetscCall(EqmIntakePiece(&chosen, components, 0, &piece, &can, reason, sizeof(reason)));
    PetscCall(EqmIntakeDestroy(&piece));
    if (can || strcmp(options->prepare.steps, "auto")) PetscFunctionReturn(0);
    PetscCall(EqmComponentsReset(components));
  }
  PetscCall(EqmIntakeCut(options, input, components));
  PetscFunctionReturn(0);
}

/* All pieces one after the other, each as far as it goes. */
static PetscErrorCode TryAll(const char *command, const EqmIntakeOptions *options, const EqmStopFile *stop_file,
                             EqmLedger ledger, Whole *whole, EqmPieces *pieces)
{
  const EqmSoup given = whole->components->given, prepared = whole->components->whole.soup;

  PetscFunctionBegin;
  pieces->num_pieces = whole->components->num_pieces;
  PetscCall(PetscCalloc1(pieces->num_pieces, &pieces->piece));
  PetscCall(PetscCalloc2(CellsOf(given), &whole->mark, prepared->vertex_end - prepared->vertex_start, &whole->vertex));
  PetscCall(PetscCalloc2(given->vertex_end - given->vertex_start, &pieces->vertex, CellsOf(given), &pieces->cell));
  for (PetscInt p = 0; p < pieces->num_pieces; p++) {
    pieces->piece[p].number = p + 1;
    PetscCall(TryPiece(command, options, stop_file, ledger, &pieces->piece[p], whole, pieces));
    pieces->num_mapped += !pieces->piece[p].message[0];
  }
  if (!pieces->num_mapped)
    EqmFail(given->comm, EQM_ERR_MESH,
            "%s: none of its %" PetscInt_FMT " pieces can be mapped to the %s; the largest: %s", given->file,
            pieces->num_pieces, command, pieces->piece[0].message);
  PetscCall(Gather(whole, pieces));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPiecesSolve(const char *command, const EqmIntakeOptions *options, const EqmIntake *input,
                              const EqmStopFile *stop_file, EqmLedger ledger, EqmPieces *pieces)
{
  EqmComponents components;
  Whole whole = {.components = &components};

  PetscFunctionBegin;
  PetscCall(PetscMemzero(pieces, sizeof(*pieces)));
  PetscCall(Cut(input, options, &components));
  PetscCall(TryAll(command, options, stop_file, ledger, &whole, pieces));
  PetscCall(EqmComponentsReset(&components));
  PetscCall(EqmPiecesMeasure(command, input, ledger, whole.mark, pieces));
  PetscCall(PetscFree2(whole.mark, whole.vertex));
  PetscCall(PetscFree(whole.image));
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
