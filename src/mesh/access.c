/* Accessors of soups and meshes. */
#include "mesh/mesh_private.h"

PetscErrorCode EqmSoupGetSizes(EqmSoup soup, PetscInt *cell_size, PetscInt *num_vertices, PetscInt *num_cells)
{
  PetscFunctionBegin;
  if (cell_size) *cell_size = soup->cell_size;
  if (num_vertices) *num_vertices = soup->num_vertices;
  if (num_cells) *num_cells = soup->num_cells;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupGetVertices(EqmSoup soup, PetscInt *start, PetscInt *end, const PetscReal **vertices)
{
  PetscFunctionBegin;
  if (start) *start = soup->vertex_start;
  if (end) *end = soup->vertex_end;
  if (vertices) *vertices = soup->vertices;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupGetCells(EqmSoup soup, PetscInt *start, PetscInt *end, const PetscInt **cells)
{
  PetscFunctionBegin;
  if (start) *start = soup->cell_start;
  if (end) *end = soup->cell_end;
  if (cells) *cells = soup->cells;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupGetFile(EqmSoup soup, const char **file)
{
  PetscFunctionBegin;
  *file = soup->file;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshGetSizes(EqmMesh mesh, PetscInt *cell_size, PetscInt *num_vertices, PetscInt *num_cells)
{
  PetscFunctionBegin;
  if (cell_size) *cell_size = mesh->cell_size;
  if (num_vertices) *num_vertices = mesh->num_vertices;
  if (num_cells) *num_cells = mesh->num_cells;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshGetLocalSizes(EqmMesh mesh, PetscInt *num_owned, PetscInt *num_local, PetscInt *num_owned_cells,
                                    PetscInt *num_local_cells)
{
  PetscFunctionBegin;
  if (num_owned) *num_owned = mesh->num_owned;
  if (num_local) *num_local = mesh->num_local;
  if (num_owned_cells) *num_owned_cells = mesh->num_owned_cells;
  if (num_local_cells) *num_local_cells = mesh->num_local_cells;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshGetCells(EqmMesh mesh, const PetscInt **cells)
{
  PetscFunctionBegin;
  *cells = mesh->cells;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshGetVertexInput(EqmMesh mesh, const PetscInt **input)
{
  PetscFunctionBegin;
  *input = mesh->vertex_input;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSurfaceGetSoup(EqmSurface surface, EqmSoup *soup)
{
  PetscFunctionBegin;
  *soup = surface->soup;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDoubleGetSoup(EqmDouble covering, EqmSoup *soup)
{
  PetscFunctionBegin;
  *soup = covering->soup;
  PetscFunctionReturn(0);
}
