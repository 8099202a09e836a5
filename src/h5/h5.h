/* A thin, collective layer over parallel HDF5: every call's result is checked on every rank, and all ranks fail alike.
   Files are replaced whole: written under another name, forced to the disk, renamed. */
#ifndef EQM_H5_H
#define EQM_H5_H

#include <hdf5.h>
#include <equimap/base.h>
#include "base/atomicfile.h"

typedef struct _p_EqmH5 *EqmH5;
struct _p_EqmH5 {
  MPI_Comm comm;
  PetscMPIInt rank;
  hid_t file, transfer;  /* the file; the property list of collective transfers */
  PetscBool fixed_texts; /* texts have a fixed length and stand in headers, which have checksums; see EqmH5PutText */
  PetscBool writing;     /* a new file, under its temporary name until it is committed */
  char name[PETSC_MAX_PATH_LEN]; /* the name that the user gave */
  EqmAtomicFile atomic;          /* where a new file grows; rank 0 keeps it, all know its temporary name */
  int reserved;                  /* rank 0: descriptor of disk space that is reserved for the headers; -1: none */
  H5E_auto2_t printer;           /* HDF5's own error printing, silenced while the file is open */
  void *printer_data;
};

/* Longest name in a list of arrays, terminating zero included. */
#define EQM_H5_NAME 128

/* One rank's part of an array whose first dimension is dealt to the ranks in contiguous slabs. */
typedef struct {
  PetscInt total; /* rows on all ranks */
  PetscInt start; /* this rank's first row */
  PetscInt count; /* this rank's rows, may be 0 */
  PetscInt width; /* entries per row; 0 makes the array one-dimensional */
} EqmSlab;

PETSC_INTERN void EqmH5WatchMemory(void);
PETSC_INTERN PetscErrorCode EqmH5CheckMemory(EqmH5 h5);
PETSC_INTERN PetscErrorCode EqmH5Create(MPI_Comm comm, const char *name, EqmH5 *h5);
PETSC_INTERN PetscErrorCode EqmH5Open(MPI_Comm comm, const char *name, EqmH5 *h5);
PETSC_INTERN PetscErrorCode EqmH5KeepPrevious(EqmH5 h5, const char *previous);
PETSC_INTERN PetscErrorCode EqmH5Commit(EqmH5 *h5);
PETSC_INTERN PetscErrorCode EqmH5CommitBegin(EqmH5 h5);
PETSC_INTERN PetscErrorCode EqmH5CommitEnd(EqmH5 *h5);
PETSC_INTERN PetscErrorCode EqmH5Close(EqmH5 *h5);

PETSC_INTERN PetscErrorCode EqmH5DeclareReals(EqmH5 h5, const char *path, PetscInt total, PetscInt width);
PETSC_INTERN PetscErrorCode EqmH5DeclareIntegers(EqmH5 h5, const char *path, PetscInt total, PetscInt width);
PETSC_INTERN PetscErrorCode EqmH5Reserve(EqmH5 h5);
PETSC_INTERN PetscErrorCode EqmH5WriteReals(EqmH5 h5, const char *path, EqmSlab slab, const PetscReal *values);
PETSC_INTERN PetscErrorCode EqmH5WriteIntegers(EqmH5 h5, const char *path, EqmSlab slab, const PetscInt64 *values);
PETSC_INTERN PetscErrorCode EqmH5PutReal(EqmH5 h5, const char *name, PetscReal value);
PETSC_INTERN PetscErrorCode EqmH5PutInteger(EqmH5 h5, const char *name, PetscInt64 value);
PETSC_INTERN PetscErrorCode EqmH5PutText(EqmH5 h5, const char *name, const char *text);
PETSC_INTERN PetscErrorCode EqmH5PutProvenance(EqmH5 h5, const char *mesh_file, PetscInt ranks);
PETSC_INTERN PetscErrorCode EqmH5PutChecksum(EqmH5 h5, const char *path, PetscInt64 checksum);
PETSC_INTERN PetscErrorCode EqmH5GetChecksum(EqmH5 h5, const char *path, PetscInt64 *checksum);

PETSC_INTERN PetscErrorCode EqmH5HasDataset(EqmH5 h5, const char *path, PetscBool *has);
PETSC_INTERN PetscErrorCode EqmH5ListNumbers(EqmH5 h5, const char *group, PetscInt *num, char (**names)[EQM_H5_NAME]);
PETSC_INTERN PetscErrorCode EqmH5GetShape(EqmH5 h5, const char *path, PetscInt64 *total, PetscInt64 *width);
PETSC_INTERN PetscErrorCode EqmH5CheckRows(EqmH5 h5, const char *path, PetscInt64 total);
PETSC_INTERN PetscErrorCode EqmH5ReadReals(EqmH5 h5, const char *path, EqmSlab slab, PetscReal *values);
PETSC_INTERN PetscErrorCode EqmH5ReadIntegers(EqmH5 h5, const char *path, EqmSlab slab, PetscInt64 *values);
PETSC_INTERN PetscErrorCode EqmH5GetReal(EqmH5 h5, const char *name, PetscReal fallback, PetscReal *value);
PETSC_INTERN PetscErrorCode EqmH5GetInteger(EqmH5 h5, const char *name, PetscInt64 fallback, PetscInt64 *value);
PETSC_INTERN PetscErrorCode EqmH5GetText(EqmH5 h5, const char *name, const char *fallback, char *text, size_t length);

/* Fail on all ranks if HDF5 refused `what` on one of them. For h5*.c only. Collective. */
PETSC_INTERN PetscErrorCode EqmH5Agree(EqmH5 h5, PetscBool fine, const char *what);

#endif
