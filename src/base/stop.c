#define _GNU_SOURCE
#include "base/stop.h"
#include "base/atomicfile.h"
#include <libgen.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>

/* Global by nature: a process has one set of signals. */
static volatile sig_atomic_t caught = EQM_STOP_NONE;

static void RemoveAndEnd(int signal_number)
{
  EqmAtomicAbandonAll();
  (void)signal(signal_number, SIG_DFL);
  (void)raise(signal_number);
}

void EqmStopRemoveTemporaries(void)
{
  static const int signals[] = {SIGTERM, SIGINT, SIGHUP};

  for (size_t k = 0; k < sizeof(signals) / sizeof(signals[0]); k++) {
    struct sigaction before;

    if (!sigaction(signals[k], NULL, &before) && before.sa_handler == SIG_IGN) continue; /* nohup */
    (void)signal(signals[k], RemoveAndEnd);
  }
}

static void Note(int signal_number)
{
  caught = signal_number == SIGTERM ? EQM_STOP_TERM : EQM_STOP_USR1;
}

/* Batch systems send TERM more than once (to the launcher and to the ranks): every one of them is only noted. Whoever
   sees one rank at work may send a signal to all. */
PetscErrorCode EqmStopCatchSignals(MPI_Comm comm)
{
  struct sigaction action;

  PetscFunctionBegin;
  memset(&action, 0, sizeof(action));
  action.sa_handler = Note;
  action.sa_flags = SA_RESTART;
  (void)sigemptyset(&action.sa_mask);
  (void)sigaction(SIGUSR1, &action, NULL);
  (void)sigaction(SIGTERM, &action, NULL);
  PetscCallMPI(MPI_Barrier(comm));
  PetscFunctionReturn(0);
}

static void Stamp(const char *name, long long stamp[3])
{
  struct stat status;

  memset(stamp, 0, 3 * sizeof(*stamp));
  if (stat(name, &status)) return;
  stamp[0] = (long long)status.st_ino;
  stamp[1] = (long long)status.st_mtim.tv_sec;
  stamp[2] = (long long)status.st_mtim.tv_nsec;
}

PetscErrorCode EqmStopWatchFile(MPI_Comm comm, const char *file, EqmStopFile *watch)
{
  char folder[PETSC_MAX_PATH_LEN];
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscStrncpy(folder, file, sizeof(folder)));
  PetscCall(PetscSNPrintf(watch->name, sizeof(watch->name), "%s/STOP", dirname(folder)));
  if (rank == 0) Stamp(watch->name, watch->stamp);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStopRequested(MPI_Comm comm, const EqmStopFile *watch, EqmStopReason *reason)
{
  int mine = (int)caught, all;
  long long now[3];
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0 && watch && watch->name[0]) {
    Stamp(watch->name, now);
    if (now[0] && memcmp(now, watch->stamp, sizeof(now))) mine = EQM_STOP_FILE;
  }
  PetscCallMPI(MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_MAX, comm));
  *reason = (EqmStopReason)all;
  PetscFunctionReturn(0);
}

const char *EqmStopReasonName(EqmStopReason reason)
{
  static const char *const names[] = {"nothing", "the signal USR1", "the signal TERM", "a file STOP"};

  return names[reason];
}
