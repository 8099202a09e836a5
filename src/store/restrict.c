/* The map of a mended mesh, brought back onto the mesh that the user gave. */
#include <equimap/map.h>
#include "base/rows.h"

/* Copy `width` reals per vertex from the slabs of the mended soup to those of the input, whose vertices kept their
   numbers. Collective. */
static PetscErrorCode FetchVertices(EqmSoup mended, EqmSoup input, PetscInt width, const PetscReal *from, PetscReal *to)
{
  const PetscInt count = input->vertex_end - input->vertex_start;

  PetscFunctionBegin;
  PetscCall(EqmFetchSlab(mended->comm, mended->vertex_end - mended->vertex_start, count, input->vertex_start, MPIU_REAL,
                         width, from, to));
  PetscFunctionReturn(0);
}

/* The value of an input cell is the mean of its children's, weighted: of ratios, their image over their measure.
 * Collective. */
static PetscErrorCode GatherMeans(EqmMap mended, const PetscInt *parent, const PetscReal *weight,
                                  const PetscReal *value, EqmMap map, PetscReal *mean)
{
  const PetscInt num_children = mended->soup->cell_end - mended->soup->cell_start;
  const PetscInt num_cells = map->soup->cell_end - map->soup->cell_start;
  PetscReal *product, *value_sum, *weight_sum;
  PetscLayout layout;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num_children, &product));
  PetscCall(PetscCalloc2(num_cells, &value_sum, num_cells, &weight_sum));
  for (PetscInt c = 0; c < num_children; c++) product[c] = weight[c] * value[c];
  PetscCall(PetscLayoutCreateFromSizes(map->soup->comm, num_cells, map->soup->num_cells, 1, &layout));
  PetscCall(PetscSFCreate(map->soup->comm, &sf));
  PetscCall(PetscSFSetGraphLayout(sf, layout, num_children, NULL, PETSC_COPY_VALUES, parent));
  PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, product, value_sum, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, product, value_sum, MPIU_SUM));
  PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, weight, weight_sum, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, weight, weight_sum, MPIU_SUM));
  for (PetscInt c = 0; c < num_cells; c++) mean[c] = weight_sum[c] > 0. ? value_sum[c] / weight_sum[c] : 1.;
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscCall(PetscFree(product));
  PetscCall(PetscFree2(value_sum, weight_sum));
  PetscFunctionReturn(0);
}

/* What is told of the run is that of the mended map; what belongs to the input's vertices and cells is not touched. */
static PetscErrorCode CopyStory(EqmMap mended, EqmMap map)
{
  const struct _p_EqmMap own = *map;

  PetscFunctionBegin;
  *map = *mended;
  map->soup = own.soup;
  map->coordinates = own.coordinates;
  map->cell_ratio = own.cell_ratio;
  map->vertex_ratio = own.vertex_ratio;
  map->quasi_conformal = own.quasi_conformal;
  map->conformal_factor = own.conformal_factor;
  PetscCall(PetscMalloc1(mended->num_history, &map->history));
  PetscCall(PetscArraycpy(map->history, mended->history, mended->num_history));
  PetscFunctionReturn(0);
}

/* EqmMapOntoInput - bring the map of a mended mesh back onto the input that EqmSoupRepair made it of.

   Collective. parent - per cell of the mended soup's slab, the input cell it comes from; cell_weight - per cell of that
   slab, its weight w, in any unit. The input's vertices kept their numbers, so their places and ratios are copied; the
   places of added vertices are only in `mended`. An input cell gets the weighted means of its children, 1 if it
   was removed. Vertices that no cell uses stay at zero. `mended` and `parent` are referenced and must outlive `map`.
   Errors: none of its own. */
PetscErrorCode EqmMapOntoInput(EqmMap mended, EqmSoup input, const PetscInt *parent, const PetscReal *cell_weight,
                               EqmMap *map)
{
  PetscFunctionBegin;
  PetscCall(EqmMapCreate(input, mended->dim, map));
  PetscCall(CopyStory(mended, *map));
  PetscCall(FetchVertices(mended->soup, input, mended->dim, mended->coordinates, (*map)->coordinates));
  PetscCall(FetchVertices(mended->soup, input, 1, mended->vertex_ratio, (*map)->vertex_ratio));
  PetscCall(FetchVertices(mended->soup, input, 1, mended->conformal_factor, (*map)->conformal_factor));
  PetscCall(GatherMeans(mended, parent, cell_weight, mended->cell_ratio, *map, (*map)->cell_ratio));
  PetscCall(GatherMeans(mended, parent, cell_weight, mended->quasi_conformal, *map, (*map)->quasi_conformal));
  (*map)->mended = mended;
  (*map)->parent = parent;
  PetscFunctionReturn(0);
}
