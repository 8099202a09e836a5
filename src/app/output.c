/* Whether results can be written where the user wants them, asked before the run, not after it; and what the run has
   cost, known only then. */
#include "app.h"
#include "base/atomicfile.h"
#include "store/store.h"
#include <omp.h>
#include <sys/stat.h>

static PetscBool IsSameFile(const char *a, const char *b)
{
  struct stat one, other;

  return (PetscBool)(!stat(a, &one) && !stat(b, &other) && one.st_dev == other.st_dev && one.st_ino == other.st_ino);
}

/* On rank 0: a temporary is made and dropped, which knows about quotas, permissions and read-only disks. */
static PetscErrorCode Probe(const char *mesh, const char *file, char *message, size_t length)
{
  EqmAtomicFile probe;
  PetscErrorCode error;

  if (IsSameFile(mesh, file)) {
    (void)snprintf(message, length, "'%.900s' is the mesh itself and would be overwritten: give another name", file);
    return EQM_ERR_USAGE;
  }
  error = EqmAtomicBegin(file, &probe, message, length);
  if (!error) EqmAtomicAbort(&probe);
  return error;
}

/* EqmCheckOutput - look whether every name in the comma-separated `files` can be written and is another file than the
   mesh.

   Collective on PETSC_COMM_WORLD; rank 0 looks. Errors: EQM_ERR_USAGE (no name, or the mesh would be overwritten),
   EQM_ERR_IO (no such directory, no permission). */
PetscErrorCode EqmCheckOutput(const char *mesh, const char *files)
{
  char message[EQM_MESSAGE_MAX] = "", **names;
  PetscErrorCode error = 0;
  PetscMPIInt rank;
  int count;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(PetscStrToArray(files, ',', &count, &names));
  for (int k = 0; k < count && rank == 0 && !error; k++) error = Probe(mesh, names[k], message, sizeof(message));
  PetscCall(PetscStrToArrayDestroy(count, names));
  PetscCall(EqmAgree(PETSC_COMM_WORLD, error, message));
  if (!count) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-o, -summary, -history and -histogram want the name of a file");
  PetscFunctionReturn(0);
}

/* Of a file, and of those that come beside a result. */
static PetscErrorCode Sweep(const char *file)
{
  static const char *const suffixes[] = {".xmf", ".morph.xmf"};
  char name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  EqmAtomicSweep(file);
  for (size_t k = 0; k < sizeof(suffixes) / sizeof(suffixes[0]) && EqmHasSuffix(file, ".h5"); k++) {
    PetscCall(EqmNameBeside(file, suffixes[k], name, sizeof(name)));
    EqmAtomicSweep(name);
  }
  PetscFunctionReturn(0);
}

/* EqmSweepOutput - remove what a killed run has left behind of the comma-separated `files`. For runs with checkpoints,
   which are killed and begun again, one at a time.

   Collective on PETSC_COMM_WORLD; rank 0 looks. */
PetscErrorCode EqmSweepOutput(const char *files)
{
  PetscMPIInt rank;
  char **names;
  int count;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(PetscStrToArray(files, ',', &count, &names));
  for (int k = 0; k < count && rank == 0; k++) PetscCall(Sweep(names[k]));
  PetscCall(PetscStrToArrayDestroy(count, names));
  PetscFunctionReturn(0);
}

/* EqmCloseBooks - put into the map what the run has cost so far: threads, seconds, memory.

   Collective on PETSC_COMM_WORLD. */
PetscErrorCode EqmCloseBooks(EqmLedger ledger, EqmMap map)
{
  PetscFunctionBegin;
  map->threads = omp_get_max_threads();
  PetscCall(EqmLedgerGetSeconds(ledger, map->phase_seconds, map->event_seconds, &map->total_seconds));
  PetscCall(EqmGetPeakMemory(PETSC_COMM_WORLD, &map->memory_max_per_rank, &map->memory_total));
  PetscFunctionReturn(0);
}
