/* States in files, the mesh that is kept beside them, and commits in the background. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "base/atomicfile.h"
#include "store/keptmesh.h"
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* A bit of everything. */
typedef struct {
  EqmMesh mesh;
  PetscInt count;
  PetscReal damping, pair[2], *field;
  char word[32];
} Thing;

static PetscErrorCode Visit(EqmState state, void *context)
{
  Thing *const thing = context;

  PetscFunctionBegin;
  PetscCall(EqmStateSameInt(state, "the mesh", thing->mesh->identity));
  PetscCall(EqmStateGroup(state, "thing"));
  PetscCall(EqmStateInt(state, "count", &thing->count));
  PetscCall(EqmStateReal(state, "damping", &thing->damping));
  PetscCall(EqmStateText(state, "word", thing->word, sizeof(thing->word)));
  PetscCall(EqmStateReals(state, "pair", 2, thing->pair));
  PetscCall(EqmStateVertices(state, "field", 2, thing->field));
  PetscFunctionReturn(0);
}

/* What is read is what was written, and the file before is kept until the next one is there. */
static PetscErrorCode TestRoundTrip(void)
{
  Thing there = {.count = 7, .damping = 1. / 3., .pair = {1e-300, -2.}, .word = "seven, 7"}, back = {0};
  EqmState state, writing;
  struct stat status;
  TestMesh test;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "hills", 300, 1, &test));
  there.mesh = back.mesh = test.mesh;
  PetscCall(PetscMalloc1(2 * test.mesh->num_local, &there.field));
  PetscCall(PetscCalloc1(2 * test.mesh->num_local, &back.field));
  for (PetscInt v = 0; v < 2 * test.mesh->num_local; v++)
    there.field[v] = TestRandom(1, test.mesh->global[v / 2], v % 2);
  for (there.count = 6; there.count < 8; there.count++) {
    PetscCall(EqmStateSave(test.mesh, "thing.ck", Visit, &there, &writing));
    PetscCall(EqmStateFinish(&writing));
  }
  CHECK(!writing && !stat("thing.ck.previous", &status), "no previous file");
  PetscCall(EqmStateOpen(test.mesh, "thing.ck", &state));
  PetscCall(Visit(state, &back));
  PetscCall(EqmStateClose(&state));
  CHECK(back.count == 7 && back.damping == there.damping && !strcmp(back.word, there.word), "%d", (int)back.count);
  CHECK(!memcmp(back.pair, there.pair, sizeof(there.pair)), "the pair");
  CHECK(!memcmp(back.field, there.field, 2 * sizeof(*there.field) * (size_t)test.mesh->num_local), "the field");
  PetscCall(EqmStateOpen(test.mesh, "thing.ck.previous", &state));
  PetscCall(Visit(state, &back));
  PetscCall(EqmStateClose(&state));
  CHECK(back.count == 6, "the file before is %d", (int)back.count);
  PetscCall(PetscFree(there.field));
  PetscCall(PetscFree(back.field));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* The thread's success and failure come to the one that waits; a file that is given up leaves nothing. */
static PetscErrorCode TestBackground(void)
{
  char error[EQM_MESSAGE_MAX] = "", temporary[PETSC_MAX_PATH_LEN], text[8] = "";
  EqmAtomicFile file;
  PetscMPIInt rank;
  FILE *stream;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank) PetscFunctionReturn(0);
  CHECK(!EqmAtomicOpen("slow", &file, error, sizeof(error)), "%s", error);
  EqmAtomicPrint(&file, "new");
  EqmAtomicCommitBegin(&file);
  CHECK(!EqmAtomicCommit(&file, error, sizeof(error)), "%s", error);
  stream = fopen("slow", "r");
  CHECK(stream && fread(text, 1, 3, stream) == 3 && !strcmp(text, "new") && !fclose(stream), "'%s'", text);
  CHECK(!EqmAtomicBegin("slow", &file, error, sizeof(error)), "%s", error);
  CHECK(!unlink(file.temporary), "no temporary");
  EqmAtomicCommitBegin(&file);
  CHECK(EqmAtomicCommit(&file, error, sizeof(error)) == EQM_ERR_IO && strstr(error, "slow"), "'%s'", error);
  CHECK(!access("slow", F_OK), "the file that was there is gone");
  CHECK(!EqmAtomicBegin("fast", &file, error, sizeof(error)), "%s", error);
  strcpy(temporary, file.temporary);
  EqmAtomicCommitBegin(&file);
  EqmAtomicAbort(&file);
  CHECK(access(temporary, F_OK), "%s is left", temporary);
  PetscFunctionReturn(0);
}

/* Inode and time: another one after every rewriting. */
static PetscErrorCode Stamp(const char *name, struct stat *status)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  CHECK(!stat(name, status), "%s is not there", name);
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(0);
}

/* Written once, anew when it is damaged or of another mesh, and never by a resumed run over a sound one. */
static PetscErrorCode TestKeptMesh(void)
{
  static const struct {
    PetscInt seed;
    PetscBool damage, resumed, written;
  } steps[] = {{1, PETSC_FALSE, PETSC_FALSE, PETSC_FALSE},
               {1, PETSC_TRUE, PETSC_TRUE, PETSC_TRUE},
               {2, PETSC_FALSE, PETSC_TRUE, PETSC_FALSE},
               {2, PETSC_FALSE, PETSC_FALSE, PETSC_TRUE}};
  struct stat before, after;
  char name[PETSC_MAX_PATH_LEN];
  EqmSoup soup, back;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(EqmKeptMeshName("a.b/run", NULL, name, sizeof(name)));
  CHECK(!strcmp(name, "a.b/run.mesh.h5"), "%s", name);
  PetscCall(EqmKeptMeshName("run.ck.h5", NULL, name, sizeof(name)));
  CHECK(!strcmp(name, "run.ck.mesh.h5"), "%s", name);
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "hills", 300, 1, &soup));
  PetscCall(EqmKeptMeshWrite(soup, NULL, name, PETSC_FALSE));
  PetscCall(EqmSoupDestroy(&soup));
  for (size_t k = 0; k < sizeof(steps) / sizeof(steps[0]); k++) {
    if (steps[k].damage && rank == 0) CHECK(!truncate(name, 3000), "cannot cut %s", name);
    PetscCall(Stamp(name, &before));
    PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "hills", 300, steps[k].seed, &soup));
    PetscCall(EqmKeptMeshWrite(soup, NULL, name, steps[k].resumed));
    PetscCall(Stamp(name, &after));
    CHECK((before.st_ino != after.st_ino) == (steps[k].written == PETSC_TRUE), "step %d", (int)k);
    PetscCall(EqmKeptMeshRead(PETSC_COMM_WORLD, name, &back));
    CHECK((back->checksum == soup->checksum) == (k != 2), "step %d: another mesh", (int)k);
    PetscCall(EqmSoupDestroy(&soup));
    PetscCall(EqmSoupDestroy(&back));
  }
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  char folder[64] = "/tmp/equimap_state_XXXXXX", command[128];
  PetscMPIInt rank;

  PetscCall(EqmInitialize(&argc, &argv));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) CHECK(mkdtemp(folder), "no folder");
  PetscCallMPI(MPI_Bcast(folder, sizeof(folder), MPI_CHAR, 0, PETSC_COMM_WORLD));
  CHECK(!chdir(folder), "%s", folder);
  PetscCall(TestRoundTrip());
  PetscCall(TestBackground());
  PetscCall(TestKeptMesh());
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  (void)snprintf(command, sizeof(command), "rm -r '%s'", folder);
  if (rank == 0) CHECK(!chdir("/") && !system(command), "%s stays", folder);
  PetscCall(EqmFinalize());
  return 0;
}
