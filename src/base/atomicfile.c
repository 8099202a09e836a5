#define _GNU_SOURCE
#include "base/atomicfile.h"
#include "base/temporaries.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static PetscErrorCode RejectWrite(const char *path, int error_number, char *error, size_t length)
{
  snprintf(error, length, "cannot write %.1900s: %s", path, strerror(error_number ? error_number : EIO));
  return EQM_ERR_IO;
}

/* Follow links, so that a link to a result stays a link; a file that is not there yet keeps its name. */
static int ResolvePath(const char *path, EqmAtomicFile *file)
{
  char *real = realpath(path, NULL);
  const char *name = real ? real : path;
  int error_number = strlen(name) < sizeof(file->path) ? 0 : ENAMETOOLONG;

  if (!error_number) strcpy(file->path, name);
  free(real);
  return error_number;
}

/* Create the temporary file, under a name that nobody has; `descriptor` is open for writing. */
static int CreateTemporary(EqmAtomicFile *file, int *descriptor)
{
  for (int attempt = 0; attempt < 1000; ++attempt) {
    int used = snprintf(file->temporary, sizeof(file->temporary), "%s.%ld-%d.tmp", file->path, (long)getpid(), attempt);

    if (used < 0 || (size_t)used >= sizeof(file->temporary)) return ENAMETOOLONG;
    *descriptor = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (*descriptor >= 0) {
      EqmNoteTemporary(file->temporary);
      return 0;
    }
    if (errno != EEXIST) return errno;
  }
  return EEXIST;
}

/* A device or a pipe cannot be renamed over; neither can the file that our own output goes to (/dev/stdout). */
static PetscBool IsWrittenInPlace(const struct stat *status)
{
  struct stat output;

  if (!S_ISREG(status->st_mode)) return PETSC_TRUE;
  for (int descriptor = STDOUT_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    if (!fstat(descriptor, &output) && output.st_dev == status->st_dev && output.st_ino == status->st_ino)
      return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static int OpenDescriptor(const char *path, EqmAtomicFile *file, int *descriptor)
{
  struct stat status;
  PetscBool exists;
  int error_number = ResolvePath(path, file);

  if (error_number) return error_number;
  exists = stat(file->path, &status) == 0 ? PETSC_TRUE : PETSC_FALSE;
  if (exists && S_ISDIR(status.st_mode)) return EISDIR;
  if (exists && IsWrittenInPlace(&status)) {
    strcpy(file->temporary, file->path);
    *descriptor = open(file->path, O_WRONLY | O_APPEND | O_CLOEXEC);
    return *descriptor >= 0 ? 0 : errno;
  }
  if (exists && access(file->path, W_OK)) return errno; /* rename would replace a write-protected file */
  error_number = CreateTemporary(file, descriptor);
  if (error_number) return error_number;
  if (exists && fchmod(*descriptor, status.st_mode & 07777)) errno = 0; /* keep the permissions where that is allowed */
  return 0;
}

/* EqmAtomicBegin - reserve a temporary file beside `path` for somebody else to fill.

   Not collective. `file->temporary` exists and is empty afterwards; EqmAtomicCommit or EqmAtomicAbort must follow.
   Errors: EQM_ERR_IO (returned quietly, reason in `error`). */
PetscErrorCode EqmAtomicBegin(const char *path, EqmAtomicFile *file, char *error, size_t length)
{
  int descriptor = -1, error_number;

  memset(file, 0, sizeof(*file));
  error_number = OpenDescriptor(path, file, &descriptor);
  if (!error_number && close(descriptor)) error_number = errno;
  if (error_number) return RejectWrite(path, error_number, error, length);
  return 0;
}

/* EqmAtomicOpen - open a temporary file beside `path` for EqmAtomicWrite, EqmAtomicPrint and EqmAtomicPrintReals.

   Not collective. EqmAtomicCommit or EqmAtomicAbort must follow a success. Devices and pipes are written in place.
   Errors: EQM_ERR_IO (returned quietly, reason in `error`). */
PetscErrorCode EqmAtomicOpen(const char *path, EqmAtomicFile *file, char *error, size_t length)
{
  int descriptor = -1, error_number;

  memset(file, 0, sizeof(*file));
  error_number = OpenDescriptor(path, file, &descriptor);
  if (!error_number) {
    file->stream = fdopen(descriptor, "wb");
    if (!file->stream) {
      error_number = errno;
      close(descriptor);
      EqmAtomicAbort(file);
    }
  }
  if (error_number) return RejectWrite(path, error_number, error, length);
  return 0;
}

/* EqmAtomicWrite - append bytes. Not collective. A failure is remembered and reported by EqmAtomicCommit. */
void EqmAtomicWrite(EqmAtomicFile *file, const void *bytes, size_t count)
{
  if (file->error_number || !count) return;
  errno = 0;
  if (fwrite(bytes, 1, count, file->stream) != count) file->error_number = errno ? errno : EIO;
}

/* Bring a closed file's or a directory's contents to the disk. */
static int SyncPath(const char *path, int flags)
{
  int error_number = 0, descriptor = open(path, flags | O_CLOEXEC);

  if (descriptor < 0) return errno;
  if (fsync(descriptor) && errno != EINVAL && errno != ENOTSUP) error_number = errno; /* some file systems cannot */
  if (close(descriptor) && !error_number) error_number = errno;
  return error_number;
}

static int SyncDirectoryOf(const char *path)
{
  char copy[PETSC_MAX_PATH_LEN];

  strcpy(copy, path);
  return SyncPath(dirname(copy), O_RDONLY | O_DIRECTORY);
}

/* Close the stream; the first error of its whole life counts. */
static int CloseStream(EqmAtomicFile *file)
{
  int error_number = file->error_number;

  errno = 0;
  if (fflush(file->stream) && !error_number) error_number = errno ? errno : EIO;
  if (ferror(file->stream) && !error_number) error_number = EIO;
  if (fclose(file->stream) && !error_number) error_number = errno ? errno : EIO;
  file->stream = NULL;
  return error_number;
}

/* Give a file a second name, so that the first can be taken from it without a moment in which neither is there. */
static int KeepPrevious(const EqmAtomicFile *file)
{
  if (!file->previous[0] || access(file->path, F_OK)) return 0;
  if (unlink(file->previous) && errno != ENOENT) return errno;
  if (!link(file->path, file->previous)) return 0;
  return rename(file->path, file->previous) ? errno : 0; /* a file system without hard links */
}

/* Flush, rename, flush the directory; 0 or the error number. System calls only: this may be another thread. */
static int FlushAndRename(EqmAtomicFile *file)
{
  const PetscBool in_place = strcmp(file->path, file->temporary) ? PETSC_FALSE : PETSC_TRUE;
  int error_number = file->stream ? CloseStream(file) : file->error_number;

  if (error_number || in_place) return error_number;
  error_number = SyncPath(file->temporary, O_RDONLY);
  if (!error_number) error_number = KeepPrevious(file);
  if (!error_number && rename(file->temporary, file->path)) error_number = errno;
  if (!error_number) error_number = SyncDirectoryOf(file->path);
  return error_number;
}

static void *CommitInBackground(void *context)
{
  EqmAtomicFile *const file = (EqmAtomicFile *)context;

  file->error_number = FlushAndRename(file);
  return NULL;
}

static void Join(EqmAtomicFile *file)
{
  if (file->has_thread) (void)pthread_join(file->thread, NULL);
  file->has_thread = PETSC_FALSE;
}

/* EqmAtomicCommitBegin - begin to flush and rename, and return at once; the disk is slow and needs no help.

   Not collective. EqmAtomicCommit, which waits for the end and says how it went, or EqmAtomicAbort must follow; `file`
   must stay where it is until then. A process that dies meanwhile leaves the file that was there before, or the new
   one. Where no thread can be had nothing happens here, and EqmAtomicCommit does it all. */
void EqmAtomicCommitBegin(EqmAtomicFile *file)
{
  sigset_t all, before;

  (void)sigfillset(&all); /* signals are for the thread that computes */
  if (pthread_sigmask(SIG_SETMASK, &all, &before)) return;
  file->has_thread = pthread_create(&file->thread, NULL, CommitInBackground, file) ? PETSC_FALSE : PETSC_TRUE;
  (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
}

/* EqmAtomicCommit - flush the temporary file to the disk, give it its name, flush the directory; or wait until what
   EqmAtomicCommitBegin has begun is done.

   Not collective. After a failure the temporary file is gone and a file that had the name before is untouched.
   Errors: EQM_ERR_IO (returned quietly, reason in `error`): the first write that failed, a full disk, a failed rename.
 */
PetscErrorCode EqmAtomicCommit(EqmAtomicFile *file, char *error, size_t length)
{
  const PetscBool begun = file->has_thread;
  int error_number;

  Join(file);
  error_number = begun ? file->error_number : FlushAndRename(file);
  if (!error_number) {
    EqmForgetTemporary(file->temporary);
    return 0;
  }
  EqmAtomicAbort(file);
  return RejectWrite(file->path, error_number, error, length);
}

/* EqmAtomicAbort - forget the file: the temporary file is removed, one that had the name before is untouched.
   Not collective; harmless when repeated. */
void EqmAtomicAbort(EqmAtomicFile *file)
{
  Join(file);
  if (file->stream) fclose(file->stream);
  file->stream = NULL;
  if (file->temporary[0] && strcmp(file->path, file->temporary)) unlink(file->temporary);
  EqmForgetTemporary(file->temporary);
  file->temporary[0] = '\0';
}
