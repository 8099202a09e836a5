/* Landmarks, vertices with target positions: sum w_i |x(v_i) - q_i|^2 (000 (46), 001 section 6.6). */
#include "problem/term.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"

static PetscErrorCode Add(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                          PetscReal *value, Vec gradient)
{
  const EqmLandmarks *const landmarks = &problem->landmarks;
  const EqmDomain domain = problem->domain;
  PetscReal squares, *ambient;

  PetscFunctionBegin;
  (void)image;
  PetscCall(EqmLandmarksSquares(landmarks, domain, place->x, NULL, &squares));
  *value += term->weight * squares;
  if (!gradient) PetscFunctionReturn(0);
  PetscCall(PetscCalloc1(domain->dim * problem->mesh->num_owned, &ambient));
  EqmLandmarksAddGradient(landmarks, domain, place->x, 2. * term->weight, ambient);
  PetscCall(EqmDomainAddProjected(domain, place, ambient, gradient));
  PetscCall(PetscFree(ambient));
  PetscFunctionReturn(0);
}

/* Half the Hessian of a square is w_i times the identity, and the shares hold w_i; curvature of the domain is
 * neglected. */
static void AddMatrix(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image, PetscInt cell,
                      const EqmCellFrame *frame, PetscReal factor, PetscReal *matrix)
{
  const PetscReal *const share = problem->landmarks.share;
  const PetscInt corners = problem->mesh->cell_size, *const v = problem->mesh->cells + corners * cell;

  (void)place;
  (void)image;
  for (PetscInt i = 0; i < frame->count; i++) {
    const PetscInt a = frame->corner[i];
    for (PetscInt j = 0; j < frame->count && share[v[a]] > 0.; j++) {
      if (frame->corner[j] == a)
        matrix[frame->count * i + j] +=
            factor * term->weight * share[v[a]] * EqmDot3(frame->direction[i], frame->direction[j]);
    }
  }
}

static PetscErrorCode Destroy(EqmTerm term)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(term));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmTermCreateLandmarks(EqmProblem problem, PetscReal weight, EqmTerm *term)
{
  PetscFunctionBegin;
  (void)problem;
  PetscCall(PetscNew(term));
  **term = (struct _p_EqmTerm){
      .name = "landmarks", .weight = weight, .add = Add, .add_matrix = AddMatrix, .destroy = Destroy};
  PetscFunctionReturn(0);
}
