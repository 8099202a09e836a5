/* The map of a repaired mesh, brought back onto the mesh that the user gave. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "base/rows.h"

/* Copy `width` reals per vertex from the slabs of the repaired soup to those of the input, whose vertices kept their
   numbers or have another one in `vertex`. Collective. */
static PetscErrorCode FetchVertices(EqmSoup repaired, EqmSoup input, const PetscInt *vertex, PetscInt width,
                                    const PetscReal *from, PetscReal *to)
{
  const PetscInt num_slab = repaired->vertex_end - repaired->vertex_start;
  const PetscInt count = input->vertex_end - input->vertex_start;

  PetscFunctionBegin;
  if (vertex)
    PetscCall(EqmFetchRows(repaired->comm, num_slab, count, vertex, MPIU_REAL, width, from, to));
  else
    PetscCall(EqmFetchSlab(repaired->comm, num_slab, count, input->vertex_start, MPIU_REAL, width, from, to));
  PetscFunctionReturn(0);
}

/* The value of an input cell is the weighted mean of those of its children. Collective. */
static PetscErrorCode GatherMeans(EqmMap repaired, const PetscInt *parent, const PetscReal *weight,
                                  const PetscReal *value, EqmMap map, PetscReal *mean)
{
  const PetscInt num_children = repaired->soup->cell_end - repaired->soup->cell_start;
  const PetscInt num_cells = map->soup->cell_end - map->soup->cell_start;
  PetscInt num_leaves = 0, *input_cell;
  PetscReal *product, *share, *value_sum, *weight_sum;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(num_children, &input_cell, num_children, &product, num_children, &share));
  PetscCall(PetscCalloc2(num_cells, &value_sum, num_cells, &weight_sum));
  for (PetscInt c = 0; c < num_children; c++) {
    if (parent[c] < 0) continue;
    input_cell[num_leaves] = parent[c];
    product[num_leaves] = weight[c] * value[c];
    share[num_leaves++] = weight[c];
  }
  PetscCall(EqmRowsCreateSF(map->soup->comm, num_cells, num_leaves, input_cell, &sf));
  PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, product, value_sum, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, product, value_sum, MPIU_SUM));
  PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, share, weight_sum, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, share, weight_sum, MPIU_SUM));
  for (PetscInt c = 0; c < num_cells; c++) mean[c] = weight_sum[c] > 0. ? value_sum[c] / weight_sum[c] : 1.;
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscFree3(input_cell, product, share));
  PetscCall(PetscFree2(value_sum, weight_sum));
  PetscFunctionReturn(0);
}

/* How the run went, its figures included. The arrays that a program added are in the numbering of the repaired mesh:
   they stay there. */
static PetscErrorCode CopyRun(EqmMap from, EqmMap to)
{
  PetscFunctionBegin;
  to->in_space = from->in_space;
  to->distortion = from->distortion;
  to->energy_initial = from->energy_initial;
  to->energy_final = from->energy_final;
  to->iterations = from->iterations;
  to->num_history = from->num_history;
  PetscCall(PetscMalloc1(from->num_history, &to->history));
  PetscCall(PetscArraycpy(to->history, from->history, from->num_history));
  PetscCall(EqmMapSetStatus(to, from->status, from->message));
  to->poor = from->poor;
  PetscCall(EqmMapSetCommand(to, from->command));
  PetscCall(PetscStrncpy(to->method, from->method, sizeof(to->method)));
  PetscCall(PetscStrncpy(to->linear_solver, from->linear_solver, sizeof(to->linear_solver)));
  to->cost = from->cost;
  to->num_boundary_vertices = from->num_boundary_vertices;
  to->boundary_folds = from->boundary_folds;
  if (from->num_hessian_eigenvalues)
    PetscCall(EqmMapSetHessianEigenvalues(to, from->num_hessian_eigenvalues, from->hessian_eigenvalues));
  to->num_figures = from->num_figures;
  PetscCall(PetscMalloc1(from->num_figures, &to->figures));
  PetscCall(PetscArraycpy(to->figures, from->figures, from->num_figures));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapOntoInput(EqmMap repaired, EqmSoup input, const PetscInt *parent, const PetscInt *vertex,
                               const PetscReal *cell_weight, EqmMap *map)
{
  PetscFunctionBegin;
  PetscCall(EqmMapCreate(input, repaired->dim, map));
  PetscCall(CopyRun(repaired, *map));
  PetscCall(FetchVertices(repaired->soup, input, vertex, repaired->dim, repaired->coordinates, (*map)->coordinates));
  PetscCall(FetchVertices(repaired->soup, input, vertex, 1, repaired->vertex_ratio, (*map)->vertex_ratio));
  PetscCall(GatherMeans(repaired, parent, cell_weight, repaired->cell_ratio, *map, (*map)->cell_ratio));
  if (input->cell_size == 3) {
    PetscCall(FetchVertices(repaired->soup, input, vertex, 1, repaired->conformal_factor, (*map)->conformal_factor));
    PetscCall(GatherMeans(repaired, parent, cell_weight, repaired->quasi_conformal, *map, (*map)->quasi_conformal));
  }
  (*map)->repaired = repaired;
  (*map)->parent = parent;
  PetscFunctionReturn(0);
}
