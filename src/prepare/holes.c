/* Fill holes: boundary loops are gathered on one rank and filled there one by one. */
#include "prepare/loops.h"
#include "mesh/target.h"

/* Fill one loop: its triangles go to the list, its new vertices to the group. The hole is on the left of the loop
   backwards. */
static PetscErrorCode FillLoop(const EqmBoundary *boundary, PetscInt l, PetscInt num_kept, PetscInt *place,
                               PetscInt (*chord)[2], EqmVertexGroup *group, EqmCellList *list)
{
  const PetscInt start = boundary->loop_start[l], n = boundary->loop_start[l + 1] - start;
  PetscInt *loop, num_chords, num_added;
  PetscReal *position;
  EqmPatch patch;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &loop, 3 * n, &position));
  for (PetscInt k = 0; k < n; k++) {
    loop[k] = boundary->order[start + n - 1 - k];
    PetscCall(PetscArraycpy(position + 3 * k, boundary->edge[loop[k]].x, 3));
  }
  PetscCall(EqmBoundaryChords(boundary, n, loop, place, &num_chords, chord));
  PetscCall(EqmPatchCreate(n, position, num_chords, (const PetscInt(*)[2])chord, &patch));
  PetscCall(EqmPatchRefine(num_chords, (const PetscInt(*)[2])chord, &patch));
  num_added = patch.num_vertices - n;
  PetscCall(PetscRealloc((size_t)(3 * (group->num_local + num_added)) * sizeof(PetscReal), &group->position));
  PetscCall(PetscArraycpy(group->position + 3 * group->num_local, patch.position + 3 * n, 3 * num_added));
  for (PetscInt t = 0; t < patch.num_triangles; t++) {
    PetscInt vertex[3];

    for (int a = 0; a < 3; a++) {
      const PetscInt v = patch.triangle[3 * t + a];
      vertex[a] = v < n ? boundary->edge[boundary->same[loop[v]]].tail : num_kept + group->num_local + v - n;
    }
    PetscCall(EqmCellListAdd(list, -1, vertex));
  }
  group->num_local += num_added;
  PetscCall(EqmPatchReset(&patch));
  PetscCall(PetscFree2(loop, position));
  PetscFunctionReturn(0);
}

/* Fill the loops that rank 0 has; on the others there are none. */
static PetscErrorCode FillLoops(PetscBool all, PetscInt num_kept, EqmBoundary *boundary, EqmVertexGroup *group,
                                EqmCellList *list, PetscInt64 *filled)
{
  PetscInt *place, (*chord)[2];

  PetscFunctionBegin;
  PetscCall(EqmBoundaryCutLoops(all ? -1 : EqmBoundaryLongestLoop(boundary), boundary));
  PetscCall(PetscMalloc2(boundary->num_edges, &place, boundary->num_chords, &chord));
  for (PetscInt e = 0; e < boundary->num_edges; e++) place[e] = -1;
  for (PetscInt l = 0; l < boundary->num_loops; l++) {
    PetscCall(FillLoop(boundary, l, num_kept, place, chord, group, list));
    ++*filled;
  }
  PetscCall(PetscFree2(place, chord));
  PetscFunctionReturn(0);
}

/* Share the joined vertices with all ranks: number[i] was joined to other[i], ascending. They are few. */
static PetscErrorCode ShareJoined(MPI_Comm comm, const EqmBoundary *boundary, PetscInt *num_joined, PetscInt **number,
                                  PetscInt **other)
{
  PetscInt count = 0;
  PetscMPIInt items;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < boundary->num_edges; e++) count += boundary->same[e] != e;
  PetscCallMPI(MPI_Bcast(&count, 1, MPIU_INT, 0, comm));
  PetscCall(PetscMPIIntCast(count, &items));
  PetscCall(PetscMalloc2(count, number, count, other));
  for (PetscInt e = 0, k = 0; e < boundary->num_edges; e++) { /* ascending by tail */
    if (boundary->same[e] == e) continue;
    (*number)[k] = boundary->edge[e].tail;
    (*other)[k++] = boundary->edge[boundary->same[e]].tail;
  }
  PetscCallMPI(MPI_Bcast(*number, items, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(*other, items, MPIU_INT, 0, comm));
  *num_joined = count;
  PetscFunctionReturn(0);
}

/* List all cells of the mesh, with the numbers of joined vertices replaced. */
static PetscErrorCode KeepCells(const EqmBoundary *boundary, EqmChange *change, EqmCellList *list)
{
  const EqmSoup soup = change->soup;
  PetscInt num_joined, *number, *other;

  PetscFunctionBegin;
  PetscCall(ShareJoined(soup->comm, boundary, &num_joined, &number, &other));
  for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) {
    PetscInt vertex[3];

    for (PetscInt a = 0; a < 3; a++) {
      PetscInt k;
      vertex[a] = soup->cells[3 * (c - soup->cell_start) + a];
      PetscCall(PetscFindInt(vertex[a], num_joined, number, &k));
      if (k >= 0) vertex[a] = other[k];
    }
    PetscCall(EqmCellListAdd(list, c, vertex));
  }
  PetscCall(EqmChangeRenumber(change, num_joined, number, other));
  PetscCall(PetscFree2(number, other));
  PetscFunctionReturn(0);
}

/* `count` is of loops. All are filled for a target that takes closed surfaces only, else all but the longest. */
PetscErrorCode EqmStepHoles(const EqmPrepareOptions *options, EqmChange *change, EqmPreparedStep *report)
{
  const EqmTarget *const target = options->target ? EqmTargetFind(options->target) : NULL;
  const PetscBool all = (PetscBool)(target && !target->domain[EQM_TOPOLOGY_DISK]);
  const PetscInt num_kept = change->soup->num_vertices;
  EqmVicinity vicinity;
  EqmVertexGroup group = {0};
  EqmCellList list = {.cell_size = 3};
  EqmBoundary boundary = {0};
  PetscInt64 count[3] = {0, 0, 0}; /* loops, triangles, vertices */

  PetscFunctionBegin;
  if (change->soup->cell_size == 4) {
    PetscCall(EqmFillCavities(options, change, report));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmVicinityCreate(change->soup, &vicinity));
  PetscCall(EqmBoundaryGather(&vicinity, &boundary));
  PetscCall(EqmVicinityReset(&vicinity));
  PetscCall(EqmBoundaryChain(&boundary));
  PetscCall(FillLoops(all, num_kept, &boundary, &group, &list, &count[0]));
  count[1] = list.count;
  count[2] = group.num_local;
  PetscCallMPI(MPI_Bcast(count, 3, MPIU_INT64, 0, change->soup->comm));
  report->count = count[0];
  if (count[0]) {
    PetscCall(KeepCells(&boundary, change, &list));
    PetscCall(PetscSNPrintf(report->what, sizeof(report->what),
                            "%" PetscInt64_FMT " filled with %" PetscInt64_FMT " triangles and %" PetscInt64_FMT
                            " new vertices",
                            count[0], count[1], count[2]));
    PetscCall(EqmChangeAssemble(change, &group, &list));
    PetscCall(EqmChangeWeighAdded(change, options->hole_weight));
  }
  PetscCall(PetscFree(group.position));
  PetscCall(EqmBoundaryReset(&boundary));
  PetscFunctionReturn(0);
}
