/* The image mesh: the input's cells with every vertex at its image, in any mesh format. */
#include "store/map_private.h"
#include "store/store.h"
#include "format/format.h"
#include "base/rows.h"

/* Bring slabs of reals together on rank 0, where `all` has room for them. */
static PetscErrorCode GatherReals(MPI_Comm comm, PetscInt width, PetscInt count, const PetscReal *slab, PetscReal *all)
{
  PetscLayout layout;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(comm, count, PETSC_DETERMINE, 1, &layout));
  PetscCall(PetscSFCreate(comm, &sf));
  PetscCall(PetscSFSetGraphWithPattern(sf, layout, PETSCSF_PATTERN_GATHER));
  PetscCall(EqmRowsToLeaves(sf, width, slab, all));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscFunctionReturn(0);
}

/* On rank 0, put the images in the place of the vertices. */
static PetscErrorCode MoveVertices(EqmMap map, EqmSerialMesh *serial)
{
  const PetscInt count = map->soup->vertex_end - map->soup->vertex_start;
  PetscReal *images;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(map->dim * serial->num_vertices, &images));
  PetscCall(GatherReals(map->soup->comm, map->dim, count, map->coordinates, images));
  for (PetscInt i = 0; i < serial->num_vertices; i++) {
    for (PetscInt d = 0; d < 3; d++) serial->vertices[3 * i + d] = d < map->dim ? images[map->dim * i + d] : 0.0;
  }
  PetscCall(PetscFree(images));
  PetscFunctionReturn(0);
}

/* Write the mesh with its vertices at their images (z = 0 for planar maps), and the ratios where the format has room
   for fields. Errors: EQM_ERR_IO on all ranks. Collective; rank 0 gathers and writes. */
PetscErrorCode EqmMapWriteImage(EqmMap map, const char *file)
{
  EqmSoup soup = map->soup;
  char message[EQM_MESSAGE_MAX] = "";
  PetscReal *cell_ratio, *vertex_ratio;
  PetscErrorCode error = 0;
  EqmSerialMesh serial;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(EqmSoupGather(soup, &serial));
  PetscCall(MoveVertices(map, &serial));
  PetscCall(PetscMalloc2(serial.num_cells, &cell_ratio, serial.num_vertices, &vertex_ratio));
  PetscCall(GatherReals(soup->comm, 1, soup->cell_end - soup->cell_start, map->cell_ratio, cell_ratio));
  PetscCall(GatherReals(soup->comm, 1, soup->vertex_end - soup->vertex_start, map->vertex_ratio, vertex_ratio));
  if (rank == 0) {
    const EqmField fields[] = {{"ratio", PETSC_TRUE, 1, cell_ratio}, {"vertex_ratio", PETSC_FALSE, 1, vertex_ratio}};
    error = EqmFormatWriteSerial(file, &serial, fields, 2, message, sizeof(message));
  }
  PetscCall(PetscFree2(cell_ratio, vertex_ratio));
  PetscCall(EqmSerialMeshReset(&serial));
  PetscCall(EqmAgree(soup->comm, error, message));
  PetscFunctionReturn(0);
}
