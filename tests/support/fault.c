/* A library of faults, loaded before the program (LD_PRELOAD). One fault per run:

   FAULT_ALLOCATION=K   the K-th allocation fails, of those asked for from a place not seen before
   FAULT_SIGNAL=N@K     the K-th time that a phase begins, the process sends itself signal N
   FAULT_NAN=K          the K-th sum of reals over all ranks is no number, on every rank
   FAULT_RANK=R         the first two on this rank alone (default: 0), whose number the launcher gives
   FAULT_TRACE=1        the callers of the allocation that fails are printed
   FAULT_REPORT=FILE    how many places, phases and sums were counted is appended there when the process ends

   A place is the stack of the innermost callers: a small run has some thousand places, not millions of allocations.
   Counted are calls of the program and of the libraries listed below; those of Open MPI, the linker and the C library
   are not ours to survive. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <math.h>
#include <mpi.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { DEPTH = 10, SLOTS = 1 << 18 };

static const char *const counted[] = {"/equimap", "libpetsc", "libslepc", "libcholmod", "libmetis",
                                      "libhdf5",  "libxml2.", "libcjson", "libz."};
static uint64_t seen[SLOTS];
static long places, phases, sums, bad_allocation, bad_sum, signal_number, bad_phase;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static __thread int inside;
static int ready, counts_sums;

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);

/* May an allocation that returns there fail? */
static int IsCounted(void *address)
{
  Dl_info info;

  if (!dladdr(address, &info) || !info.dli_fname) return 0;
  for (size_t k = 0; k < sizeof(counted) / sizeof(counted[0]); k++) {
    if (strstr(info.dli_fname, counted[k])) return 1;
  }
  return 0;
}

static int IsNew(void *const *stack, int depth)
{
  uint64_t hash = UINT64_C(1469598103934665603);
  size_t slot;

  for (int k = 0; k < depth; k++) hash = (hash ^ (uint64_t)(uintptr_t)stack[k]) * UINT64_C(1099511628211);
  hash += hash == 0;
  for (slot = hash % SLOTS; seen[slot] && seen[slot] != hash;) slot = (slot + 1) % SLOTS;
  if (seen[slot]) return 0;
  seen[slot] = hash;
  return 1;
}

/* Called for every allocation, with the address that it returns to. Never inlined: two frames of the stack are ours. */
__attribute__((noinline)) static int MustFail(void *caller)
{
  void *stack[DEPTH];
  int fails = 0;

  if (!ready || inside) return 0;
  inside = 1;
  if (IsCounted(caller)) {
    const int depth = backtrace(stack, DEPTH);

    pthread_mutex_lock(&lock);
    if (places < SLOTS / 2 && IsNew(stack + 2, depth - 2)) fails = ++places == bad_allocation;
    pthread_mutex_unlock(&lock);
    if (fails && getenv("FAULT_TRACE")) backtrace_symbols_fd(stack, depth, STDERR_FILENO);
  }
  inside = 0;
  if (fails) errno = ENOMEM;
  return fails;
}

void *malloc(size_t size)
{
  return MustFail(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
  return MustFail(__builtin_return_address(0)) ? NULL : __libc_calloc(count, size);
}

void *realloc(void *block, size_t size)
{
  return MustFail(__builtin_return_address(0)) ? NULL : __libc_realloc(block, size);
}

void *memalign(size_t alignment, size_t size)
{
  return MustFail(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
  return MustFail(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **block, size_t alignment, size_t size)
{
  void *const found = MustFail(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, size);

  if (!found) return ENOMEM;
  *block = found;
  return 0;
}

/* A phase of equimap is a stage of PETSc's log. */
int PetscLogStagePush(int stage)
{
  int (*next)(int) = (int (*)(int))(uintptr_t)dlsym(RTLD_NEXT, "PetscLogStagePush");

  if (ready && ++phases == bad_phase) (void)raise((int)signal_number);
  return next(stage);
}

/* Sums over ranks: energies, norms, products. The same one is spoiled on every rank. */
int MPI_Allreduce(const void *mine, void *all, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm)
{
  const int error = PMPI_Allreduce(mine, all, count, type, op, comm);

  if (!error && counts_sums && type == MPI_DOUBLE && op == MPI_SUM && ++sums == bad_sum) *(double *)all = NAN;
  return error;
}

static long Number(const char *name)
{
  const char *const text = getenv(name);

  return text ? atol(text) : 0;
}

__attribute__((constructor)) static void Begin(void)
{
  const char *const rank = getenv("OMPI_COMM_WORLD_RANK"), *const at = getenv("FAULT_SIGNAL")
                                                                           ? strchr(getenv("FAULT_SIGNAL"), '@')
                                                                           : NULL;
  void *stack[2];

  bad_sum = Number("FAULT_NAN");
  counts_sums = 1;
  if ((rank ? atol(rank) : 0) != Number("FAULT_RANK")) return;
  inside = 1;
  bad_allocation = Number("FAULT_ALLOCATION");
  signal_number = Number("FAULT_SIGNAL");
  bad_phase = at ? atol(at + 1) : 0;
  (void)backtrace(stack, 2); /* loads the unwinder, which allocates */
  inside = 0;
  ready = 1;
}

__attribute__((destructor)) static void End(void)
{
  FILE *report;

  if (!ready) return;
  ready = 0;
  report = getenv("FAULT_REPORT") ? fopen(getenv("FAULT_REPORT"), "a") : NULL;
  if (!report) return;
  (void)fprintf(report, "%ld %ld %ld\n", places, phases, sums);
  (void)fclose(report);
}
