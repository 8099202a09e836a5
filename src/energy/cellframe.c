#include "energy/cellframe.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"

/* Are all corners free? In the ball this holds for nearly all cells. */
static const EqmCellFrame plain = {
    .count = 12,
    .corner = {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3},
    .direction = {{1., 0., 0.},
                  {0., 1., 0.},
                  {0., 0., 1.},
                  {1., 0., 0.},
                  {0., 1., 0.},
                  {0., 0., 1.},
                  {1., 0., 0.},
                  {0., 1., 0.},
                  {0., 0., 1.},
                  {1., 0., 0.},
                  {0., 1., 0.},
                  {0., 0., 1.}},
    .is_plain = PETSC_TRUE,
};

static PetscBool AreFree(EqmDomain domain, PetscInt count, const PetscInt *vertex)
{
  for (PetscInt a = 0; a < count; a++) {
    if (EqmDomainMotion(domain, vertex[a]) != &EqmMotionFree) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

void EqmCellFrameFind(EqmDomain domain, const EqmPlace *place, PetscInt cell, EqmCellFrame *frame)
{
  const PetscInt dim = domain->dim, corners = domain->mesh->cell_size;
  const PetscInt *const vertex = domain->mesh->cells + corners * cell;

  if (corners == 4 && AreFree(domain, corners, vertex)) {
    *frame = plain;
    return;
  }
  frame->is_plain = PETSC_FALSE;
  frame->count = 0;
  for (PetscInt a = 0; a < corners; a++) {
    PetscReal axes[9];
    const PetscInt count = EqmDomainFrame(domain, place, vertex[a], axes);
    for (PetscInt k = 0; k < count; k++, frame->count++) {
      frame->corner[frame->count] = a;
      for (PetscInt c = 0; c < 3; c++) frame->direction[frame->count][c] = c < dim ? axes[dim * k + c] : 0.;
    }
  }
}

void EqmCellFrameAddSquare(const EqmCellFrame *frame, PetscReal factor, PetscReal gradient[4][3], PetscReal *matrix)
{
  const PetscInt n = frame->count;
  PetscReal rate[EQM_MOST_CELL_DOFS];

  for (PetscInt i = 0; i < n; i++) {
    rate[i] = frame->is_plain ? gradient[i / 3][i % 3] : EqmDot3(gradient[frame->corner[i]], frame->direction[i]);
  }
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt j = 0; j < n; j++) matrix[n * i + j] += factor * rate[i] * rate[j];
  }
}

void EqmCellFrameAddLaplacian(const EqmCellFrame *frame, PetscReal factor, PetscReal laplacian[4][4], PetscReal *matrix)
{
  const PetscInt n = frame->count;

  for (PetscInt i = 0; i < n && frame->is_plain; i++) {
    for (PetscInt b = 0; b < 4; b++) matrix[n * i + 3 * b + i % 3] += factor * laplacian[i / 3][b];
  }
  for (PetscInt i = 0; i < n && !frame->is_plain; i++) {
    for (PetscInt j = 0; j < n; j++)
      matrix[n * i + j] +=
          factor * laplacian[frame->corner[i]][frame->corner[j]] * EqmDot3(frame->direction[i], frame->direction[j]);
  }
}
