/* Most of what a run takes from the system are arrays of many megabytes, and with pages of 4 kB each of them is some
   thousand interrupts when it is first written: an eighth of a large run on a virtual machine. */
#define _GNU_SOURCE
#include "base/largepages.h"
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

typedef PetscErrorCode (*Malloc)(size_t, PetscBool, int, const char[], const char[], void **);

static Malloc usual = NULL; /* PETSc's own */

/* Advice, no more: where the system has no large pages the array is as good as before. */
static void AskForLargePages(void *block, size_t size)
{
#ifdef MADV_HUGEPAGE
  const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE);
  const uintptr_t begin = ((uintptr_t)block + page - 1) / page * page, end = ((uintptr_t)block + size) / page * page;

  if (begin < end) (void)madvise((void *)begin, end - begin, MADV_HUGEPAGE);
#else
  (void)block;
  (void)size;
#endif
}

static PetscErrorCode Allocate(size_t size, PetscBool clear, int line, const char function[], const char file[],
                               void **block)
{
  const size_t large = (size_t)2 << 20; /* of x86 and of ARM with pages of 4 kB */
  PetscErrorCode code;

  if (size < large) return usual(size, clear, line, function, file, block);
  code = usual(size, PETSC_FALSE, line, function, file, block);
  if (code) return code;
  AskForLargePages(*block, size);
  if (clear) (void)memset(*block, 0, size);
  return 0;
}

PetscErrorCode EqmUseLargePages(void)
{
  PetscBool is_traced;

  PetscFunctionBegin;
  PetscCall(PetscMallocGetDebug(&is_traced, NULL, NULL));
  if (is_traced || usual) PetscFunctionReturn(0);
  usual = PetscTrMalloc;
  PetscCall(PetscMallocSet(Allocate, PetscTrFree, PetscTrRealloc));
  PetscFunctionReturn(0);
}
