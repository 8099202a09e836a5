/* HDF5 begins before MPI does, and before anything of ours watches for crashes. */
#define _GNU_SOURCE
#include "loading.h"
#include "h5/load.h"
#include <signal.h>

/* EqmLoadHdf5 - HDF5 begins; whether it could. Where an allocation fails meanwhile it calls itself until the stack is
   full: `at_crash`, which must not return, has a stack of its own. */
PetscBool EqmLoadHdf5(void (*at_crash)(int))
{
  static char room[1 << 16];
  const stack_t stack = {.ss_sp = room, .ss_size = sizeof(room)}, none = {.ss_flags = SS_DISABLE};
  struct sigaction crash = {.sa_handler = at_crash, .sa_flags = SA_ONSTACK}, before;
  const PetscBool watches = (PetscBool)(!sigaltstack(&stack, NULL) && !sigaction(SIGSEGV, &crash, &before));
  const PetscBool loaded = EqmH5Load();

  if (watches) (void)sigaction(SIGSEGV, &before, NULL);
  (void)sigaltstack(&none, NULL);
  return loaded;
}
