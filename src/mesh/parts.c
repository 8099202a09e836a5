/* A mesh of which every rank has read a part, dealt anew in balanced slabs. */
#include "mesh/build.h"
#include "mesh/soup_private.h"
#include "mesh/fields.h"
#include "base/rows.h"

/* Replace this rank's rows by those of its balanced slab. */
static PetscErrorCode Balance(MPI_Comm comm, PetscInt *count, MPI_Datatype unit, PetscInt width, void *rows)
{
  PetscInt total, start, num;
  PetscMPIInt size, rank, bytes;
  void *slab;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Type_size(unit, &bytes));
  PetscCall(MPIU_Allreduce(count, &total, 1, MPIU_INT, MPI_SUM, comm));
  start = EqmSlabStart(total, rank, size);
  num = EqmSlabStart(total, rank + 1, size) - start;
  PetscCall(PetscMalloc((size_t)bytes * (size_t)width * (size_t)num, &slab));
  PetscCall(EqmFetchSlab(comm, *count, num, start, unit, width, *(void **)rows, slab));
  PetscCall(PetscFree(*(void **)rows));
  *(void **)rows = slab;
  *count = num;
  PetscFunctionReturn(0);
}

/* More than PetscInt counts? */
static PetscErrorCode CheckSizes(MPI_Comm comm, const EqmSerialMesh *part, const char *file)
{
  PetscInt64 total[2] = {part->num_vertices, part->num_cells};

  PetscFunctionBegin;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, total, 2, MPIU_INT64, MPI_SUM, comm));
  if (total[0] > PETSC_MAX_INT || total[1] > PETSC_MAX_INT) {
    EqmFail(comm, EQM_ERR_IO, "%s: the mesh has %lld vertices and %lld cells: build with 64-bit indices", file,
            (long long)total[0], (long long)total[1]);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupCreateFromParts(MPI_Comm comm, EqmSerialMesh *part, const char *file, EqmSoup *soup)
{
  PetscInt num_vertices = part->num_vertices, num_cells = part->num_cells, num;

  PetscFunctionBegin;
  PetscCall(CheckSizes(comm, part, file));
  PetscCall(Balance(comm, &num_vertices, MPIU_REAL, 3, &part->vertices));
  PetscCall(Balance(comm, &num_cells, MPIU_INT, part->cell_size, &part->cells));
  PetscCall(EqmMeshFieldsTakeTexture(part));
  for (PetscInt f = 0; f < part->num_fields; ++f) {
    EqmMeshField *const field = &part->fields[f];

    num = field->on_cells ? part->num_cells : part->num_vertices;
    PetscCall(Balance(comm, &num, MPIU_REAL, field->width, &field->values));
  }
  PetscCall(
      EqmSoupCreateFromSlabs(comm, part->cell_size, num_vertices, part->vertices, num_cells, part->cells, file, soup));
  PetscCall(PetscStrncpy((*soup)->note, part->note, EQM_SOUP_NOTE));
  PetscCall(PetscStrncpy((*soup)->left, part->left, EQM_SOUP_NOTE));
  (*soup)->metadata = part->metadata;
  (*soup)->num_fields = part->num_fields;
  (*soup)->fields = part->fields;
  *part = (EqmSerialMesh){0};
  PetscFunctionReturn(0);
}
