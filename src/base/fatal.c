/* Errors after which one rank cannot go on, nor wait for the others. */
#define _GNU_SOURCE
#include "base/fatal.h"
#include "base/atomicfile.h"
#include <petscblaslapack.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

PetscBool EqmIsOutOfMemory(const char *function, PetscErrorCode code, PetscErrorType type)
{
  static const PetscErrorCode of_realloc = 1; /* what PetscRealloc returns, without a word */

  if (code == PETSC_ERR_MEM || (code == of_realloc && type == PETSC_ERROR_REPEAT)) return PETSC_TRUE;
  return (PetscBool)(function && (!strcmp(function, "PetscMallocAlign") || !strcmp(function, "PetscReallocAlign")));
}

static PetscBool is_running = PETSC_FALSE; /* between EqmWatchExits and EqmForgetEnds */

/* The first errors may come before MPI has begun. */
static void WhereAmI(MPI_Comm comm, int *rank, int *size)
{
  int has_begun = 0, has_ended = 0;

  *rank = 0;
  *size = 1;
  (void)MPI_Initialized(&has_begun);
  (void)MPI_Finalized(&has_ended);
  if (!has_begun || has_ended || comm == MPI_COMM_NULL) return;
  (void)MPI_Comm_rank(comm, rank);
  (void)MPI_Comm_size(comm, size);
}

void EqmEndAllRanks(void)
{
  int rank, size;

  is_running = PETSC_FALSE;
  EqmAtomicAbandonAll();
  (void)fflush(stdout);
  WhereAmI(PETSC_COMM_WORLD, &rank, &size);
  if (size > 1) (void)MPI_Abort(PETSC_COMM_WORLD, EQM_STATUS_INTERNAL);
  _exit(EQM_STATUS_INTERNAL); /* alone: without the launcher's lines about an abort */
}

/* PETSc's message may be no sentence: the name of a function, a number of bytes, or a blank. */
static void SayOutOfMemory(int rank, const char *message)
{
  const char *const text = message && strcmp(message, " ") ? message : NULL;

  if (text && strchr(text, ' ') && strncmp(text, "Memory requested", 16))
    (void)fprintf(stderr, "equimap: %s\n", text);
  else
    (void)fprintf(stderr,
                  "equimap: out of memory on rank %d%s%s%s; use more ranks or nodes, a smaller mesh, or raise the "
                  "limit (ulimit -v)\n",
                  rank, text ? " (" : "", text ? text : "", text ? ")" : "");
}

PetscErrorCode EqmFailForMemory(MPI_Comm comm, PetscErrorCode code, PetscErrorType type, const char *message)
{
  static PetscBool is_shared = PETSC_FALSE; /* such an error is on its way up on all ranks */
  int size, world_size, rank_of_comm, rank;

  if (type == PETSC_ERROR_REPEAT && is_shared) return code;
  WhereAmI(PETSC_COMM_WORLD, &rank, &world_size);
  WhereAmI(comm, &rank_of_comm, &size);
  is_shared = (PetscBool)(type == PETSC_ERROR_INITIAL && size > 1);
  if (rank_of_comm == 0) SayOutOfMemory(rank, message);
  if (!is_shared) EqmEndAllRanks();
  return code;
}

/* A library that has no memory may call exit by itself: HDF5 1.10 does. */
static void ExitOfALibrary(void)
{
  int rank, size;

  if (!is_running) return;
  WhereAmI(PETSC_COMM_WORLD, &rank, &size);
  (void)fprintf(
      stderr,
      "equimap: a library has ended the program on rank %d, for want of memory as it seems; use more ranks or nodes\n",
      rank);
  EqmEndAllRanks();
}

static void Crash(int signal_number)
{
  int rank, size;

  WhereAmI(PETSC_COMM_WORLD, &rank, &size);
  (void)fprintf(stderr,
                "equimap: internal error: signal %d (%s) on rank %d; this is a bug, please report the command and the "
                "mesh\n",
                signal_number, strsignal(signal_number), rank);
  EqmEndAllRanks();
}

void EqmWatchExits(void)
{
  static PetscBool is_done = PETSC_FALSE;

  is_running = PETSC_TRUE;
  if (!is_done) (void)atexit(ExitOfALibrary);
  is_done = PETSC_TRUE;
}

PetscErrorCode EqmWatchEnds(void)
{
  static const int signals[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT}; /* the last: a heap that is damaged */
  PetscBool without;

  PetscFunctionBegin;
  EqmWatchExits();
  PetscCall(PetscOptionsHasName(NULL, NULL, "-no_signal_handler", &without));
  if (without) PetscFunctionReturn(0);
  for (size_t k = 0; k < sizeof(signals) / sizeof(signals[0]); k++) (void)signal(signals[k], Crash);
  PetscFunctionReturn(0);
}

void EqmForgetEnds(void)
{
  is_running = PETSC_FALSE;
}

void EqmRefuseToBegin(int rank)
{
  if (rank == 0) (void)fputs("equimap: out of memory at the very beginning\n", stderr);
  EqmForgetEnds();
}

/* OpenBLAS asks for its work space (128 MiB of addresses) at its first call, keeps it, and where it is refused asks
   again for ever. So it is asked for where a refusal can be told. */
PetscErrorCode EqmReserveForBlas(void)
{
  static PetscBool is_done = PETSC_FALSE;
  const size_t length = (size_t)160 << 20;
  PetscReal matrix[4] = {1., 0., 0., 1.};
  PetscBLASInt n = 2, info;
  void *space;

  PetscFunctionBegin;
  if (is_done) PetscFunctionReturn(0);
  space = mmap(NULL, length, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  PetscCheck(
      space != MAP_FAILED, PETSC_COMM_SELF, PETSC_ERR_MEM,
      "out of memory: the BLAS asks for a work space of %d MB on every rank; raise the limit (ulimit -v), or use "
      "fewer ranks on a node",
      (int)(length >> 20));
  (void)munmap(space, length);
  PetscCallBLAS("LAPACKpotrf", LAPACKpotrf_("L", &n, matrix, &n, &info));
  is_done = PETSC_TRUE;
  PetscFunctionReturn(0);
}
