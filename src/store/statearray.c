/* Arrays of a state: every rank announces, writes or reads its slab. */
#include "store/state_private.h"
#include "mesh/mesh_private.h"
#include "base/rows.h"

/* This rank's share of rows; or, for what is the same everywhere, rank 0's writing all of them. */
EqmSlab EqmStateSlab(EqmState state, PetscInt total, PetscInt width, PetscBool on_root)
{
  const EqmMesh mesh = state->mesh;
  const PetscInt64 rows = total;
  EqmSlab slab = {.total = total, .width = width};

  if (on_root) {
    slab.count = mesh->rank == 0 ? total : 0;
  } else {
    slab.start = (PetscInt)(rows * mesh->rank / mesh->size);
    slab.count = (PetscInt)(rows * (mesh->rank + 1) / mesh->size) - slab.start;
  }
  return slab;
}

/* Announce an array, or find it with the shape that is wanted. */
static PetscErrorCode FindArray(EqmState state, const char *name, EqmSlab slab, char full[EQM_STATE_NAME],
                                PetscInt *index)
{
  PetscInt64 total, width;

  PetscFunctionBegin;
  PetscCall(EqmStateFindEntry(state, &state->arrays, "/", name, full, index));
  if (state->mode == EQM_STATE_ANNOUNCE) {
    PetscCall(EqmH5DeclareReals(state->h5, full, slab.total, slab.width));
    PetscCall(EqmH5PutChecksum(state->h5, full, -1));
  } else if (state->mode == EQM_STATE_READ) {
    PetscCall(EqmH5GetShape(state->h5, full, &total, &width));
    if (total != slab.total || width != slab.width) {
      EqmFail(state->mesh->comm, EQM_ERR_CHECKPOINT,
              "'%s': %s is %" PetscInt64_FMT " x %" PetscInt64_FMT ", not %" PetscInt_FMT " x %" PetscInt_FMT
              ": it belongs to another run",
              state->h5->name, full, total, width, slab.total, slab.width);
    }
  }
  PetscFunctionReturn(0);
}

/* Write an array with its checksum. */
static PetscErrorCode WriteArray(EqmState state, const char *full, PetscInt index, EqmSlab slab,
                                 const PetscReal *values)
{
  EqmChecksum checksum;

  PetscFunctionBegin;
  PetscCall(EqmH5WriteReals(state->h5, full, slab, values));
  PetscCall(EqmChecksumJoin(state->mesh->comm,
                            EqmChecksumReals((PetscInt64)slab.count * PetscMax(slab.width, 1), values), &checksum));
  PetscCall(EqmH5PutChecksum(state->h5, full, checksum.crc));
  state->arrays.entry[index].integer = checksum.crc;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateReals(EqmState state, const char *name, PetscInt count, PetscReal *values)
{
  const EqmSlab on_root = EqmStateSlab(state, count, 0, PETSC_TRUE), everywhere = {.total = count, .count = count};
  char full[EQM_STATE_NAME];
  PetscInt index;

  PetscFunctionBegin;
  if (count == 0) PetscFunctionReturn(0);
  PetscCall(FindArray(state, name, on_root, full, &index));
  if (state->mode == EQM_STATE_READ) PetscCall(EqmH5ReadReals(state->h5, full, everywhere, values));
  if (state->mode == EQM_STATE_WRITE) PetscCall(WriteArray(state, full, index, on_root, values));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateUseMesh(EqmState state, EqmMesh mesh)
{
  PetscFunctionBegin;
  PetscCall(PetscSFDestroy(&state->to_slab));
  state->mesh = mesh;
  PetscFunctionReturn(0);
}

/* The way between owned vertices and the slabs of the file, and a buffer of `width` reals per row. */
static PetscErrorCode MakeWay(EqmState state, EqmSlab slab)
{
  const EqmMesh mesh = state->mesh;
  PetscLayout layout;

  PetscFunctionBegin;
  if (!state->to_slab) {
    PetscCall(PetscLayoutCreateFromSizes(mesh->comm, slab.count, slab.total, 1, &layout));
    PetscCall(PetscSFCreate(mesh->comm, &state->to_slab));
    PetscCall(
        PetscSFSetGraphLayout(state->to_slab, layout, mesh->num_owned, NULL, PETSC_OWN_POINTER, mesh->vertex_input));
    PetscCall(PetscLayoutDestroy(&layout));
  }
  if (slab.width * slab.count > state->most_in_buffer) {
    state->most_in_buffer = slab.width * slab.count;
    PetscCall(PetscRealloc(sizeof(PetscReal) * (size_t)state->most_in_buffer, &state->buffer));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateVertices(EqmState state, const char *name, PetscInt width, PetscReal *local)
{
  const EqmMesh mesh = state->mesh;
  const EqmSlab slab = EqmStateSlab(state, mesh->soup_vertices, width, PETSC_FALSE);
  char full[EQM_STATE_NAME];
  PetscInt index;

  PetscFunctionBegin;
  PetscCall(FindArray(state, name, slab, full, &index));
  if (state->mode == EQM_STATE_ANNOUNCE) PetscFunctionReturn(0);
  PetscCall(MakeWay(state, slab));
  if (state->mode == EQM_STATE_WRITE) {
    PetscCall(PetscArrayzero(state->buffer, slab.width * slab.count)); /* vertices of no cell */
    PetscCall(EqmRowsToRoots(state->to_slab, width, local, state->buffer));
    PetscCall(WriteArray(state, full, index, slab, state->buffer));
  } else {
    PetscCall(EqmH5ReadReals(state->h5, full, slab, state->buffer));
    PetscCall(EqmRowsToLeaves(state->to_slab, width, state->buffer, local));
    PetscCall(EqmMeshUpdateGhosts(mesh, width, local));
  }
  PetscFunctionReturn(0);
}
