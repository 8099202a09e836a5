/* Open, create, commit and abandon HDF5 files. */
#include "h5/h5.h"
#include "h5/load.h"
#include "base/temporaries.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { RESERVED = 1 << 17 }; /* bytes of disk space */

/* HDF5 may lose handles of a damaged file, and complains when it is closed, which MPI_Finalize does, unless its
   messages are off. */
static PetscErrorCode EndQuietly(void)
{
  (void)H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  return 0;
}

/* EqmH5Load - HDF5 begins. Not collective. Where MPI has not begun yet, HDF5 will not clean up when MPI ends: that
   crashes where an allocation of its own has failed before, even one that it did not report. All files are closed by
   us. Returns whether it could begin. */
PetscBool EqmH5Load(void)
{
  (void)H5dont_atexit();
  return (PetscBool)(H5open() >= 0);
}

/* Once per process. */
static PetscErrorCode Prepare(void)
{
  static PetscBool is_done = PETSC_FALSE;

  PetscFunctionBegin;
  if (is_done) PetscFunctionReturn(0);
  is_done = PETSC_TRUE;
  PetscCheck(EqmH5Load(), PETSC_COMM_SELF, PETSC_ERR_MEM, "out of memory: HDF5 cannot begin");
  PetscCall(PetscRegisterFinalize(EndQuietly));
  PetscFunctionReturn(0);
}

static PetscErrorCode Begin(MPI_Comm comm, const char *name, PetscBool writing, EqmH5 *out)
{
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(Prepare());
  PetscCall(PetscNew(&h5));
  h5->comm = comm;
  h5->file = h5->transfer = H5I_INVALID_HID;
  h5->reserved = -1;
  h5->writing = writing;
  PetscCallMPI(MPI_Comm_rank(comm, &h5->rank));
  PetscCall(PetscStrncpy(h5->name, name, sizeof(h5->name)));
  (void)H5Eget_auto2(H5E_DEFAULT, &h5->printer, &h5->printer_data);
  EqmH5WatchMemory();
  *out = h5;
  PetscFunctionReturn(0);
}

static void ReleaseReserved(EqmH5 h5)
{
  if (h5->reserved >= 0) (void)close(h5->reserved);
  h5->reserved = -1;
}

/* Close the handles of a file, whatever state it is in; a file that was not committed leaves nothing behind. */
static PetscBool End(EqmH5 *handle)
{
  EqmH5 h5 = *handle;
  PetscBool fine = PETSC_TRUE;

  if (!h5) return PETSC_TRUE;
  ReleaseReserved(h5);
  if (h5->transfer >= 0 && H5Pclose(h5->transfer) < 0) fine = PETSC_FALSE;
  if (h5->file >= 0 && H5Fclose(h5->file) < 0) fine = PETSC_FALSE;
  if (h5->rank > 0) EqmForgetTemporary(h5->atomic.temporary);
  if (h5->writing && h5->rank == 0) EqmAtomicAbort(&h5->atomic);
  (void)H5Eset_auto2(H5E_DEFAULT, h5->printer, h5->printer_data);
  (void)PetscFree(*handle);
  return fine;
}

/* New files have the headers of HDF5 1.8, which carry checksums. */
static hid_t ParallelAccess(MPI_Comm comm, PetscBool writing)
{
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);

  if (access >= 0 &&
      (H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL) < 0 || H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) < 0 ||
       (writing && H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18) < 0))) {
    (void)H5Pclose(access);
    return H5I_INVALID_HID;
  }
  return access;
}

/* All attributes in the object header, however many: that is what all ranks can change together without tables. */
static hid_t Creation(void)
{
  hid_t creation = H5Pcreate(H5P_FILE_CREATE);

  if (creation >= 0 && H5Pset_attr_phase_change(creation, 1000, 0) < 0) {
    (void)H5Pclose(creation);
    return H5I_INVALID_HID;
  }
  return creation;
}

static PetscErrorCode OpenHandles(EqmH5 h5)
{
  hid_t access, creation;
  PetscBool fine;

  PetscFunctionBegin;
  access = ParallelAccess(h5->comm, h5->writing);
  creation = Creation();
  PetscCall(EqmH5Agree(h5, (PetscBool)(access >= 0 && creation >= 0), "there is no parallel access"));
  h5->file = h5->writing ? H5Fcreate(h5->atomic.temporary, H5F_ACC_TRUNC, creation, access)
                         : H5Fopen(h5->name, H5F_ACC_RDONLY, access);
  (void)H5Pclose(access);
  (void)H5Pclose(creation);
  h5->transfer = H5Pcreate(H5P_DATASET_XFER);
  fine = (PetscBool)(h5->file >= 0 && h5->transfer >= 0 && H5Pset_dxpl_mpio(h5->transfer, H5FD_MPIO_COLLECTIVE) >= 0);
  PetscCall(EqmH5Agree(h5, fine, h5->writing ? "it cannot be made" : "it is not an HDF5 file, or a damaged one"));
  PetscFunctionReturn(0);
}

/* HDF5 cannot abandon a file: it writes headers even while it closes a file for which the disk has no space, and
   crashes later if that fails. So the space for headers is reserved first, in an unnamed file, and released when the
   space for the rest has been reserved, or could not be. 0 or the error number. */
static int ReserveForHeaders(EqmH5 h5)
{
  char message[EQM_MESSAGE_MAX];
  EqmAtomicFile unnamed;
  int failed;

  if (EqmAtomicBegin(h5->name, &unnamed, message, sizeof(message))) return 0; /* the temporary itself was possible */
  h5->reserved = open(unnamed.temporary, O_WRONLY | O_CLOEXEC);
  EqmAtomicAbort(&unnamed);
  if (h5->reserved < 0) return 0;
  failed = posix_fallocate(h5->reserved, 0, RESERVED);
  return failed == EINVAL || failed == EOPNOTSUPP ? 0 : failed;
}

/* Rank 0 makes the temporary with plain system calls: their errors are clearer than those that come through MPI. */
static PetscErrorCode MakeTemporary(EqmH5 h5)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error = 0;
  int failed;

  PetscFunctionBegin;
  if (h5->rank == 0) {
    error = EqmAtomicBegin(h5->name, &h5->atomic, message, sizeof(message));
    if (!error && !strcmp(h5->atomic.path, h5->atomic.temporary)) {
      error = EQM_ERR_IO;
      (void)snprintf(message, sizeof(message), "cannot write '%.1000s': an HDF5 file must be a regular file", h5->name);
    }
    failed = error ? 0 : ReserveForHeaders(h5);
    if (failed) {
      error = EQM_ERR_IO;
      (void)snprintf(message, sizeof(message), "cannot write '%.1000s': %s", h5->name, strerror(failed));
    }
  }
  PetscCall(EqmAgree(h5->comm, error, message));
  PetscCallMPI(MPI_Bcast(h5->atomic.temporary, (PetscMPIInt)sizeof(h5->atomic.temporary), MPI_CHAR, 0, h5->comm));
  if (h5->rank > 0) EqmNoteTemporary(h5->atomic.temporary); /* whoever ends all ranks removes it */
  PetscFunctionReturn(0);
}

/* Likewise for files to read. */
static PetscErrorCode CheckReadable(EqmH5 h5)
{
  char message[EQM_MESSAGE_MAX] = "";
  FILE *stream;
  int failed = 0;

  PetscFunctionBegin;
  if (h5->rank == 0) {
    stream = fopen(h5->name, "rb");
    failed = stream ? 0 : errno;
    if (stream) (void)fclose(stream);
    if (failed) (void)snprintf(message, sizeof(message), "cannot read '%.1000s': %s", h5->name, strerror(failed));
  }
  PetscCall(EqmAgree(h5->comm, failed ? EQM_ERR_IO : 0, message));
  PetscFunctionReturn(0);
}

/* A file that has the name now will be called `previous` from the commit on. Call before EqmH5Commit. Not collective.
 */
PetscErrorCode EqmH5KeepPrevious(EqmH5 h5, const char *previous)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(h5->atomic.previous, previous, sizeof(h5->atomic.previous)));
  PetscFunctionReturn(0);
}

/* Start a new file that will replace `name` when it is committed; EqmH5Close without a commit drops it. Errors:
   EQM_ERR_IO, and *h5 is NULL. Collective. */
PetscErrorCode EqmH5Create(MPI_Comm comm, const char *name, EqmH5 *h5)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(Begin(comm, name, PETSC_TRUE, h5));
  error = MakeTemporary(*h5);
  if (!error) error = OpenHandles(*h5);
  if (error) (void)End(h5);
  PetscCall(error);
  PetscFunctionReturn(0);
}

/* Open a file to read. Errors: EQM_ERR_IO (missing, unreadable, not HDF5), and *h5 is NULL. Collective. */
PetscErrorCode EqmH5Open(MPI_Comm comm, const char *name, EqmH5 *h5)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(Begin(comm, name, PETSC_FALSE, h5));
  error = CheckReadable(*h5);
  if (!error) error = OpenHandles(*h5);
  if (error) (void)End(h5);
  PetscCall(error);
  PetscFunctionReturn(0);
}

/* Close a file; a new one that was not committed is removed. Collective. */
PetscErrorCode EqmH5Close(EqmH5 *h5)
{
  PetscFunctionBegin;
  (void)End(h5);
  PetscFunctionReturn(0);
}

/* Reserve the bytes that a file will have; 0 or the error number. */
static int ReserveBytes(const char *name, off_t size)
{
  const int descriptor = open(name, O_WRONLY);
  int failed = 0;

  if (descriptor < 0) return errno;
  if (size > 0) failed = posix_fallocate(descriptor, 0, size);
  if (failed == EINVAL || failed == EOPNOTSUPP)
    failed = 0; /* a file system that cannot reserve: the writes themselves will fail */
  if (close(descriptor) != 0 && !failed) failed = errno;
  return failed;
}

/* Take the disk space of all declared arrays and attributes before the first array is written: a full disk is then one
   clear error on rank 0. In the middle of a collective write it would be worse than unclear: Open MPI 4.1 waits for
   ever when an aggregating rank's write fails. Errors: EQM_ERR_IO. Collective. */
PetscErrorCode EqmH5Reserve(EqmH5 h5)
{
  char message[EQM_MESSAGE_MAX] = "";
  hsize_t size = 0;
  int failed = 0;

  PetscFunctionBegin;
  PetscCall(EqmH5Agree(h5, (PetscBool)(H5Fget_filesize(h5->file, &size) >= 0), "its arrays cannot be laid out"));
  if (h5->rank == 0) failed = ReserveBytes(h5->atomic.temporary, (off_t)size);
  ReleaseReserved(h5);
  if (failed) {
    (void)snprintf(message, sizeof(message), "cannot write '%.1000s': %s (it takes %.1f MB)", h5->name,
                   strerror(failed), (double)size / 1e6);
  }
  PetscCall(EqmAgree(h5->comm, failed ? EQM_ERR_IO : 0, message));
  PetscFunctionReturn(0);
}

/* Mark a new file complete, close it, and begin to force it to the disk and to give it its name, which goes on while
   the caller does other things; EqmH5CommitEnd must follow, or EqmH5Close. Errors: EQM_ERR_IO. Collective. */
PetscErrorCode EqmH5CommitBegin(EqmH5 h5)
{
  PetscBool fine;

  PetscFunctionBegin;
  PetscCall(EqmH5PutInteger(h5, "complete", 1));
  fine = (PetscBool)(H5Fclose(h5->file) >= 0);
  h5->file = H5I_INVALID_HID;
  PetscCall(EqmH5Agree(h5, fine, "it cannot be closed"));
  if (h5->rank == 0) EqmAtomicCommitBegin(&h5->atomic);
  PetscFunctionReturn(0);
}

/* Wait until the file is on the disk under its name. Errors: EQM_ERR_IO; the file that was there before then stays, and
   EqmH5Close must follow. Collective. */
PetscErrorCode EqmH5CommitEnd(EqmH5 *handle)
{
  char message[EQM_MESSAGE_MAX] = "";
  EqmH5 h5 = *handle;
  PetscErrorCode error = 0;

  PetscFunctionBegin;
  if (h5->rank == 0) error = EqmAtomicCommit(&h5->atomic, message, sizeof(message));
  PetscCall(EqmAgree(h5->comm, error, message));
  h5->writing = PETSC_FALSE;
  (void)End(handle);
  PetscFunctionReturn(0);
}

/* Both at once. Collective. */
PetscErrorCode EqmH5Commit(EqmH5 *handle)
{
  PetscFunctionBegin;
  PetscCall(EqmH5CommitBegin(*handle));
  PetscCall(EqmH5CommitEnd(handle));
  PetscFunctionReturn(0);
}
