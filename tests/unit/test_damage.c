/* Checkpoints with one bit changed, cut short, or of another version: refused, or read as if nothing had happened. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "base/quiet.h"
#include "store/state.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FLIPS = 200, CUTS = 20 };

typedef struct {
  EqmMesh mesh;
  PetscInt count;
  PetscReal pair[2], *field;
  char word[32];
} Thing;

static PetscErrorCode Visit(EqmState state, void *context)
{
  Thing *const thing = context;

  PetscFunctionBegin;
  PetscCall(EqmStateSameInt(state, "the mesh", thing->mesh->identity));
  PetscCall(EqmStateGroup(state, "thing"));
  PetscCall(EqmStateInt(state, "count", &thing->count));
  PetscCall(EqmStateText(state, "word", thing->word, sizeof(thing->word)));
  PetscCall(EqmStateReals(state, "pair", 2, thing->pair));
  PetscCall(EqmStateVertices(state, "field", 2, thing->field));
  PetscFunctionReturn(0);
}

/* Rank 0 alone has the file in memory and writes it anew. */
static PetscErrorCode Put(const char *bytes, size_t length)
{
  PetscMPIInt rank;
  FILE *file;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) {
    file = fopen("bad.ck", "wb");
    CHECK(file && fwrite(bytes, 1, length, file) == length && !fclose(file), "cannot write");
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(0);
}

static PetscErrorCode Get(const char *name, char **bytes, size_t *length)
{
  FILE *const file = fopen(name, "rb");

  PetscFunctionBegin;
  CHECK(file && !fseek(file, 0, SEEK_END), "cannot read %s", name);
  *length = (size_t)ftell(file);
  rewind(file);
  PetscCall(PetscMalloc1(*length, bytes));
  CHECK(fread(*bytes, 1, *length, file) == *length && !fclose(file), "cannot read %s", name);
  PetscFunctionReturn(0);
}

static PetscBool IsSame(const Thing *a, const Thing *b)
{
  return (PetscBool)(a->count == b->count && !strcmp(a->word, b->word) && !memcmp(a->pair, b->pair, sizeof(a->pair)) &&
                     !memcmp(a->field, b->field, 2 * sizeof(*a->field) * (size_t)a->mesh->num_owned));
}

/* Read the damaged file: refused with a sentence, or the same contents; true if it was refused. */
static PetscErrorCode Try(const Thing *there, Thing *back, const char *what, size_t which, PetscBool *refused)
{
  char message[EQM_MESSAGE_MAX] = "";
  EqmState state = NULL;
  PetscErrorCode error;

  PetscFunctionBegin;
  back->count = -1;
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmStateOpen(there->mesh, "bad.ck", &state);
  if (!error) error = Visit(state, back);
  PetscCall(PetscPopErrorHandler());
  PetscCall(EqmStateClose(&state));
  *refused = (PetscBool)(error != 0);
  if (error)
    CHECK((error == EQM_ERR_CHECKPOINT || error == EQM_ERR_IO) && message[0], "%s %zu: error %d, '%s'", what, which,
          (int)error, message);
  else
    CHECK(IsSame(there, back), "%s %zu: read as sound, with other contents", what, which);
  PetscFunctionReturn(0);
}

static PetscErrorCode TestDamage(Thing *there, Thing *back, char *bytes, size_t length)
{
  PetscInt num_refused = 0;
  PetscBool refused;

  PetscFunctionBegin;
  for (size_t k = 0; k < FLIPS; k++) {
    const size_t at = (size_t)((.5 + .5 * TestRandom(7, (PetscInt)k, 0)) * (PetscReal)length) % length;
    const int bit = 1 << (int)((.5 + .5 * TestRandom(7, (PetscInt)k, 1)) * 7.99);

    bytes[at] = (char)(bytes[at] ^ bit);
    PetscCall(Put(bytes, length));
    bytes[at] = (char)(bytes[at] ^ bit);
    PetscCall(Try(there, back, "bit flipped at", at, &refused));
    num_refused += refused;
  }
  CHECK(num_refused > FLIPS / 4, "of %d changed bits only %d are found", FLIPS, (int)num_refused);
  for (size_t k = 0; k < CUTS; k++) {
    const size_t end = k * length / CUTS;

    PetscCall(Put(bytes, end));
    PetscCall(Try(there, back, "cut to", end, &refused));
    CHECK(refused, "cut to %zu of %zu bytes, and read", end, length);
  }
  PetscFunctionReturn(0);
}

/* A sound file that says it is of another layout. */
static PetscErrorCode TestOtherVersion(const Thing *there, Thing *back, const char *bytes, size_t length)
{
  const char command[] = "/usr/bin/python3 -c \"import h5py; h5py.File('bad.ck', 'r+').attrs['state_layout'] = 99\"";
  PetscBool refused;
  PetscMPIInt rank;
  int changed = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(Put(bytes, length));
  if (rank == 0) changed = !system(command);
  PetscCallMPI(MPI_Bcast(&changed, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  PetscCall(Try(there, back, "version", 99, &refused));
  CHECK(refused == (PetscBool)(changed != 0), "another version is %s", refused ? "refused" : "read");
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  char folder[64] = "/tmp/equimap_damage_XXXXXX", command[128], *bytes;
  Thing there = {.count = 7, .pair = {1e-300, -2.}, .word = "seven, 7"}, back = {0};
  EqmState writing;
  PetscMPIInt rank;
  TestMesh test;
  size_t length;

  PetscCall(EqmInitialize(&argc, &argv));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) CHECK(mkdtemp(folder), "no folder");
  PetscCallMPI(MPI_Bcast(folder, sizeof(folder), MPI_CHAR, 0, PETSC_COMM_WORLD));
  CHECK(!chdir(folder), "%s", folder);
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "hills", 60, 1, &test));
  there.mesh = back.mesh = test.mesh;
  PetscCall(PetscMalloc2(2 * test.mesh->num_local, &there.field, 2 * test.mesh->num_local, &back.field));
  for (PetscInt v = 0; v < 2 * test.mesh->num_local; v++)
    there.field[v] = TestRandom(1, test.mesh->global[v / 2], v % 2);
  PetscCall(EqmStateSave(test.mesh, "good.ck", Visit, &there, &writing));
  PetscCall(EqmStateFinish(&writing));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscCall(Get("good.ck", &bytes, &length));
  PetscCall(TestDamage(&there, &back, bytes, length));
  PetscCall(TestOtherVersion(&there, &back, bytes, length));
  PetscCall(PetscFree(bytes));
  PetscCall(PetscFree2(there.field, back.field));
  PetscCall(TestMeshDestroy(&test));
  (void)snprintf(command, sizeof(command), "rm -r '%s'", folder);
  if (rank == 0) CHECK(!chdir("/") && !system(command), "%s stays", folder);
  PetscCall(EqmFinalize());
  return 0;
}
