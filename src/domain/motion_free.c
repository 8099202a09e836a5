/* Vertices without a constraint. */
#include <equimap/domain.h>

static void Frame(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal *frame)
{
  (void)x;
  (void)stored;
  for (PetscInt k = 0; k < dim * dim; k++) frame[k] = k % (dim + 1) ? 0. : 1.;
}

static void Retract(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t, const PetscScalar *dofs,
                    PetscReal *y, PetscReal *new_stored)
{
  (void)stored;
  (void)new_stored;
  for (PetscInt c = 0; c < dim; c++) y[c] = x[c] + t * dofs[c];
}

const EqmVertexMotion EqmMotionFree = {.name = "free",
                                       .num_dofs = EQM_DOFS_OF_SPACE,
                                       .frame = Frame,
                                       .retract = Retract,
                                       .is_free = {PETSC_TRUE, PETSC_TRUE, PETSC_TRUE}};
