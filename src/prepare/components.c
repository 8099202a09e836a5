/* The pieces of a mesh as meshes of their own. */
#include "prepare/components_private.h"
#include "prepare/step.h"
#include "base/rows.h"
#include "mesh/soup_private.h"

static PetscInt CellsOf(EqmSoup soup)
{
  return soup->cell_end - soup->cell_start;
}

static PetscInt VerticesOf(EqmSoup soup)
{
  return soup->vertex_end - soup->vertex_start;
}

/* The piece of every vertex of the prepared mesh, -1 for those of no cell; at least one piece. */
static PetscErrorCode LabelVertices(EqmComponents *components, PetscInt *piece)
{
  EqmVicinity vicinity;
  EqmFoundPiece *found;
  PetscInt *label, *lowest, *number;

  PetscFunctionBegin;
  PetscCall(EqmVicinityCreate(components->whole.soup, &vicinity));
  PetscCall(PetscMalloc1(vicinity.num_local, &label));
  PetscCall(EqmVicinityLabelComponents(&vicinity, label));
  PetscCall(EqmListPieces(&vicinity, label, &components->num_pieces, &found));
  PetscCall(PetscMalloc2(components->num_pieces, &lowest, components->num_pieces, &number));
  for (PetscInt p = 0; p < components->num_pieces; p++) {
    lowest[p] = found[p].label;
    number[p] = p;
  }
  PetscCall(PetscSortIntWithArray(components->num_pieces, lowest, number));
  for (PetscInt v = 0; v < vicinity.num_owned; v++) {
    PetscInt k;

    PetscCall(PetscFindInt(label[v], components->num_pieces, lowest, &k));
    piece[v] = k >= 0 && vicinity.star_start[v] < vicinity.star_start[v + 1] ? number[k] : -1;
  }
  components->num_pieces = PetscMax(components->num_pieces, 1);
  PetscCall(PetscFree2(lowest, number));
  PetscCall(PetscFree(found));
  PetscCall(PetscFree(label));
  PetscCall(EqmVicinityReset(&vicinity));
  PetscFunctionReturn(0);
}

/* The piece of every cell of the prepared mesh. Of several pieces none has the cells that name a vertex twice or one
   that does not exist: -1. */
static PetscErrorCode LabelCells(EqmComponents *components, PetscInt *piece)
{
  const EqmSoup soup = components->whole.soup;
  const PetscInt cs = soup->cell_size, num = CellsOf(soup);
  PetscInt *of_vertex, *cell, *corner, *found, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(VerticesOf(soup), &of_vertex, num, &cell, num, &corner, num, &found));
  PetscCall(LabelVertices(components, of_vertex));
  for (PetscInt c = 0; c < num; c++) {
    piece[c] = components->num_pieces == 1 ? 0 : -1;
    if (EqmSoupCellUse(soup, soup->cells + cs * c) != EQM_CELL_USABLE) continue;
    cell[count] = c;
    corner[count++] = soup->cells[cs * c];
  }
  PetscCall(EqmFetchRows(soup->comm, VerticesOf(soup), count, corner, MPIU_INT, 1, of_vertex, found));
  for (PetscInt k = 0; k < count; k++) piece[cell[k]] = found[k];
  PetscCall(PetscFree4(of_vertex, cell, corner, found));
  PetscFunctionReturn(0);
}

/* The pieces of the given cells are those of their children; of one piece all are. */
static PetscErrorCode LabelGiven(const EqmComponents *components, const PetscInt *piece, PetscInt *given_piece)
{
  const EqmSoup soup = components->whole.soup, given = components->given;
  PetscInt *parent, *value, count = 0;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(CellsOf(soup), &parent, CellsOf(soup), &value));
  for (PetscInt c = 0; c < CellsOf(given); c++) given_piece[c] = components->num_pieces == 1 ? 0 : -1;
  for (PetscInt c = 0; c < CellsOf(soup); c++) {
    if (components->whole.parent[c] < 0 || piece[c] < 0) continue;
    parent[count] = components->whole.parent[c];
    value[count++] = piece[c];
  }
  PetscCall(EqmRowsCreateSF(given->comm, CellsOf(given), count, parent, &sf));
  PetscCall(PetscSFReduceBegin(sf, MPIU_INT, value, given_piece, MPI_MAX));
  PetscCall(PetscSFReduceEnd(sf, MPIU_INT, value, given_piece, MPI_MAX));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscFree2(parent, value));
  PetscFunctionReturn(0);
}

/* Group rows by their pieces. */
static PetscErrorCode GroupRows(PetscInt num_pieces, PetscInt num, const PetscInt *piece, EqmRowsOfPieces *rows)
{
  PetscInt *next;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(num_pieces + 1, &rows->start));
  PetscCall(PetscMalloc1(num, &rows->row));
  PetscCall(PetscMalloc1(num_pieces, &next));
  for (PetscInt r = 0; r < num; r++) {
    if (piece[r] >= 0) rows->start[piece[r] + 1]++;
  }
  for (PetscInt p = 0; p < num_pieces; p++) rows->start[p + 1] += rows->start[p];
  PetscCall(PetscArraycpy(next, rows->start, num_pieces));
  for (PetscInt r = 0; r < num; r++) {
    if (piece[r] >= 0) rows->row[next[piece[r]]++] = r;
  }
  PetscCall(PetscFree(next));
  PetscFunctionReturn(0);
}

/* Ask for the corners of a soup's cells, as far as they exist. */
static PetscErrorCode AskForCorners(EqmSoup soup, const PetscInt *piece, EqmPlacesInPieces *places)
{
  const PetscInt cs = soup->cell_size;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < cs * CellsOf(soup); k++) {
    if (piece[k / cs] < 0 || soup->cells[k] < 0 || soup->cells[k] >= soup->num_vertices) continue;
    PetscCall(EqmPlacesAdd(places, piece[k / cs], soup->cells[k]));
  }
  PetscFunctionReturn(0);
}

/* Vertices that others stand for, with these: both are in the piece. `number` is the vertex that stands in. */
static PetscErrorCode FindStandIns(const EqmComponents *components, const PetscInt *given_piece,
                                   EqmPlacesInPieces *places, EqmPlacesInPieces *stand_ins)
{
  const EqmSoup given = components->given;
  const PetscInt cs = given->cell_size, num = cs * CellsOf(given);
  PetscInt *corner, *piece, *found, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(num, &corner, num, &piece, num, &found));
  for (PetscInt k = 0; k < num; k++) {
    if (given_piece[k / cs] < 0 || given->cells[k] < 0 || given->cells[k] >= given->num_vertices) continue;
    piece[count] = given_piece[k / cs];
    corner[count++] = given->cells[k];
  }
  PetscCall(EqmFetchRows(given->comm, VerticesOf(given), count, corner, MPIU_INT, 1, components->whole.vertex, found));
  for (PetscInt k = 0; k < count; k++) {
    if (found[k] < 0 || found[k] == corner[k]) continue;
    PetscCall(EqmPlacesAdd(places, piece[k], found[k]));
    PetscCall(EqmPlacesAdd(stand_ins, piece[k], corner[k]));
    stand_ins->place[stand_ins->count - 1].number = found[k];
  }
  PetscCall(PetscFree3(corner, piece, found));
  PetscFunctionReturn(0);
}

/* The corners of the grouped cells in the numberings of their pieces; -1 where there is no such vertex. */
static PetscErrorCode Renumber(EqmSoup soup, const EqmPlacesInPieces *places, PetscInt num_pieces,
                               const EqmRowsOfPieces *cell, PetscInt **corner)
{
  const PetscInt cs = soup->cell_size;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cs * cell->start[num_pieces], corner));
  for (PetscInt p = 0; p < num_pieces; p++) {
    for (PetscInt k = cs * cell->start[p]; k < cs * cell->start[p + 1]; k++)
      (*corner)[k] = EqmPlacesFind(places, p, soup->cells[cs * cell->row[k / cs] + k % cs]);
  }
  PetscFunctionReturn(0);
}

/* Piece and number in it of every given cell, two per cell. */
static PetscErrorCode NumberGivenCells(const EqmComponents *components, const PetscInt *given_piece, PetscInt *number)
{
  const EqmRowsOfPieces *const cell = &components->given_cell;
  const PetscInt n = components->num_pieces;
  PetscInt *mine, *before;
  PetscMPIInt rank, count;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(components->given->comm, &rank));
  PetscCall(PetscMPIIntCast(n, &count));
  PetscCall(PetscMalloc2(n, &mine, n, &before));
  for (PetscInt p = 0; p < n; p++) mine[p] = cell->start[p + 1] - cell->start[p];
  PetscCallMPI(MPI_Exscan(mine, before, count, MPIU_INT, MPI_SUM, components->given->comm));
  if (rank == 0) PetscCall(PetscArrayzero(before, n)); /* undefined by MPI */
  for (PetscInt c = 0; c < CellsOf(components->given); c++) number[2 * c] = given_piece[c];
  for (PetscInt p = 0; p < n; p++) {
    for (PetscInt k = cell->start[p]; k < cell->start[p + 1]; k++)
      number[2 * cell->row[k] + 1] = before[p] + k - cell->start[p];
  }
  PetscCall(PetscFree2(mine, before));
  PetscFunctionReturn(0);
}

/* Parents as numbers among the given cells of the piece; -1: of another piece, which is as if the cell were added. */
static PetscErrorCode RenumberParents(EqmComponents *components, const PetscInt *given_piece)
{
  const EqmSoup given = components->given;
  const EqmRowsOfPieces *const cell = &components->cell;
  const PetscInt num = cell->start[components->num_pieces];
  PetscInt *number, *wanted, *row, *found, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num, &components->parent));
  PetscCall(PetscMalloc4(2 * CellsOf(given), &number, num, &wanted, num, &row, 2 * num, &found));
  PetscCall(NumberGivenCells(components, given_piece, number));
  for (PetscInt k = 0; k < num; k++) {
    components->parent[k] = -1;
    if (components->whole.parent[cell->row[k]] < 0) continue;
    row[count] = k;
    wanted[count++] = components->whole.parent[cell->row[k]];
  }
  PetscCall(EqmFetchRows(given->comm, CellsOf(given), count, wanted, MPIU_INT, 2, number, found));
  for (PetscInt k = 0, p = 0; k < count; k++) {
    while (cell->start[p + 1] <= row[k]) p++;
    if (found[2 * k] == p) components->parent[row[k]] = found[2 * k + 1];
  }
  PetscCall(PetscFree4(number, wanted, row, found));
  PetscFunctionReturn(0);
}

/* Where the given mesh has the vertices of the pieces; those that steps have added are nowhere. */
static PetscErrorCode FetchGivenPositions(EqmComponents *components)
{
  const EqmSoup given = components->given, soup = components->whole.soup;
  const PetscInt num = components->vertex.start[components->num_pieces];
  PetscInt *wanted;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num, &wanted));
  PetscCall(PetscMalloc1(3 * num, &components->given_position));
  for (PetscInt k = 0; k < num; k++)
    wanted[k] = PetscMin(soup->vertex_start + components->vertex.row[k], given->num_vertices - 1);
  PetscCall(EqmFetchRows(given->comm, VerticesOf(given), num, wanted, MPIU_REAL, 3, given->vertices,
                         components->given_position));
  PetscCall(PetscFree(wanted));
  PetscFunctionReturn(0);
}

/* Vertices and corners of all pieces. */
static PetscErrorCode NumberVertices(EqmComponents *components, const PetscInt *piece, const PetscInt *given_piece)
{
  const PetscInt n = components->num_pieces;
  EqmPlacesInPieces places = {0}, stand_ins = {0};

  PetscFunctionBegin;
  PetscCall(AskForCorners(components->whole.soup, piece, &places));
  PetscCall(AskForCorners(components->given, given_piece, &places));
  PetscCall(FindStandIns(components, given_piece, &places, &stand_ins));
  PetscCall(EqmPlacesNumber(&places, components));
  for (PetscInt k = 0; k < stand_ins.count; k++)
    stand_ins.place[k].number = EqmPlacesFind(&places, stand_ins.place[k].piece, stand_ins.place[k].number);
  PetscCall(EqmPlacesStandIns(&stand_ins, components));
  PetscCall(Renumber(components->whole.soup, &places, n, &components->cell, &components->corner));
  PetscCall(Renumber(components->given, &places, n, &components->given_cell, &components->given_corner));
  PetscCall(PetscFree(places.place));
  PetscCall(PetscFree(stand_ins.place));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmComponentsCreate(EqmSoup given, const EqmPrepareOptions *options, EqmComponents *components)
{
  PetscInt *piece, *given_piece;

  PetscFunctionBegin;
  *components = (EqmComponents){.given = given};
  PetscCall(EqmPrepareShared(given, options, &components->automatic, &components->whole));
  PetscCall(PetscMalloc2(CellsOf(components->whole.soup), &piece, CellsOf(given), &given_piece));
  PetscCall(LabelCells(components, piece));
  PetscCall(LabelGiven(components, piece, given_piece));
  PetscCall(GroupRows(components->num_pieces, CellsOf(components->whole.soup), piece, &components->cell));
  PetscCall(GroupRows(components->num_pieces, CellsOf(given), given_piece, &components->given_cell));
  PetscCall(NumberVertices(components, piece, given_piece));
  PetscCall(RenumberParents(components, given_piece));
  PetscCall(FetchGivenPositions(components));
  PetscCall(PetscFree2(piece, given_piece));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmComponentsReset(EqmComponents *components)
{
  EqmRowsOfPieces *const rows[] = {&components->cell, &components->given_cell, &components->vertex};

  PetscFunctionBegin;
  PetscCall(EqmPreparationReset(&components->whole));
  for (int k = 0; k < 3; k++) {
    PetscCall(PetscFree(rows[k]->start));
    PetscCall(PetscFree(rows[k]->row));
  }
  PetscCall(PetscFree(components->before));
  PetscCall(PetscFree(components->num_kept));
  PetscCall(PetscFree(components->corner));
  PetscCall(PetscFree(components->given_corner));
  PetscCall(PetscFree(components->parent));
  PetscCall(PetscFree(components->stand_in));
  PetscCall(PetscFree(components->given_position));
  PetscFunctionReturn(0);
}
