/* Ratios of the faces of the input that have more than three corners and were cut into triangles. */
#include "store/map_private.h"
#include "base/rows.h"
#include "geometry/simplex.h"
#include "mesh/fields.h"
#include "mesh/soup_private.h"

/* Per cell of the slab its share of the surface, up to a factor: area times density. */
static PetscErrorCode WeighCells(EqmSoup soup, PetscReal *weight)
{
  const PetscInt num = soup->cell_end - soup->cell_start;
  PetscReal *corner;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(9 * num, &corner));
  PetscCall(EqmFetchRows(soup->comm, soup->vertex_end - soup->vertex_start, 3 * num, soup->cells, MPIU_REAL, 3,
                         soup->vertices, corner));
  for (PetscInt c = 0; c < num; c++) {
    weight[c] = EqmArea3(corner + 9 * c, corner + 9 * c + 3, corner + 9 * c + 6);
    if (soup->density) weight[c] *= soup->density[c];
  }
  PetscCall(PetscFree(corner));
  PetscFunctionReturn(0);
}

/* The numbers of the faces, and how many there are: 0 if they are no numbers of faces. */
static PetscErrorCode NumberFaces(EqmSoup soup, const PetscReal *values, PetscInt *face, PetscInt *num_faces)
{
  const PetscInt num = soup->cell_end - soup->cell_start;
  PetscReal most = -1., least = 0.;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < num; c++) {
    least = PetscMin(least, values[c] >= 0. ? 0. : -1.);
    most = PetscMax(most, values[c]);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &most, 1, MPIU_REAL, MPIU_MAX, soup->comm));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &least, 1, MPIU_REAL, MPIU_MIN, soup->comm));
  *num_faces = least < 0. || most >= soup->num_cells ? 0 : (PetscInt)most + 1;
  for (PetscInt c = 0; c < num && *num_faces; c++) face[c] = (PetscInt)values[c];
  PetscFunctionReturn(0);
}

/* The mean ratio of each face, weighted by its triangles' shares; this rank's slab of them. */
static PetscErrorCode MeanRatios(EqmMap map, const PetscInt *face, PetscInt count, PetscReal *mean)
{
  const PetscInt num = map->soup->cell_end - map->soup->cell_start;
  PetscReal *weight, *product, *sum;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(num, &weight, num, &product));
  PetscCall(PetscCalloc1(count, &sum));
  PetscCall(PetscArrayzero(mean, count));
  PetscCall(WeighCells(map->soup, weight));
  for (PetscInt c = 0; c < num; c++) product[c] = weight[c] * map->cell_ratio[c];
  PetscCall(EqmRowsCreateSF(map->soup->comm, count, num, face, &sf));
  PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, product, mean, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, product, mean, MPIU_SUM));
  PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, weight, sum, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, weight, sum, MPIU_SUM));
  PetscCall(PetscSFDestroy(&sf));
  for (PetscInt f = 0; f < count; f++) mean[f] = sum[f] > 0. ? mean[f] / sum[f] : 1.;
  PetscCall(PetscFree(sum));
  PetscCall(PetscFree2(weight, product));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapAddPolygons(EqmMap map)
{
  const EqmSoup soup = map->soup;
  const EqmMeshField *const field = EqmMeshFieldsFind(soup->num_fields, soup->fields, EQM_FIELD_POLYGON, PETSC_TRUE);
  PetscInt *face, num_faces, count = PETSC_DECIDE, end;
  PetscReal *mean;

  PetscFunctionBegin;
  if (!field || soup->cell_size != 3) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(soup->cell_end - soup->cell_start, &face));
  PetscCall(NumberFaces(soup, field->values, face, &num_faces));
  if (num_faces) {
    PetscCall(PetscSplitOwnership(soup->comm, &count, &num_faces));
    PetscCallMPI(MPI_Scan(&count, &end, 1, MPIU_INT, MPI_SUM, soup->comm));
    PetscCall(PetscMalloc1(count + 1, &mean));
    PetscCall(MeanRatios(map, face, count, mean));
    PetscCall(EqmMapAddReals(map, "/polygon/ratio", num_faces, end - count, count, 0, mean));
  }
  PetscCall(PetscFree(face));
  PetscFunctionReturn(0);
}
