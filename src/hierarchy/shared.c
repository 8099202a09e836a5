/* All shared levels, and the hierarchy on the first rank that goes on below them. */
#include "hierarchy/shared.h"
#include "base/rows.h"
#include "mesh/mesh_private.h"

/* The mesh as a source of level 0; `part` and `place` are new. */
static PetscErrorCode FromMesh(EqmMesh mesh, const PetscBool *corner, EqmSharedSource *source, unsigned char **part,
                               PetscInt **place)
{
  PetscInt end;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Scan(&mesh->num_owned_cells, &end, 1, MPIU_INT, MPI_SUM, mesh->comm));
  PetscCall(PetscMalloc1(mesh->num_owned_cells, place));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) (*place)[c] = end - mesh->num_owned_cells + c;
  PetscCall(PetscMalloc1(mesh->num_owned, part));
  for (PetscInt v = 0; v < mesh->num_owned; v++)
    (*part)[v] = !mesh->on_boundary[v] ? EQM_INSIDE : corner && corner[v] ? EQM_CORNER : EQM_ON_BOUNDARY;
  *source = (EqmSharedSource){.comm = mesh->comm,
                              .halo = mesh->halo,
                              .num_owned = mesh->num_owned,
                              .num_local = mesh->num_local,
                              .num_kept = mesh->num_vertices,
                              .position = mesh->position,
                              .number = mesh->vertex_input,
                              .part = *part,
                              .num_cells = mesh->num_owned_cells,
                              .cells = mesh->cells,
                              .weight = mesh->weight,
                              .place = *place};
  PetscFunctionReturn(0);
}

/* Weights are bounded below, so that they are not lost to rounding; the sum is one. Collective. */
static PetscErrorCode BoundWeights(EqmSharedLevel *shared)
{
  EqmHierarchyLevel *const level = &shared->level;
  const PetscReal least = 1e-12 / shared->num_cells;
  PetscReal *piece, sum;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(shared->num_pieces, &piece));
  for (PetscInt c = 0; c < level->num_cells; c++) level->weight[c] = PetscMax(level->weight[c], least);
  for (PetscInt k = 0; k < shared->num_pieces; k++) {
    for (PetscInt c = shared->cell_start[k]; c < shared->cell_start[k + 1]; c++) piece[k] += level->weight[c];
  }
  PetscCall(EqmSharedSum(shared, 1, piece, &sum));
  for (PetscInt c = 0; c < level->num_cells; c++) level->weight[c] /= sum;
  PetscCall(PetscFree(piece));
  PetscFunctionReturn(0);
}

/* A level, whole, on the first rank. Collective. */
static PetscErrorCode GatherLevel(const EqmSharedLevel *shared, EqmHierarchy hierarchy)
{
  const EqmHierarchyLevel *const from = &shared->level;
  EqmHierarchyLevel *const to = &hierarchy->level[0];
  const PetscInt n = hierarchy->rank == 0 ? shared->num_vertices : 0, m = hierarchy->rank == 0 ? shared->num_cells : 0,
                 owned = from->num_cells - shared->num_foreign_cells;
  PetscInt *corner;

  PetscFunctionBegin;
  to->num_vertices = n;
  to->num_cells = m;
  to->num_boundary = hierarchy->rank == 0 ? shared->num_boundary : 0;
  PetscCall(PetscMalloc1(3 * n, &to->position));
  PetscCall(PetscMalloc1(n, &to->part));
  PetscCall(PetscMalloc1(3 * m, &to->cells));
  PetscCall(PetscMalloc1(m, &to->weight));
  PetscCall(PetscMalloc1(3 * owned, &corner));
  for (PetscInt k = 0; k < 3 * owned; k++)
    corner[k] = EqmSharedGlobal(shared, from->cells[3 * shared->num_foreign_cells + k]);
  PetscCall(EqmFetchSlab(shared->comm, shared->num_owned, n, 0, MPIU_REAL, 3, from->position, to->position));
  PetscCall(EqmFetchSlab(shared->comm, shared->num_owned, n, 0, MPI_UNSIGNED_CHAR, 1, from->part, to->part));
  PetscCall(EqmFetchSlab(shared->comm, owned, m, 0, MPIU_INT, 3, corner, to->cells));
  PetscCall(
      EqmFetchSlab(shared->comm, owned, m, 0, MPIU_REAL, 1, from->weight + shared->num_foreign_cells, to->weight));
  PetscCall(PetscFree(corner));
  PetscFunctionReturn(0);
}

static PetscErrorCode GoOnBelow(EqmShared shared, const EqmHierarchyOptions *options, PetscInt least_boundary)
{
  const EqmSharedLevel *const last = &shared->level[shared->num_levels - 1];
  EqmHierarchy hierarchy;

  PetscFunctionBegin;
  PetscCall(PetscNew(&hierarchy));
  shared->coarser = hierarchy;
  hierarchy->comm = shared->comm;
  PetscCallMPI(MPI_Comm_rank(shared->comm, &hierarchy->rank));
  hierarchy->num_owned = last->num_owned;
  PetscCall(GatherLevel(last, hierarchy));
  PetscCall(PetscMalloc1(hierarchy->level[0].num_vertices, &hierarchy->order));
  for (PetscInt v = 0; v < hierarchy->level[0].num_vertices; v++) hierarchy->order[v] = v;
  PetscCall(EqmHierarchyMakeLevels(hierarchy, options, least_boundary));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedCreate(EqmMesh mesh, const EqmHierarchyOptions *options, EqmShared *out)
{
  const PetscInt least_boundary = EqmHierarchyLeastBoundary(mesh->num_cells, options->boundary_share);
  const PetscReal little_progress = .8;
  EqmSharedSource source;
  unsigned char *part;
  PetscInt *place;
  EqmShared shared;

  PetscFunctionBegin;
  PetscCheck(mesh->cell_size == 3, mesh->comm, EQM_ERR_USAGE, "a hierarchy is of a surface, not of a solid");
  PetscCall(PetscNew(&shared));
  shared->comm = mesh->comm;
  PetscCall(FromMesh(mesh, options->corner, &source, &part, &place));
  PetscCall(EqmSharedLevelCreate(&source, 0, options->vertices_of_piece, &shared->level[0]));
  PetscCall(PetscFree(part));
  PetscCall(PetscFree(place));
  PetscCall(BoundWeights(&shared->level[0]));
  for (shared->num_levels = 1; shared->num_levels < EQM_MOST_LEVELS; shared->num_levels++) {
    EqmSharedLevel *const level = &shared->level[shared->num_levels];
    if (level[-1].num_vertices <= options->gathered) break;
    PetscCall(EqmSharedDecimate(level - 1, options, least_boundary, shared->num_levels, level));
    if (level->num_vertices > little_progress * level[-1].num_vertices) {
      shared->num_levels++;
      break;
    }
  }
  PetscCall(GoOnBelow(shared, options, least_boundary));
  *out = shared;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedDestroy(EqmShared *shared)
{
  PetscFunctionBegin;
  if (!*shared) PetscFunctionReturn(0);
  for (PetscInt k = 0; k < (*shared)->num_levels; k++) PetscCall(EqmSharedLevelDestroy(&(*shared)->level[k]));
  PetscCall(EqmHierarchyDestroy(&(*shared)->coarser));
  PetscCall(PetscFree(*shared));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedMemory(EqmShared shared, PetscInt64 *bytes)
{
  PetscFunctionBegin;
  PetscCall(EqmHierarchyMemory(shared->coarser, bytes));
  for (PetscInt k = 0; k < shared->num_levels; k++) {
    const EqmSharedLevel *const here = &shared->level[k];
    *bytes += EqmLevelMemory(&here->level);
    *bytes += (PetscInt64)sizeof(PetscInt) * (here->level.num_vertices - here->num_owned);
    if (here->cell_order) *bytes += (PetscInt64)sizeof(PetscInt) * here->level.num_cells;
    *bytes += (PetscInt64)(sizeof(PetscSFNode) + sizeof(PetscInt)) * here->level.num_vertices; /* the star forests */
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bytes, 1, MPIU_INT64, MPI_SUM, shared->comm));
  PetscFunctionReturn(0);
}
