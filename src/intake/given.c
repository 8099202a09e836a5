/* The map of a prepared mesh on the cells of the file, which are the ones that the result is for: their distortion. */
#include "intake/intake.h"
#include "mesh/mesh_private.h"
#include "base/rows.h"
#include "geometry/simplex.h"
#include "store/map_private.h"
#include <string.h>

/* The cells of the file that have been mapped, as a mesh of their own. */
typedef struct {
  EqmSoup soup;
  PetscInt *cell; /* per cell of its slab its place in the slab of the file's mesh */
} MappedCells;

/* Normal of a triangle, not normalised. */
static void Normal(const PetscReal *corner, PetscReal normal[3])
{
  PetscReal u[3], v[3];

  for (int k = 0; k < 3; k++) {
    u[k] = corner[3 + k] - corner[k];
    v[k] = corner[6 + k] - corner[k];
  }
  EqmCross(u, v, normal);
}

/* Is a corner of a part an added vertex where a corner of the whole is? Then the surface has been cut apart there. */
static PetscBool IsCut(PetscInt num_given, const PetscInt *corner, const PetscReal *before, const PetscReal *after)
{
  for (int a = 0; a < 3; a++) {
    if (corner[a] < num_given) continue;
    for (int b = 0; b < 3; b++) {
      const PetscReal *const x = before + 3 * b, *const y = after + 3 * a;
      if (x[0] == y[0] && x[1] == y[1] && x[2] == y[2]) return PETSC_TRUE;
    }
  }
  return PETSC_FALSE;
}

/* The fate of the cells that parts come from, a value per part. Parts of a triangle lie in its plane, so normals
   tell whether they were turned over. Tetrahedra are turned when the mesh is made, and never cut apart. */
static PetscErrorCode CompareParts(const EqmIntake *intake, PetscInt num, const PetscInt *child, const PetscInt *parent,
                                   PetscInt *value)
{
  const EqmSoup given = intake->given, mapped = intake->mapped;
  PetscInt *corner;
  PetscReal *before, *after;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < num; k++) value[k] = EQM_CELL_MAPPED;
  if (given->cell_size != 3) PetscFunctionReturn(0);
  PetscCall(PetscMalloc3(3 * num, &corner, 9 * num, &before, 9 * num, &after));
  PetscCall(
      EqmFetchRows(given->comm, given->cell_end - given->cell_start, num, parent, MPIU_INT, 3, given->cells, corner));
  PetscCall(EqmFetchRows(given->comm, given->vertex_end - given->vertex_start, 3 * num, corner, MPIU_REAL, 3,
                         given->vertices, before));
  for (PetscInt k = 0; k < 3 * num; k++) corner[k] = mapped->cells[3 * child[k / 3] + k % 3];
  PetscCall(EqmFetchRows(given->comm, mapped->vertex_end - mapped->vertex_start, 3 * num, corner, MPIU_REAL, 3,
                         mapped->vertices, after));
  for (PetscInt k = 0; k < num; k++) {
    PetscReal m[3], n[3];

    Normal(before + 9 * k, m);
    Normal(after + 9 * k, n);
    if (EqmDot3(m, n) < 0.) value[k] = EQM_CELL_TURNED;
    if (IsCut(given->num_vertices, corner + 3 * k, before + 9 * k, after + 9 * k)) value[k] = EQM_CELL_CUT;
  }
  PetscCall(PetscFree3(corner, before, after));
  PetscFunctionReturn(0);
}

/* EqmIntakeMarkCells - the fate of the file's cells: an EqmCellFate per cell of the slab. Collective. */
PetscErrorCode EqmIntakeMarkCells(const EqmIntake *intake, PetscInt *mark)
{
  const PetscBool changed = (PetscBool)(intake->mapped != intake->given);
  const PetscInt count = intake->given->cell_end - intake->given->cell_start;
  const PetscInt num = intake->mapped->cell_end - intake->mapped->cell_start;
  PetscInt num_children = 0, *child, *parent, *value;
  PetscSF sf;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < count; c++) mark[c] = changed ? EQM_CELL_LEFT_OUT : EQM_CELL_MAPPED;
  if (!changed) PetscFunctionReturn(0);
  PetscCall(PetscMalloc3(num, &child, num, &parent, num, &value));
  for (PetscInt c = 0; c < num; c++) {
    if (intake->parent[c] < 0) continue;
    child[num_children] = c;
    parent[num_children++] = intake->parent[c];
  }
  PetscCall(CompareParts(intake, num_children, child, parent, value));
  PetscCall(EqmRowsCreateSF(intake->given->comm, count, num_children, parent, &sf));
  PetscCall(PetscSFReduceBegin(sf, MPIU_INT, value, mark, MPI_MAX));
  PetscCall(PetscSFReduceEnd(sf, MPIU_INT, value, mark, MPI_MAX));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscFree3(child, parent, value));
  PetscFunctionReturn(0);
}

/* All vertices of the file, and those of its cells that have been mapped and not cut apart, turned as they were. */
static PetscErrorCode CollectMapped(EqmSoup given, const PetscInt *mark, MappedCells *cells)
{
  const PetscInt cs = given->cell_size, count = given->cell_end - given->cell_start;
  const PetscInt num_vertices = given->vertex_end - given->vertex_start;
  PetscInt num = 0, *corner;
  PetscReal *vertices, *density = NULL;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * num_vertices, &vertices));
  PetscCall(PetscArraycpy(vertices, given->vertices, 3 * num_vertices));
  PetscCall(PetscMalloc1(cs * count, &corner));
  PetscCall(PetscMalloc1(count, &cells->cell));
  if (given->density) PetscCall(PetscMalloc1(count + 1, &density));
  for (PetscInt c = 0; c < count; c++) {
    PetscInt *const v = corner + cs * num, last = given->cells[cs * c + cs - 1];

    if (mark[c] != EQM_CELL_MAPPED && mark[c] != EQM_CELL_TURNED) continue;
    PetscCall(PetscArraycpy(v, given->cells + cs * c, cs));
    if (mark[c] == EQM_CELL_TURNED) {
      v[cs - 1] = v[cs - 2];
      v[cs - 2] = last;
    }
    if (density) density[num] = given->density[c];
    cells->cell[num++] = c;
  }
  PetscCall(EqmSoupCreateFromSlabs(given->comm, cs, num_vertices, vertices, num, corner, given->file, &cells->soup));
  cells->soup->density = density;
  PetscFunctionReturn(0);
}

/* Set distortion and ratios of the file's map to those of the mapped cells alone. */
static PetscErrorCode CopyDistortion(EqmMap measured, const MappedCells *cells, EqmMap map)
{
  const PetscInt num = cells->soup->cell_end - cells->soup->cell_start;
  const PetscInt num_vertices = map->soup->vertex_end - map->soup->vertex_start;

  PetscFunctionBegin;
  map->distortion = measured->distortion;
  for (PetscInt c = 0; c < num; c++) {
    map->cell_ratio[cells->cell[c]] = measured->cell_ratio[c];
    if (map->quasi_conformal) map->quasi_conformal[cells->cell[c]] = measured->quasi_conformal[c];
  }
  PetscCall(PetscArraycpy(map->vertex_ratio, measured->vertex_ratio, num_vertices));
  if (map->conformal_factor) PetscCall(PetscArraycpy(map->conformal_factor, measured->conformal_factor, num_vertices));
  PetscFunctionReturn(0);
}

/* As the solver judges maps: ratios off by half, root mean square, are none of equal areas. */
static PetscErrorCode DoubtGiven(EqmMap map)
{
  const PetscReal poor_sd = .5;

  PetscFunctionBegin;
  if (map->distortion.folds > 0 || map->status != EQM_STATUS_CONVERGED || map->distortion.weighted_ratio.sd <= poor_sd)
    PetscFunctionReturn(0);
  map->status = EQM_STATUS_NOT_CONVERGED;
  map->poor = PETSC_TRUE;
  PetscCall(PetscStrncpy(map->message,
                         "the map of the file's own cells is poor, far from equal measures: where cells were split, "
                         "their parts are mapped well and they are not",
                         sizeof(map->message)));
  PetscFunctionReturn(0);
}

/* Add the figures of the prepared mesh's map; folds and ratios of the file's cells decide the status. */
static PetscErrorCode Judge(EqmMap found, const char *target, PetscInt64 num_cut, EqmMap map)
{
  const PetscBool keeps_angles = (PetscBool)!strcmp(target, "conformal");
  const PetscInt64 folds = map->distortion.folds;

  PetscFunctionBegin;
  PetscCall(EqmMapAddFigure(map, "prepared_mesh.energy", found->energy_final));
  PetscCall(EqmMapAddFigure(map, "prepared_mesh.ratio_sd", found->distortion.ratio.sd));
  PetscCall(EqmMapAddFigure(map, "prepared_mesh.ratio_min", found->distortion.ratio.min));
  PetscCall(EqmMapAddFigure(map, "prepared_mesh.ratio_max", found->distortion.ratio.max));
  PetscCall(EqmMapAddCount(map, "prepared_mesh.folds", found->distortion.folds));
  PetscCall(EqmMapAddCount(map, "prepared_mesh.cells_cut_off", num_cut));
  if (!keeps_angles) PetscCall(EqmMapSetEnergies(map, map->energy_initial, map->distortion.energy));
  if (!keeps_angles) PetscCall(DoubtGiven(map));
  if (folds == 0 || (map->status != EQM_STATUS_CONVERGED && map->status != EQM_STATUS_NOT_CONVERGED))
    PetscFunctionReturn(0);
  map->status = EQM_STATUS_FOLDS;
  PetscCall(PetscSNPrintf(map->message, sizeof(map->message),
                          "%" PetscInt64_FMT " %s of the file are folded or flat in the map, %" PetscInt64_FMT
                          " of the prepared mesh: where cells were split, their parts are mapped well and they are not",
                          folds, map->soup->cell_size == 3 ? "triangles" : "tetrahedra", found->distortion.folds));
  PetscFunctionReturn(0);
}

/* EqmIntakeMeasureCells - measure a map on those cells of the file that `mark` (EqmCellFate per cell of the slab) calls
   mapped: fills distortion and ratios of `map` from `coordinates`, map->dim per vertex of the slab. Collective. */
PetscErrorCode EqmIntakeMeasureCells(EqmSoup given, EqmLedger ledger, const PetscInt *mark,
                                     const PetscReal *coordinates, EqmMap map)
{
  MappedCells cells;
  PetscReal *x;
  EqmMap measured;
  EqmMesh mesh;

  PetscFunctionBegin;
  PetscCall(CollectMapped(given, mark, &cells));
  PetscCall(EqmMeshCreate(cells.soup, ledger, &mesh));
  PetscCall(EqmMapCreate(cells.soup, map->dim, &measured));
  PetscCall(PetscMalloc1(map->dim * mesh->num_local, &x));
  PetscCall(EqmMeshVerticesFromInput(mesh, cells.soup, map->dim, coordinates, x));
  PetscCall(EqmMapMeasure(measured, mesh, x));
  PetscCall(CopyDistortion(measured, &cells, map));
  PetscCall(PetscFree(x));
  PetscCall(EqmMapDestroy(&measured));
  PetscCall(EqmMeshDestroy(&mesh));
  PetscCall(EqmSoupDestroy(&cells.soup));
  PetscCall(PetscFree(cells.cell));
  PetscFunctionReturn(0);
}

/* EqmIntakeMeasureGiven - measure a map on the cells of the file, where a prepared mesh has been mapped in their place.

   Collective. found - the map of intake->mapped; map - as EqmIntakeTakeMap made it of `found`: gets distortion, ratios,
   energy and status of the file's mesh; those of the prepared mesh become figures `prepared_mesh`. Cells at which the
   surface was cut apart have two images of a vertex, which the file's numbering cannot hold: they are not measured,
   their number is a figure, their images are in the prepared mesh. Where nothing was prepared, nothing happens. */
PetscErrorCode EqmIntakeMeasureGiven(const EqmIntake *intake, EqmLedger ledger, EqmMap found, EqmMap map)
{
  const EqmSoup given = intake->given;
  PetscInt64 num_cut = 0;
  PetscInt *mark;

  PetscFunctionBegin;
  if (map == found) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(given->cell_end - given->cell_start, &mark));
  PetscCall(EqmIntakeMarkCells(intake, mark));
  PetscCall(EqmIntakeMeasureCells(given, ledger, mark, map->coordinates, map));
  for (PetscInt c = 0; c < given->cell_end - given->cell_start; c++) num_cut += mark[c] == EQM_CELL_CUT;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &num_cut, 1, MPIU_INT64, MPI_SUM, given->comm));
  PetscCall(Judge(found, intake->target, num_cut, map));
  PetscCall(PetscFree(mark));
  PetscFunctionReturn(0);
}
