#include "store/columns.h"
#include <stddef.h>

#define REAL(field)                                                                                                    \
  {                                                                                                                    \
#field, PETSC_FALSE, offsetof(EqmHistoryRow, field)                                                                \
  }
#define COUNT(field)                                                                                                   \
  {                                                                                                                    \
#field, PETSC_TRUE, offsetof(EqmHistoryRow, field)                                                                 \
  }
#define WORK(field)                                                                                                    \
  {                                                                                                                    \
#field, PETSC_TRUE, offsetof(EqmHistoryRow, work) + offsetof(EqmWork, field)                                       \
  }

const EqmHistoryColumn EqmHistoryColumns[EQM_NUM_HISTORY_COLUMNS] = {
    REAL(energy),         REAL(sd),
    COUNT(folds),         REAL(step),
    REAL(gradient_norm),  WORK(evaluations),
    WORK(factorizations), WORK(coupled_factorizations),
    WORK(solves),         REAL(seconds),
    REAL(stretch),        REAL(image_measure),
    COUNT(unfolded_from), REAL(preconditioned_norm),
    REAL(wolfe_decrease), REAL(wolfe_slope),
    REAL(change),         COUNT(phase),
};

const void *EqmHistoryEntry(const EqmHistoryRow *row, const EqmHistoryColumn *column)
{
  return (const char *)row + column->offset;
}

void EqmHistoryPack(const EqmHistoryRow *row, PetscReal *packed)
{
  for (int k = 0; k < EQM_NUM_HISTORY_COLUMNS; k++) {
    const EqmHistoryColumn *const column = &EqmHistoryColumns[k];
    packed[k] = column->is_count ? (PetscReal) * (const PetscInt64 *)EqmHistoryEntry(row, column)
                                 : *(const PetscReal *)EqmHistoryEntry(row, column);
  }
}

void EqmHistoryUnpack(const PetscReal *packed, EqmHistoryRow *row)
{
  for (int k = 0; k < EQM_NUM_HISTORY_COLUMNS; k++) {
    char *const entry = (char *)row + EqmHistoryColumns[k].offset;
    if (EqmHistoryColumns[k].is_count)
      *(PetscInt64 *)entry = (PetscInt64)packed[k];
    else
      *(PetscReal *)entry = packed[k];
  }
}
