/* The boundary of a Riemann map by harmonic measure. The conformal map to the disk that takes p to the centre takes an
   arc of the boundary to one of 2 pi times its harmonic measure as seen from p: the flux of the Green function of p
   (Kakutani 1944). Where the surface is long, arc lengths are far from that, and vertices at its ends, which belong as
   close together as e^(-pi length / width), would have to come together from afar. */
#include "method/riemann.h"
#include "domain/domain_private.h"

/* omega = -L_BI L_II^-1 e_p per owned boundary vertex; their sum is one. */
static PetscErrorCode FindMeasure(EqmProblem problem, EqmRiemann riemann, PetscReal *omega)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal *green;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(mesh->num_local, &green));
  if (riemann->pole >= 0) green[riemann->pole] = 1.;
  PetscCall(EqmGroupSolve(problem, 1, green));
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, green));
  PetscCall(EqmLaplacianApply(mesh, riemann->weights, 1, green, riemann->scratch));
  for (PetscInt b = 0; b < riemann->num_boundary; b++) omega[b] = -riemann->scratch[riemann->boundary[b]];
  PetscCall(PetscFree(green));
  PetscFunctionReturn(0);
}

/* From measures of the vertices in the loop's order to angles. Obtuse triangles, and ears without an edge to the
   interior, leave gaps of none or less: such a gap shares with its neighbours. `crowded`: gaps were too small for the
   arithmetic and have been widened. */
static PetscErrorCode AnglesFromMeasure(PetscInt n, PetscReal *omega, PetscBool *crowded)
{
  const PetscReal least = 10. * EQM_RIEMANN_LEAST_GAP;
  PetscReal *gap, sum = 0., angle = 0.;
  PetscBool mended = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &gap));
  for (PetscInt k = 0; k < n; k++) gap[k] = .5 * (omega[k] + omega[(k + 1) % n]);
  for (PetscInt round = 0; round < n && mended; round++) {
    mended = PETSC_FALSE;
    for (PetscInt k = 0; k < n; k++) {
      PetscReal *const before = &gap[(k + n - 1) % n], *const after = &gap[(k + 1) % n];
      if (gap[k] > 0.) continue;
      *before = *after = gap[k] = (*before + gap[k] + *after) / 3.;
      mended = PETSC_TRUE;
    }
  }
  for (PetscInt k = 0; k < n; k++) {
    *crowded = (PetscBool)(*crowded || gap[k] < least);
    gap[k] = PetscMax(gap[k], least);
    sum += gap[k];
  }
  for (PetscInt k = 0; k < n; k++) {
    omega[k] = 2. * PETSC_PI * angle / sum;
    angle += gap[k];
  }
  PetscCall(PetscFree(gap));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRiemannPlaceByMeasure(EqmProblem problem, EqmRiemann riemann, EqmPlace *place, PetscBool *crowded)
{
  const EqmLoop loop = riemann->loop;
  PetscReal *omega, *whole;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(riemann->num_boundary, &omega, loop->count, &whole));
  PetscCall(FindMeasure(problem, riemann, omega));
  PetscCall(EqmLoopGather(loop, omega, whole));
  *crowded = PETSC_FALSE;
  if (loop->count > 0) PetscCall(AnglesFromMeasure(loop->count, whole, crowded));
  PetscCallMPI(MPI_Bcast(crowded, 1, MPIU_BOOL, 0, loop->comm));
  PetscCall(EqmLoopScatter(loop, whole, omega));
  for (PetscInt b = 0; b < riemann->num_boundary; b++) {
    place->x[2 * riemann->boundary[b]] = PetscCosReal(omega[b]);
    place->x[2 * riemann->boundary[b] + 1] = PetscSinReal(omega[b]);
  }
  PetscCall(EqmMeshUpdateGhosts(problem->mesh, 2, place->x));
  PetscCall(PetscFree2(omega, whole));
  PetscFunctionReturn(0);
}
