/* Keep one piece of a mesh. */
#include "prepare/step.h"
#include "mesh/soup_private.h"
#include "base/narrow.h"
#include "base/rows.h"
#include "base/sort.h"
#include "geometry/simplex.h"

/* Larger first, then the one with the lower vertex. */
static int ComparePieces(const void *a, const void *b)
{
  const EqmFoundPiece *const s = a, *const t = b;

  if (s->measure != t->measure) return s->measure > t->measure ? -1 : 1;
  return (s->label > t->label) - (s->label < t->label);
}

/* Area or volume of every piece, at its lowest vertex. */
static PetscErrorCode MeasurePieces(const EqmVicinity *vicinity, const PetscInt *label, PetscReal *measure)
{
  PetscReal *share, quality;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(vicinity->num_local, &share));
  PetscCall(PetscArrayzero(measure, vicinity->num_owned));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    const PetscInt owner = EqmVicinityCellOwnerVertex(vicinity, c);

    if (owner < vicinity->num_owned) share[owner] += PetscAbsReal(EqmCellMeasure(vicinity, c, &quality));
  }
  PetscCall(EqmRowsCreateSF(vicinity->comm, vicinity->num_owned, vicinity->num_owned, label, &sf));
  PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, share, measure, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, share, measure, MPIU_SUM));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscFree(share));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmListPieces(const EqmVicinity *vicinity, const PetscInt *label, PetscInt *num_pieces,
                             EqmFoundPiece **all)
{
  PetscInt count = 0;
  PetscReal *measure;
  EqmFoundPiece *mine;
  PetscMPIInt *counts, *starts;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(vicinity->num_owned, &measure, vicinity->num_owned, &mine));
  PetscCall(PetscMalloc2(vicinity->size, &counts, vicinity->size + 1, &starts));
  PetscCall(MeasurePieces(vicinity, label, measure));
  PetscCall(PetscMemzero(mine, (size_t)vicinity->num_owned * sizeof(*mine)));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    if (label[v] != vicinity->input[v] || vicinity->star_start[v] == vicinity->star_start[v + 1]) continue;
    mine[count].label = label[v];
    mine[count++].measure = measure[v];
  }
  PetscCall(
      EqmGatherCounts(vicinity->comm, count * (PetscInt64)sizeof(EqmFoundPiece), "bytes about pieces", counts, starts));
  *num_pieces = starts[vicinity->size] / (PetscInt)sizeof(EqmFoundPiece);
  PetscCall(PetscMalloc1(*num_pieces, all));
  PetscCallMPI(MPI_Allgatherv(mine, counts[vicinity->rank], MPI_BYTE, *all, counts, starts, MPI_BYTE, vicinity->comm));
  EqmSort(*all, (size_t)*num_pieces, sizeof(EqmFoundPiece), ComparePieces);
  PetscCall(PetscFree2(measure, mine));
  PetscCall(PetscFree2(counts, starts));
  PetscFunctionReturn(0);
}

/* The cells of the piece named after vertex `kept`. */
static PetscErrorCode KeepCells(const EqmVicinity *vicinity, const PetscInt *label, PetscInt kept, EqmCellList *list,
                                PetscInt64 *left_out)
{
  const PetscInt cs = vicinity->cell_size;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    PetscInt vertex[4];

    if (EqmVicinityCellOwnerVertex(vicinity, c) >= vicinity->num_owned) continue;
    if (label[vicinity->cells[cs * c]] != kept) {
      ++*left_out;
      continue;
    }
    for (PetscInt a = 0; a < cs; a++) vertex[a] = vicinity->input[vicinity->cells[cs * c + a]];
    PetscCall(EqmCellListAdd(list, vicinity->cell_input[c], vertex));
  }
  PetscFunctionReturn(0);
}

/* Keep the piece of the largest area or volume, or the K-th; `count` is how many pieces are left out. Cells that name a
   vertex twice or one that does not exist belong to no piece and are left out, too. */
PetscErrorCode EqmStepLargest(const EqmPrepareOptions *options, EqmChange *change, EqmPreparedStep *report)
{
  EqmVicinity vicinity;
  EqmCellList list = {.cell_size = change->soup->cell_size};
  PetscInt *label, num_pieces;
  PetscInt64 left_out = 0;
  PetscReal kept, total = 0.;
  EqmFoundPiece *pieces;

  PetscFunctionBegin;
  PetscCall(EqmVicinityCreate(change->soup, &vicinity));
  PetscCall(PetscMalloc1(vicinity.num_local, &label));
  PetscCall(EqmVicinityLabelComponents(&vicinity, label));
  PetscCall(EqmListPieces(&vicinity, label, &num_pieces, &pieces));
  if (options->piece > num_pieces && num_pieces) {
    EqmFail(vicinity.comm, EQM_ERR_USAGE, "-piece %" PetscInt_FMT ": there are only %" PetscInt_FMT " pieces",
            options->piece, num_pieces);
  }
  if (num_pieces > 1) {
    const EqmFoundPiece *const piece = &pieces[options->piece - 1];

    for (PetscInt k = 0; k < num_pieces; k++) total += pieces[k].measure;
    kept = piece->measure;
    PetscCall(KeepCells(&vicinity, label, piece->label, &list, &left_out));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &left_out, 1, MPIU_INT64, MPI_SUM, vicinity.comm));
    report->count = num_pieces - 1;
    PetscCall(PetscSNPrintf(report->what, sizeof(report->what),
                            "%" PetscInt_FMT " of %" PetscInt_FMT " pieces left out, with %" PetscInt64_FMT
                            " cells and %.2g%% of the %s",
                            num_pieces - 1, num_pieces, left_out, (double)(100. * (1. - kept / total)),
                            change->soup->cell_size == 3 ? "area" : "volume"));
    PetscCall(EqmChangeAssemble(change, NULL, &list));
  }
  PetscCall(PetscFree(pieces));
  PetscCall(PetscFree(label));
  PetscCall(EqmVicinityReset(&vicinity));
  PetscFunctionReturn(0);
}
