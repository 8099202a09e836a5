/* Mobius maps of the sphere: conformal to rounding, a group's worth of them centred to the same map up to a rotation.
 */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

typedef struct {
  TestMesh test;
  EqmSolver solver;
  EqmDomain domain;
  PetscReal *mass;
} Setting;

static PetscErrorCode Begin(const char *shape, PetscInt n, Setting *s)
{
  PetscReal total = 0.;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 3, &s->test));
  PetscCall(TestSolve(s->test.mesh, "sphere", "-method fixed-point -max_it 0", &s->solver));
  s->domain = s->solver->problem->domain;
  PetscCall(PetscMalloc1(s->test.mesh->num_owned, &s->mass));
  PetscCall(EqmMeshVertexWeights(s->test.mesh, s->mass));
  for (PetscInt v = 0; v < s->test.mesh->num_owned; v++) total += s->mass[v];
  CHECK_CLOSE(TestSum(PETSC_COMM_WORLD, total), 1., 1e-13, 1.);
  PetscFunctionReturn(0);
}

static PetscErrorCode End(Setting *s)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(s->mass));
  PetscCall(EqmSolverDestroy(&s->solver));
  PetscCall(TestMeshDestroy(&s->test));
  PetscFunctionReturn(0);
}

static PetscReal Distance(const PetscReal *p, const PetscReal *q)
{
  const PetscReal d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  return PetscSqrtReal(EqmDot3(d, d));
}

/* Mobius maps are the maps that keep every cross ratio. */
static PetscErrorCode TestCrossRatios(Setting *s)
{
  const EqmMesh mesh = s->test.mesh;
  const PetscReal c[3] = {.3, -.5, .6};
  const PetscReal *const x = s->solver->iterate->place.x;
  EqmPlace to;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(s->domain, &to));
  PetscCall(EqmPlaceCopy(s->domain, &s->solver->iterate->place, &to));
  PetscCall(EqmPlaceShift(s->domain, c, &to));
  for (PetscInt k = 0; k + 3 < mesh->num_local; k++) {
    const PetscReal *const p = x + 3 * k, *const y = to.x + 3 * k;
    const PetscReal before =
        Distance(p, p + 3) * Distance(p + 6, p + 9) / (Distance(p, p + 6) * Distance(p + 3, p + 9));
    const PetscReal after = Distance(y, y + 3) * Distance(y + 6, y + 9) / (Distance(y, y + 6) * Distance(y + 3, y + 9));
    CHECK_CLOSE(after, before, 1e-11, before);
    CHECK_CLOSE(EqmDot3(y, y), 1., 1e-15, 1.);
    CHECK_CLOSE(EqmDot3(y, to.frame + 3 * k), 0., 1e-15, 1.);
  }
  PetscCall(EqmPlaceDestroy(&to));
  PetscFunctionReturn(0);
}

/* Centring undoes any shift: mutual distances are those of the map centred without one. */
static PetscErrorCode TestCentering(Setting *s, const PetscReal c[3])
{
  const EqmMesh mesh = s->test.mesh;
  PetscReal offset, center[3];
  EqmPlace straight, shifted;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(s->domain, &straight));
  PetscCall(EqmPlaceCreate(s->domain, &shifted));
  PetscCall(EqmPlaceCopy(s->domain, &s->solver->iterate->place, &straight));
  PetscCall(EqmPlaceCopy(s->domain, &s->solver->iterate->place, &shifted));
  PetscCall(EqmPlaceShift(s->domain, c, &shifted));
  PetscCall(EqmPlaceCenter(s->domain, s->mass, &straight, &offset));
  PetscCall(EqmPlaceCenter(s->domain, s->mass, &shifted, &offset));
  PetscCall(EqmPlaceMassCenter(s->domain, s->mass, &shifted, center));
  CHECK_CLOSE(PetscSqrtReal(EqmDot3(center, center)), offset, 1e-15, 1.);
  CHECK(offset <= 1e-12, "the mass centre is off by %g", (double)offset);
  for (PetscInt k = 1; k < mesh->num_local; k++)
    CHECK_CLOSE(Distance(shifted.x, shifted.x + 3 * k), Distance(straight.x, straight.x + 3 * k), 1e-9, 1.);
  PetscCall(EqmPlaceDestroy(&straight));
  PetscCall(EqmPlaceDestroy(&shifted));
  PetscFunctionReturn(0);
}

/* More than half of the mass in one spot: no Mobius map centres that; the attempt says so and stays on the sphere. */
static PetscErrorCode TestHeavySpot(Setting *s)
{
  const EqmMesh mesh = s->test.mesh;
  PetscReal *mass, offset;
  EqmPlace place;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_owned, &mass));
  PetscCall(EqmPlaceCreate(s->domain, &place));
  PetscCall(EqmPlaceCopy(s->domain, &s->solver->iterate->place, &place));
  for (PetscInt v = 0; v < mesh->num_owned; v++) mass[v] = .4 * s->mass[v] + (mesh->vertex_input[v] == 0 ? .6 : 0.);
  PetscCall(EqmPlaceCenter(s->domain, mass, &place, &offset));
  CHECK(offset > .1 && offset < 1., "offset %g", (double)offset);
  for (PetscInt k = 0; k < mesh->num_local; k++) CHECK_CLOSE(EqmDot3(place.x + 3 * k, place.x + 3 * k), 1., 1e-15, 1.);
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(PetscFree(mass));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Setting s;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(Begin("head", 700, &s));
  PetscCall(TestCrossRatios(&s));
  PetscCall(TestCentering(&s, (PetscReal[3]){0., 0., 0.}));
  PetscCall(TestCentering(&s, (PetscReal[3]){.2, -.4, .1}));
  PetscCall(TestCentering(&s, (PetscReal[3]){.6, .5, -.55})); /* nearly everything in one spot */
  PetscCall(TestHeavySpot(&s));
  PetscCall(End(&s));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
