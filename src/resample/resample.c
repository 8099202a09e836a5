/* Places of the target carried back to the mesh, with its fields. */
#include "resample/resample.h"
#include "base/rows.h"
#include "geometry/simplex.h"
#include "mesh/fields.h"
#include "mesh/mesh_private.h"
#include <math.h>
#include <string.h>

/* Vertices that were added have no values: not numbers so far, they get the mean of their neighbours that have some,
   from the known ones inward. `value`: width reals per local vertex. Collective. */
static PetscErrorCode Extend(EqmMesh mesh, PetscInt width, PetscReal *value)
{
  const PetscInt cs = mesh->cell_size;
  PetscReal *sum;
  PetscInt64 changed = 1;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1((width + 1) * mesh->num_owned, &sum));
  while (changed) {
    changed = 0;
    PetscCall(PetscArrayzero(sum, (width + 1) * mesh->num_owned));
    for (PetscInt k = 0; k < cs * mesh->num_local_cells; k++) {
      const PetscInt v = mesh->cells[k];

      if (v >= mesh->num_owned || !isnan(value[width * v])) continue;
      for (PetscInt a = 0; a < cs; a++) {
        const PetscInt w = mesh->cells[k - k % cs + a];

        if (isnan(value[width * w])) continue;
        for (PetscInt i = 0; i < width; i++) sum[(width + 1) * v + i] += value[width * w + i];
        sum[(width + 1) * v + width] += 1.;
      }
    }
    for (PetscInt v = 0; v < mesh->num_owned; v++) {
      const PetscReal count = sum[(width + 1) * v + width];

      for (PetscInt i = 0; i < width && count > 0.; i++) value[width * v + i] = sum[(width + 1) * v + i] / count;
      changed += count > 0.;
    }
    PetscCall(EqmMeshUpdateGhosts(mesh, width, value));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPIU_INT64, MPI_SUM, mesh->comm));
  }
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(0);
}

/* A field of the file's vertices, at the new vertices. */
static PetscErrorCode CarryVertices(const EqmResampleSource *source, EqmLocation location, PetscInt width,
                                    const PetscReal *slab, PetscReal *carried)
{
  const EqmSoup given = source->given, mapped = source->mapped;
  const EqmMesh mesh = source->mesh;
  const PetscInt count = mapped->vertex_end - mapped->vertex_start;
  const PetscInt known = PetscMin(PetscMax(given->num_vertices - mapped->vertex_start, 0), count);
  PetscReal *all, *local;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(width * count, &all, width * mesh->num_local, &local));
  for (PetscInt k = width * known; k < width * count; k++) all[k] = NAN; /* added ones are the last */
  PetscCall(EqmFetchSlab(given->comm, given->vertex_end - given->vertex_start, known, mapped->vertex_start, MPIU_REAL,
                         width, slab, all));
  PetscCall(EqmMeshVerticesFromInput(mesh, mapped, width, all, local));
  if (mapped != given) PetscCall(Extend(mesh, width, local));
  PetscCall(EqmLocationInterpolate(location, mesh, width, local, carried));
  PetscCall(PetscFree2(all, local));
  PetscFunctionReturn(0);
}

/* A field of the file's cells: the value of the cell that the new vertex lies in. */
static PetscErrorCode CarryCells(const EqmResampleSource *source, EqmLocation location, PetscInt width,
                                 const PetscReal *slab, PetscReal *carried)
{
  const EqmSoup given = source->given, mapped = source->mapped;
  const EqmMesh mesh = source->mesh;
  const PetscInt num = mesh->num_owned_cells;
  PetscInt *cell, *wanted, count = 0;
  PetscReal *found, *owned;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(num, &cell, num, &wanted, width * num, &found, width * num, &owned));
  PetscCall(PetscArraycpy(cell, mesh->cell_input, num));
  if (source->parent) {
    PetscCall(EqmFetchRows(mapped->comm, mapped->cell_end - mapped->cell_start, num, mesh->cell_input, MPIU_INT, 1,
                           source->parent, cell));
  }
  for (PetscInt c = 0; c < num; c++) {
    if (cell[c] >= 0) wanted[count++] = cell[c];
  }
  PetscCall(
      EqmFetchRows(given->comm, given->cell_end - given->cell_start, count, wanted, MPIU_REAL, width, slab, found));
  count = 0;
  for (PetscInt c = 0; c < num; c++) {
    for (PetscInt i = 0; i < width; i++) owned[width * c + i] = cell[c] < 0 ? NAN : found[width * count + i];
    count += cell[c] >= 0;
  }
  PetscCall(EqmLocationSample(location, mesh, width, owned, carried));
  PetscCall(PetscFree4(cell, wanted, found, owned));
  PetscFunctionReturn(0);
}

/* Carry one field, which becomes one of `soup`. */
static PetscErrorCode CarryField(const EqmResampleSource *source, EqmLocation location, const EqmMeshField *field,
                                 EqmSoup soup)
{
  EqmMeshField kind = {.on_cells = PETSC_FALSE, .width = field->width};
  const PetscBool clash =
      (PetscBool)(field->on_cells &&
                  EqmMeshFieldsFind(source->given->num_fields, source->given->fields, field->name, PETSC_FALSE));
  PetscReal *values;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(kind.name, sizeof(kind.name), "%s%s", clash ? "cell_" : "", field->name));
  PetscCall(EqmMeshFieldsAdd(&soup->num_fields, &soup->fields, &kind, (size_t)location->num, &values));
  PetscCall(field->on_cells ? CarryCells(source, location, field->width, field->values, values)
                            : CarryVertices(source, location, field->width, field->values, values));
  PetscFunctionReturn(0);
}

/* The fields of the mesh, but texture coordinates, which belong to corners; and those of the list. */
static PetscErrorCode CarryFields(const EqmResampleSource *source, EqmLocation location, const char *more, EqmSoup soup)
{
  const EqmSoup given = source->given;
  char **names;
  int count;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < given->num_fields; f++) {
    if (!strcmp(given->fields[f].name, EQM_FIELD_TEXTURE) && given->fields[f].on_cells) continue;
    PetscCall(CarryField(source, location, &given->fields[f], soup));
  }
  PetscCall(PetscStrToArray(more, ',', &count, &names));
  for (int k = 0; k < count; k++) {
    EqmCarriedField read = {.slab = NULL};
    EqmMeshField field;

    PetscCall(EqmFieldRead(given, names[k], &read));
    field = (EqmMeshField){.on_cells = read.on_cells, .width = read.width, .values = read.slab};
    PetscCall(PetscStrncpy(field.name, read.name, sizeof(field.name)));
    PetscCall(CarryField(source, location, &field, soup));
    PetscCall(EqmFieldReset(&read));
  }
  PetscCall(PetscStrToArrayDestroy(count, names));
  PetscFunctionReturn(0);
}

/* Area or volume of a soup. Collective. */
static PetscErrorCode Measure(EqmSoup soup, PetscReal *measure)
{
  const PetscInt cs = soup->cell_size, num = soup->cell_end - soup->cell_start;
  PetscReal *corner, sum = 0.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * cs * num, &corner));
  PetscCall(EqmFetchRows(soup->comm, soup->vertex_end - soup->vertex_start, cs * num, soup->cells, MPIU_REAL, 3,
                         soup->vertices, corner));
  for (PetscInt c = 0; c < num; c++) {
    const PetscReal *const p = corner + 3 * cs * c;

    sum += cs == 3 ? EqmArea3(p, p + 3, p + 6) : EqmVolume(p, p + 3, p + 6, p + 9);
  }
  PetscCall(PetscFree(corner));
  PetscCallMPI(MPI_Allreduce(&sum, measure, 1, MPIU_REAL, MPIU_SUM, soup->comm));
  PetscFunctionReturn(0);
}

/* The places as a field "target", three coordinates each. */
static PetscErrorCode AddPlaces(const EqmResampleSource *source, const PetscReal *place, EqmSoup soup)
{
  const EqmMeshField kind = {.name = "target", .width = 3};
  const PetscInt count = soup->vertex_end - soup->vertex_start, dim = source->dim;
  PetscReal *values;

  PetscFunctionBegin;
  PetscCall(EqmMeshFieldsAdd(&soup->num_fields, &soup->fields, &kind, (size_t)count, &values));
  for (PetscInt k = 0; k < 3 * count; k++) values[k] = k % 3 < dim ? place[dim * (k / 3) + k % 3] : 0.;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmResample(const EqmResampleSource *source, const char *more, EqmSoup soup, const PetscReal *place,
                           EqmResampleFigures *figures)
{
  EqmLocation location;
  EqmLocator locator;

  PetscFunctionBegin;
  PetscCall(EqmLocatorCreate(source->mesh, source->kind, source->x, &locator));
  PetscCall(EqmLocatorFind(locator, soup->vertex_end - soup->vertex_start, place, &location));
  PetscCall(EqmLocatorDestroy(&locator));
  PetscCall(EqmLocationInterpolate(location, source->mesh, 3, source->mesh->position, soup->vertices));
  PetscCall(EqmMeshFieldsReset(&soup->num_fields, &soup->fields));
  PetscCall(CarryFields(source, location, more, soup));
  PetscCall(AddPlaces(source, place, soup));
  figures->clamped = location->num_clamped;
  figures->farthest = location->most_distant;
  PetscCall(EqmLocationDestroy(&location));
  PetscCall(Measure(soup, &figures->measure));
  PetscCall(Measure(source->mapped, &figures->measure_before));
  PetscFunctionReturn(0);
}
