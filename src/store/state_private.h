/* What the files state*.c share. */
#ifndef EQM_STATE_PRIVATE_H
#define EQM_STATE_PRIVATE_H

#include "store/state.h"
#include "h5/h5.h"
#include "base/checksum.h"

enum { EQM_STATE_NAME = 96, EQM_STATE_LAYOUT = 1, EQM_STATE_LISTS = 4, EQM_STATE_LONGEST = 60000 };

/* Announce, then write; or read. */
typedef enum { EQM_STATE_ANNOUNCE, EQM_STATE_WRITE, EQM_STATE_READ } EqmStateMode;

/* Names in the order in which they came, with a value each. */
typedef struct {
  PetscInt count, most;
  struct {
    char name[EQM_STATE_NAME];
    PetscInt64 integer;
    PetscReal real;
    char *text;
  } * entry;
} EqmStateTable;

struct _p_EqmState {
  EqmMesh mesh;
  EqmH5 h5;
  EqmStateMode mode;
  char group[EQM_STATE_NAME / 2];
  EqmStateTable arrays, integers, reals, texts;
  PetscSF to_slab;   /* from owned vertices to rows of the file; made at the first need */
  PetscReal *buffer; /* one slab */
  PetscInt most_in_buffer;
};

/* The attributes that list the names of each kind, and where the numbers stand. */
PETSC_INTERN const char *const EqmStateListNames[EQM_STATE_LISTS];
PETSC_INTERN const char EqmStateIntegersPath[], EqmStateRealsPath[];

PETSC_INTERN PetscErrorCode EqmStateTableAdd(EqmStateTable *table, const char *name, PetscInt *index);
PETSC_INTERN PetscInt EqmStateTableFind(const EqmStateTable *table, const char *name);
PETSC_INTERN PetscErrorCode EqmStateTableReset(EqmStateTable *table);
PETSC_INTERN EqmStateTable *EqmStateTableOf(EqmState state, int k);
PETSC_INTERN PetscErrorCode EqmStateFindEntry(EqmState state, EqmStateTable *table, const char *lead, const char *name,
                                              char full[EQM_STATE_NAME], PetscInt *index);
PETSC_INTERN PetscErrorCode EqmStateCreate(EqmMesh mesh, EqmStateMode mode, EqmState *state);
PETSC_INTERN EqmSlab EqmStateSlab(EqmState state, PetscInt total, PetscInt width, PetscBool on_root);
PETSC_INTERN PetscErrorCode EqmStateChecksumOfNames(EqmState state, PetscInt64 *checksum);

#endif
