/* The file of a state: written whole. */
#include "store/state_private.h"
#include "mesh/mesh_private.h"
#include <string.h>

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

static PetscErrorCode PutNames(EqmState state)
{
  PetscInt64 checksum;
  char *list;

  PetscFunctionBegin;
  for (int k = 0; k < EQM_STATE_LISTS; k++) {
    PetscCall(JoinNames(EqmStateTableOf(state, k), &list));
    PetscCheck(strlen(list) < EQM_STATE_LONGEST, state->mesh->comm, PETSC_ERR_PLIB, "a state with too many parts");
    PetscCall(EqmH5PutText(state->h5, EqmStateListNames[k], list));
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
  PetscCall(EqmH5DeclareIntegers(state->h5, EqmStateIntegersPath, state->integers.count, 0));
  PetscCall(EqmH5PutChecksum(state->h5, EqmStateIntegersPath, -1));
  PetscCall(EqmH5DeclareReals(state->h5, EqmStateRealsPath, state->reals.count, 0));
  PetscCall(EqmH5PutChecksum(state->h5, EqmStateRealsPath, -1));
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
  error =
      EqmH5WriteIntegers(state->h5, EqmStateIntegersPath, EqmStateSlab(state, num_integers, 0, PETSC_TRUE), integers);
  if (!error)
    error = EqmH5WriteReals(state->h5, EqmStateRealsPath, EqmStateSlab(state, num_reals, 0, PETSC_TRUE), reals);
  if (!error) {
    error = EqmH5PutChecksum(state->h5, EqmStateIntegersPath,
                             EqmChecksumBytes(sizeof(*integers) * (size_t)num_integers, integers).crc);
  }
  if (!error) error = EqmH5PutChecksum(state->h5, EqmStateRealsPath, EqmChecksumReals(num_reals, reals).crc);
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
  if (!error) state->h5->fixed_texts = PETSC_TRUE; /* damage to a checkpoint must be found */
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
