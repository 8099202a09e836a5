/* A symmetric matrix made of cells, the same on every rank: per cell diag(shift) + q q^T with q from the numbers of the
   unknowns. */
#ifndef EQM_TEST_CELLMATRIX_H
#define EQM_TEST_CELLMATRIX_H

#include "domain/domain_private.h"

typedef struct {
  EqmMesh mesh;
  EqmUnknowns unknowns;
  PetscReal shift, spoil; /* spoil: taken off the diagonal of the cells of one unknown */
  PetscInt spoiled;       /* that unknown; -1: none */
} TestMatrix;

static inline PetscReal TestPull(PetscInt unknown)
{
  return PetscSinReal(1. + 3. * unknown);
}

/* An EqmCellMatrix whose context is a TestMatrix. */
static inline void TestCellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const TestMatrix *const model = context;
  PetscInt list[EQM_MOST_CELL_UNKNOWNS], n = 0;

  for (PetscInt a = 0; a < model->mesh->cell_size; a++) {
    const PetscInt v = model->mesh->cells[model->mesh->cell_size * cell + a];
    for (PetscInt k = 0; k < model->unknowns.count[v]; k++) list[n++] = model->unknowns.start[v] + k;
  }
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt j = 0; j < n; j++)
      matrix[n * i + j] = TestPull(list[i]) * TestPull(list[j]) + (i == j ? model->shift : 0.);
    if (list[i] == model->spoiled) matrix[n * i + i] -= model->spoil;
  }
}

#endif
