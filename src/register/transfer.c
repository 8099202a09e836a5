/* Fields of one mesh carried to the other, and back. */
#include "register/registration.h"
#include "mesh/mesh_private.h"
#include <string.h>

/* Locate the centroids of `to`'s cells in `from`. */
static PetscErrorCode LocateMiddles(EqmRegistration r, const EqmSide *from, const EqmSide *to, EqmLocation *location)
{
  const EqmMesh mesh = to->mesh;
  const PetscInt dim = r->dim, cs = mesh->cell_size;
  PetscReal *middle;
  EqmLocator locator;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(dim * mesh->num_owned_cells, &middle));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    PetscReal squared = 0.;
    for (PetscInt k = 0; k < dim; k++) {
      for (PetscInt a = 0; a < cs; a++) middle[dim * c + k] += to->x[dim * mesh->cells[cs * c + a] + k] / cs;
      squared += PetscSqr(middle[dim * c + k]);
    }
    for (PetscInt k = 0; k < dim && r->kind == EQM_IMAGE_SPHERE; k++) middle[dim * c + k] /= PetscSqrtReal(squared);
  }
  PetscCall(EqmLocatorCreate(from->mesh, r->kind, from->x, &locator));
  PetscCall(EqmLocatorFind(locator, mesh->num_owned_cells, middle, location));
  PetscCall(EqmLocatorDestroy(&locator));
  PetscCall(PetscFree(middle));
  PetscFunctionReturn(0);
}

/* A cell field: each cell gets the value of the cell in which its centroid lies. */
static PetscErrorCode CarryCells(EqmRegistration r, const EqmSide *from, const EqmSide *to,
                                 const EqmCarriedField *field, const char *path)
{
  const EqmSoup soup = to->soup;
  const PetscInt count = soup->cell_end - soup->cell_start, width = field->width;
  PetscReal *owned, *carried, *slab;
  EqmLocation location;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(width * from->mesh->num_owned_cells, &owned, width * to->mesh->num_owned_cells, &carried));
  PetscCall(PetscCalloc1(width * count, &slab));
  PetscCall(EqmCellsFromOrigin(from->origin, width, field->slab, owned));
  PetscCall(LocateMiddles(r, from, to, &location));
  PetscCall(EqmLocationSample(location, from->mesh, width, owned, carried));
  PetscCall(EqmLocationDestroy(&location));
  PetscCall(EqmCellsToOrigin(to->origin, width, carried, slab));
  PetscCall(PetscFree2(owned, carried));
  PetscCall(EqmMapAddReals(r->map, path, soup->num_cells, soup->cell_start, count, width == 1 ? 0 : width, slab));
  PetscFunctionReturn(0);
}

/* Round trip error: root mean square of the change from there and back, over the field's standard deviation. */
static PetscErrorCode RoundTrip(EqmRegistration r, const EqmSide *from, PetscInt width, const PetscReal *value,
                                const PetscReal *back, PetscReal *share)
{
  const EqmMesh mesh = from->mesh;
  PetscReal *mean, squares[2] = {0., 0.};

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(width, &mean));
  for (PetscInt k = 0; k < width * mesh->num_owned; k++) mean[k % width] += from->weight[k / width] * value[k];
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, mean, (PetscMPIInt)width, MPIU_REAL, MPIU_SUM, r->comm));
  for (PetscInt k = 0; k < width * mesh->num_owned; k++) {
    squares[0] += from->weight[k / width] * PetscSqr(back[k] - value[k]);
    squares[1] += from->weight[k / width] * PetscSqr(value[k] - mean[k % width]);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, squares, 2, MPIU_REAL, MPIU_SUM, r->comm));
  PetscCall(PetscFree(mean));
  *share = squares[1] > 0. ? PetscSqrtReal(squares[0] / squares[1]) : PetscSqrtReal(squares[0]);
  PetscFunctionReturn(0);
}

/* A vertex field, linear in each cell; then back again, for the round trip error. */
static PetscErrorCode CarryVertices(EqmRegistration r, const EqmSide *from, const EqmSide *to,
                                    const EqmCarriedField *field, const char *path)
{
  const EqmSoup soup = to->soup;
  const PetscInt count = soup->vertex_end - soup->vertex_start, width = field->width;
  const EqmLocation there = from == &r->a ? r->inverse : r->forward, again = from == &r->a ? r->forward : r->inverse;
  PetscReal *value, *carried, *back, *slab, share;
  char key[128];

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(width * from->mesh->num_local, &value, width * to->mesh->num_local, &carried,
                         width * from->mesh->num_owned, &back));
  PetscCall(PetscCalloc1(width * count, &slab));
  PetscCall(EqmVerticesFromOrigin(from->origin, width, field->slab, value));
  PetscCall(EqmLocationInterpolate(there, from->mesh, width, value, carried));
  PetscCall(EqmMeshUpdateGhosts(to->mesh, width, carried));
  PetscCall(EqmLocationInterpolate(again, to->mesh, width, carried, back));
  PetscCall(RoundTrip(r, from, width, value, back, &share));
  PetscCall(EqmVerticesToOrigin(to->origin, width, carried, slab));
  PetscCall(PetscFree3(value, carried, back));
  PetscCall(EqmMapAddReals(r->map, path, soup->num_vertices, soup->vertex_start, count, width == 1 ? 0 : width, slab));
  PetscCall(
      PetscSNPrintf(key, sizeof(key), "register.transfer.to_%s.%s.round_trip", field->of_b ? "a" : "b", field->name));
  PetscCall(EqmMapAddFigure(r->map, key, share));
  PetscFunctionReturn(0);
}

/* Read what -transfer names, entries of the form [a:|b:]SOURCE. Collective. */
PetscErrorCode EqmReadFields(EqmRegistration r)
{
  char **entries;
  int count;

  PetscFunctionBegin;
  if (!r->set.transfer[0]) PetscFunctionReturn(0);
  if (r->bare) EqmFail(r->comm, EQM_ERR_USAGE, "-transfer wants a mesh for B: the target itself has no vertices");
  PetscCall(PetscStrToArray(r->set.transfer, ',', &count, &entries));
  PetscCall(PetscCalloc1(count, &r->fields));
  for (r->num_fields = 0; r->num_fields < count; r->num_fields++) {
    const char *const entry = entries[r->num_fields];
    EqmCarriedField *const field = &r->fields[r->num_fields];
    const PetscBool of_b = (PetscBool)!strncmp(entry, "b:", 2);
    const char *const source = of_b || !strncmp(entry, "a:", 2) ? entry + 2 : entry;
    const EqmSoup soup = of_b ? r->b.soup : r->a.soup;

    PetscCall(EqmFieldRead(soup, source, field));
    if (!strcmp(source, "coordinates")) PetscCall(EqmFieldShift(soup, r->a.intake.unit, field));
    field->of_b = of_b;
  }
  PetscCall(PetscStrToArrayDestroy(count, entries));
  PetscFunctionReturn(0);
}

/* Carry them. Collective. */
PetscErrorCode EqmTransferFields(EqmRegistration r)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < r->num_fields; k++) {
    const EqmCarriedField *const field = &r->fields[k];
    const EqmSide *const from = field->of_b ? &r->b : &r->a, *const to = field->of_b ? &r->a : &r->b;
    char path[128];
    PetscCall(PetscSNPrintf(path, sizeof(path), "/transfer/to_%s/%s", field->of_b ? "a" : "b", field->name));
    if (field->on_cells)
      PetscCall(CarryCells(r, from, to, field, path));
    else
      PetscCall(CarryVertices(r, from, to, field, path));
  }
  PetscFunctionReturn(0);
}
