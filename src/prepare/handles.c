/* Cut small handles, the topological noise of scans (Guskov and Wood 2001), along a short loop each, and fill both
   sides. The whole mesh is gathered on rank 0 for it, so this is for meshes of a limited size. */
#include "prepare/step.h"
#include "mesh/soup_private.h"
#include "mesh/handles.h"
#include "base/sort.h"
#include <string.h>

/* A mesh that is being cut: more cells and vertices than at first. */
typedef struct {
  EqmSerialMesh mesh;
  PetscInt num_kept_vertices, num_kept_cells;
  PetscInt *place; /* in the loop, per vertex; -1 elsewhere */
} Surgery;

/* The diameter of the bounding box of the vertices in use. */
static PetscReal Diameter(const EqmSerialMesh *mesh)
{
  PetscReal low[3] = {PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL};
  PetscReal high[3] = {-PETSC_MAX_REAL, -PETSC_MAX_REAL, -PETSC_MAX_REAL}, squares = 0.;

  for (PetscInt k = 0; k < 3 * mesh->num_cells; k++) {
    for (int c = 0; c < 3 && mesh->cells[k] >= 0 && mesh->cells[k] < mesh->num_vertices; c++) {
      low[c] = PetscMin(low[c], mesh->vertices[3 * mesh->cells[k] + c]);
      high[c] = PetscMax(high[c], mesh->vertices[3 * mesh->cells[k] + c]);
    }
  }
  for (int c = 0; c < 3; c++) squares += PetscSqr(high[c] - low[c]);
  return PetscSqrtReal(squares);
}

static PetscReal LoopLength(const EqmSerialMesh *mesh, PetscInt n, const PetscInt *loop)
{
  PetscReal length = 0.;

  for (PetscInt k = 0; k < n; k++) {
    const PetscReal *const x = mesh->vertices + 3 * loop[k], *const y = mesh->vertices + 3 * loop[(k + 1) % n];
    length += PetscSqrtReal(PetscSqr(x[0] - y[0]) + PetscSqr(x[1] - y[1]) + PetscSqr(x[2] - y[2]));
  }
  return length;
}

/* The corners at the loop's vertices, grouped by vertex: start[i] .. in `corner`, places in mesh->cells. */
static PetscErrorCode CollectCorners(const Surgery *s, PetscInt n, PetscInt **start, PetscInt **corner)
{
  const PetscInt num = 3 * s->mesh.num_cells;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n + 2, start));
  for (PetscInt k = 0; k < num; k++) {
    const PetscInt v = s->mesh.cells[k];
    if (v >= 0 && v < s->mesh.num_vertices && s->place[v] >= 0) (*start)[s->place[v] + 2]++;
  }
  for (PetscInt i = 0; i < n; i++) (*start)[i + 2] += (*start)[i + 1];
  PetscCall(PetscMalloc1((*start)[n + 1], corner));
  for (PetscInt k = 0; k < num; k++) {
    const PetscInt v = s->mesh.cells[k];
    if (v >= 0 && v < s->mesh.num_vertices && s->place[v] >= 0) (*corner)[(*start)[s->place[v] + 1]++] = k;
  }
  PetscFunctionReturn(0);
}

/* The corners on the left of the loop: around each vertex from the next one counterclockwise to the one before. False
   if a star has a boundary edge there. */
static PetscErrorCode FindLeft(const Surgery *s, PetscInt n, const PetscInt *loop, PetscInt *num_left, PetscInt **left,
                               PetscBool *found)
{
  PetscInt *start, *corner;

  PetscFunctionBegin;
  PetscCall(CollectCorners(s, n, &start, &corner));
  PetscCall(PetscMalloc1(start[n], left));
  *num_left = 0;
  *found = PETSC_TRUE;
  for (PetscInt i = 0; i < n && *found; i++) {
    const PetscInt before = loop[(i + n - 1) % n];
    PetscInt next = loop[(i + 1) % n];

    for (PetscInt step = start[i]; next != before && *found; step++) {
      PetscInt k = start[i];

      while (k < start[i + 1] && s->mesh.cells[corner[k] - corner[k] % 3 + (corner[k] + 1) % 3] != next) k++;
      *found = (PetscBool)(k < start[i + 1] && step < start[i + 1]);
      if (!*found) break;
      (*left)[(*num_left)++] = corner[k];
      next = s->mesh.cells[corner[k] - corner[k] % 3 + (corner[k] + 2) % 3];
    }
  }
  PetscCall(PetscFree(start));
  PetscCall(PetscFree(corner));
  PetscFunctionReturn(0);
}

/* Edges between vertices of the loop that are not on it, as pairs of positions, ascending. */
static PetscErrorCode FindChords(const Surgery *s, PetscInt n, PetscInt *num_chords, PetscInt (**chord)[2])
{
  PetscInt count = 0;

  PetscFunctionBegin;
  for (int pass = 0; pass < 2; pass++) {
    if (pass) PetscCall(PetscMalloc1(count, chord));
    count = 0;
    for (PetscInt k = 0; k < 3 * s->mesh.num_cells; k++) {
      const PetscInt v = s->mesh.cells[k], w = s->mesh.cells[k - k % 3 + (k + 1) % 3];
      PetscInt a, b;

      if (v < 0 || w < 0 || v >= s->mesh.num_vertices || w >= s->mesh.num_vertices) continue;
      a = PetscMin(s->place[v], s->place[w]);
      b = PetscMax(s->place[v], s->place[w]);
      if (a < 0 || b - a == 1 || b - a == n - 1) continue;
      if (pass) {
        (*chord)[count][0] = a;
        (*chord)[count][1] = b;
      }
      count++;
    }
  }
  EqmSort(*chord, (size_t)count, sizeof(**chord), EqmComparePairs);
  *num_chords = count;
  PetscFunctionReturn(0);
}

/* Add the new vertices and triangles of a patch whose boundary vertices are `ring`; grows the arrays. */
static PetscErrorCode AddPatch(Surgery *s, PetscInt n, const PetscInt *ring, PetscInt num_chords,
                               const PetscInt (*chord)[2])
{
  EqmSerialMesh *const mesh = &s->mesh;
  PetscReal *position;
  EqmPatch patch;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * n, &position));
  for (PetscInt k = 0; k < n; k++) PetscCall(PetscArraycpy(position + 3 * k, mesh->vertices + 3 * ring[k], 3));
  PetscCall(EqmPatchCreate(n, position, num_chords, chord, &patch));
  PetscCall(EqmPatchRefine(num_chords, chord, &patch));
  PetscCall(PetscRealloc((size_t)(3 * (mesh->num_vertices + patch.num_vertices)) * sizeof(PetscReal), &mesh->vertices));
  PetscCall(PetscRealloc((size_t)(3 * (mesh->num_cells + patch.num_triangles)) * sizeof(PetscInt), &mesh->cells));
  PetscCall(
      PetscArraycpy(mesh->vertices + 3 * mesh->num_vertices, patch.position + 3 * n, 3 * (patch.num_vertices - n)));
  for (PetscInt k = 0; k < 3 * patch.num_triangles; k++) {
    const PetscInt v = patch.triangle[k];
    mesh->cells[3 * mesh->num_cells + k] = v < n ? ring[v] : mesh->num_vertices + v - n;
  }
  mesh->num_vertices += patch.num_vertices - n;
  mesh->num_cells += patch.num_triangles;
  PetscCall(EqmPatchReset(&patch));
  PetscCall(PetscFree(position));
  PetscFunctionReturn(0);
}

/* Copies of the loop's vertices for the left side, and a patch on either side. */
static PetscErrorCode CutAndFill(Surgery *s, PetscInt n, const PetscInt *loop, PetscInt num_left, const PetscInt *left)
{
  EqmSerialMesh *const mesh = &s->mesh;
  const PetscInt first = mesh->num_vertices;
  PetscInt *ring, num_chords, (*chord)[2];

  PetscFunctionBegin;
  PetscCall(FindChords(s, n, &num_chords, &chord));
  PetscCall(PetscRealloc((size_t)(3 * (first + n)) * sizeof(PetscReal), &mesh->vertices));
  for (PetscInt k = 0; k < n; k++)
    PetscCall(PetscArraycpy(mesh->vertices + 3 * (first + k), mesh->vertices + 3 * loop[k], 3));
  for (PetscInt k = 0; k < num_left; k++) mesh->cells[left[k]] = first + s->place[mesh->cells[left[k]]];
  mesh->num_vertices += n;
  PetscCall(AddPatch(s, n, loop, num_chords, (const PetscInt(*)[2])chord));
  PetscCall(PetscMalloc1(n, &ring));
  for (PetscInt k = 0; k < n; k++) ring[k] = first + n - 1 - k;
  for (PetscInt k = 0; k < num_chords; k++) {
    const PetscInt low = chord[k][0];
    chord[k][0] = n - 1 - chord[k][1];
    chord[k][1] = n - 1 - low;
  }
  EqmSort(chord, (size_t)num_chords, sizeof(*chord), EqmComparePairs);
  PetscCall(AddPatch(s, n, ring, num_chords, (const PetscInt(*)[2])chord));
  PetscCall(PetscFree(ring));
  PetscCall(PetscFree(chord));
  PetscFunctionReturn(0);
}

/* Cut handles one after the other, while their loops are short and away from the boundary. Not collective. */
static PetscErrorCode CutHandles(PetscReal share, Surgery *s, PetscInt64 *cut)
{
  const PetscReal limit = share * Diameter(&s->mesh);
  PetscBool again = PETSC_TRUE;

  PetscFunctionBegin;
  while (again) {
    PetscInt n, *loop, num_left = 0, *left = NULL;

    PetscCall(EqmHandleFind(&s->mesh, &n, &loop));
    again = (PetscBool)(n > 0 && LoopLength(&s->mesh, n, loop) <= limit);
    PetscCall(PetscMalloc1(s->mesh.num_vertices, &s->place));
    for (PetscInt v = 0; v < s->mesh.num_vertices; v++) s->place[v] = -1;
    for (PetscInt k = 0; k < n; k++) s->place[loop[k]] = k;
    if (again) PetscCall(FindLeft(s, n, loop, &num_left, &left, &again));
    if (again) PetscCall(CutAndFill(s, n, loop, num_left, left));
    *cut += again;
    PetscCall(PetscFree(left));
    PetscCall(PetscFree(s->place));
    PetscCall(PetscFree(loop));
  }
  PetscFunctionReturn(0);
}

/* Output the changed mesh: cells to the list, added vertices to the group. */
static PetscErrorCode ListMesh(const Surgery *s, EqmVertexGroup *group, EqmCellList *list)
{
  PetscFunctionBegin;
  for (PetscInt c = 0; c < s->mesh.num_cells; c++) {
    PetscCall(EqmCellListAdd(list, c < s->num_kept_cells ? c : -1, s->mesh.cells + 3 * c));
  }
  group->num_local = s->mesh.num_vertices - s->num_kept_vertices;
  group->position = s->mesh.vertices + 3 * s->num_kept_vertices;
  PetscFunctionReturn(0);
}

/* `count` is of handles. */
PetscErrorCode EqmStepHandles(const EqmPrepareOptions *options, EqmChange *change, EqmPreparedStep *report)
{
  EqmVertexGroup group = {0};
  EqmCellList list = {.cell_size = 3};
  EqmDiagnosis diagnosis;
  Surgery surgery = {.num_kept_vertices = change->soup->num_vertices, .num_kept_cells = change->soup->num_cells};
  PetscMPIInt rank;

  PetscFunctionBegin;
  if (change->soup->cell_size != 3 || change->soup->num_cells > EQM_MOST_CELLS_FOR_HANDLES) PetscFunctionReturn(0);
  PetscCall(EqmSoupDiagnose(change->soup, &diagnosis));
  if (diagnosis.genus <= 0) PetscFunctionReturn(0);
  PetscCallMPI(MPI_Comm_rank(change->soup->comm, &rank));
  PetscCall(EqmSoupGather(change->soup, &surgery.mesh));
  if (rank == 0) PetscCall(CutHandles(options->handle_length, &surgery, &report->count));
  PetscCallMPI(MPI_Bcast(&report->count, 1, MPIU_INT64, 0, change->soup->comm));
  if (report->count) {
    if (rank == 0) PetscCall(ListMesh(&surgery, &group, &list));
    PetscCall(PetscSNPrintf(report->what, sizeof(report->what),
                            "%" PetscInt64_FMT " of %" PetscInt64_FMT " cut and filled", report->count,
                            diagnosis.genus));
    PetscCall(EqmChangeAssemble(change, &group, &list));
  }
  PetscCall(EqmSerialMeshReset(&surgery.mesh));
  PetscFunctionReturn(0);
}
