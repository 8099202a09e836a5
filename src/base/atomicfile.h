/* Files that are there complete or not at all: written under a temporary name in the same directory, flushed to the
   disk, renamed. A text that one function prints goes to EqmAtomicPrintFile, which is collective. All else is for one
   rank and raises no PETSc error: functions return 0 or EQM_ERR_IO and put what happened into `error`, so that the
   caller can clean up and hand both to EqmAgree.

       EqmAtomicFile out;
       code = EqmAtomicOpen(path, &out, error, sizeof(error));
       if (!code) {
         EqmAtomicPrint(&out, "{\"equimap\": \"%s\"}\n", EqmVersion());
         code = EqmAtomicCommit(&out, error, sizeof(error));
       }
       PetscCall(EqmAgree(comm, code, error));

   A library that opens files itself (HDF5) takes EqmAtomicBegin instead of EqmAtomicOpen and writes `temporary`.
   EqmAtomicCommitBegin lets the disk work while the caller does something else; EqmAtomicCommit then waits for it. */
#ifndef EQM_ATOMICFILE_H
#define EQM_ATOMICFILE_H

#include <pthread.h>
#include <stdio.h>
#include <equimap/base.h>

typedef struct {
  FILE *stream;                       /* NULL after EqmAtomicBegin: the caller writes `temporary` by its own means */
  int error_number;                   /* errno of the first write that failed, 0 while all is well */
  char path[PETSC_MAX_PATH_LEN];      /* what the file will be called; links are followed */
  char temporary[PETSC_MAX_PATH_LEN]; /* what it is called until EqmAtomicCommit; = path for devices and pipes */
  char previous[PETSC_MAX_PATH_LEN];  /* what a file that had the name before is called from then on; empty: lost */
  pthread_t thread;                   /* flushes and renames in the background, after EqmAtomicCommitBegin */
  PetscBool has_thread;
} EqmAtomicFile;

PETSC_INTERN PetscErrorCode EqmAtomicBegin(const char *path, EqmAtomicFile *file, char *error, size_t length);
PETSC_INTERN PetscErrorCode EqmAtomicOpen(const char *path, EqmAtomicFile *file, char *error, size_t length);
PETSC_INTERN void EqmAtomicWrite(EqmAtomicFile *file, const void *bytes, size_t count);
PETSC_INTERN void EqmAtomicPrint(EqmAtomicFile *file, const char *format, ...) PETSC_ATTRIBUTE_FORMAT(2, 3);
PETSC_INTERN void EqmAtomicPrintReals(EqmAtomicFile *file, PetscInt count, const PetscReal *values, char separator);
PETSC_INTERN void EqmAtomicCommitBegin(EqmAtomicFile *file);
PETSC_INTERN PetscErrorCode EqmAtomicCommit(EqmAtomicFile *file, char *error, size_t length);
PETSC_INTERN void EqmAtomicAbort(EqmAtomicFile *file);
PETSC_INTERN void EqmAtomicSweep(const char *path);
PETSC_INTERN void EqmAtomicAbandonAll(void);

/* Prints a file's contents; where memory runs out, sets error_number. */
typedef void (*EqmAtomicPrinter)(EqmAtomicFile *file, void *context);
PETSC_INTERN void EqmAtomicPrintLine(EqmAtomicFile *file, void *text);
PETSC_INTERN PetscErrorCode EqmAtomicPrintFile(MPI_Comm comm, const char *path, EqmAtomicPrinter print, void *context);

#endif
