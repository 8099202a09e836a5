/* What the writer and the reader of a state's file share. */
#include "store/state_private.h"
#include <string.h>

const char EqmStateIntegersPath[] = "/state/integers", EqmStateRealsPath[] = "/state/reals";
const char *const EqmStateListNames[EQM_STATE_LISTS] = {"array_names", "integer_names", "real_names", "text_names"};

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

/* The table whose names are the k-th list. Not collective. */
EqmStateTable *EqmStateTableOf(EqmState state, int k)
{
  EqmStateTable *const tables[EQM_STATE_LISTS] = {&state->arrays, &state->integers, &state->reals, &state->texts};
  return tables[k];
}

/* Of all names, and of the texts. Not collective. */
PetscErrorCode EqmStateChecksumOfNames(EqmState state, PetscInt64 *checksum)
{
  EqmChecksum all = {0, 0};

  PetscFunctionBegin;
  for (int k = 0; k < EQM_STATE_LISTS; k++) {
    const EqmStateTable *const table = EqmStateTableOf(state, k);
    for (PetscInt i = 0; i < table->count; i++) {
      const char *const name = table->entry[i].name, *const text = table->entry[i].text;
      all = EqmChecksumAppend(all, EqmChecksumBytes(strlen(name) + 1, name));
      if (text) all = EqmChecksumAppend(all, EqmChecksumBytes(strlen(text) + 1, text));
    }
  }
  *checksum = all.crc;
  PetscFunctionReturn(0);
}
