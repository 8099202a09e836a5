/* Fields in our HDF5 files: /vertex/NAME and /cell/NAME, and what the mesh's file said beside, as the attribute
   mesh_metadata. */
#include "hdf5.h"
#include "mesh/fields.h"
#include "mesh/soup_private.h"

#include <stdio.h>
#include <string.h>

enum { MOST_COMPONENTS = 64, MOST_METADATA = 60000 };

static const char metadata_name[] = "mesh_metadata";

static EqmSlab SlabOf(EqmSoup soup, PetscBool on_cells, PetscInt width)
{
  if (on_cells) return (EqmSlab){soup->num_cells, soup->cell_start, soup->cell_end - soup->cell_start, width};
  return (EqmSlab){soup->num_vertices, soup->vertex_start, soup->vertex_end - soup->vertex_start, width};
}

/* The array of a field; a slash in its name would be a group. */
static void PathOf(const char *name, PetscBool on_cells, char *path, size_t length)
{
  snprintf(path, length, "%s%s", on_cells ? "/cell/" : "/vertex/", name);
  for (char *c = path + (on_cells ? 6 : 8); *c; ++c) {
    if (*c == '/') *c = '_';
  }
  if (!strcmp(name, ".")) path[strlen(path) - 1] = '_';
}

/* One array into a field of the soup, if it has a row per vertex or cell. Collective. */
static PetscErrorCode ReadField(EqmH5 h5, EqmSoup soup, const char *name, PetscBool on_cells)
{
  EqmMeshField kind = {.on_cells = on_cells};
  EqmSlab slab;
  PetscInt64 total, width;
  PetscReal *values;
  char path[EQM_H5_NAME + 16];

  PetscFunctionBegin;
  PathOf(name, on_cells, path, sizeof(path));
  PetscCall(EqmH5GetShape(h5, path, &total, &width));
  if (total != (on_cells ? soup->num_cells : soup->num_vertices) || width > MOST_COMPONENTS) PetscFunctionReturn(0);
  slab = SlabOf(soup, on_cells, (PetscInt)width);
  kind.width = (PetscInt)PetscMax(width, 1);
  PetscCall(PetscStrncpy(kind.name, name, sizeof(kind.name)));
  PetscCall(EqmMeshFieldsAdd(&soup->num_fields, &soup->fields, &kind, (size_t)slab.count, &values));
  PetscCall(EqmH5ReadReals(h5, path, slab, values));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupReadFieldsHdf5(EqmH5 h5, EqmSoup soup)
{
  char(*names)[EQM_H5_NAME], *text;
  PetscInt num;

  PetscFunctionBegin;
  for (int on_cells = 0; on_cells < 2; ++on_cells) {
    PetscErrorCode code = 0;

    PetscCall(EqmH5ListNumbers(h5, on_cells ? "/cell" : "/vertex", &num, &names));
    for (PetscInt k = 0; k < num && !code; ++k) code = ReadField(h5, soup, names[k], (PetscBool)on_cells);
    PetscCall(PetscFree(names));
    PetscCall(code);
  }
  PetscCall(PetscMalloc1(MOST_METADATA, &text));
  PetscCall(EqmH5GetText(h5, metadata_name, "", text, MOST_METADATA));
  if (text[0]) PetscCall(PetscStrallocpy(text, &soup->metadata));
  PetscCall(PetscFree(text));
  PetscFunctionReturn(0);
}

/* Is a field left out, since the file has an array of its own under that name? */
static PetscBool IsTaken(EqmSoup soup, const EqmMeshField *field, PetscBool of_result)
{
  if (field->on_cells && soup->density && !strcmp(field->name, "density")) return PETSC_TRUE;
  return of_result ? EqmMeshFieldIsOfResult(field->name) : PETSC_FALSE;
}

PetscBool EqmSoupHasFieldHdf5(EqmSoup soup, const EqmMeshField *field, char *path, size_t length)
{
  PathOf(field->name, field->on_cells, path, length);
  return IsTaken(soup, field, PETSC_TRUE) ? PETSC_FALSE : PETSC_TRUE;
}

/* What is done with a field and its array. Collective. */
typedef PetscErrorCode (*FieldAction)(EqmH5 h5, const char *path, EqmSlab slab, const PetscReal *values);

static PetscErrorCode Declare(EqmH5 h5, const char *path, EqmSlab slab, const PetscReal *values)
{
  PetscFunctionBegin;
  PetscCall(EqmH5DeclareReals(h5, path, slab.total, slab.width));
  PetscFunctionReturn(0);
}

static PetscErrorCode Write(EqmH5 h5, const char *path, EqmSlab slab, const PetscReal *values)
{
  PetscFunctionBegin;
  PetscCall(EqmH5WriteReals(h5, path, slab, values));
  PetscFunctionReturn(0);
}

static PetscErrorCode ForEachField(EqmH5 h5, EqmSoup soup, PetscBool of_result, FieldAction action)
{
  char path[EQM_H5_NAME + 16];

  PetscFunctionBegin;
  for (PetscInt f = 0; f < soup->num_fields; ++f) {
    const EqmMeshField *const field = &soup->fields[f];

    if (IsTaken(soup, field, of_result)) continue;
    PathOf(field->name, field->on_cells, path, sizeof(path));
    PetscCall(action(h5, path, SlabOf(soup, field->on_cells, field->width == 1 ? 0 : field->width), field->values));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupDeclareFieldsHdf5(EqmH5 h5, EqmSoup soup, PetscBool of_result)
{
  PetscFunctionBegin;
  PetscCall(ForEachField(h5, soup, of_result, Declare));
  if (soup->metadata) PetscCall(EqmH5PutText(h5, metadata_name, soup->metadata));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupWriteFieldsHdf5(EqmH5 h5, EqmSoup soup, PetscBool of_result)
{
  PetscFunctionBegin;
  PetscCall(ForEachField(h5, soup, of_result, Write));
  PetscFunctionReturn(0);
}
