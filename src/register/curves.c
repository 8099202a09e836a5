/* Feature curves as landmarks (000 figure 6): polylines of vertices on A and on B. Each vertex of a curve of A goes to
   the point at the same part of the length of B's curve of the same number. */
#include "register/registration.h"
#include "format/table.h"
#include "mesh/gather.h"
#include "mesh/mesh_private.h"

/* The curves of one mesh, on every rank, as their file lists them. */
typedef struct {
  PetscInt num, *curve, *vertex;
  PetscReal *at; /* length from the curve's first vertex over that of the whole curve */
  PetscReal *position;
} Curves;

static PetscErrorCode Reset(Curves *curves)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(curves->curve, curves->vertex, curves->at, curves->position));
  PetscFunctionReturn(0);
}

/* The lines of a file, which must be whole numbers. */
static PetscErrorCode Read(EqmRegistration r, const EqmSide *side, const char *file, Curves *curves)
{
  EqmTable table;
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(EqmTableRead(r->comm, file, 2, 2,
                         "a line of a curve is the curve's number and a vertex, in their order along the curve",
                         &table));
  PetscCall(PetscMPIIntCast(2 * table.rows, &count));
  if (side->mesh->rank != 0) PetscCall(PetscMalloc1(2 * table.rows, &table.values));
  PetscCallMPI(MPI_Bcast(table.values, count, MPIU_REAL, 0, r->comm));
  curves->num = table.rows;
  PetscCall(PetscMalloc4(table.rows, &curves->curve, table.rows, &curves->vertex, table.rows, &curves->at,
                         3 * table.rows, &curves->position));
  for (PetscInt k = 0; k < table.rows; k++) {
    const PetscReal curve = table.values[2 * k], vertex = table.values[2 * k + 1];
    if (!(curve >= 0. && curve < 1e9 && curve == PetscFloorReal(curve)))
      EqmFail(r->comm, EQM_ERR_USAGE, "%s, line %" PetscInt_FMT ": curve %g; curves are numbered from 0", file, k + 2,
              (double)curve);
    if (!(vertex >= 0. && vertex < side->soup->num_vertices && vertex == PetscFloorReal(vertex)))
      EqmFail(r->comm, EQM_ERR_USAGE, "%s, line %" PetscInt_FMT ": vertex %g of %s, which has 0 to %" PetscInt_FMT,
              file, k + 2, (double)vertex, side->name, side->soup->num_vertices - 1);
    curves->curve[k] = (PetscInt)curve;
    curves->vertex[k] = (PetscInt)vertex;
  }
  PetscCall(PetscFree(table.values));
  PetscFunctionReturn(0);
}

/* Positions, and parts of the length. The lines of a curve stand together. */
static PetscErrorCode Measure(EqmRegistration r, const EqmSide *side, const char *file, Curves *curves)
{
  PetscInt *inside;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(curves->num, &inside));
  PetscCall(EqmSideCheckVertices(side, curves->num, curves->vertex, inside));
  PetscCall(PetscFree(inside));
  PetscCall(
      EqmMeshGatherVertices(side->mesh, curves->num, curves->vertex, 3, side->mesh->position, curves->position, NULL));
  for (PetscInt first = 0, next; first < curves->num; first = next) {
    PetscReal length = 0.;
    for (next = first; next < curves->num && curves->curve[next] == curves->curve[first]; next++) {
      const PetscReal *const p = curves->position + 3 * next;
      if (next > first)
        length += PetscSqrtReal(PetscSqr(p[0] - p[-3]) + PetscSqr(p[1] - p[-2]) + PetscSqr(p[2] - p[-1]));
      curves->at[next] = length;
    }
    if (!(length > 0.))
      EqmFail(r->comm, EQM_ERR_USAGE, "%s: curve %" PetscInt_FMT " has no length; give two vertices or more", file,
              curves->curve[first]);
    for (PetscInt k = first; k < next; k++) curves->at[k] /= length;
  }
  PetscFunctionReturn(0);
}

/* The point of a curve of B at a part of its length; false where there is no such curve. */
static PetscBool PointAt(const Curves *b, PetscInt curve, PetscReal at, PetscReal point[3])
{
  for (PetscInt k = 0; k + 1 < b->num; k++) {
    if (b->curve[k] != curve || b->curve[k + 1] != curve || b->at[k + 1] < at) continue;
    const PetscReal length = b->at[k + 1] - b->at[k], t = length > 0. ? (at - b->at[k]) / length : 0.;
    for (PetscInt c = 0; c < 3; c++) point[c] = (1. - t) * b->position[3 * k + c] + t * b->position[3 * (k + 1) + c];
    return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* The landmarks that there are already, as points of B; the lists get room for `more`. */
static PetscErrorCode MakePoints(EqmRegistration r, PetscInt more, EqmLandmarkList *longer)
{
  const EqmLandmarkList *const list = &r->landmarks;
  const PetscInt room = list->num + more;
  PetscInt *vertices;

  PetscFunctionBegin;
  if (list->num > 0 && list->width == 2)
    EqmFail(r->comm, EQM_ERR_USAGE, "with curves landmarks are vertices or points of B, not of the target");
  *longer = *list;
  longer->width = 3;
  longer->has_curves = PETSC_TRUE;
  PetscCall(PetscMalloc4(room, &longer->vertex, 3 * room, &longer->other, room, &longer->weight, room, &longer->curve));
  PetscCall(PetscArraycpy(longer->vertex, list->vertex, list->num));
  PetscCall(PetscArraycpy(longer->weight, list->weight, list->num));
  PetscCall(PetscArraycpy(longer->curve, list->curve, list->num));
  if (list->width == 3) PetscCall(PetscArraycpy(longer->other, list->other, 3 * list->num));
  if (list->width != 1) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(list->num, &vertices));
  for (PetscInt k = 0; k < list->num; k++) vertices[k] = (PetscInt)list->other[k];
  PetscCall(EqmMeshGatherVertices(r->b.mesh, list->num, vertices, 3, r->b.mesh->position, longer->other, NULL));
  PetscCall(PetscFree(vertices));
  PetscFunctionReturn(0);
}

/* A vertex is one landmark: where curves cross, and on landmarks, the first is taken. */
static PetscBool IsListed(const EqmLandmarkList *list, PetscInt vertex)
{
  for (PetscInt k = 0; k < list->num; k++) {
    if (list->vertex[k] == vertex) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static PetscErrorCode Append(EqmRegistration r, const Curves *a, const Curves *b)
{
  EqmLandmarkList list;

  PetscFunctionBegin;
  PetscCall(MakePoints(r, a->num, &list));
  for (PetscInt k = 0; k < a->num; k++) {
    if (IsListed(&list, a->vertex[k])) continue;
    if (!PointAt(b, a->curve[k], a->at[k], list.other + 3 * list.num))
      EqmFail(r->comm, EQM_ERR_USAGE, "%s has a curve %" PetscInt_FMT ", %s has none of that number", r->set.curves_a,
              a->curve[k], r->set.curves_b);
    list.vertex[list.num] = a->vertex[k];
    list.weight[list.num] = 1.;
    list.curve[list.num] = a->curve[k];
    list.num++;
  }
  PetscCall(EqmLandmarkListReset(&r->landmarks));
  r->landmarks = list;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmAddCurves(EqmRegistration r)
{
  Curves a = {0}, b = {0};

  PetscFunctionBegin;
  if (!r->set.curves_a[0] && !r->set.curves_b[0]) PetscFunctionReturn(0);
  if (!r->set.curves_a[0] || !r->set.curves_b[0] || r->bare)
    EqmFail(r->comm, EQM_ERR_USAGE, "-curves_a and -curves_b belong together, one file for each of two meshes");
  if (r->set.points == EQM_POINTS_TARGET)
    EqmFail(r->comm, EQM_ERR_USAGE, "with curves landmarks are vertices or points of B, not of the target");
  r->set.points = EQM_POINTS_SURFACE;
  PetscCall(Read(r, &r->a, r->set.curves_a, &a));
  PetscCall(Read(r, &r->b, r->set.curves_b, &b));
  PetscCall(Measure(r, &r->a, r->set.curves_a, &a));
  PetscCall(Measure(r, &r->b, r->set.curves_b, &b));
  PetscCall(Append(r, &a, &b));
  PetscCall(Reset(&a));
  PetscCall(Reset(&b));
  PetscFunctionReturn(0);
}
