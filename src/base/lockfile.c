#define _GNU_SOURCE
#include "base/lockfile.h"
#include "base/temporaries.h"
#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

/* Is the file that was opened still the one of that name? Whoever held the lock before has removed it. */
static PetscBool IsCurrent(int descriptor, const char *name)
{
  struct stat mine, there;

  return (PetscBool)(!fstat(descriptor, &mine) && !stat(name, &there) && mine.st_dev == there.st_dev &&
                     mine.st_ino == there.st_ino);
}

/* The number of the process that holds the lock; 0 if it is ours now, or nobody can have it. */
static long TryLock(EqmLock *lock)
{
  struct flock all = {.l_type = F_WRLCK, .l_whence = SEEK_SET};

  for (int attempt = 0; attempt < 100; attempt++) {
    lock->descriptor = open(lock->name, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock->descriptor < 0) break;
    if (fcntl(lock->descriptor, F_SETLK, &all)) {
      const PetscBool is_held = (PetscBool)(errno == EACCES || errno == EAGAIN);

      if (!is_held) (void)unlink(lock->name); /* no locks on this file system */
      if (is_held && fcntl(lock->descriptor, F_GETLK, &all)) all.l_pid = -1;
      (void)close(lock->descriptor);
      if (!is_held) break;
      if (all.l_type != F_UNLCK) return all.l_pid ? (long)all.l_pid : -1L;
      all.l_type = F_WRLCK; /* it has just been released */
      continue;
    }
    if (IsCurrent(lock->descriptor, lock->name)) {
      EqmNoteTemporary(lock->name);
      return 0;
    }
    (void)close(lock->descriptor);
  }
  lock->name[0] = '\0';
  lock->descriptor = -1;
  return 0;
}

PetscErrorCode EqmLockTake(MPI_Comm comm, const char *file, const char *what, EqmLock *lock)
{
  long holder = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  lock->name[0] = '\0';
  lock->descriptor = -1;
  if (rank == 0) {
    PetscCall(PetscSNPrintf(lock->name, sizeof(lock->name), "%s.lock", file));
    holder = TryLock(lock);
    if (holder) lock->name[0] = '\0';
  }
  PetscCallMPI(MPI_Bcast(&holder, 1, MPI_LONG, 0, comm));
  if (holder)
    EqmFail(comm, EQM_ERR_USAGE, "%s %s: another run writes it (process %ld); name another file, or wait for its end",
            what, file, holder);
  PetscFunctionReturn(0);
}

void EqmLockRelease(EqmLock *lock)
{
  if (!lock->name[0]) return;
  (void)unlink(lock->name); /* while nobody else can hold it */
  EqmForgetTemporary(lock->name);
  (void)close(lock->descriptor);
  lock->name[0] = '\0';
}
