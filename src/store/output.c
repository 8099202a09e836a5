/* Before a run: can its files be written? Removal of temporaries that a killed run has left. */
#include "store/output.h"
#include "base/atomicfile.h"
#include "store/store.h"
#include <sys/stat.h>

static PetscBool IsSameFile(const char *a, const char *b)
{
  struct stat one, other;

  return (PetscBool)(!stat(a, &one) && !stat(b, &other) && one.st_dev == other.st_dev && one.st_ino == other.st_ino);
}

/* On one rank: a temporary is made and removed, the only test that knows about quotas, permissions and read-only
   disks. */
static PetscErrorCode Probe(const char *mesh, const char *file, char *message, size_t length)
{
  EqmAtomicFile probe;
  PetscErrorCode error;

  if (mesh && IsSameFile(mesh, file)) {
    (void)snprintf(message, length, "'%.900s' is the mesh itself and would be overwritten: give another name", file);
    return EQM_ERR_USAGE;
  }
  error = EqmAtomicBegin(file, &probe, message, length);
  if (!error) EqmAtomicAbort(&probe);
  return error;
}

PetscErrorCode EqmCheckOutput(MPI_Comm comm, const char *mesh, const char *files)
{
  char message[EQM_MESSAGE_MAX] = "", **names;
  PetscErrorCode error = 0;
  PetscMPIInt rank;
  int count;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscStrToArray(files, ',', &count, &names));
  for (int k = 0; k < count && rank == 0 && !error; k++) error = Probe(mesh, names[k], message, sizeof(message));
  PetscCall(PetscStrToArrayDestroy(count, names));
  PetscCall(EqmAgree(comm, error, message));
  if (!count) EqmFail(comm, EQM_ERR_USAGE, "-o, -summary, -history and -histogram need the name of a file");
  PetscFunctionReturn(0);
}

/* Of a file, and of those that are written beside a result. */
static PetscErrorCode Sweep(const char *file)
{
  static const char *const suffixes[] = {".xmf", ".map.xmf", ".morph.xmf"};
  char name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  EqmAtomicSweep(file);
  for (size_t k = 0; k < sizeof(suffixes) / sizeof(suffixes[0]) && EqmHasSuffix(file, ".h5"); k++) {
    PetscCall(EqmNameBeside(file, suffixes[k], name, sizeof(name)));
    EqmAtomicSweep(name);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSweepOutput(MPI_Comm comm, const char *files)
{
  PetscMPIInt rank;
  char **names;
  int count;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscStrToArray(files, ',', &count, &names));
  for (int k = 0; k < count && rank == 0; k++) PetscCall(Sweep(names[k]));
  PetscCall(PetscStrToArrayDestroy(count, names));
  PetscFunctionReturn(0);
}
