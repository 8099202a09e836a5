/* Numbers for the vertices of each piece of a mesh. A vertex is counted by the rank in whose slab of the prepared mesh
   it lies; the ranks whose cells name it ask that one. */
#include "prepare/components_private.h"
#include <petscis.h>
#include "base/exchange.h"
#include "base/sort.h"
#include "mesh/soup_private.h"

static int ComparePlaces(const void *a, const void *b)
{
  const EqmPlaceInPiece *const s = a, *const t = b;

  if (s->piece != t->piece) return s->piece < t->piece ? -1 : 1;
  return (s->vertex > t->vertex) - (s->vertex < t->vertex);
}

PetscErrorCode EqmPlacesAdd(EqmPlacesInPieces *places, PetscInt piece, PetscInt vertex)
{
  PetscFunctionBegin;
  if (places->count == places->capacity) {
    places->capacity = PetscMax(1024, 2 * places->capacity);
    PetscCall(PetscRealloc((size_t)places->capacity * sizeof(*places->place), &places->place));
  }
  places->place[places->count++] = (EqmPlaceInPiece){.piece = piece, .vertex = vertex};
  PetscFunctionReturn(0);
}

/* Ascending, each once. */
static void SortPlaces(EqmPlacesInPieces *places)
{
  PetscInt count = 0;

  EqmSort(places->place, (size_t)places->count, sizeof(*places->place), ComparePlaces);
  for (PetscInt k = 0; k < places->count; k++) {
    if (k == 0 || ComparePlaces(&places->place[count - 1], &places->place[k]))
      places->place[count++] = places->place[k];
  }
  places->count = count;
}

PetscInt EqmPlacesFind(const EqmPlacesInPieces *places, PetscInt piece, PetscInt vertex)
{
  const EqmPlaceInPiece key = {.piece = piece, .vertex = vertex};
  const EqmPlaceInPiece *const found =
      EqmSearch(&key, places->place, (size_t)places->count, sizeof(key), ComparePlaces);

  return found ? found->number : -1;
}

/* A question or an answer: the asking rank, and the place in its list. */
typedef struct {
  EqmPlaceInPiece what;
  PetscInt asker, place;
} Question;

static int CompareQuestions(const void *a, const void *b)
{
  return ComparePlaces(&((const Question *)a)->what, &((const Question *)b)->what);
}

/* The rank in whose slab of the prepared mesh each vertex lies. */
static PetscErrorCode FindCounters(EqmSoup soup, const EqmPlacesInPieces *places, PetscMPIInt *counter)
{
  PetscLayout layout;

  PetscFunctionBegin;
  PetscCall(
      PetscLayoutCreateFromSizes(soup->comm, soup->vertex_end - soup->vertex_start, soup->num_vertices, 1, &layout));
  for (PetscInt k = 0; k < places->count; k++)
    PetscCall(PetscLayoutFindOwner(layout, places->place[k].vertex, &counter[k]));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscFunctionReturn(0);
}

/* Ask about all places of this rank. */
static PetscErrorCode Ask(EqmSoup soup, const EqmPlacesInPieces *places, PetscInt *num_asked, Question **asked)
{
  PetscMPIInt rank, *counter;
  Question *mine;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(PetscMalloc2(places->count, &counter, places->count, &mine));
  PetscCall(FindCounters(soup, places, counter));
  for (PetscInt k = 0; k < places->count; k++)
    mine[k] = (Question){.what = places->place[k], .asker = rank, .place = k};
  PetscCall(EqmExchangeBytes(soup->comm, places->count, sizeof(Question), counter, mine, num_asked, asked));
  PetscCall(PetscFree2(counter, mine));
  PetscFunctionReturn(0);
}

/* List the vertices asked for by pieces: components->vertex, with the places in this list as numbers so far. */
static PetscErrorCode ListVertices(PetscInt num_asked, Question *asked, EqmComponents *components)
{
  const EqmSoup soup = components->whole.soup;
  EqmRowsOfPieces *const vertex = &components->vertex;
  PetscInt count = 0;

  PetscFunctionBegin;
  EqmSort(asked, (size_t)num_asked, sizeof(*asked), CompareQuestions);
  PetscCall(PetscCalloc1(components->num_pieces + 1, &vertex->start));
  PetscCall(PetscMalloc1(num_asked, &vertex->row));
  for (PetscInt k = 0; k < num_asked; k++) {
    if (k == 0 || CompareQuestions(&asked[k - 1], &asked[k])) {
      vertex->row[count++] = asked[k].what.vertex - soup->vertex_start;
      vertex->start[asked[k].what.piece + 1]++;
    }
    asked[k].what.number = count - 1;
  }
  for (PetscInt p = 0; p < components->num_pieces; p++) vertex->start[p + 1] += vertex->start[p];
  PetscFunctionReturn(0);
}

/* Per piece, how many of its vertices lower ranks have, and how many of those here are the given mesh's. */
static PetscErrorCode CountVertices(EqmComponents *components)
{
  const EqmSoup soup = components->whole.soup;
  const EqmRowsOfPieces *const vertex = &components->vertex;
  PetscInt *mine;
  PetscMPIInt rank, num;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(PetscMPIIntCast(components->num_pieces, &num));
  PetscCall(PetscMalloc1(components->num_pieces, &mine));
  PetscCall(PetscCalloc1(components->num_pieces, &components->num_kept));
  PetscCall(PetscCalloc1(components->num_pieces, &components->before));
  for (PetscInt p = 0; p < components->num_pieces; p++) {
    mine[p] = vertex->start[p + 1] - vertex->start[p];
    for (PetscInt k = vertex->start[p]; k < vertex->start[p + 1]; k++)
      components->num_kept[p] += soup->vertex_start + vertex->row[k] < components->given->num_vertices;
  }
  PetscCallMPI(MPI_Exscan(mine, components->before, num, MPIU_INT, MPI_SUM, soup->comm));
  if (rank == 0) PetscCall(PetscArrayzero(components->before, num)); /* undefined by MPI */
  PetscCall(PetscFree(mine));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPlacesNumber(EqmPlacesInPieces *places, EqmComponents *components)
{
  MPI_Comm comm = components->given->comm;
  PetscInt num_asked, num_answers;
  PetscMPIInt *asker;
  Question *asked, *answer;

  PetscFunctionBegin;
  SortPlaces(places);
  PetscCall(Ask(components->whole.soup, places, &num_asked, &asked));
  PetscCall(ListVertices(num_asked, asked, components));
  PetscCall(CountVertices(components));
  PetscCall(PetscMalloc1(num_asked, &asker));
  for (PetscInt k = 0; k < num_asked; k++) {
    const PetscInt piece = asked[k].what.piece;

    asked[k].what.number += components->before[piece] - components->vertex.start[piece];
    asker[k] = (PetscMPIInt)asked[k].asker;
  }
  PetscCall(EqmExchangeBytes(comm, num_asked, sizeof(Question), asker, asked, &num_answers, &answer));
  for (PetscInt k = 0; k < num_answers; k++) places->place[answer[k].place].number = answer[k].what.number;
  PetscCall(PetscFree(asker));
  PetscCall(PetscFree(asked));
  PetscCall(PetscFree(answer));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPlacesStandIns(const EqmPlacesInPieces *stand_ins, EqmComponents *components)
{
  const EqmRowsOfPieces *const vertex = &components->vertex;
  PetscInt num;
  Question *received;

  PetscFunctionBegin;
  PetscCall(Ask(components->whole.soup, stand_ins, &num, &received));
  PetscCall(PetscMalloc1(vertex->start[components->num_pieces], &components->stand_in));
  for (PetscInt p = 0; p < components->num_pieces; p++) {
    for (PetscInt k = vertex->start[p]; k < vertex->start[p + 1]; k++)
      components->stand_in[k] = components->before[p] + k - vertex->start[p];
  }
  for (PetscInt k = 0; k < num; k++) {
    const PetscInt piece = received[k].what.piece, first = vertex->start[piece];
    PetscInt found;

    PetscCall(PetscFindInt(received[k].what.vertex - components->whole.soup->vertex_start,
                           vertex->start[piece + 1] - first, vertex->row + first, &found));
    if (found >= 0) components->stand_in[first + found] = received[k].what.number;
  }
  PetscCall(PetscFree(received));
  PetscFunctionReturn(0);
}
