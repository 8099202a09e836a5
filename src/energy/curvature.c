/* First and second derivatives of a cell's image measure along the geodesics of its corners. */
#include "energy/curvature.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"

/* Displacements of the corners of a cell. */
typedef struct {
  PetscReal x[3 * EQM_MAX_CORNERS];
} Displacement;

/* The displacements that a cell's degrees of freedom stand for. */
static void FindDirections(PetscInt dim, const EqmCellFrame *frame, Displacement direction[EQM_MOST_CELL_DOFS])
{
  for (PetscInt i = 0; i < frame->count; i++) {
    direction[i] = (Displacement){{0.}};
    for (PetscInt c = 0; c < dim; c++) direction[i].x[dim * frame->corner[i] + c] = frame->direction[i][c];
  }
}

static PetscReal SecondDerivative(EqmDomain domain, const PetscReal *const p[], const Displacement *displacement)
{
  const PetscReal *d[EQM_MAX_CORNERS];

  for (PetscInt a = 0; a < domain->mesh->cell_size; a++) d[a] = displacement->x + domain->dim * a;
  return EqmMeasureSecondDerivative(domain->measure, p, d);
}

/* Straight motions first, mixed derivatives by polarisation; then the geodesics' curvature term. Not collective.
 */
void EqmCellDifferentiate(EqmDomain domain, const EqmPlace *place, PetscInt cell, EqmCellDerivatives *d)
{
  const PetscInt dim = domain->dim, corners = domain->mesh->cell_size, *const v = domain->mesh->cells + corners * cell;
  const PetscReal *p[EQM_MAX_CORNERS];
  PetscReal gradient[3 * EQM_MAX_CORNERS];
  Displacement direction[EQM_MOST_CELL_DOFS], sum;

  for (PetscInt a = 0; a < corners; a++) p[a] = place->x + dim * v[a];
  EqmCellFrameFind(domain, place, cell, &d->frame);
  FindDirections(dim, &d->frame, direction);
  EqmMeasureGradient(domain->measure, p, gradient);
  for (PetscInt i = 0; i < d->frame.count; i++) {
    d->first[i] = 0.;
    for (PetscInt k = 0; k < dim * corners; k++) d->first[i] += gradient[k] * direction[i].x[k];
    d->second[i][i] = SecondDerivative(domain, p, &direction[i]);
    for (PetscInt j = 0; j < i; j++) {
      for (PetscInt k = 0; k < dim * corners; k++) sum.x[k] = direction[i].x[k] + direction[j].x[k];
      d->second[i][j] = d->second[j][i] = .5 * (SecondDerivative(domain, p, &sum) - d->second[i][i] - d->second[j][j]);
    }
  }
  for (PetscInt i = 0; i < d->frame.count;
       i++) { /* a geodesic of unit speed on a circle or sphere has the acceleration -x */
    const PetscInt a = d->frame.corner[i];
    const PetscReal curvature = EqmDomainMotion(domain, v[a])->curvature;
    if (curvature == 0.) continue;
    for (PetscInt c = 0; c < dim; c++) d->second[i][i] -= curvature * gradient[dim * a + c] * p[a][c];
  }
}
