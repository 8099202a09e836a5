/* The seams of a texture, found by all ranks: the same numbers as EqmSeamsFind gives on one. Of the corners at a vertex
   the first with a point stands for it: of each rank's corners one per point goes to the rank that holds the vertex. */
#include "seam.h"
#include <petscis.h>
#include "base/exchange.h"
#include "base/rows.h"
#include "base/sort.h"
#include "mesh/soup_private.h"

/* A corner of a triangle; 3 * cell + its place there is its number. */
typedef struct {
  PetscInt64 number,
      first; /* first: of the first corner with the same vertex and point, -1: the vertex's first point */
  PetscInt vertex;
  PetscReal uv[2];
} Corner;

static int CompareCorners(const void *a, const void *b)
{
  const Corner *const s = a, *const t = b;

  if (s->vertex != t->vertex) return s->vertex < t->vertex ? -1 : 1;
  return (s->number > t->number) - (s->number < t->number);
}

/* Send corners to the ranks that hold their vertices, or back to those that hold their cells. */
static PetscErrorCode Send(EqmSoup soup, PetscBool back, PetscInt num, const Corner *corner, PetscInt *num_received,
                           Corner **received)
{
  const PetscInt vertices = soup->vertex_end - soup->vertex_start, cells = soup->cell_end - soup->cell_start;
  PetscMPIInt *destination;
  PetscLayout layout;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num, &destination));
  PetscCall(PetscLayoutCreateFromSizes(soup->comm, back ? cells : vertices, back ? soup->num_cells : soup->num_vertices,
                                       1, &layout));
  for (PetscInt k = 0; k < num; ++k)
    PetscCall(
        PetscLayoutFindOwner(layout, back ? (PetscInt)(corner[k].number / 3) : corner[k].vertex, &destination[k]));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscCall(EqmExchangeBytes(soup->comm, num, sizeof(Corner), destination, corner, num_received, received));
  PetscCall(PetscFree(destination));
  PetscFunctionReturn(0);
}

/* Corners of one vertex, in their order: which ones are the first with their points. `distinct` has room for all. */
static void FindFirst(PetscInt num, Corner *corner, PetscInt *distinct)
{
  PetscInt count = 0;

  for (PetscInt k = 0; k < num; ++k) {
    PetscInt d = 0;

    while (d < count && (corner[distinct[d]].uv[0] != corner[k].uv[0] || corner[distinct[d]].uv[1] != corner[k].uv[1]))
      ++d;
    if (d == count) distinct[count++] = k;
    corner[k].first = d ? corner[distinct[d]].number : -1;
  }
}

/* Of this rank's corners, the first one with the same vertex and point. Not collective. */
static PetscErrorCode FindFirstHere(EqmSoup soup, const PetscReal *texture, PetscInt *first)
{
  const PetscInt num = 3 * (soup->cell_end - soup->cell_start);
  PetscInt *vertex, *order, *distinct, last;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(num, &vertex, num, &order, num, &distinct));
  PetscCall(PetscArraycpy(vertex, soup->cells, num));
  for (PetscInt k = 0; k < num; ++k) order[k] = k;
  PetscCall(PetscSortIntWithArray(num, vertex, order));
  for (PetscInt k = 0; k < num; k = last) {
    PetscInt count = 0;

    for (last = k; last < num && vertex[last] == vertex[k];) ++last;
    PetscCall(PetscSortInt(last - k, order + k));
    for (PetscInt i = k; i < last; ++i) {
      const PetscReal *const uv = texture + 2 * (size_t)order[i];
      PetscInt d = 0;

      while (d < count && (texture[2 * (size_t)distinct[d]] != uv[0] || texture[2 * (size_t)distinct[d] + 1] != uv[1]))
        ++d;
      if (d == count) distinct[count++] = order[i];
      first[order[i]] = distinct[d];
    }
  }
  PetscCall(PetscFree3(vertex, order, distinct));
  PetscFunctionReturn(0);
}

/* One corner of this rank's per vertex and point. */
static PetscErrorCode ListFirst(EqmSoup soup, const PetscReal *texture, const PetscInt *first, PetscInt *num_mine,
                                Corner **mine)
{
  const PetscInt num = 3 * (soup->cell_end - soup->cell_start);
  PetscInt count = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < num; ++k) count += first[k] == k;
  PetscCall(PetscMalloc1(count, mine));
  count = 0;
  for (PetscInt k = 0; k < num; ++k) {
    if (first[k] != k) continue;
    (*mine)[count++] = (Corner){.number = 3 * (PetscInt64)soup->cell_start + k,
                                .vertex = soup->cells[k],
                                .uv = {texture[2 * (size_t)k], texture[2 * (size_t)k + 1]}};
  }
  *num_mine = count;
  PetscFunctionReturn(0);
}

/* On the ranks of the vertices: their first points, and the first corner with every other one. */
static PetscErrorCode MeetAtVertices(EqmSoup soup, PetscInt num_mine, const Corner *mine, EqmSeamSlabs *seams,
                                     PetscInt *num_back, Corner **back)
{
  PetscInt num_met, last, *distinct;
  Corner *met;

  PetscFunctionBegin;
  PetscCall(Send(soup, PETSC_FALSE, num_mine, mine, &num_met, &met));
  EqmSort(met, (size_t)num_met, sizeof(Corner), CompareCorners);
  PetscCall(PetscMalloc1(num_met, &distinct));
  for (PetscInt k = 0; k < num_met; k = last) {
    PetscReal *const point = seams->point + 2 * (size_t)(met[k].vertex - soup->vertex_start);

    for (last = k; last < num_met && met[last].vertex == met[k].vertex;) ++last;
    FindFirst(last - k, met + k, distinct);
    point[0] = met[k].uv[0];
    point[1] = met[k].uv[1];
  }
  PetscCall(PetscFree(distinct));
  PetscCall(Send(soup, PETSC_TRUE, num_met, met, num_back, back));
  PetscCall(PetscFree(met));
  PetscFunctionReturn(0);
}

/* The first corner of all ranks with the vertex and the point of each of this rank's; -1: the vertex's first point. */
static PetscErrorCode FindFirstOfAll(EqmSoup soup, const PetscReal *texture, EqmSeamSlabs *seams, PetscInt64 *first)
{
  const PetscInt num = 3 * (soup->cell_end - soup->cell_start);
  PetscInt num_mine, num_back, *here;
  Corner *mine, *back;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num, &here));
  PetscCall(FindFirstHere(soup, texture, here));
  PetscCall(ListFirst(soup, texture, here, &num_mine, &mine));
  PetscCall(MeetAtVertices(soup, num_mine, mine, seams, &num_back, &back));
  PetscCall(PetscFree(mine));
  for (PetscInt k = 0; k < num_back; ++k) first[back[k].number - 3 * (PetscInt64)soup->cell_start] = back[k].first;
  for (PetscInt k = 0; k < num; ++k) first[k] = first[here[k]];
  PetscCall(PetscFree(back));
  PetscCall(PetscFree(here));
  PetscFunctionReturn(0);
}

/* On the ranks of the cells: numbers for the corners that are the first with another point, in their order. */
static PetscErrorCode NumberFirst(EqmSoup soup, const PetscReal *texture, const PetscInt64 *first, EqmSeamSlabs *seams)
{
  const PetscInt num = 3 * (soup->cell_end - soup->cell_start);
  const PetscInt64 start = 3 * (PetscInt64)soup->cell_start;
  PetscInt64 mine = 0, end;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(soup->comm, &size));
  for (PetscInt k = 0; k < num; ++k) mine += first[k] == start + k;
  PetscCallMPI(MPI_Scan(&mine, &end, 1, MPIU_INT64, MPI_SUM, soup->comm));
  PetscCall(MPIU_Allreduce(&mine, &seams->num_more, 1, MPIU_INT64, MPI_SUM, soup->comm));
  PetscCheck(soup->num_vertices + seams->num_more <= PETSC_MAX_INT, soup->comm, PETSC_ERR_SUP,
             "more texture points than PetscInt can count");
  PetscCall(PetscMalloc1(2 * (size_t)mine, &seams->more));
  end -= mine;
  mine = 0;
  for (PetscInt k = 0; k < num; ++k) {
    seams->corner[k] = -1;
    if (first[k] < 0) seams->corner[k] = soup->cells[k];
    if (first[k] != start + k) continue;
    seams->corner[k] = (PetscInt)(soup->num_vertices + end + mine);
    seams->more[2 * mine] = texture[2 * (size_t)k];
    seams->more[2 * mine++ + 1] = texture[2 * (size_t)k + 1];
  }
  seams->more_end = (PetscInt)(end + mine);
  PetscFunctionReturn(0);
}

/* The others have the numbers of their first ones. */
static PetscErrorCode FetchNumbers(EqmSoup soup, const PetscInt64 *first, EqmSeamSlabs *seams)
{
  const PetscInt num_cells = soup->cell_end - soup->cell_start, num = 3 * num_cells;
  PetscInt *place, *cell, *row, count = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < num; ++k) count += seams->corner[k] < 0;
  PetscCall(PetscMalloc3(count, &place, count, &cell, 3 * count, &row));
  count = 0;
  for (PetscInt k = 0; k < num; ++k) {
    if (seams->corner[k] >= 0) continue;
    place[count] = k;
    cell[count++] = (PetscInt)(first[k] / 3);
  }
  PetscCall(EqmFetchRows(soup->comm, num_cells, count, cell, MPIU_INT, 3, seams->corner, row));
  for (PetscInt i = 0; i < count; ++i) seams->corner[place[i]] = row[3 * i + first[place[i]] % 3];
  PetscCall(PetscFree3(place, cell, row));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSeamsFindSlabs(EqmSoup soup, const PetscReal *texture, EqmSeamSlabs *seams)
{
  const PetscInt num = 3 * (soup->cell_end - soup->cell_start);
  PetscInt64 *first;

  PetscFunctionBegin;
  *seams = (EqmSeamSlabs){0};
  PetscCall(PetscCalloc1(2 * (size_t)(soup->vertex_end - soup->vertex_start), &seams->point));
  PetscCall(PetscMalloc1(num, &seams->corner));
  PetscCall(PetscMalloc1(num, &first));
  PetscCall(FindFirstOfAll(soup, texture, seams, first));
  PetscCall(NumberFirst(soup, texture, first, seams));
  PetscCall(FetchNumbers(soup, first, seams));
  PetscCall(PetscFree(first));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSeamSlabsReset(EqmSeamSlabs *seams)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(seams->point));
  PetscCall(PetscFree(seams->more));
  PetscCall(PetscFree(seams->corner));
  PetscFunctionReturn(0);
}
