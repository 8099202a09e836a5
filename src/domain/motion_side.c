/* Vertices that slide along a side of the unit square, and those at its corners (002 section 4.1). */
#include <equimap/domain.h>

static void FrameX(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal *frame)
{
  (void)dim;
  (void)x;
  (void)stored;
  frame[0] = 1.;
  frame[1] = 0.;
}

static void FrameY(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal *frame)
{
  (void)dim;
  (void)x;
  (void)stored;
  frame[0] = 0.;
  frame[1] = 1.;
}

static void RetractX(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t, const PetscScalar *dofs,
                     PetscReal *y, PetscReal *new_stored)
{
  (void)dim;
  (void)stored;
  (void)new_stored;
  y[1] = x[1];
  y[0] = x[0] + t * dofs[0];
}

static void RetractY(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t, const PetscScalar *dofs,
                     PetscReal *y, PetscReal *new_stored)
{
  (void)dim;
  (void)stored;
  (void)new_stored;
  y[0] = x[0];
  y[1] = x[1] + t * dofs[0];
}

/* The signed length from p to q, neighbours on the boundary, along the side that they share. */
static PetscReal Advance(const PetscReal *p, const PetscReal *q)
{
  if (p[1] == 0. && q[1] == 0.) return q[0] - p[0];
  if (p[0] == 1. && q[0] == 1.) return q[1] - p[1];
  if (p[1] == 1. && q[1] == 1.) return p[0] - q[0];
  return p[1] - q[1];
}

/* The retraction of kinds without degrees of freedom: the vertex is not moved. */
void EqmRetractNowhere(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t, const PetscScalar *dofs,
                       PetscReal *y, PetscReal *new_stored)
{
  (void)stored;
  (void)t;
  (void)dofs;
  (void)new_stored;
  for (PetscInt c = 0; c < dim; c++) y[c] = x[c];
}

const EqmVertexMotion EqmMotionSideX = {.name = "horizontal-side",
                                        .num_dofs = 1,
                                        .frame = FrameX,
                                        .retract = RetractX,
                                        .advance = Advance,
                                        .is_free = {PETSC_TRUE, PETSC_FALSE, PETSC_FALSE}};
const EqmVertexMotion EqmMotionSideY = {.name = "vertical-side",
                                        .num_dofs = 1,
                                        .frame = FrameY,
                                        .retract = RetractY,
                                        .advance = Advance,
                                        .is_free = {PETSC_FALSE, PETSC_TRUE, PETSC_FALSE}};
const EqmVertexMotion EqmMotionCorner = {.name = "corner",
                                         .num_dofs = 0,
                                         .retract = EqmRetractNowhere,
                                         .advance = Advance};
