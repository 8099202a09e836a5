/* The hierarchy as a whole. */
#include "hierarchy/level.h"
#include "mesh/mesh_private.h"
#include "hierarchy/gather.h"
#include "base/quiet.h"
#include "base/rows.h"

PetscErrorCode EqmHierarchyOptionsDefault(EqmHierarchyOptions *options)
{
  PetscFunctionBegin;
  *options = (EqmHierarchyOptions){
      .ratio = 2.5, .coarsest = 4, .boundary_share = 1.5, .corner = NULL, .gathered = 20000, .vertices_of_piece = 8192};
  PetscFunctionReturn(0);
}

PetscInt EqmHierarchyLeastBoundary(PetscInt num_cells, PetscReal share)
{
  return (PetscInt)(share * 2. * PETSC_PI / PetscPowReal(12. * PETSC_PI / num_cells, 1. / 3.));
}

static PetscErrorCode MakeLevels(EqmHierarchy hierarchy, const EqmHierarchyOptions *options, PetscInt least_boundary)
{
  EqmHierarchyLevel *const level = hierarchy->level;
  const PetscReal no_progress = .95;
  PetscReal quality = .3;

  PetscFunctionBegin;
  hierarchy->num_levels = 1;
  while (hierarchy->num_levels < EQM_MOST_LEVELS && level[hierarchy->num_levels - 1].num_vertices > options->coarsest) {
    EqmHierarchyLevel *const finer = &level[hierarchy->num_levels - 1], *const coarser = finer + 1;
    PetscCall(EqmDecimate(finer, options->ratio, least_boundary, &quality, coarser));
    if (finer->num_collapses == 0) break;
    hierarchy->num_levels++;
    if (coarser->num_vertices > no_progress * finer->num_vertices) break;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHierarchyMakeLevels(EqmHierarchy hierarchy, const EqmHierarchyOptions *options,
                                      PetscInt least_boundary)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message)); /* the other ranks wait for this one */
  if (hierarchy->rank == 0) code = MakeLevels(hierarchy, options, least_boundary);
  PetscCall(PetscPopErrorHandler());
  PetscCall(EqmAgree(hierarchy->comm, code, message));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHierarchyCreate(EqmMesh mesh, const EqmHierarchyOptions *options, EqmHierarchy *out)
{
  EqmHierarchy hierarchy;

  PetscFunctionBegin;
  PetscCheck(mesh->cell_size == 3, mesh->comm, EQM_ERR_USAGE, "a hierarchy is of a surface, not of a solid");
  PetscCall(PetscNew(&hierarchy));
  hierarchy->comm = mesh->comm;
  hierarchy->rank = mesh->rank;
  hierarchy->num_owned = mesh->num_owned;
  PetscCall(EqmGatherFinest(mesh, options->corner, hierarchy));
  PetscCall(
      EqmHierarchyMakeLevels(hierarchy, options, EqmHierarchyLeastBoundary(mesh->num_cells, options->boundary_share)));
  *out = hierarchy;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelReset(EqmHierarchyLevel *level)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(level->cells));
  PetscCall(PetscFree(level->weight));
  PetscCall(PetscFree(level->position));
  PetscCall(PetscFree(level->part));
  PetscCall(PetscFree(level->finer));
  PetscCall(PetscFree(level->collapse));
  PetscCall(PetscFree(level->ring));
  PetscCall(PetscFree(level->ring_weight));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHierarchyDestroy(EqmHierarchy *hierarchy)
{
  PetscFunctionBegin;
  if (!*hierarchy) PetscFunctionReturn(0);
  for (PetscInt k = 0; k < EQM_MOST_LEVELS; k++) PetscCall(EqmLevelReset(&(*hierarchy)->level[k]));
  PetscCall(PetscFree((*hierarchy)->order));
  PetscCall(PetscFree((*hierarchy)->cell_order));
  PetscCall(PetscFree(*hierarchy));
  PetscFunctionReturn(0);
}

PetscInt64 EqmLevelMemory(const EqmHierarchyLevel *level)
{
  const size_t per_vertex = 3 * sizeof(PetscReal) + sizeof(unsigned char) + (level->finer ? sizeof(PetscInt) : 0),
               per_cell = 3 * sizeof(PetscInt) + sizeof(PetscReal), per_ring = sizeof(PetscInt) + sizeof(PetscReal);

  return (PetscInt64)(per_vertex * level->num_vertices + per_cell * level->num_cells + per_ring * level->ring_length +
                      sizeof(*level->collapse) * level->num_collapses);
}

PetscErrorCode EqmHierarchyMemory(EqmHierarchy hierarchy, PetscInt64 *bytes)
{
  PetscFunctionBegin;
  *bytes = 0;
  for (PetscInt k = 0; k < hierarchy->num_levels; k++) *bytes += EqmLevelMemory(&hierarchy->level[k]);
  if (hierarchy->num_levels > 0) *bytes += (PetscInt64)sizeof(PetscInt) * hierarchy->level[0].num_vertices;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHierarchyGather(EqmHierarchy hierarchy, PetscInt width, const PetscReal *owned, PetscReal *finest)
{
  const PetscInt n = hierarchy->rank == 0 ? hierarchy->level[0].num_vertices : 0;

  PetscFunctionBegin;
  PetscCall(EqmFetchRows(hierarchy->comm, hierarchy->num_owned, n, hierarchy->order, MPIU_REAL, width, owned, finest));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHierarchyScatter(EqmHierarchy hierarchy, PetscInt width, const PetscReal *finest, PetscReal *owned)
{
  const PetscInt n = hierarchy->rank == 0 ? hierarchy->level[0].num_vertices : 0;

  PetscFunctionBegin;
  PetscCall(EqmPutRows(hierarchy->comm, hierarchy->num_owned, n, hierarchy->order, MPIU_REAL, width, finest, owned));
  PetscFunctionReturn(0);
}

PetscReal EqmLevelWorstQuality(const EqmHierarchyLevel *level)
{
  PetscReal worst = 1., normal[3];

  for (PetscInt c = 0; c < level->num_cells; c++) {
    const PetscInt *const v = level->cells + 3 * c;
    worst = PetscMin(worst, EqmTriangleQuality(level->position + 3 * v[0], level->position + 3 * v[1],
                                               level->position + 3 * v[2], normal));
  }
  return worst;
}
