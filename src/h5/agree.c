/* The same outcome of an HDF5 call on all ranks, and the reason of a failure. */
#include "h5/h5.h"
#include <stdio.h>

typedef struct {
  char *text;
  size_t length;
} Cause;

static PetscBool no_memory = PETSC_FALSE; /* an allocation of HDF5 has failed since a file was begun */

static herr_t LookForMemory(unsigned n, const H5E_error2_t *entry, void *context)
{
  (void)n;
  (void)context;
  if (entry->min_num == H5E_NOSPACE || entry->min_num == H5E_CANTALLOC) no_memory = PETSC_TRUE;
  return 0;
}

/* Called by HDF5 when a call fails, in place of its printing: what a later call that succeeds would
   wipe out is noted. */
static herr_t NoteFailure(hid_t stack, void *context)
{
  (void)H5Ewalk2(stack, H5E_WALK_UPWARD, LookForMemory, context);
  return 0;
}

/* EqmH5WatchMemory - a file is begun: HDF5 calls NoteFailure from now on, and prints nothing. Not collective. */
void EqmH5WatchMemory(void)
{
  no_memory = PETSC_FALSE;
  (void)H5Eset_auto2(H5E_DEFAULT, NoteFailure, NULL);
}

/* EqmH5CheckMemory - fails if an allocation of HDF5 has failed: what is then not found may well be there. Not
   collective. Errors: PETSC_ERR_MEM. */
PetscErrorCode EqmH5CheckMemory(EqmH5 h5)
{
  PetscFunctionBegin;
  PetscCheck(!no_memory, PETSC_COMM_SELF, PETSC_ERR_MEM, "out of memory: HDF5 cannot %s '%s'",
             h5->writing ? "write" : "read", h5->name);
  PetscFunctionReturn(0);
}

static herr_t TakeDescription(unsigned n, const H5E_error2_t *entry, void *context)
{
  Cause *cause = (Cause *)context;

  (void)n;
  if (!entry->desc || !entry->desc[0]) return 0;
  (void)snprintf(cause->text, cause->length, "%s", entry->desc);
  return 1; /* the innermost cause is enough */
}

/* EqmH5Agree - all ranks fail with EQM_ERR_IO if one of them is not fine, or with PETSC_ERR_MEM where HDF5 had no
   memory, after which its heap is damaged and nothing of it can be used; the message names the file, `what` and HDF5's
   innermost cause. Collective. */
PetscErrorCode EqmH5Agree(EqmH5 h5, PetscBool fine, const char *what)
{
  char cause[512] = "", message[EQM_MESSAGE_MAX] = "";
  Cause context = {cause, sizeof(cause)};

  PetscFunctionBegin;
  if (!fine) {
    (void)H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, TakeDescription, &context);
    (void)snprintf(message, sizeof(message), "cannot %s '%.1000s': %s%s%s%s", h5->writing ? "write" : "read", h5->name,
                   what, cause[0] ? " (HDF5: " : "", cause, cause[0] ? ")" : "");
  }
  PetscCall(EqmAgree(h5->comm, fine ? 0 : no_memory ? PETSC_ERR_MEM : EQM_ERR_IO, message));
  PetscFunctionReturn(0);
}
