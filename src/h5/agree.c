/* The same outcome of an HDF5 call on all ranks, and the reason of a failure. */
#include "h5/h5.h"
#include <stdio.h>

typedef struct {
  char *text;
  size_t length;
  PetscBool no_memory;
} Cause;

static herr_t TakeDescription(unsigned n, const H5E_error2_t *entry, void *context)
{
  Cause *cause = (Cause *)context;

  (void)n;
  if (entry->min_num == H5E_NOSPACE || entry->min_num == H5E_CANTALLOC) cause->no_memory = PETSC_TRUE;
  if (!entry->desc || !entry->desc[0]) return 0;
  (void)snprintf(cause->text, cause->length, "%s", entry->desc);
  return 1; /* the innermost cause is enough */
}

/* EqmH5Agree - all ranks fail with EQM_ERR_IO if one of them is not fine, or with PETSC_ERR_MEM where HDF5 had no
   memory, after which it does not even close its files without a crash; the message names the file, `what` and HDF5's
   innermost cause. Collective. */
PetscErrorCode EqmH5Agree(EqmH5 h5, PetscBool fine, const char *what)
{
  char cause[512] = "", message[EQM_MESSAGE_MAX] = "";
  Cause context = {cause, sizeof(cause), PETSC_FALSE};

  PetscFunctionBegin;
  if (!fine) {
    (void)H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, TakeDescription, &context);
    (void)snprintf(message, sizeof(message), "cannot %s '%.1000s': %s%s%s%s", h5->writing ? "write" : "read", h5->name,
                   what, cause[0] ? " (HDF5: " : "", cause, cause[0] ? ")" : "");
  }
  PetscCall(EqmAgree(h5->comm, fine ? 0 : context.no_memory ? PETSC_ERR_MEM : EQM_ERR_IO, message));
  PetscFunctionReturn(0);
}
