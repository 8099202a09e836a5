/* Join boundary vertices at the same position: seams that programs cut for their texture coordinates. */
#include "prepare/step.h"
#include "mesh/soup_private.h"
#include "base/exchange.h"
#include "base/rows.h"
#include "base/sets.h"
#include "base/sort.h"

/* A boundary vertex on rank 0, which gets all of them: few beside those of the mesh. */
typedef struct {
  PetscInt number, label;
  PetscReal x[3];
} Point;

static int ComparePlaces(const void *a, const void *b)
{
  const Point *const s = a, *const t = b;

  for (int k = 0; k < 3; k++) {
    if (s->x[k] != t->x[k]) return s->x[k] < t->x[k] ? -1 : 1;
  }
  return (s->number > t->number) - (s->number < t->number);
}

/* Label every point by the lowest number of its cluster: points connected by distances of at most `distance`. Not
   collective.
 */
static PetscErrorCode JoinPoints(PetscInt n, Point *point, PetscReal distance, PetscInt *num_joined)
{
  PetscInt *set, *lowest;

  PetscFunctionBegin;
  if (n > 0) EqmSort(point, (size_t)n, sizeof(Point), ComparePlaces); /* not NULL */
  PetscCall(PetscMalloc2(n, &set, n, &lowest));
  for (PetscInt i = 0; i < n; i++) {
    set[i] = i;
    lowest[i] = PETSC_MAX_INT;
  }
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt j = i + 1; j < n && point[j].x[0] - point[i].x[0] <= distance; j++) {
      const PetscReal x = point[j].x[0] - point[i].x[0], y = point[j].x[1] - point[i].x[1];
      const PetscReal z = point[j].x[2] - point[i].x[2];

      if (x * x + y * y + z * z <= distance * distance)
        (void)EqmSetJoin(set, i, j);
      else if (distance == 0.)
        break; /* equal points are adjacent, and many may have the same first coordinate */
    }
  }
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt root = EqmSetRoot(set, i);
    lowest[root] = PetscMin(lowest[root], point[i].number);
  }
  *num_joined = 0;
  for (PetscInt i = 0; i < n; i++) {
    point[i].label = lowest[EqmSetRoot(set, i)];
    *num_joined += point[i].label != point[i].number;
  }
  PetscCall(PetscFree2(set, lowest));
  PetscFunctionReturn(0);
}

/* The diameter of the bounding box. Collective. */
static PetscErrorCode Diameter(const EqmVicinity *vicinity, PetscReal *diameter)
{
  PetscReal box[6] = {PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL};

  PetscFunctionBegin;
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    if (vicinity->star_start[v] == vicinity->star_start[v + 1]) continue;
    for (int k = 0; k < 3; k++) {
      box[k] = PetscMin(box[k], vicinity->position[3 * v + k]);
      box[3 + k] = PetscMin(box[3 + k], -vicinity->position[3 * v + k]);
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, box, 6, MPIU_REAL, MPIU_MIN, vicinity->comm));
  *diameter = PetscSqrtReal(PetscSqr(box[0] + box[3]) + PetscSqr(box[1] + box[4]) + PetscSqr(box[2] + box[5]));
  PetscFunctionReturn(0);
}

/* Gather the boundary vertices on rank 0 and label them: `label` per owned vertex. */
static PetscErrorCode LabelBoundary(const EqmVicinity *vicinity, PetscReal distance, PetscInt *label,
                                    PetscInt *num_joined)
{
  PetscInt count = 0, num_points, *number, *labels;
  PetscBool *on_boundary;
  PetscMPIInt *destination;
  Point *mine, *point;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(vicinity->num_local, &on_boundary));
  PetscCall(EqmVicinityMarkBoundary(vicinity, on_boundary));
  PetscCall(PetscMalloc1(vicinity->num_owned, &mine));
  PetscCall(PetscCalloc1(vicinity->num_owned, &destination));
  PetscCall(PetscMemzero(mine, (size_t)vicinity->num_owned * sizeof(*mine)));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    label[v] = vicinity->input[v];
    if (!on_boundary[v]) continue;
    mine[count].number = vicinity->input[v];
    PetscCall(PetscArraycpy(mine[count++].x, vicinity->position + 3 * v, 3));
  }
  PetscCall(EqmExchangeBytes(vicinity->comm, count, sizeof(Point), destination, mine, &num_points, &point));
  PetscCall(JoinPoints(num_points, point, distance, num_joined));
  PetscCallMPI(MPI_Bcast(num_joined, 1, MPIU_INT, 0, vicinity->comm));
  PetscCall(PetscMalloc2(num_points, &number, num_points, &labels));
  for (PetscInt i = 0; i < num_points; i++) {
    number[i] = point[i].number;
    labels[i] = point[i].label;
  }
  PetscCall(EqmPutRows(vicinity->comm, vicinity->num_owned, num_points, number, MPIU_INT, 1, labels, label));
  PetscCall(PetscFree2(number, labels));
  PetscCall(PetscFree(point));
  PetscCall(PetscFree(destination));
  PetscCall(PetscFree(mine));
  PetscCall(PetscFree(on_boundary));
  PetscFunctionReturn(0);
}

/* `count` is how many vertices have been replaced by another one. Cells that the welding makes flat are removed. */
PetscErrorCode EqmStepWeld(const EqmPrepareOptions *options, EqmChange *change, EqmPreparedStep *report)
{
  const PetscInt cs = change->soup->cell_size;
  EqmVicinity vicinity;
  EqmCellList list = {.cell_size = cs};
  PetscInt *label, num_joined;
  PetscReal diameter;

  PetscFunctionBegin;
  PetscCall(EqmVicinityCreate(change->soup, &vicinity));
  PetscCall(PetscMalloc1(vicinity.num_local, &label));
  PetscCall(Diameter(&vicinity, &diameter));
  PetscCall(LabelBoundary(&vicinity, options->weld_tolerance * diameter, label, &num_joined));
  report->count = num_joined;
  if (num_joined) {
    PetscCall(PetscSFBcastBegin(vicinity.ghosts, MPIU_INT, label, label, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(vicinity.ghosts, MPIU_INT, label, label, MPI_REPLACE));
    for (PetscInt c = 0; c < vicinity.num_cells; c++) {
      PetscInt vertex[4];

      if (EqmVicinityCellOwnerVertex(&vicinity, c) >= vicinity.num_owned) continue;
      for (PetscInt a = 0; a < cs; a++) vertex[a] = label[vicinity.cells[cs * c + a]];
      if (vertex[0] == vertex[1] || vertex[1] == vertex[2] || vertex[0] == vertex[2]) continue;
      PetscCall(EqmCellListAdd(&list, vicinity.cell_input[c], vertex));
    }
    change->renumbers = PETSC_TRUE;
    PetscCall(PetscMalloc1(vicinity.num_owned, &change->vertex));
    PetscCall(PetscArraycpy(change->vertex, label, vicinity.num_owned));
    PetscCall(PetscSNPrintf(report->what, sizeof(report->what), "%" PetscInt_FMT " boundary vertices joined to others",
                            num_joined));
    PetscCall(EqmChangeAssemble(change, NULL, &list));
  }
  PetscCall(PetscFree(label));
  PetscCall(EqmVicinityReset(&vicinity));
  PetscFunctionReturn(0);
}
