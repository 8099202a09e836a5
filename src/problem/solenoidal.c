#include "problem/solenoidal_private.h"
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"
#include <petscblaslapack.h>

/* Vertices whose products are summed by themselves: sums do not depend on the threads. */
enum { VERTICES_OF_PART = 4096 };

/* Number the splines that are not zero everywhere in the ball. */
static PetscInt NumberSplines(PetscInt number[EQM_SPLINES])
{
  const PetscInt half = EQM_SPLINE_SIDE / 2;
  PetscInt count = 0;

  for (PetscInt i = -half; i <= half; i++) {
    for (PetscInt j = -half; j <= half; j++) {
      for (PetscInt k = -half; k <= half; k++) {
        const PetscInt at[] = {i, j, k};
        PetscReal square = 0.;
        for (PetscInt d = 0; d < 3; d++)
          square += PetscSqr(PetscMax(0., EQM_SPLINE_STEP * ((PetscReal)PetscAbsInt(at[d]) - 1.5)));
        number[EqmSplinePlace(i, j, k)] = square < 1. ? count++ : -1;
      }
    }
  }
  return count;
}

static PetscInt NumParts(EqmMesh mesh)
{
  return (mesh->num_owned + VERTICES_OF_PART - 1) / VERTICES_OF_PART;
}

PetscErrorCode EqmSolenoidalCreate(EqmProblem problem, EqmSolenoidal *out)
{
  const EqmMesh mesh = problem->mesh;
  EqmSolenoidal space;

  PetscFunctionBegin;
  PetscCall(PetscNew(&space));
  space->problem = problem;
  space->num_splines = NumberSplines(space->number);
  space->size = EQM_FIELDS_PER_SPLINE * space->num_splines;
  PetscCall(PetscMalloc3(space->size, &space->coefficient, NumParts(mesh) * space->size, &space->partial,
                         3 * mesh->num_owned, &space->ambient));
  *out = space;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolenoidalDestroy(EqmSolenoidal *space)
{
  PetscFunctionBegin;
  if (!*space) PetscFunctionReturn(0);
  PetscCall(PetscFree3((*space)->coefficient, (*space)->partial, (*space)->ambient));
  PetscCall(PetscFree((*space)->factor));
  PetscCall(PetscFree(*space));
  PetscFunctionReturn(0);
}

/* First of the three splines along the last direction. */
static inline PetscInt PlaceOf(const EqmSplines *s, PetscInt m)
{
  return EqmSplinePlace(s->base[0] - 1 + m / 9, s->base[1] - 1 + m / 3 % 3, s->base[2] - 1 + m % 3);
}

/* sum += P^T a over vertices begin .. end - 1. */
EQM_CLONES static void Restrict(EqmSolenoidal space, const PetscReal *x, const PetscReal *a, PetscInt begin,
                                PetscInt end, PetscReal *sum)
{
  for (PetscInt v = begin; v < end; v++) {
    PetscReal product[EQM_FIELDS_PER_SPLINE][EQM_SPLINES_AT_POINT];
    EqmSplines s;
    EqmSplinesAt(x + 3 * v, &s);
    EqmSolenoidalAgainst(&s, x + 3 * v, a + 3 * v, product);
    for (PetscInt m = 0; m < EQM_SPLINES_AT_POINT; m++) {
      const PetscInt which = space->number[PlaceOf(&s, m)];
      if (which < 0) continue;
      for (PetscInt f = 0; f < EQM_FIELDS_PER_SPLINE; f++) sum[f * space->num_splines + which] += product[f][m];
    }
  }
}

/* a = P c at a vertex: sums of w x c_123 + (grad phi x x) c_4, w = grad((1 - |x|^2) phi). */
EQM_CLONES static void Prolong(EqmSolenoidal space, const PetscReal x[3], const PetscReal *coefficient, PetscReal a[3])
{
  const PetscReal bubble = 1. - x[0] * x[0] - x[1] * x[1] - x[2] * x[2];
  PetscReal c[EQM_FIELDS_PER_SPLINE][EQM_SPLINES_AT_POINT];
  PetscReal curl[3] = {0., 0., 0.}, potential[3] = {0., 0., 0.}, slope[3] = {0., 0., 0.};
  EqmSplines s;

  EqmSplinesAt(x, &s);
  for (PetscInt m = 0; m < EQM_SPLINES_AT_POINT; m++) {
    const PetscInt which = space->number[PlaceOf(&s, m)];
    for (PetscInt f = 0; f < EQM_FIELDS_PER_SPLINE; f++)
      c[f][m] = which < 0 ? 0. : coefficient[f * space->num_splines + which];
  }
  for (PetscInt m = 0; m < EQM_SPLINES_AT_POINT; m++) {
    for (PetscInt k = 0; k < 3; k++) {
      const PetscInt i = (k + 1) % 3, j = (k + 2) % 3;
      curl[k] += s.gradient[i][m] * c[j][m] - s.gradient[j][m] * c[i][m];
      potential[k] += s.value[m] * c[k][m];
      slope[k] += s.gradient[k][m] * c[3][m];
    }
  }
  for (PetscInt k = 0; k < 3; k++) {
    const PetscInt i = (k + 1) % 3, j = (k + 2) % 3;
    a[k] = bubble * curl[k] - 2. * (x[i] * potential[j] - x[j] * potential[i]) + slope[i] * x[j] - slope[j] * x[i];
  }
}

/* P^T of the ambient velocities, on all ranks. Sums of parts are added in their order. */
static PetscErrorCode RestrictAll(EqmSolenoidal space, const PetscReal *x)
{
  const EqmMesh mesh = space->problem->mesh;
  const PetscInt size = space->size, num_parts = NumParts(mesh);
  PetscMPIInt count;

  PetscFunctionBegin;
#pragma omp parallel for schedule(dynamic)
  for (PetscInt part = 0; part < num_parts; part++) {
    PetscReal *const sum = space->partial + size * part;
    for (PetscInt i = 0; i < size; i++) sum[i] = 0.;
    Restrict(space, x, space->ambient, VERTICES_OF_PART * part,
             PetscMin(VERTICES_OF_PART * (part + 1), mesh->num_owned), sum);
  }
  for (PetscInt i = 0; i < size; i++) {
    space->coefficient[i] = 0.;
    for (PetscInt part = 0; part < num_parts; part++) space->coefficient[i] += space->partial[size * part + i];
  }
  PetscCall(PetscMPIIntCast(size, &count));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, space->coefficient, count, MPIU_REAL, MPI_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolenoidalSolve(EqmSolenoidal space, const EqmPlace *place, Vec g)
{
  const EqmDomain domain = space->problem->domain;
  const PetscBLASInt one = 1;
  PetscBLASInt n, info;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(domain->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(EqmDomainExpandOwned(domain, place, g, space->ambient));
  PetscCall(RestrictAll(space, place->x));
  PetscCall(PetscBLASIntCast(space->size, &n));
  PetscCallBLAS("LAPACKpotrs", LAPACKpotrs_("L", &n, &one, space->factor, &n, space->coefficient, &n, &info));
  PetscCall(EqmEventEnd(domain->mesh->ledger, EQM_EVENT_SOLVE));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolenoidalAdd(EqmSolenoidal space, const EqmPlace *place, Vec h)
{
  const EqmDomain domain = space->problem->domain;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(domain->mesh->ledger, EQM_EVENT_SOLVE));
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < domain->mesh->num_owned; v++)
    Prolong(space, place->x + 3 * v, space->coefficient, space->ambient + 3 * v);
  PetscCall(EqmDomainAddProjected(domain, place, space->ambient, h));
  PetscCall(EqmEventEnd(domain->mesh->ledger, EQM_EVENT_SOLVE));
  PetscFunctionReturn(0);
}
