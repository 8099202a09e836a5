/* Opening the file of a state: all of it is checked before anything is read from it. */
#include "store/state_private.h"
#include "mesh/mesh_private.h"

static PetscErrorCode SplitNames(const char *list, EqmStateTable *table)
{
  char **names;
  PetscInt index;
  int count;

  PetscFunctionBegin;
  PetscCall(PetscStrToArray(list, ',', &count, &names));
  for (int k = 0; k < count; k++) PetscCall(EqmStateTableAdd(table, names[k], &index));
  PetscCall(PetscStrToArrayDestroy(count, names));
  PetscFunctionReturn(0);
}

static PetscErrorCode Damaged(EqmState state, const char *what)
{
  PetscFunctionBegin;
  EqmFail(state->mesh->comm, EQM_ERR_CHECKPOINT, "'%s' is damaged: %s", state->h5->name, what);
}

/* Names, and texts, which stand in attributes. */
static PetscErrorCode TakeNames(EqmState state)
{
  char *list;
  PetscInt64 kept, found;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(EQM_STATE_LONGEST + 1, &list));
  for (int k = 0; k < EQM_STATE_LISTS; k++) {
    PetscCall(EqmH5GetText(state->h5, EqmStateListNames[k], "", list, EQM_STATE_LONGEST + 1));
    PetscCall(SplitNames(list, EqmStateTableOf(state, k)));
  }
  for (PetscInt k = 0; k < state->texts.count; k++) {
    PetscCall(EqmH5GetText(state->h5, state->texts.entry[k].name, "", list, EQM_STATE_LONGEST + 1));
    PetscCall(PetscStrallocpy(list, &state->texts.entry[k].text));
  }
  PetscCall(PetscFree(list));
  PetscCall(EqmH5GetInteger(state->h5, "names_crc32", -1, &kept));
  PetscCall(EqmStateChecksumOfNames(state, &found));
  if (found != kept) PetscCall(Damaged(state, "the checksum of its names is wrong"));
  PetscFunctionReturn(0);
}

/* Find an array and see that it has the shape of its kind. */
static PetscErrorCode FindArray(EqmState state, const char *path, PetscInt64 *total, PetscInt64 *width)
{
  PetscBool has;

  PetscFunctionBegin;
  PetscCall(EqmH5HasDataset(state->h5, path, &has));
  if (!has) PetscCall(Damaged(state, "an array is not there"));
  PetscCall(EqmH5GetShape(state->h5, path, total, width));
  if (*total < 1 || *total > PETSC_MAX_INT || *width > 1024) PetscCall(Damaged(state, "an array has a wrong shape"));
  PetscFunctionReturn(0);
}

static PetscErrorCode CompareChecksum(EqmState state, const char *path, EqmChecksum found)
{
  char what[EQM_STATE_NAME + 64];
  PetscInt64 kept;

  PetscFunctionBegin;
  PetscCall(EqmH5GetChecksum(state->h5, path, &kept));
  if (kept == found.crc) PetscFunctionReturn(0);
  PetscCall(PetscSNPrintf(what, sizeof(what), "the checksum of %s is wrong", path));
  PetscCall(Damaged(state, what));
  PetscFunctionReturn(0);
}

/* Read an array once, only to see whether it is as it was written. */
static PetscErrorCode CheckArray(EqmState state, const char *path)
{
  PetscInt64 total, width;
  EqmChecksum found;
  EqmSlab slab;
  PetscReal *values;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(FindArray(state, path, &total, &width));
  slab = EqmStateSlab(state, (PetscInt)total, (PetscInt)width, PETSC_FALSE);
  PetscCall(PetscMalloc1((size_t)slab.count * (size_t)PetscMax(width, 1), &values));
  error = EqmH5ReadReals(state->h5, path, slab, values);
  found = EqmChecksumReals(slab.count * PetscMax(width, 1), values);
  PetscCall(PetscFree(values));
  PetscCall(error);
  PetscCall(EqmChecksumJoin(state->mesh->comm, found, &found));
  PetscCall(CompareChecksum(state, path, found));
  PetscFunctionReturn(0);
}

/* Every rank reads all scalars. */
static PetscErrorCode TakeScalars(EqmState state)
{
  EqmStateTable *const integers = &state->integers, *const reals = &state->reals;
  PetscInt64 total, width, *integer;
  PetscReal *real;
  EqmChecksum found[2];

  PetscFunctionBegin;
  PetscCall(FindArray(state, EqmStateIntegersPath, &total, &width));
  if (total != integers->count || width) PetscCall(Damaged(state, "names and integers do not belong together"));
  PetscCall(FindArray(state, EqmStateRealsPath, &total, &width));
  if (total != reals->count || width) PetscCall(Damaged(state, "names and reals do not belong together"));
  PetscCall(PetscMalloc2(integers->count, &integer, reals->count, &real));
  PetscCall(EqmH5ReadIntegers(state->h5, EqmStateIntegersPath,
                              (EqmSlab){.total = integers->count, .count = integers->count}, integer));
  PetscCall(
      EqmH5ReadReals(state->h5, EqmStateRealsPath, (EqmSlab){.total = reals->count, .count = reals->count}, real));
  for (PetscInt k = 0; k < integers->count; k++) integers->entry[k].integer = integer[k];
  for (PetscInt k = 0; k < reals->count; k++) reals->entry[k].real = real[k];
  found[0] = EqmChecksumBytes(sizeof(*integer) * (size_t)integers->count, integer);
  found[1] = EqmChecksumReals(reals->count, real);
  PetscCall(PetscFree2(integer, real));
  PetscCall(CompareChecksum(state, EqmStateIntegersPath, found[0]));
  PetscCall(CompareChecksum(state, EqmStateRealsPath, found[1]));
  PetscFunctionReturn(0);
}

static PetscErrorCode Check(EqmState state)
{
  PetscInt64 complete, layout;

  PetscFunctionBegin;
  PetscCall(EqmH5GetInteger(state->h5, "complete", 0, &complete));
  PetscCall(EqmH5GetInteger(state->h5, "state_layout", -1, &layout));
  if (layout == -1) EqmFail(state->mesh->comm, EQM_ERR_CHECKPOINT, "'%s' is not a checkpoint", state->h5->name);
  if (!complete) PetscCall(Damaged(state, "it was not written to its end"));
  if (layout != EQM_STATE_LAYOUT) {
    EqmFail(state->mesh->comm, EQM_ERR_CHECKPOINT,
            "'%s' was written by another version, in a layout that this one does not know", state->h5->name);
  }
  PetscCall(TakeNames(state));
  PetscCall(TakeScalars(state));
  for (PetscInt k = 0; k < state->arrays.count; k++) PetscCall(CheckArray(state, state->arrays.entry[k].name));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateOpen(EqmMesh mesh, const char *file, EqmState *state)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(EqmStateCreate(mesh, EQM_STATE_READ, state));
  error = EqmH5Open(mesh->comm, file, &(*state)->h5);
  if (!error) error = Check(*state);
  if (error) PetscCall(EqmStateClose(state));
  PetscCall(error);
  PetscFunctionReturn(0);
}
