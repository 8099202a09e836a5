/* Vertices that slide in a face of the unit cube or along one of its edges, and those at its corners. The coordinates
   that are not free stay exactly what they are. */
#include "domain/domain_private.h"

/* The unit vectors of the coordinates first, first + 1, ..., cyclically. */
static void FrameFrom(PetscInt first, PetscInt count, PetscReal *frame)
{
  for (PetscInt k = 0; k < 3 * count; k++) frame[k] = k % 3 == (first + k / 3) % 3 ? 1. : 0.;
}

static void Slide(PetscInt first, PetscInt count, const PetscReal *x, PetscReal t, const PetscScalar *dofs,
                  PetscReal *y)
{
  for (PetscInt c = 0; c < 3; c++) {
    const PetscInt k = (c + 3 - first) % 3;
    y[c] = k < count ? x[c] + t * dofs[k] : x[c];
  }
}

/* Frame and retraction for the free coordinates first ... first + count - 1, cyclically. */
#define DEFINE_SLIDE(suffix, first, count)                                                                             \
  static void Frame##suffix(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal *frame)               \
  {                                                                                                                    \
    (void)dim, (void)x, (void)stored;                                                                                  \
    FrameFrom(first, count, frame);                                                                                    \
  }                                                                                                                    \
  static void Retract##suffix(PetscInt dim, const PetscReal *x, const PetscReal *stored, PetscReal t,                  \
                              const PetscScalar *dofs, PetscReal *y, PetscReal *new_stored)                            \
  {                                                                                                                    \
    (void)dim, (void)stored, (void)new_stored;                                                                         \
    Slide(first, count, x, t, dofs, y);                                                                                \
  }
DEFINE_SLIDE(YZ, 1, 2)
DEFINE_SLIDE(ZX, 2, 2)
DEFINE_SLIDE(XY, 0, 2)
DEFINE_SLIDE(X, 0, 1)
DEFINE_SLIDE(Y, 1, 1)
DEFINE_SLIDE(Z, 2, 1)
#undef DEFINE_SLIDE

#define T PETSC_TRUE
#define F PETSC_FALSE
const EqmVertexMotion EqmMotionFace[3] = {
    {.name = "face-x", .num_dofs = 2, .frame = FrameYZ, .retract = RetractYZ, .is_free = {F, T, T}},
    {.name = "face-y", .num_dofs = 2, .frame = FrameZX, .retract = RetractZX, .is_free = {T, F, T}},
    {.name = "face-z", .num_dofs = 2, .frame = FrameXY, .retract = RetractXY, .is_free = {T, T, F}}};
const EqmVertexMotion EqmMotionEdge[3] = {
    {.name = "edge-x", .num_dofs = 1, .frame = FrameX, .retract = RetractX, .is_free = {T, F, F}},
    {.name = "edge-y", .num_dofs = 1, .frame = FrameY, .retract = RetractY, .is_free = {F, T, F}},
    {.name = "edge-z", .num_dofs = 1, .frame = FrameZ, .retract = RetractZ, .is_free = {F, F, T}}};
const EqmVertexMotion EqmMotionCubeCorner = {.name = "cube-corner", .num_dofs = 0, .retract = EqmRetractNowhere};
