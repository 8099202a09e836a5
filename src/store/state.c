/* Scalars, texts and names of a state: what each call does while the state is announced, written or read. */
#include "store/state_private.h"
#include "mesh/mesh_private.h"
#include <string.h>

PetscErrorCode EqmStateTableAdd(EqmStateTable *table, const char *name, PetscInt *index)
{
  PetscFunctionBegin;
  if (table->count == table->most) {
    table->most = PetscMax(32, 2 * table->most);
    PetscCall(PetscRealloc(sizeof(*table->entry) * (size_t)table->most, &table->entry));
  }
  *index = table->count++;
  PetscCall(PetscMemzero(&table->entry[*index], sizeof(*table->entry)));
  PetscCall(PetscStrncpy(table->entry[*index].name, name, EQM_STATE_NAME));
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

/* The index of a name in its table: a new entry while announcing, the old one while reading, -1 while writing. */
PetscErrorCode EqmStateFindEntry(EqmState state, EqmStateTable *table, const char *lead, const char *name,
                                 char full[EQM_STATE_NAME], PetscInt *index)
{
  PetscFunctionBegin;
  PetscCall(FullName(state, lead, name, full));
  *index = EqmStateTableFind(table, full);
  if (state->mode == EQM_STATE_READ && *index < 0) {
    EqmFail(state->mesh->comm, EQM_ERR_CHECKPOINT,
            "'%s' says nothing of '%s': another version wrote it, or a run of another kind; begin anew, without "
            "-restart",
            state->h5->name, full);
  }
  if (state->mode == EQM_STATE_ANNOUNCE) {
    PetscCheck(*index < 0, state->mesh->comm, PETSC_ERR_PLIB, "two parts of the state are called '%s'", full);
    PetscCall(EqmStateTableAdd(table, full, index));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateInt64(EqmState state, const char *name, PetscInt64 *value)
{
  char full[EQM_STATE_NAME];
  PetscInt index;

  PetscFunctionBegin;
  PetscCall(EqmStateFindEntry(state, &state->integers, "", name, full, &index));
  if (state->mode == EQM_STATE_READ) *value = state->integers.entry[index].integer;
  if (state->mode == EQM_STATE_ANNOUNCE) state->integers.entry[index].integer = *value;
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
  PetscInt index;

  PetscFunctionBegin;
  PetscCall(EqmStateFindEntry(state, &state->reals, "", name, full, &index));
  if (state->mode == EQM_STATE_READ) *value = state->reals.entry[index].real;
  if (state->mode == EQM_STATE_ANNOUNCE) state->reals.entry[index].real = *value;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStateText(EqmState state, const char *name, char *text, size_t length)
{
  char full[EQM_STATE_NAME];
  PetscInt index;

  PetscFunctionBegin;
  PetscCall(EqmStateFindEntry(state, &state->texts, "", name, full, &index));
  if (state->mode == EQM_STATE_READ) PetscCall(PetscStrncpy(text, state->texts.entry[index].text, length));
  if (state->mode == EQM_STATE_ANNOUNCE) PetscCall(PetscStrallocpy(text, &state->texts.entry[index].text));
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
