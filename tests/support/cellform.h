/* Quadratic forms of matrices that are given cell by cell. */
#ifndef TEST_CELLFORM_H
#define TEST_CELLFORM_H

#include "mesh/mesh_private.h"
#include "problem/term.h"

/* x^T M x of the matrices of the problem's added terms, of factor one, for the degrees of freedom that a velocity (dim
   per local vertex) stands for. As matrices are assembled: rows of owned vertices, from all local cells. Collective. */
static inline PetscErrorCode TestTermsForm(EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                                           const PetscReal *velocity, PetscReal *form)
{
  const EqmMesh mesh = problem->mesh;
  const PetscInt dim = problem->domain->dim;
  PetscReal local = 0.;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt *const v = mesh->cells + mesh->cell_size * c;
    PetscReal matrix[EQM_MOST_CELL_DOFS * EQM_MOST_CELL_DOFS] = {0.}, x[EQM_MOST_CELL_DOFS];
    EqmCellFrame frame;
    EqmCellFrameFind(problem->domain, place, c, &frame);
    for (PetscInt i = 0; i < frame.count; i++) {
      x[i] = 0.;
      for (PetscInt k = 0; k < dim; k++) x[i] += frame.direction[i][k] * velocity[dim * v[frame.corner[i]] + k];
    }
    EqmTermsAddMatrix(problem, place, image, c, &frame, 1., matrix);
    for (PetscInt i = 0; i < frame.count; i++) {
      for (PetscInt j = 0; j < frame.count && v[frame.corner[i]] < mesh->num_owned; j++)
        local += x[i] * matrix[frame.count * i + j] * x[j];
    }
  }
  PetscCall(MPIU_Allreduce(&local, form, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

#endif
