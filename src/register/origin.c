/* From a repaired mesh to the mesh of the file and back. */
#include "register/origin.h"
#include "mesh/mesh_private.h"
#include "base/rows.h"
#include <string.h>

static PetscInt VerticesOf(EqmSoup soup)
{
  return soup->vertex_end - soup->vertex_start;
}

static PetscInt CellsOf(EqmSoup soup)
{
  return soup->cell_end - soup->cell_start;
}

/* Barycentric coordinates in its parent of a corner that is new: the parent's centroid or the midpoint of one of its
   edges, by its position. */
static void ShareOfNew(PetscInt cs, const PetscReal *parent, const PetscReal *corner, PetscReal *share)
{
  PetscReal closest = INFINITY;

  for (PetscInt a = 0; a < cs; a++) {
    for (PetscInt b = a; b < cs; b++) { /* b = a: the centre */
      PetscReal candidate[4] = {0., 0., 0., 0.}, distance = 0.;
      for (PetscInt i = 0; i < cs; i++) candidate[i] = a == b ? 1. / cs : .5 * ((i == a) + (i == b));
      for (PetscInt k = 0; k < 3; k++) {
        PetscReal x = -corner[k];
        for (PetscInt i = 0; i < cs; i++) x += candidate[i] * parent[3 * i + k];
        distance += PetscSqr(x);
      }
      if (distance >= closest) continue;
      closest = distance;
      for (PetscInt i = 0; i < cs; i++) share[i] = candidate[i];
    }
  }
}

/* Input numbers of the vertices of local cells, in the repaired mesh's numbering. */
static PetscErrorCode NumberCorners(EqmMesh mesh, PetscInt *corner)
{
  PetscInt *input;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local, &input));
  PetscCall(PetscArraycpy(input, mesh->vertex_input, mesh->num_owned));
  PetscCall(PetscSFBcastBegin(mesh->halo, MPIU_INT, input, input + mesh->num_owned, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(mesh->halo, MPIU_INT, input, input + mesh->num_owned, MPI_REPLACE));
  for (PetscInt k = 0; k < mesh->cell_size * mesh->num_local_cells; k++) corner[k] = input[mesh->cells[k]];
  PetscCall(PetscFree(input));
  PetscFunctionReturn(0);
}

/* Barycentric coordinates of corners that are vertices of the file. `fresh`, if not NULL, gets the cells that have
   others. */
static PetscInt TakeKnownCorners(EqmOrigin o, const PetscInt *corner, const PetscInt *parent_corner, PetscInt *fresh)
{
  const PetscInt cs = o->mesh->cell_size, known = o->intake->given->num_vertices;
  PetscInt num_fresh = 0;

  for (PetscInt c = 0; c < o->mesh->num_local_cells; c++) {
    PetscBool has_new = PETSC_FALSE;
    for (PetscInt k = 0; k < cs * cs; k++) {
      const PetscInt vertex = corner[cs * c + k / cs];
      o->share[cs * cs * c + k] = vertex == parent_corner[cs * c + k % cs] ? 1. : 0.;
      has_new = (PetscBool)(has_new || vertex >= known);
    }
    if (has_new) fresh[num_fresh++] = c;
  }
  return num_fresh;
}

/* Barycentric coordinates of the new corners: for these cells the positions of the parents' vertices are fetched. */
static PetscErrorCode TakeNewCorners(EqmOrigin o, const PetscInt *corner, const PetscInt *parent_corner,
                                     PetscInt num_fresh, const PetscInt *fresh)
{
  const EqmSoup given = o->intake->given;
  const PetscInt cs = o->mesh->cell_size;
  PetscInt *wanted;
  PetscReal *position;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(cs * num_fresh, &wanted, 3 * cs * num_fresh, &position));
  for (PetscInt k = 0; k < cs * num_fresh; k++) wanted[k] = parent_corner[cs * fresh[k / cs] + k % cs];
  PetscCall(
      EqmFetchRows(given->comm, VerticesOf(given), cs * num_fresh, wanted, MPIU_REAL, 3, given->vertices, position));
  for (PetscInt k = 0; k < cs * num_fresh; k++) {
    const PetscInt at = cs * fresh[k / cs] + k % cs;
    if (corner[at] >= given->num_vertices)
      ShareOfNew(cs, position + 3 * cs * (k / cs), o->mesh->position + 3 * o->mesh->cells[at], o->share + cs * at);
  }
  PetscCall(PetscFree2(wanted, position));
  PetscFunctionReturn(0);
}

/* Vertices and coordinates of which each owned vertex is a combination, from any of the cells around it. */
static void TakeSources(EqmOrigin o, const PetscInt *parent_corner)
{
  const EqmMesh mesh = o->mesh;
  const PetscInt cs = mesh->cell_size;

  for (PetscInt k = 0; k < cs * mesh->num_local_cells; k++) {
    const PetscInt v = mesh->cells[k];
    for (PetscInt a = 0; a < cs && v < mesh->num_owned; a++) {
      o->source[cs * v + a] = parent_corner[k - k % cs + a];
      o->part[cs * v + a] = o->share[cs * k + a];
    }
  }
}

static PetscErrorCode Trace(EqmOrigin o)
{
  const EqmSoup given = o->intake->given, mapped = o->intake->mapped;
  const EqmMesh mesh = o->mesh;
  const PetscInt cs = mesh->cell_size, num = mesh->num_local_cells;
  PetscInt *corner, *parent_corner, *fresh, num_fresh;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(num + 1, &o->parent, cs * cs * num, &o->share, cs * mesh->num_owned, &o->source,
                         cs * mesh->num_owned, &o->part));
  PetscCall(PetscMalloc3(cs * num, &corner, cs * num, &parent_corner, num, &fresh));
  PetscCall(
      EqmFetchRows(mesh->comm, CellsOf(mapped), num, mesh->cell_input, MPIU_INT, 1, o->intake->parent, o->parent));
  PetscCall(EqmFetchRows(mesh->comm, CellsOf(given), num, o->parent, MPIU_INT, cs, given->cells, parent_corner));
  PetscCall(NumberCorners(mesh, corner));
  num_fresh = TakeKnownCorners(o, corner, parent_corner, fresh);
  PetscCall(TakeNewCorners(o, corner, parent_corner, num_fresh, fresh));
  TakeSources(o, parent_corner);
  PetscCall(PetscFree3(corner, parent_corner, fresh));
  PetscFunctionReturn(0);
}

/* `intake` and `mesh` must outlive it. Collective. */
PetscErrorCode EqmOriginCreate(const EqmIntake *intake, EqmMesh mesh, EqmOrigin *origin)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(origin));
  (*origin)->intake = intake;
  (*origin)->mesh = mesh;
  if (intake->mapped != intake->given) PetscCall(Trace(*origin));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmOriginDestroy(EqmOrigin *origin)
{
  PetscFunctionBegin;
  if (!*origin) PetscFunctionReturn(0);
  if ((*origin)->parent) PetscCall(PetscFree4((*origin)->parent, (*origin)->share, (*origin)->source, (*origin)->part));
  PetscCall(PetscFree(*origin));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmVerticesFromOrigin(EqmOrigin o, PetscInt width, const PetscReal *slab, PetscReal *local)
{
  const EqmSoup given = o->intake->given;
  const PetscInt cs = o->mesh->cell_size, num = o->mesh->num_owned;
  PetscReal *value;

  PetscFunctionBegin;
  if (!o->parent) {
    PetscCall(EqmMeshVerticesFromInput(o->mesh, given, width, slab, local));
    PetscFunctionReturn(0);
  }
  PetscCall(PetscMalloc1(cs * width * num, &value));
  PetscCall(EqmFetchRows(given->comm, VerticesOf(given), cs * num, o->source, MPIU_REAL, width, slab, value));
  for (PetscInt k = 0; k < width * num; k++) {
    const PetscInt v = k / width;
    local[k] = 0.;
    for (PetscInt a = 0; a < cs; a++) local[k] += o->part[cs * v + a] * value[width * (cs * v + a) + k % width];
  }
  PetscCall(PetscFree(value));
  PetscCall(EqmMeshUpdateGhosts(o->mesh, width, local));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmVerticesToOrigin(EqmOrigin o, PetscInt width, const PetscReal *owned, PetscReal *slab)
{
  const EqmSoup given = o->intake->given;
  PetscInt num = 0, *number;
  PetscReal *rows;

  PetscFunctionBegin;
  if (!o->parent) {
    PetscCall(EqmMeshVerticesToInput(o->mesh, given, width, owned, slab));
    PetscFunctionReturn(0);
  }
  PetscCall(PetscMalloc2(o->mesh->num_owned, &number, width * o->mesh->num_owned, &rows));
  for (PetscInt v = 0; v < o->mesh->num_owned; v++) {
    if (o->mesh->vertex_input[v] >= given->num_vertices) continue;
    PetscCall(PetscArraycpy(rows + width * num, owned + width * v, width));
    number[num++] = o->mesh->vertex_input[v];
  }
  PetscCall(EqmPutRows(given->comm, VerticesOf(given), num, number, MPIU_REAL, width, rows, slab));
  PetscCall(PetscFree2(number, rows));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCellsFromOrigin(EqmOrigin o, PetscInt width, const PetscReal *slab, PetscReal *owned)
{
  const EqmSoup given = o->intake->given;

  PetscFunctionBegin;
  PetscCall(EqmFetchRows(given->comm, CellsOf(given), o->mesh->num_owned_cells,
                         o->parent ? o->parent : o->mesh->cell_input, MPIU_REAL, width, slab, owned));
  PetscFunctionReturn(0);
}

/* Is an owned cell the first part of its parent? The parts of a cell are consecutive in the repaired mesh. */
static PetscErrorCode FindFirstParts(EqmOrigin o, PetscBool *is_first)
{
  const EqmSoup mapped = o->intake->mapped;
  const PetscInt num = o->mesh->num_owned_cells;
  PetscInt *before, *parent_before;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(num, &before, num, &parent_before));
  for (PetscInt c = 0; c < num; c++) before[c] = PetscMax(0, o->mesh->cell_input[c] - 1);
  PetscCall(EqmFetchRows(mapped->comm, CellsOf(mapped), num, before, MPIU_INT, 1, o->intake->parent, parent_before));
  for (PetscInt c = 0; c < num; c++)
    is_first[c] = (PetscBool)(o->mesh->cell_input[c] == 0 || parent_before[c] != o->parent[c]);
  PetscCall(PetscFree2(before, parent_before));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCellsToOrigin(EqmOrigin o, PetscInt width, const PetscReal *owned, PetscReal *slab)
{
  const EqmSoup given = o->intake->given;
  PetscInt num = 0, *number;
  PetscBool *is_first;
  PetscReal *rows;

  PetscFunctionBegin;
  if (!o->parent) {
    PetscCall(EqmMeshCellsToInput(o->mesh, given, width, owned, slab));
    PetscFunctionReturn(0);
  }
  PetscCall(PetscMalloc3(o->mesh->num_owned_cells, &number, o->mesh->num_owned_cells, &is_first,
                         width * o->mesh->num_owned_cells, &rows));
  PetscCall(FindFirstParts(o, is_first));
  for (PetscInt c = 0; c < o->mesh->num_owned_cells; c++) {
    if (!is_first[c]) continue;
    PetscCall(PetscArraycpy(rows + width * num, owned + width * c, width));
    number[num++] = o->parent[c];
  }
  PetscCall(EqmPutRows(given->comm, CellsOf(given), num, number, MPIU_REAL, width, rows, slab));
  PetscCall(PetscFree3(number, is_first, rows));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLocationInOrigin(EqmOrigin o, EqmLocation location, PetscInt *cell, PetscReal *barycentric)
{
  const PetscInt cs = location->cell_size, num = location->num;
  PetscReal *share;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(cell, location->cell, num));
  PetscCall(PetscArraycpy(barycentric, location->barycentric, cs * num));
  if (!o->parent) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(cs * cs * num, &share));
  PetscCall(PetscSFBcastBegin(location->cells, MPIU_INT, o->parent, cell, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(location->cells, MPIU_INT, o->parent, cell, MPI_REPLACE));
  PetscCall(EqmRowsToLeaves(location->cells, cs * cs, o->share, share));
  for (PetscInt k = 0; k < cs * num; k++) {
    const PetscInt i = k / cs;
    barycentric[k] = 0.;
    for (PetscInt a = 0; a < cs; a++)
      barycentric[k] += location->barycentric[cs * i + a] * share[cs * (cs * i + a) + k % cs];
  }
  PetscCall(PetscFree(share));
  PetscFunctionReturn(0);
}
