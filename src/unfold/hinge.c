/* Folds of maps to the ball: the isovolumetric energy with a hinge on small volumes, lambda sum w max(0, .1 - J)^2, J
   the ratio of each cell, and of the cells between the origin and each boundary triangle: these keep the boundary's own
   map unfolded (docs/methods.md, Solids). */
#include "unfold/hinge.h"
#include "energy/kernel.h"

static const PetscReal hinge_at = .1;

/* Triangles of the boundary with their share of the surface, and whether this rank counts them. */
struct _p_EqmHinge {
  PetscReal lambda, total; /* total: the volume that ratios refer to, held */
  PetscReal *share;        /* per boundary facet */
  PetscBool *counts;
  PetscReal *slope; /* per local cell */
  PetscReal *ambient;
};

PetscErrorCode EqmHingeCreate(EqmSolver solver, EqmHinge *out)
{
  const EqmMesh mesh = solver->mesh;
  PetscReal local = 0., area;
  EqmHinge hinge;

  PetscFunctionBegin;
  PetscCall(PetscNew(&hinge));
  hinge->total = solver->domain->target_measure;
  PetscCall(PetscMalloc4(mesh->num_boundary_facets, &hinge->share, mesh->num_boundary_facets, &hinge->counts,
                         mesh->num_local_cells, &hinge->slope, 3 * mesh->num_owned, &hinge->ambient));
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    const PetscInt *const v = mesh->boundary_facets + 3 * f;
    PetscInt lowest = v[0];
    for (PetscInt a = 1; a < 3; a++) lowest = mesh->global[v[a]] < mesh->global[lowest] ? v[a] : lowest;
    hinge->counts[f] = (PetscBool)(lowest < mesh->num_owned);
    hinge->share[f] = EqmArea3(mesh->position + 3 * v[0], mesh->position + 3 * v[1], mesh->position + 3 * v[2]);
    if (hinge->counts[f]) local += hinge->share[f];
  }
  PetscCall(MPIU_Allreduce(&local, &area, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) hinge->share[f] /= area;
  *out = hinge;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHingeDestroy(EqmHinge *hinge)
{
  PetscFunctionBegin;
  if (!*hinge) PetscFunctionReturn(0);
  PetscCall(PetscFree4((*hinge)->share, (*hinge)->counts, (*hinge)->slope, (*hinge)->ambient));
  PetscCall(PetscFree(*hinge));
  PetscFunctionReturn(0);
}

PetscReal EqmHingeStiffness(EqmHinge hinge, PetscReal weight, PetscReal measure)
{
  return hinge && measure < hinge_at * weight * hinge->total ? hinge->lambda : 0.;
}

/* Cells: the value, and the slopes by the volumes. */
static PetscReal AddCells(EqmHinge hinge, EqmMesh mesh, const PetscReal *image)
{
  PetscReal sum = 0.;

  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscReal lack = PetscMax(0., hinge_at - image[c] / (mesh->weight[c] * hinge->total));
    hinge->slope[c] = -2. * hinge->lambda * lack;
    if (c < mesh->num_owned_cells) sum += mesh->weight[c] * (lack * lack);
  }
  return sum;
}

/* The cells between the origin and the boundary's triangles: their gradients at owned vertices go to `ambient`. */
static PetscReal AddBoundary(EqmHinge hinge, EqmMesh mesh, const PetscReal *x, PetscReal *ambient)
{
  PetscReal sum = 0.;

  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    const PetscInt *const v = mesh->boundary_facets + 3 * f;
    const PetscReal *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2]};
    const PetscReal volume = EqmHalfDet(p[0], p[1], p[2]) / 3.;
    const PetscReal lack = PetscMax(0., hinge_at - volume / (hinge->share[f] * hinge->total));
    if (hinge->counts[f]) sum += hinge->share[f] * (lack * lack);
    for (PetscInt a = 0; a < 3 && ambient && lack > 0.; a++) {
      PetscReal normal[3];
      if (v[a] >= mesh->num_owned) continue;
      EqmCross(p[(a + 1) % 3], p[(a + 2) % 3], normal);
      for (PetscInt k = 0; k < 3; k++) ambient[3 * v[a] + k] -= 2. * hinge->lambda * lack * normal[k] / 6.;
    }
  }
  return sum;
}

PetscErrorCode EqmHingeAdd(EqmSolver solver, EqmHinge hinge, const EqmPlace *place, const PetscReal *image,
                           PetscReal *value, Vec gradient)
{
  const EqmMesh mesh = solver->mesh;
  PetscReal local, sum;
  Vec part;

  PetscFunctionBegin;
  local = AddCells(hinge, mesh, image);
  PetscCall(EqmImageGradient(solver->domain, place, hinge->slope, hinge->ambient));
  local += AddBoundary(hinge, mesh, place->x, hinge->ambient);
  PetscCall(MPIU_Allreduce(&local, &sum, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  *value += hinge->lambda * hinge->total * sum;
  PetscCall(VecDuplicate(gradient, &part));
  PetscCall(EqmDomainProject(solver->domain, place, hinge->ambient, part));
  PetscCall(VecAXPY(gradient, 1., part));
  PetscCall(VecDestroy(&part));
  PetscFunctionReturn(0);
}

/* Minimise with one weight, until nothing is folded. */
static PetscErrorCode Stage(EqmSolver solver, PetscReal lambda, PetscInt most_steps)
{
  const PetscInt iterations = solver->iteration;
  EqmStep outcome = EQM_STEP_TAKEN;

  PetscFunctionBegin;
  solver->hinge->lambda = lambda;
  solver->iteration = 0; /* the method counts from here when its metric is due */
  PetscCall(EqmMethodLbfgs.set_up(solver));
  while (solver->iteration < most_steps && outcome == EQM_STEP_TAKEN && solver->totals.folds > 0) {
    PetscCall(EqmMethodLbfgs.step(solver, &outcome));
    solver->iteration++;
  }
  PetscCall(EqmMethodLbfgs.destroy(solver));
  solver->iteration = iterations;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBallUnfold(EqmSolver solver, PetscInt64 *before, PetscInt64 *after)
{
  static const PetscReal lambda[] = {1., 30., 1000.};
  enum { MOST_STEPS = 100 };
  EqmPlace best;

  PetscFunctionBegin;
  *before = *after = solver->totals.folds;
  PetscCall(EqmPlaceCreate(solver->domain, &best));
  PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &best));
  PetscCall(EqmHingeCreate(solver, &solver->hinge));
  for (size_t k = 0; k < sizeof(lambda) / sizeof(lambda[0]) && *after > 0; k++) {
    PetscCall(Stage(solver, lambda[k], MOST_STEPS));
    if (solver->totals.folds >= *after) continue;
    *after = solver->totals.folds;
    PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &best));
  }
  PetscCall(EqmHingeDestroy(&solver->hinge));
  PetscCall(EqmPlaceCopy(solver->domain, &best, &solver->place));
  PetscCall(EqmPlaceDestroy(&best));
  PetscFunctionReturn(0);
}
