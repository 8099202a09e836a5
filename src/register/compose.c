/* phi = g^-1 o h o f and its inverse by point location, and their figures. */
#include "register/registration.h"
#include "mesh/mesh_private.h"
#include "geometry/rotation.h"
#include <string.h>

/* Points of `to` for the owned vertices of `from`. */
static PetscErrorCode Carry(EqmRegistration r, const EqmSide *from, const EqmSide *to, EqmLocation *location,
                            PetscReal **image)
{
  EqmLocator locator;

  PetscFunctionBegin;
  PetscCall(EqmLocatorCreate(to->mesh, r->kind, to->x, &locator));
  PetscCall(EqmLocatorFind(locator, from->mesh->num_owned, from->x, location));
  PetscCall(EqmLocatorDestroy(&locator));
  PetscCall(PetscMalloc1(3 * from->mesh->num_local, image));
  PetscCall(EqmLocationInterpolate(*location, to->mesh, 3, to->mesh->position, *image));
  PetscCall(EqmMeshUpdateGhosts(from->mesh, 3, *image));
  PetscFunctionReturn(0);
}

/* If B is the target itself, the images are the points. */
static PetscErrorCode TakePlaces(EqmRegistration r)
{
  const EqmMesh mesh = r->a.mesh;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * mesh->num_local, &r->image));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    for (PetscInt k = 0; k < r->dim; k++) r->image[3 * v + k] = r->a.x[r->dim * v + k];
  }
  PetscFunctionReturn(0);
}

/* Locations, points, and the map of A that holds them: of the repaired mesh if there is one. Collective. */
PetscErrorCode EqmCompose(EqmRegistration r)
{
  const EqmSoup soup = r->a.intake.mapped;

  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(r->ledger, EQM_PHASE_MEASURE));
  if (r->bare) {
    PetscCall(TakePlaces(r));
  } else {
    PetscCall(Carry(r, &r->a, &r->b, &r->forward, &r->image));
    PetscCall(EqmRegistrationCheckStop(r, PETSC_TRUE));
    if (r->status != EQM_STATUS_STOPPED) PetscCall(Carry(r, &r->b, &r->a, &r->inverse, &r->inverse_image));
  }
  PetscCall(EqmMapCreate(soup, 3, &r->found));
  r->found->in_space = (PetscBool)!r->bare;
  PetscCall(EqmMeshVerticesToInput(r->a.mesh, soup, 3, r->image, r->found->coordinates));
  PetscCall(EqmPhaseEnd(r->ledger, EQM_PHASE_MEASURE));
  PetscFunctionReturn(0);
}

/* Means of v and phi(v) over A, weighted by volume or area. */
static PetscErrorCode Centroids(EqmRegistration r, PetscReal mean[6])
{
  const EqmMesh mesh = r->a.mesh;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 6; k++) mean[k] = 0.;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt k = 0; k < 3; k++) {
      mean[k] += r->a.weight[v] * mesh->position[3 * v + k];
      mean[3 + k] += r->a.weight[v] * r->image[3 * v + k];
    }
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, mean, 6, MPIU_REAL, MPIU_SUM, r->comm));
  PetscFunctionReturn(0);
}

/* d(phi) = sum vol(v) |v - phi(v)| / |A| (003 section 7), in radii: as the meshes stand in space, and after the rigid
   motion of A, scaled to B's measure, that brings it closest to B. */
static PetscErrorCode Dissimilarity(EqmRegistration r)
{
  const EqmMesh mesh = r->a.mesh;
  const PetscReal radius_b = EqmSideRadius(r, &r->b), scale = radius_b / EqmSideRadius(r, &r->a);
  PetscReal mean[6], correlation[9] = {0.}, rotation[9], sum[2] = {0., 0.};

  PetscFunctionBegin;
  PetscCall(Centroids(r, mean));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt k = 0; k < 9; k++)
      correlation[k] +=
          r->a.weight[v] * (r->image[3 * v + k / 3] - mean[3 + k / 3]) * (mesh->position[3 * v + k % 3] - mean[k % 3]);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, correlation, 9, MPIU_REAL, MPIU_SUM, r->comm));
  PetscCall(EqmBestRotation(3, correlation, rotation));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscReal *const p = mesh->position + 3 * v, *const q = r->image + 3 * v;
    PetscReal turned[3] = {p[0] - mean[0], p[1] - mean[1], p[2] - mean[2]}, plain = 0., rigid = 0.;
    EqmRotate(3, rotation, 1, turned);
    for (PetscInt k = 0; k < 3; k++) {
      plain += PetscSqr(p[k] - q[k]);
      rigid += PetscSqr(scale * turned[k] + mean[3 + k] - q[k]);
    }
    sum[0] += r->a.weight[v] * PetscSqrtReal(plain) / radius_b;
    sum[1] += r->a.weight[v] * PetscSqrtReal(rigid) / radius_b;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, r->comm));
  r->figures.dissimilarity = sum[0];
  r->figures.dissimilarity_rigid = sum[1];
  PetscFunctionReturn(0);
}

/* Ratios of the composition, energy and folds of h o f, landmarks, dissimilarity. Collective. */
PetscErrorCode EqmMeasureCorrespondence(EqmRegistration r)
{
  EqmMap measured;

  PetscFunctionBegin;
  PetscCall(EqmMapMeasure(r->found, r->a.mesh, r->image));
  if (r->kind == EQM_IMAGE_SPACE)
    r->figures.folds_phi = r->found->distortion.folds; /* in space triangles have no sign */
  PetscCall(EqmMapCreate(r->a.intake.mapped, r->dim, &measured));
  PetscCall(EqmMapMeasure(measured, r->a.mesh, r->a.x));
  r->figures.energy = measured->distortion.energy;
  r->figures.folds_a = measured->distortion.folds;
  PetscCall(EqmMapDestroy(&measured));
  if (!r->bare) {
    PetscCall(EqmMapCreate(r->b.intake.mapped, r->dim, &measured));
    PetscCall(EqmMapMeasure(measured, r->b.mesh, r->b.x));
    r->figures.folds_b = measured->distortion.folds;
    r->figures.energy_b = measured->distortion.energy;
    PetscCall(EqmMapDestroy(&measured));
    PetscCall(Dissimilarity(r));
  }
  if (r->landmarks.num) PetscCall(EqmLandmarkErrors(r));
  PetscFunctionReturn(0);
}
