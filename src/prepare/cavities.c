/* Fill cavities of solids, as segmentation leaves them: each with tetrahedra around a vertex in its middle, where that
   sees its whole surface; others are left. The boundary is gathered on rank 0, if there are cavities at all. */
#include "base/exchange.h"
#include "base/sets.h"
#include "base/sort.h"
#include "geometry/simplex.h"
#include "mesh/soup_private.h"
#include "prepare/step.h"

/* A triangle of the boundary, looking out of the solid. */
typedef struct {
  PetscInt vertex[3];
  PetscReal x[9];
} Face;

typedef struct {
  PetscInt num_faces;
  Face *face;
  PetscInt *surface; /* per face the number of its surface */
  PetscInt num_surfaces, outer;
} Boundary;

/* Each boundary triangle from its lowest vertex, to rank 0. */
static PetscErrorCode GatherFaces(const EqmVicinity *vicinity, Boundary *boundary)
{
  PetscInt count = 0, capacity = 64;
  PetscMPIInt *destination;
  Face *mine;
  EqmLink link;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(capacity, &mine));
  PetscCall(EqmLinkCreate(vicinity, &link));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    EqmLinkCompute(vicinity, v, &link);
    for (PetscInt e = 0; e < link.num_edges; e++) {
      const PetscInt low = link.vertex[link.edge[2 * e]], high = link.vertex[link.edge[2 * e + 1]];
      const PetscBool turn = (PetscBool)(link.edge_sides[e] > 0); /* the solid lies to the left of (v, low, high) */
      const PetscInt corner[3] = {v, turn ? high : low, turn ? low : high};

      if (link.edge_count[e] != 1 || vicinity->input[v] > vicinity->input[low] ||
          vicinity->input[v] > vicinity->input[high])
        continue;
      if (count == capacity) PetscCall(PetscRealloc((size_t)(capacity *= 2) * sizeof(Face), &mine));
      for (int a = 0; a < 3; a++) {
        mine[count].vertex[a] = vicinity->input[corner[a]];
        PetscCall(PetscArraycpy(mine[count].x + 3 * a, vicinity->position + 3 * corner[a], 3));
      }
      count++;
    }
  }
  PetscCall(EqmLinkReset(&link));
  PetscCall(PetscCalloc1(count, &destination));
  PetscCall(
      EqmExchangeBytes(vicinity->comm, count, sizeof(Face), destination, mine, &boundary->num_faces, &boundary->face));
  PetscCall(PetscFree(destination));
  PetscCall(PetscFree(mine));
  PetscFunctionReturn(0);
}

static int CompareFaces(const void *a, const void *b)
{
  const Face *const s = a, *const t = b;

  for (int k = 0; k < 3; k++) {
    if (s->vertex[k] != t->vertex[k]) return s->vertex[k] < t->vertex[k] ? -1 : 1;
  }
  return 0;
}

/* Number the surfaces in the order of their lowest faces; the outer one is that of the largest box. */
static PetscErrorCode NumberSurfaces(Boundary *boundary)
{
  const PetscInt n = boundary->num_faces;
  PetscInt count = 3 * n, *number, *set, *label;
  PetscReal largest = -1., *box;

  PetscFunctionBegin;
  EqmSort(boundary->face, (size_t)n, sizeof(Face), CompareFaces);
  PetscCall(PetscMalloc1(n, &boundary->surface));
  PetscCall(PetscMalloc3(count, &number, count, &set, count, &label));
  for (PetscInt k = 0; k < count; k++) number[k] = boundary->face[k / 3].vertex[k % 3];
  PetscCall(PetscSortRemoveDupsInt(&count, number));
  for (PetscInt k = 0; k < count; k++) {
    set[k] = k;
    label[k] = -1;
  }
  for (PetscInt k = 0; k < 3 * n; k++) { /* surface[] for scratch: the place of a face's first corner */
    PetscInt place;

    PetscCall(PetscFindInt(boundary->face[k / 3].vertex[k % 3], count, number, &place));
    if (k % 3 == 0) boundary->surface[k / 3] = place;
    (void)EqmSetJoin(set, boundary->surface[k / 3], place);
  }
  PetscCall(PetscMalloc1(6 * n, &box));
  for (PetscInt f = 0; f < n; f++) {
    PetscInt *const of = &label[EqmSetRoot(set, boundary->surface[f])];

    if (*of < 0) {
      *of = boundary->num_surfaces++;
      for (int k = 0; k < 6; k++) box[6 * *of + k] = PETSC_MAX_REAL;
    }
    boundary->surface[f] = *of;
    for (int k = 0; k < 9; k++) {
      PetscReal *const low = &box[6 * *of + k % 3];
      low[0] = PetscMin(low[0], boundary->face[f].x[k]);
      low[3] = PetscMin(low[3], -boundary->face[f].x[k]);
    }
  }
  for (PetscInt s = 0; s < boundary->num_surfaces; s++) {
    const PetscReal *const b = box + 6 * s;
    const PetscReal size = PetscSqr(b[0] + b[3]) + PetscSqr(b[1] + b[4]) + PetscSqr(b[2] + b[5]);

    if (size > largest) boundary->outer = s;
    largest = PetscMax(largest, size);
  }
  PetscCall(PetscFree(box));
  PetscCall(PetscFree3(number, set, label));
  PetscFunctionReturn(0);
}

/* The middle of each surface, by area, and whether it sees all triangles from inside: those have a positive volume with
   it. */
static PetscErrorCode FindMiddles(const Boundary *boundary, PetscReal *middle, PetscBool *sees)
{
  PetscReal *area;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(boundary->num_surfaces, &area));
  PetscCall(PetscArrayzero(middle, 3 * boundary->num_surfaces));
  for (PetscInt f = 0; f < boundary->num_faces; f++) {
    const PetscReal *const x = boundary->face[f].x, a = EqmArea3(x, x + 3, x + 6);
    const PetscInt s = boundary->surface[f];

    area[s] += a;
    for (int k = 0; k < 3; k++) middle[3 * s + k] += a * (x[k] + x[3 + k] + x[6 + k]) / 3.;
  }
  for (PetscInt s = 0; s < boundary->num_surfaces; s++) {
    for (int k = 0; k < 3; k++) middle[3 * s + k] /= area[s];
    sees[s] = (PetscBool)(s != boundary->outer);
  }
  for (PetscInt f = 0; f < boundary->num_faces; f++) {
    const PetscInt s = boundary->surface[f];
    const PetscReal *const x = boundary->face[f].x;

    if (!(EqmVolume(x, x + 3, x + 6, middle + 3 * s) > 0.)) sees[s] = PETSC_FALSE;
  }
  PetscCall(PetscFree(area));
  PetscFunctionReturn(0);
}

/* On rank 0: a vertex and tetrahedra for each cavity that can be filled so. */
static PetscErrorCode Fill(const Boundary *boundary, PetscInt num_kept, EqmVertexGroup *group, EqmCellList *list)
{
  const PetscInt n = boundary->num_surfaces;
  PetscInt *vertex;
  PetscReal *middle;
  PetscBool *sees;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &vertex, 3 * n, &middle, n, &sees));
  PetscCall(FindMiddles(boundary, middle, sees));
  PetscCall(PetscMalloc1(3 * n, &group->position));
  for (PetscInt s = 0; s < n; s++) {
    if (!sees[s]) continue;
    vertex[s] = num_kept + group->num_local;
    PetscCall(PetscArraycpy(group->position + 3 * group->num_local++, middle + 3 * s, 3));
  }
  for (PetscInt f = 0; f < boundary->num_faces; f++) {
    const PetscInt *const v = boundary->face[f].vertex, s = boundary->surface[f];
    const PetscInt cell[4] = {v[0], v[1], v[2], sees[s] ? vertex[s] : -1};

    if (sees[s]) PetscCall(EqmCellListAdd(list, -1, cell));
  }
  PetscCall(PetscFree3(vertex, middle, sees));
  PetscFunctionReturn(0);
}

/* `count` is of cavities. */
PetscErrorCode EqmFillCavities(const EqmPrepareOptions *options, EqmChange *change, EqmPreparedStep *report)
{
  const EqmSoup soup = change->soup;
  EqmVertexGroup group = {0};
  EqmCellList list = {.cell_size = 4};
  Boundary boundary = {0};
  EqmDiagnosis diagnosis;
  EqmVicinity vicinity;
  PetscInt64 count[2] = {0, 0}; /* cavities, tetrahedra */

  PetscFunctionBegin;
  PetscCall(EqmSoupDiagnose(soup, &diagnosis));
  if (!diagnosis.finding[EQM_FINDING_HOLES].count) PetscFunctionReturn(0);
  PetscCall(EqmVicinityCreate(soup, &vicinity));
  PetscCall(GatherFaces(&vicinity, &boundary));
  PetscCall(EqmVicinityReset(&vicinity));
  if (boundary.num_faces) { /* rank 0 */
    PetscCall(NumberSurfaces(&boundary));
    PetscCall(Fill(&boundary, soup->num_vertices, &group, &list));
  }
  count[0] = group.num_local;
  count[1] = list.count;
  PetscCallMPI(MPI_Bcast(count, 2, MPIU_INT64, 0, soup->comm));
  report->count = count[0];
  if (count[0]) {
    for (PetscInt c = soup->cell_start; c < soup->cell_end; c++)
      PetscCall(EqmCellListAdd(&list, c, soup->cells + 4 * (c - soup->cell_start)));
    PetscCall(PetscSNPrintf(report->what, sizeof(report->what),
                            "%" PetscInt64_FMT " cavities filled with %" PetscInt64_FMT " tetrahedra", count[0],
                            count[1]));
    PetscCall(EqmChangeAssemble(change, &group, &list));
    PetscCall(EqmChangeWeighAdded(change, options->hole_weight));
  }
  PetscCall(PetscFree(group.position));
  PetscCall(PetscFree(boundary.face));
  PetscCall(PetscFree(boundary.surface));
  PetscFunctionReturn(0);
}
