/* The Mobius map of least area distortion: a quasi-Newton method in the three parameters of the shift. */
#include "solver/normalise.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

typedef struct {
  EqmProblem problem;
  PetscReal *image, *ambient;
  Vec gradient;
} AreaSearch;

/* The normalised authalic energy and its slope by the shift c of EqmPlaceShift, whose field is 2 (c - (c . x) x). */
static PetscErrorCode Evaluate(AreaSearch *s, const EqmPlace *place, PetscReal *energy, PetscReal slope[3])
{
  const EqmProblem problem = s->problem;
  PetscReal sum[3] = {0., 0., 0.};
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(problem->mesh->ledger, &work));
  work->evaluations++;
  PetscCall(EqmAuthalicEnergy(problem->domain, place, s->image, energy, s->gradient));
  PetscCall(EqmDomainExpand(problem->domain, place, s->gradient, s->ambient));
  for (PetscInt k = 0; k < 3 * problem->mesh->num_owned; k++) sum[k % 3] += 2. * s->ambient[k];
  PetscCall(MPIU_Allreduce(sum, slope, 3, MPIU_REAL, MPIU_SUM, problem->comm));
  PetscFunctionReturn(0);
}

/* Broyden, Fletcher, Goldfarb and Shanno's update of the inverse Hessian for the step s and the change y of the slope.
 */
static void Update(PetscReal inverse[9], const PetscReal s[3], const PetscReal y[3])
{
  PetscReal hy[3], sy = EqmDot3(s, y), yhy;

  if (!(sy > 0.)) return;
  for (int k = 0; k < 3; k++) hy[k] = EqmDot3(inverse + 3 * k, y);
  yhy = EqmDot3(y, hy);
  for (int k = 0; k < 9; k++) {
    const int i = k / 3, j = k % 3;
    inverse[k] += (1. + yhy / sy) * s[i] * s[j] / sy - (hy[i] * s[j] + s[i] * hy[j]) / sy;
  }
}

/* Armijo's rule along the direction from `place`; the trial is the last. False: no decrease. */
static PetscErrorCode Search(AreaSearch *s, const EqmPlace *place, PetscReal energy, PetscReal descent,
                             PetscReal direction[3], EqmPlace *trial, PetscReal *then, PetscReal slope[3],
                             PetscBool *found)
{
  enum { MOST_CUTS = 30 };
  const PetscReal longest = .5, length = PetscSqrtReal(EqmDot3(direction, direction));
  PetscReal t = PetscMin(1., longest / length);

  PetscFunctionBegin;
  *found = PETSC_FALSE;
  for (PetscInt cut = 0; cut < MOST_CUTS && !*found; cut++, t *= .5) {
    const PetscReal c[3] = {t * direction[0], t * direction[1], t * direction[2]};
    PetscCall(EqmPlaceCopy(s->problem->domain, place, trial));
    PetscCall(EqmPlaceShift(s->problem->domain, c, trial));
    PetscCall(Evaluate(s, trial, then, slope));
    *found = (PetscBool)(*then <= energy - 1e-4 * t * descent);
    for (int k = 0; k < 3 && *found; k++) direction[k] = c[k];
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Minimise(AreaSearch *s, EqmPlace *place)
{
  enum { MOST_STEPS = 60 };
  PetscReal inverse[9] = {.01, 0., 0., 0., .01, 0., 0., 0., .01}, energy, slope[3], then, new_slope[3];
  PetscBool found = PETSC_TRUE;
  EqmPlace trial;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(s->problem->domain, &trial));
  PetscCall(Evaluate(s, place, &energy, slope));
  for (PetscInt step = 0; step < MOST_STEPS && found; step++) {
    PetscReal direction[3];
    for (int k = 0; k < 3; k++) direction[k] = -EqmDot3(inverse + 3 * k, slope);
    const PetscReal descent = -EqmDot3(direction, slope);
    if (!(descent > 1e-14 * energy)) break;
    PetscCall(Search(s, place, energy, descent, direction, &trial, &then, new_slope, &found));
    if (!found) break;
    PetscCall(EqmPlaceCopy(s->problem->domain, &trial, place));
    for (int k = 0; k < 3; k++) slope[k] = new_slope[k] - slope[k];
    Update(inverse, direction, slope);
    for (int k = 0; k < 3; k++) slope[k] = new_slope[k];
    energy = then;
  }
  PetscCall(EqmPlaceDestroy(&trial));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMoebiusLeastArea(EqmProblem problem, EqmPlace *place)
{
  AreaSearch s = {.problem = problem};

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(problem->mesh->num_local_cells, &s.image, 3 * problem->mesh->num_local, &s.ambient));
  PetscCall(EqmDomainCreateVec(problem->domain, &s.gradient));
  PetscCall(Minimise(&s, place));
  PetscCall(VecDestroy(&s.gradient));
  PetscCall(PetscFree2(s.image, s.ambient));
  PetscFunctionReturn(0);
}
