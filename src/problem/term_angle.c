/* The angle energy beside another one (docs/methods.md, Uniqueness): Dirichlet's less the area. */
#include "problem/term.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"

typedef struct {
  struct _p_EqmTerm term;
  PetscReal *weights; /* cotangents of the mesh, 3 per local cell */
  PetscReal *image;
} AngleTerm;

static PetscErrorCode Add(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                          PetscReal *value, Vec gradient)
{
  AngleTerm *const angle = (AngleTerm *)term;
  PetscReal energy;
  Vec part = NULL;

  PetscFunctionBegin;
  (void)image;
  if (gradient) PetscCall(VecDuplicate(gradient, &part));
  PetscCall(EqmConformalEnergy(problem->domain, angle->weights, NULL, place, angle->image, &energy, part));
  *value += term->weight * energy;
  if (gradient) PetscCall(VecAXPY(gradient, term->weight, part));
  PetscCall(VecDestroy(&part));
  PetscFunctionReturn(0);
}

/* The unit normal of an image triangle. */
static void Normal(EqmDomain domain, const PetscReal *x, const PetscInt v[3], PetscReal normal[3])
{
  PetscReal first[3], second[3], length;

  normal[0] = normal[1] = 0.;
  normal[2] = 1.;
  if (domain->dim == 2) return;
  for (PetscInt k = 0; k < 3; k++) {
    first[k] = x[3 * v[1] + k] - x[3 * v[0] + k];
    second[k] = x[3 * v[2] + k] - x[3 * v[0] + k];
  }
  EqmCross(first, second, normal);
  length = PetscSqrtReal(EqmDot3(normal, normal));
  for (PetscInt k = 0; k < 3 && length > 0.; k++) normal[k] /= length;
}

/* A triangle's E_D - A is a sum of squares of how far its derivative is from a similarity, which is linear in the
   places within the triangle's plane: there half the Hessian is (L - Hess A) / 2, and Hess A couples x of one corner
   with y of the next. Motions across the plane change angles to second order only. */
static void AddMatrix(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image, PetscInt cell,
                      const EqmCellFrame *frame, PetscReal factor, PetscReal *matrix)
{
  const PetscReal *const w = ((AngleTerm *)term)->weights + 3 * cell, scale = .5 * factor * term->weight;
  PetscReal normal[3];

  (void)image;
  Normal(problem->domain, place->x, problem->mesh->cells + 3 * cell, normal);
  for (PetscInt i = 0; i < frame->count; i++) {
    for (PetscInt j = 0; j < frame->count; j++) {
      const PetscReal *const u = frame->direction[i], *const e = frame->direction[j];
      const PetscInt a = frame->corner[i], b = frame->corner[j];
      const PetscReal in_plane = EqmDot3(u, e) - EqmDot3(u, normal) * EqmDot3(e, normal);
      PetscReal cross[3];
      EqmCross(u, e, cross);
      matrix[frame->count * i + j] += scale * in_plane * (a == b ? w[(a + 1) % 3] + w[(a + 2) % 3] : -w[3 - a - b]);
      if (a != b) matrix[frame->count * i + j] -= scale * EqmDot3(cross, normal) * (b == (a + 1) % 3 ? .5 : -.5);
    }
  }
}

static PetscErrorCode Destroy(EqmTerm term)
{
  AngleTerm *angle = (AngleTerm *)term;

  PetscFunctionBegin;
  PetscCall(PetscFree2(angle->weights, angle->image));
  PetscCall(PetscFree(angle));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmTermCreateAngle(EqmProblem problem, PetscReal weight, EqmTerm *term)
{
  const PetscInt n = problem->mesh->num_local_cells;
  AngleTerm *angle;

  PetscFunctionBegin;
  PetscCall(PetscNew(&angle));
  angle->term =
      (struct _p_EqmTerm){.name = "angle", .weight = weight, .add = Add, .add_matrix = AddMatrix, .destroy = Destroy};
  PetscCall(PetscMalloc2(3 * n, &angle->weights, n, &angle->image));
  PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_COTANGENT, NULL, angle->weights));
  *term = &angle->term;
  PetscFunctionReturn(0);
}
