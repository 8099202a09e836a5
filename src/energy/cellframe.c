#include "energy/cellframe.h"
#include "energy/kernel.h"

void EqmCellFrameFind(EqmDomain domain, const EqmPlace *place, PetscInt cell, EqmCellFrame *frame)
{
  const PetscInt dim = domain->dim, corners = domain->mesh->cell_size;

  frame->count = 0;
  for (PetscInt a = 0; a < corners; a++) {
    PetscReal axes[9];
    const PetscInt count = EqmDomainFrame(domain, place, domain->mesh->cells[corners * cell + a], axes);
    for (PetscInt k = 0; k < count; k++, frame->count++) {
      frame->corner[frame->count] = a;
      for (PetscInt c = 0; c < 3; c++) frame->direction[frame->count][c] = c < dim ? axes[dim * k + c] : 0.;
    }
  }
}

void EqmCellFrameAddSquare(const EqmCellFrame *frame, PetscReal factor, PetscReal gradient[4][3], PetscReal *matrix)
{
  PetscReal rate[EQM_MOST_CELL_DOFS];

  for (PetscInt i = 0; i < frame->count; i++) rate[i] = EqmDot3(gradient[frame->corner[i]], frame->direction[i]);
  for (PetscInt i = 0; i < frame->count; i++) {
    for (PetscInt j = 0; j < frame->count; j++) matrix[frame->count * i + j] += factor * rate[i] * rate[j];
  }
}

void EqmCellFrameAddLaplacian(const EqmCellFrame *frame, PetscReal factor, PetscReal laplacian[4][4], PetscReal *matrix)
{
  for (PetscInt i = 0; i < frame->count; i++) {
    for (PetscInt j = 0; j < frame->count; j++)
      matrix[frame->count * i + j] +=
          factor * laplacian[frame->corner[i]][frame->corner[j]] * EqmDot3(frame->direction[i], frame->direction[j]);
  }
}
