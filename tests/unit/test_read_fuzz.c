/* Whatever the bytes of a file are, all ranks together read what one reads alone: the same mesh, or the same error with
   the same message. */
#include <equimap/soup.h>
#include <unistd.h>
#include "base/quiet.h"
#include "format/format.h"
#include "format_samples.h"
#include "mesh/soup_private.h"
#include "support/checks.h"
#include "support/mutate.h"

#define MUTATIONS_BY_PARTS 150 /* of each sample of a format that is read by all ranks */
#define MUTATIONS          5   /* of each other sample */

/* Read the file; `message` is that of the error, or empty. */
static PetscErrorCode Read(MPI_Comm comm, const char *file, EqmSoup *soup, char *message)
{
  PetscErrorCode code;

  PetscFunctionBegin;
  *soup = NULL;
  message[0] = '\0';
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  code = EqmSoupRead(comm, file, soup);
  PetscCall(PetscPopErrorHandler());
  PetscFunctionReturn(code);
}

static PetscErrorCode Compare(const char *file, const char *name, int which)
{
  char message[EQM_MESSAGE_MAX], message_alone[EQM_MESSAGE_MAX];
  EqmSoup soup, alone;
  const PetscErrorCode code_alone = Read(PETSC_COMM_SELF, file, &alone, message_alone);
  const PetscErrorCode code = Read(PETSC_COMM_WORLD, file, &soup, message);

  PetscFunctionBegin;
  CHECK(code == code_alone && !strcmp(message, message_alone), "%s, mutation %d: error %d '%s', alone %d '%s'", name,
        which, (int)code, message, (int)code_alone, message_alone);
  if (code) PetscFunctionReturn(0);
  CHECK(soup->checksum == alone->checksum && soup->num_cells == alone->num_cells &&
            soup->num_vertices == alone->num_vertices && soup->num_fields == alone->num_fields &&
            !strcmp(soup->note, alone->note) && !strcmp(soup->left, alone->left),
        "%s, mutation %d: another mesh than alone", name, which);
  PetscCall(EqmSoupDestroy(&soup));
  PetscCall(EqmSoupDestroy(&alone));
  PetscFunctionReturn(0);
}

static PetscErrorCode TrySample(const Sample *sample, const char *file, PetscMPIInt rank, uint64_t state)
{
  const int mutations = EqmFormatOfSuffix(file)->parse_part ? MUTATIONS_BY_PARTS : MUTATIONS;
  Sample changed;

  PetscFunctionBegin;
  for (int k = 0; k < mutations; k++) {
    size_t length = sample->length;

    changed = *sample;
    if (k) length = Mutate(changed.bytes, length, &state);
    PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD)); /* all have read what was there before */
    if (rank == 0) {
      FILE *const stream = fopen(file, "wb");
      CHECK(stream && fwrite(changed.bytes, 1, length, stream) == length && !fclose(stream), "cannot write %s", file);
    }
    PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
    PetscCall(Compare(file, sample->name, k));
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  if (rank == 0) CHECK(!unlink(file), "cannot remove %s", file);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Sample *samples = malloc(MAX_SAMPLES * sizeof(*samples));
  char folder[200], file[256];
  PetscMPIInt rank;
  int count;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  snprintf(folder, sizeof(folder), "%s/equimap-read-XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  if (rank == 0) CHECK(mkdtemp(folder), "no folder %s", folder);
  PetscCallMPI(MPI_Bcast(folder, sizeof(folder), MPI_CHAR, 0, PETSC_COMM_WORLD));
  count = MakeSamples(samples);
  for (int i = 0; i < count; i++) {
    if (!strcmp(samples[i].suffix, "tetgen")) continue; /* two files */
    snprintf(file, sizeof(file), "%s/mesh.%s", folder, samples[i].suffix);
    PetscCall(TrySample(&samples[i], file, rank, (uint64_t)(1000 * i)));
  }
  if (rank == 0) CHECK(!rmdir(folder), "cannot remove %s", folder);
  free(samples);
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
