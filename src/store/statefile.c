/* The file of a state: written whole, and looked through from end to end before anything is taken from it. */
#include "store/state_private.h"
#include "store/store.h"
#include <string.h>

static const char integers_path[] = "/state/integers", reals_path[] = "/state/reals";
enum { LONGEST_LIST = 60000 };

PetscErrorCode EqmStatePreviousName(const char *file, char *previous, size_t length)
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(previous, length, "%s.previous", file));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateCreate(EqmMesh mesh, EqmStateMode mode, EqmState *state)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(state));
  (*state)->mesh = mesh;
  (*state)->mode = mode;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmStateClose(EqmState *state)
{
  EqmState s = *state;

  PetscFunctionBegin;
  if (!s) PetscFunctionReturn(0);
  PetscCall(EqmH5Close(&s->h5));
  PetscCall(EqmStateTableReset(&s->arrays));
  PetscCall(EqmStateTableReset(&s->integers));
  PetscCall(EqmStateTableReset(&s->reals));
  PetscCall(EqmStateTableReset(&s->texts));
  PetscCall(PetscSFDestroy(&s->to_slab));
  PetscCall(PetscFree(s->buffer));
  PetscCall(PetscFree(*state));
  PetscFunctionReturn(0);
}

/* ---- names */

static const char *const list_names[] = {"array_names", "integer_names", "real_names", "text_names"};
enum { NUM_LISTS = sizeof(list_names) / sizeof(list_names[0]) };

static EqmStateTable *Table(EqmState state, int k)
{
  EqmStateTable *const tables[NUM_LISTS] = {&state->arrays, &state->integers, &state->reals, &state->texts};
  return tables[k];
}

/* All names of a table, with commas between them. */
static PetscErrorCode JoinNames(const EqmStateTable *table, char **list)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc1((size_t)(table->count + 1) * EQM_STATE_NAME, list));
  for (PetscInt k = 0; k < table->count; k++) {
    if (k) strcat(*list, ",");
    strcat(*list, table->entry[k].name);
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode SplitNames(const char *list, EqmStateTable *table)
{
  char **names;
  PetscInt place;
  int count;

  PetscFunctionBegin;
  PetscCall(PetscStrToArray(list, ',', &count, &names));
  for (int k = 0; k < count; k++) PetscCall(EqmStateTableAdd(table, names[k], &place));
  PetscCall(PetscStrToArrayDestroy(count, names));
  PetscFunctionReturn(0);
}

/* Of all names, and of the texts. Not collective. */
PetscErrorCode EqmStateChecksumOfNames(EqmState state, PetscInt64 *checksum)
{
  EqmChecksum all = {0, 0};

  PetscFunctionBegin;
  for (int k = 0; k < NUM_LISTS; k++) {
    const EqmStateTable *const table = Table(state, k);
    for (PetscInt i = 0; i < table->count; i++) {
      const char *const name = table->entry[i].name, *const text = table->entry[i].text;
      all = EqmChecksumAppend(all, EqmChecksumBytes(strlen(name) + 1, name));
      if (text) all = EqmChecksumAppend(all, EqmChecksumBytes(strlen(text) + 1, text));
    }
  }
  *checksum = all.crc;
  PetscFunctionReturn(0);
}

/* ---- saving */

static PetscErrorCode PutNames(EqmState state)
{
  PetscInt64 checksum;
  char *list;

  PetscFunctionBegin;
  for (int k = 0; k < NUM_LISTS; k++) {
    PetscCall(JoinNames(Table(state, k), &list));
    PetscCheck(strlen(list) < LONGEST_LIST, state->mesh->comm, PETSC_ERR_PLIB, "a state with too many parts");
    PetscCall(EqmH5PutText(state->h5, list_names[k], list));
    PetscCall(PetscFree(list));
  }
  for (PetscInt k = 0; k < state->texts.count; k++)
    PetscCall(EqmH5PutText(state->h5, state->texts.entry[k].name, state->texts.entry[k].text));
  PetscCall(EqmStateChecksumOfNames(state, &checksum));
  PetscCall(EqmH5PutInteger(state->h5, "names_crc32", checksum));
  PetscFunctionReturn(0);
}

/* Where the numbers of a table will stand. */
static PetscErrorCode DeclareScalars(EqmState state)
{
  PetscFunctionBegin;
  PetscCall(EqmH5DeclareIntegers(state->h5, integers_path, state->integers.count, 0));
  PetscCall(EqmH5PutChecksum(state->h5, integers_path, -1));
  PetscCall(EqmH5DeclareReals(state->h5, reals_path, state->reals.count, 0));
  PetscCall(EqmH5PutChecksum(state->h5, reals_path, -1));
  PetscFunctionReturn(0);
}

static PetscErrorCode WriteScalars(EqmState state)
{
  const PetscInt num_integers = state->integers.count, num_reals = state->reals.count;
  PetscInt64 *integers;
  PetscReal *reals;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(num_integers, &integers, num_reals, &reals));
  for (PetscInt k = 0; k < num_integers; k++) integers[k] = state->integers.entry[k].integer;
  for (PetscInt k = 0; k < num_reals; k++) reals[k] = state->reals.entry[k].real;
  error = EqmH5WriteIntegers(state->h5, integers_path, EqmStateSlab(state, num_integers, 0, PETSC_TRUE), integers);
  if (!error) error = EqmH5WriteReals(state->h5, reals_path, EqmStateSlab(state, num_reals, 0, PETSC_TRUE), reals);
  if (!error) {
    error = EqmH5PutChecksum(state->h5, integers_path,
                             EqmChecksumBytes(sizeof(*integers) * (size_t)num_integers, integers).crc);
  }
  if (!error) error = EqmH5PutChecksum(state->h5, reals_path, EqmChecksumReals(num_reals, reals).crc);
  PetscCall(PetscFree2(integers, reals));
  PetscCall(error);
  PetscFunctionReturn(0);
}

static PetscErrorCode Fill(EqmState state, EqmStateVisit visit, void *context)
{
  PetscFunctionBegin;
  PetscCall(visit(state, context));
  PetscCall(DeclareScalars(state));
  PetscCall(PutNames(state));
  PetscCall(EqmH5PutInteger(state->h5, "state_layout", EQM_STATE_LAYOUT));
  PetscCall(EqmH5PutProvenance(state->h5, state->mesh->file, state->mesh->size));
  PetscCall(EqmH5PutInteger(state->h5, "complete", 0));
  PetscCall(EqmH5Reserve(state->h5));
  PetscCall(WriteScalars(state));
  state->mode = EQM_STATE_WRITE;
  state->group[0] = '\0';
  PetscCall(visit(state, context));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateSave(EqmMesh mesh, const char *file, EqmStateVisit visit, void *context, EqmState *writing)
{
  char previous[PETSC_MAX_PATH_LEN];
  EqmState state;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(EqmStatePreviousName(file, previous, sizeof(previous)));
  PetscCall(EqmStateCreate(mesh, EQM_STATE_ANNOUNCE, &state));
  error = EqmH5Create(mesh->comm, file, &state->h5);
  if (!error) error = Fill(state, visit, context);
  if (!error) error = EqmH5KeepPrevious(state->h5, previous);
  if (!error) error = EqmH5CommitBegin(state->h5);
  if (error) PetscCall(EqmStateClose(&state));
  *writing = state;
  PetscCall(error);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateFinish(EqmState *writing)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  if (!*writing) PetscFunctionReturn(0);
  error = EqmH5CommitEnd(&(*writing)->h5);
  PetscCall(EqmStateClose(writing));
  PetscCall(error);
  PetscFunctionReturn(0);
}

/* ---- loading */

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
  PetscCall(PetscMalloc1(LONGEST_LIST + 1, &list));
  for (int k = 0; k < NUM_LISTS; k++) {
    PetscCall(EqmH5GetText(state->h5, list_names[k], "", list, LONGEST_LIST + 1));
    PetscCall(SplitNames(list, Table(state, k)));
  }
  for (PetscInt k = 0; k < state->texts.count; k++) {
    PetscCall(EqmH5GetText(state->h5, state->texts.entry[k].name, "", list, LONGEST_LIST + 1));
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
  PetscCall(FindArray(state, integers_path, &total, &width));
  if (total != integers->count || width) PetscCall(Damaged(state, "names and integers do not belong together"));
  PetscCall(FindArray(state, reals_path, &total, &width));
  if (total != reals->count || width) PetscCall(Damaged(state, "names and reals do not belong together"));
  PetscCall(PetscMalloc2(integers->count, &integer, reals->count, &real));
  PetscCall(EqmH5ReadIntegers(state->h5, integers_path, (EqmSlab){.total = integers->count, .count = integers->count},
                              integer));
  PetscCall(EqmH5ReadReals(state->h5, reals_path, (EqmSlab){.total = reals->count, .count = reals->count}, real));
  for (PetscInt k = 0; k < integers->count; k++) integers->entry[k].integer = integer[k];
  for (PetscInt k = 0; k < reals->count; k++) reals->entry[k].real = real[k];
  found[0] = EqmChecksumBytes(sizeof(*integer) * (size_t)integers->count, integer);
  found[1] = EqmChecksumReals(reals->count, real);
  PetscCall(PetscFree2(integer, real));
  PetscCall(CompareChecksum(state, integers_path, found[0]));
  PetscCall(CompareChecksum(state, reals_path, found[1]));
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
