/* Vertices are dealt to the ranks along a curve. */
#include "hierarchy/shared.h"
#include "base/curve.h"
#include "base/exchange.h"
#include "base/sort.h"
#include <stdlib.h>

/* A vertex on its way: its place, and where it comes from. */
typedef struct {
  EqmCurvePlace place; /* first, for EqmCurveCompare */
  PetscInt rank, index;
} Traveller;

/* The cube of the curve: twice as wide as need be and shifted by none, one or two thirds, so that what is at a border
   of one curve's cubes is inside those of another (Chan 1998). Collective. */
static PetscErrorCode PlaceCube(const EqmSharedSource *source, PetscInt where, EqmCube *cube)
{
  PetscReal *kept;
  PetscInt n = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * source->num_owned, &kept));
  for (PetscInt v = 0; v < source->num_owned; v++) {
    if (source->gone && source->gone[v]) continue;
    for (PetscInt k = 0; k < 3; k++) kept[3 * n + k] = source->position[3 * v + k];
    n++;
  }
  PetscCall(EqmCurveBox(source->comm, n, kept, cube));
  PetscCall(PetscFree(kept));
  for (PetscInt k = 0; k < 3; k++) cube->low[k] -= (PetscReal)(where % 3) / 3. * cube->width;
  cube->width *= 2.;
  PetscFunctionReturn(0);
}

/* This rank's vertices in the order along the curve. Collective. */
static PetscErrorCode MakeTravellers(const EqmSharedSource *source, PetscInt where, PetscInt *num, Traveller **out)
{
  Traveller *traveller;
  EqmCube cube;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(source->comm, &rank));
  PetscCall(PlaceCube(source, where, &cube));
  PetscCall(PetscMalloc1(source->num_owned, &traveller));
  *num = 0;
  for (PetscInt v = 0; v < source->num_owned; v++) {
    if (source->gone && source->gone[v]) continue;
    traveller[(*num)++] =
        (Traveller){.place = {.key = EqmCurveKey(&cube, source->position + 3 * v), .number = source->number[v]},
                    .rank = rank,
                    .index = v};
  }
  EqmSort(traveller, (size_t)*num, sizeof(*traveller), EqmCurveCompare);
  *out = traveller;
  PetscFunctionReturn(0);
}

/* To the ranks whose pieces they are in; in order again. Collective. */
static PetscErrorCode Travel(const EqmSharedSource *source, PetscMPIInt size, const PetscInt *range, PetscInt num,
                             const Traveller *traveller, PetscInt *num_arrived, Traveller **arrived)
{
  EqmCurvePlace *place, *cut;
  PetscInt64 *before;
  PetscMPIInt *to;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(num, &place, num, &to, size - 1, &cut, size - 1, &before));
  for (PetscInt k = 0; k < num; k++) place[k] = traveller[k].place;
  for (PetscMPIInt p = 0; p < size - 1; p++) before[p] = range[p + 1];
  PetscCall(EqmCurveCut(source->comm, num, place, size - 1, before, cut));
  for (PetscInt k = 0, p = 0; k < num; k++) {
    while (p < size - 1 && EqmCurveCompare(&cut[p], &place[k]) <= 0) p++;
    to[k] = (PetscMPIInt)p;
  }
  PetscCall(EqmExchangeBytes(source->comm, num, sizeof(*traveller), to, traveller, num_arrived, arrived));
  PetscCall(PetscFree4(place, to, cut, before));
  EqmSort(*arrived, (size_t)*num_arrived, sizeof(**arrived), EqmCurveCompare);
  PetscFunctionReturn(0);
}

/* The pieces, and which are whose. */
static PetscErrorCode CutPieces(const EqmSharedSource *source, PetscInt vertices_of_piece, EqmSharedLevel *to,
                                PetscInt *range)
{
  const PetscInt n = source->num_kept, pieces = PetscMax(1, (n + vertices_of_piece / 2) / vertices_of_piece);
  PetscMPIInt size, rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(source->comm, &size));
  PetscCallMPI(MPI_Comm_rank(source->comm, &rank));
  for (PetscMPIInt p = 0; p <= size; p++)
    range[p] = (PetscInt)((PetscInt64)n * (PetscInt)((PetscInt64)pieces * p / size) / pieces);
  to->num_vertices = n;
  to->num_all_pieces = pieces;
  to->first_piece = (PetscInt)((PetscInt64)pieces * rank / size);
  to->num_pieces = (PetscInt)((PetscInt64)pieces * (rank + 1) / size) - to->first_piece;
  to->first = range[rank];
  PetscCall(PetscMalloc1(to->num_pieces + 1, &to->vertex_start));
  for (PetscInt k = 0; k <= to->num_pieces; k++)
    to->vertex_start[k] = (PetscInt)((PetscInt64)n * (to->first_piece + k) / pieces) - to->first;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedNumber(const EqmSharedSource *source, PetscInt where, PetscInt vertices_of_piece,
                               EqmSharedLevel *to, PetscInt *number, PetscInt *range)
{
  Traveller *traveller, *arrived;
  PetscInt num, num_arrived, *mine;
  PetscSFNode *remote;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(source->comm, &size));
  PetscCall(CutPieces(source, vertices_of_piece, to, range));
  PetscCall(MakeTravellers(source, where, &num, &traveller));
  PetscCall(Travel(source, size, range, num, traveller, &num_arrived, &arrived));
  PetscCall(PetscFree(traveller));
  to->num_owned = to->vertex_start[to->num_pieces];
  PetscCheck(num_arrived == to->num_owned, PETSC_COMM_SELF, PETSC_ERR_PLIB,
             "%" PetscInt_FMT " vertices of a level came, not %" PetscInt_FMT, num_arrived, to->num_owned);
  PetscCall(PetscMalloc1(num_arrived, &remote));
  PetscCall(PetscMalloc1(num_arrived, &mine));
  for (PetscInt k = 0; k < num_arrived; k++) {
    remote[k] = (PetscSFNode){.rank = arrived[k].rank, .index = arrived[k].index};
    mine[k] = to->first + k;
  }
  PetscCall(PetscFree(arrived));
  PetscCall(PetscSFCreate(source->comm, &to->from_finer));
  PetscCall(PetscSFSetGraph(to->from_finer, source->num_owned, num_arrived, NULL, PETSC_OWN_POINTER, remote,
                            PETSC_OWN_POINTER));
  for (PetscInt v = 0; v < source->num_local; v++) number[v] = -1;
  PetscCall(PetscSFReduceBegin(to->from_finer, MPIU_INT, mine, number, MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(to->from_finer, MPIU_INT, mine, number, MPI_REPLACE));
  PetscCall(PetscFree(mine));
  PetscCall(PetscSFBcastBegin(source->halo, MPIU_INT, number, number + source->num_owned, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(source->halo, MPIU_INT, number, number + source->num_owned, MPI_REPLACE));
  PetscFunctionReturn(0);
}
