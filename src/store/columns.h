/* The columns of a history, for all that write them. */
#ifndef EQM_COLUMNS_H
#define EQM_COLUMNS_H

#include <equimap/map.h>

typedef struct {
  const char *name;
  PetscBool is_count; /* a PetscInt64, else a PetscReal */
  size_t offset;      /* in an EqmHistoryRow */
} EqmHistoryColumn;

enum { EQM_NUM_HISTORY_COLUMNS = 18 };

/* All but the iteration, in the order of the CSV file. */
PETSC_INTERN const EqmHistoryColumn EqmHistoryColumns[EQM_NUM_HISTORY_COLUMNS];

/* An entry of a row. Not collective. */
PETSC_INTERN const void *EqmHistoryEntry(const EqmHistoryRow *row, const EqmHistoryColumn *column);
/* The row as numbers, EQM_NUM_HISTORY_COLUMNS long, and back. Not collective. */
PETSC_INTERN void EqmHistoryPack(const EqmHistoryRow *row, PetscReal *packed);
PETSC_INTERN void EqmHistoryUnpack(const PetscReal *packed, EqmHistoryRow *row);

#endif
