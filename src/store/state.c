/* The visitor's verbs: what each does while a state is announced, written or read. */
#include "store/state_private.h"
#include <string.h>

PetscErrorCode EqmStateTableAdd(EqmStateTable *table, const char *name, PetscInt *place)
{
  PetscFunctionBegin;
  if (table->count == table->most) {
    table->most = PetscMax(32, 2 * table->most);
    PetscCall(PetscRealloc(sizeof(*table->entry) * (size_t)table->most, &table->entry));
  }
  *place = table->count++;
  PetscCall(PetscMemzero(&table->entry[*place], sizeof(*table->entry)));
  PetscCall(PetscStrncpy(table->entry[*place].name, name, EQM_STATE_NAME));
  PetscFunctionReturn(0);
}

/* Where a name stands, -1 if it is not there. */
PetscInt EqmStateTableFind(const EqmStateTable *table, const char *name)
{
  for (PetscInt k = 0; k < table->count; k++) {
    if (!strcmp(table->entry[k].name, name)) return k;
  }
  return -1;
}

PetscErrorCode EqmStateTableReset(EqmStateTable *table)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < table->count; k++) PetscCall(PetscFree(table->entry[k].text));
  PetscCall(PetscFree(table->entry));
  table->count = table->most = 0;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateGroup(EqmState state, const char *group)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(state->group, group, sizeof(state->group)));
  PetscFunctionReturn(0);
}

PetscBool EqmStateIsLoading(EqmState state)
{
  return (PetscBool)(state->mode == EQM_STATE_READ);
}

EqmMesh EqmStateMesh(EqmState state)
{
  return state->mesh;
}

/* /group/name for arrays, group/name for the rest. */
static PetscErrorCode FullName(EqmState state, const char *lead, const char *name, char full[EQM_STATE_NAME])
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(full, EQM_STATE_NAME, "%s%s%s%s", lead, state->group, state->group[0] ? "/" : "", name));
  PetscFunctionReturn(0);
}

/* The place of a name in its table: a new one while announcing, the old one while reading, -1 while writing. */
static PetscErrorCode Place(EqmState state, EqmStateTable *table, const char *lead, const char *name,
                            char full[EQM_STATE_NAME], PetscInt *place)
{
  PetscFunctionBegin;
  PetscCall(FullName(state, lead, name, full));
  *place = EqmStateTableFind(table, full);
  if (state->mode == EQM_STATE_READ && *place < 0) {
    EqmFail(state->mesh->comm, EQM_ERR_CHECKPOINT,
            "'%s' says nothing of '%s': another version wrote it, or a run of another kind; begin anew, without "
            "-restart",
            state->h5->name, full);
  }
  if (state->mode == EQM_STATE_ANNOUNCE) {
    PetscCheck(*place < 0, state->mesh->comm, PETSC_ERR_PLIB, "two parts of the state are called '%s'", full);
    PetscCall(EqmStateTableAdd(table, full, place));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateInt64(EqmState state, const char *name, PetscInt64 *value)
{
  char full[EQM_STATE_NAME];
  PetscInt place;

  PetscFunctionBegin;
  PetscCall(Place(state, &state->integers, "", name, full, &place));
  if (state->mode == EQM_STATE_READ) *value = state->integers.entry[place].integer;
  if (state->mode == EQM_STATE_ANNOUNCE) state->integers.entry[place].integer = *value;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateInt(EqmState state, const char *name, PetscInt *value)
{
  PetscInt64 wide = *value;

  PetscFunctionBegin;
  PetscCall(EqmStateInt64(state, name, &wide));
  PetscCall(PetscIntCast(wide, value));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateBool(EqmState state, const char *name, PetscBool *value)
{
  PetscInt64 wide = *value ? 1 : 0;

  PetscFunctionBegin;
  PetscCall(EqmStateInt64(state, name, &wide));
  *value = (PetscBool)(wide != 0);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateReal(EqmState state, const char *name, PetscReal *value)
{
  char full[EQM_STATE_NAME];
  PetscInt place;

  PetscFunctionBegin;
  PetscCall(Place(state, &state->reals, "", name, full, &place));
  if (state->mode == EQM_STATE_READ) *value = state->reals.entry[place].real;
  if (state->mode == EQM_STATE_ANNOUNCE) state->reals.entry[place].real = *value;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateText(EqmState state, const char *name, char *text, size_t length)
{
  char full[EQM_STATE_NAME];
  PetscInt place;

  PetscFunctionBegin;
  PetscCall(Place(state, &state->texts, "", name, full, &place));
  if (state->mode == EQM_STATE_READ) PetscCall(PetscStrncpy(text, state->texts.entry[place].text, length));
  if (state->mode == EQM_STATE_ANNOUNCE) PetscCall(PetscStrallocpy(text, &state->texts.entry[place].text));
  PetscFunctionReturn(0);
}

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
static PetscErrorCode PlaceArray(EqmState state, const char *name, EqmSlab slab, char full[EQM_STATE_NAME],
                                 PetscInt *place)
{
  PetscInt64 total, width;

  PetscFunctionBegin;
  PetscCall(Place(state, &state->arrays, "/", name, full, place));
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
static PetscErrorCode WriteArray(EqmState state, const char *full, PetscInt place, EqmSlab slab,
                                 const PetscReal *values)
{
  EqmChecksum checksum;

  PetscFunctionBegin;
  PetscCall(EqmH5WriteReals(state->h5, full, slab, values));
  PetscCall(EqmChecksumJoin(state->mesh->comm,
                            EqmChecksumReals((PetscInt64)slab.count * PetscMax(slab.width, 1), values), &checksum));
  PetscCall(EqmH5PutChecksum(state->h5, full, checksum.crc));
  state->arrays.entry[place].integer = checksum.crc;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateReals(EqmState state, const char *name, PetscInt count, PetscReal *values)
{
  const EqmSlab on_root = EqmStateSlab(state, count, 0, PETSC_TRUE), everywhere = {.total = count, .count = count};
  char full[EQM_STATE_NAME];
  PetscInt place;

  PetscFunctionBegin;
  if (count == 0) PetscFunctionReturn(0);
  PetscCall(PlaceArray(state, name, on_root, full, &place));
  if (state->mode == EQM_STATE_READ) PetscCall(EqmH5ReadReals(state->h5, full, everywhere, values));
  if (state->mode == EQM_STATE_WRITE) PetscCall(WriteArray(state, full, place, on_root, values));
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
  MPI_Datatype row;
  PetscInt place;

  PetscFunctionBegin;
  PetscCall(PlaceArray(state, name, slab, full, &place));
  if (state->mode == EQM_STATE_ANNOUNCE) PetscFunctionReturn(0);
  PetscCall(MakeWay(state, slab));
  PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)width, MPIU_REAL, &row));
  PetscCallMPI(MPI_Type_commit(&row));
  if (state->mode == EQM_STATE_WRITE) {
    PetscCall(PetscArrayzero(state->buffer, slab.width * slab.count)); /* vertices of no cell */
    PetscCall(PetscSFReduceBegin(state->to_slab, row, local, state->buffer, MPI_REPLACE));
    PetscCall(PetscSFReduceEnd(state->to_slab, row, local, state->buffer, MPI_REPLACE));
    PetscCall(WriteArray(state, full, place, slab, state->buffer));
  } else {
    PetscCall(EqmH5ReadReals(state->h5, full, slab, state->buffer));
    PetscCall(PetscSFBcastBegin(state->to_slab, row, state->buffer, local, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(state->to_slab, row, state->buffer, local, MPI_REPLACE));
    PetscCall(EqmMeshUpdateGhosts(mesh, width, local));
  }
  PetscCallMPI(MPI_Type_free(&row));
  PetscFunctionReturn(0);
}

/* ---- what must not have changed */

static PetscErrorCode Refuse(EqmState state, const char *option, const char *then, const char *now)
{
  PetscFunctionBegin;
  EqmFail(state->mesh->comm, EQM_ERR_CHECKPOINT,
          "'%s' is of another run: %s was %s there and is %s here; say the same as then, or begin anew, without "
          "-restart",
          state->h5->name, option, then, now);
}

PetscErrorCode EqmStateSameInt(EqmState state, const char *option, PetscInt64 value)
{
  PetscInt64 then = value;
  char was[32], is[32];

  PetscFunctionBegin;
  PetscCall(EqmStateInt64(state, option, &then));
  PetscCall(PetscSNPrintf(was, sizeof(was), "%" PetscInt64_FMT, then));
  PetscCall(PetscSNPrintf(is, sizeof(is), "%" PetscInt64_FMT, value));
  if (then != value) PetscCall(Refuse(state, option, was, is));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateSameReal(EqmState state, const char *option, PetscReal value)
{
  PetscReal then = value;
  char was[32], is[32];

  PetscFunctionBegin;
  PetscCall(EqmStateReal(state, option, &then));
  PetscCall(PetscSNPrintf(was, sizeof(was), "%g", (double)then));
  PetscCall(PetscSNPrintf(is, sizeof(is), "%g", (double)value));
  if (then != value) PetscCall(Refuse(state, option, was, is));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateSameText(EqmState state, const char *option, const char *value)
{
  char then[EQM_MESSAGE_MAX];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(then, value, sizeof(then)));
  PetscCall(EqmStateText(state, option, then, sizeof(then)));
  if (strcmp(then, value)) PetscCall(Refuse(state, option, then[0] ? then : "not set", value[0] ? value : "not set"));
  PetscFunctionReturn(0);
}
