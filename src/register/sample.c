/* A sample of vertices, and how far phi is from a rigid motion on it. */
#include "register/sample.h"
#include "mesh/mesh_private.h"
#include "geometry/rotation.h"

PetscErrorCode EqmSampleDestroy(EqmSample *s)
{
  PetscFunctionBegin;
  PetscCall(EqmLocatorDestroy(&s->locator));
  PetscCall(PetscFree3(s->place, s->point, s->root_weight));
  PetscFunctionReturn(0);
}

/* `num` sets of points, three reals each, about their weighted means. */
static PetscErrorCode Centre(const EqmSample *s, PetscInt num, PetscReal *points)
{
  const PetscInt length = 3 * s->count;
  PetscReal *mean;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * num, &mean));
  for (PetscInt n = 0; n < num; n++) {
    for (PetscInt k = 0; k < length; k++)
      mean[3 * n + k % 3] += PetscSqr(s->root_weight[k / 3]) * points[n * length + k];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, mean, (PetscMPIInt)(3 * num), MPIU_REAL, MPIU_SUM, s->r->comm));
  for (PetscInt n = 0; n < num; n++) {
    for (PetscInt k = 0; k < length; k++) points[n * length + k] -= mean[3 * n + k % 3];
  }
  PetscCall(PetscFree(mean));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSampleCreate(EqmRegistration r, PetscInt size, EqmSample *s)
{
  const EqmMesh mesh = r->a.mesh;
  const PetscInt stride = PetscMax(1, mesh->num_vertices / size);
  const PetscReal scale = EqmSideRadius(r, &r->b) / EqmSideRadius(r, &r->a);
  PetscReal total = 0.;

  PetscFunctionBegin;
  *s = (EqmSample){.r = r, .dim = r->dim};
  PetscCall(EqmLocatorCreate(r->b.mesh, r->kind, r->b.x, &s->locator));
  PetscCall(PetscMalloc3(r->dim * mesh->num_owned, &s->place, 3 * mesh->num_owned, &s->point, mesh->num_owned,
                         &s->root_weight));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    if (mesh->vertex_input[v] % stride) continue;
    for (PetscInt k = 0; k < r->dim; k++) s->place[r->dim * s->count + k] = r->a.x[r->dim * v + k];
    for (PetscInt k = 0; k < 3; k++) s->point[3 * s->count + k] = scale * mesh->position[3 * v + k];
    s->root_weight[s->count++] = r->a.weight[v];
    total += r->a.weight[v];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &total, 1, MPIU_REAL, MPIU_SUM, r->comm));
  for (PetscInt i = 0; i < s->count; i++) s->root_weight[i] = PetscSqrtReal(s->root_weight[i] / total);
  PetscCall(Centre(s, 1, s->point));
  PetscFunctionReturn(0);
}

/* phi(v) about the mean for each rotation: all points are located at once. */
static PetscErrorCode Carry(const EqmSample *s, PetscInt num, const PetscReal *rotations, PetscReal *images)
{
  const PetscInt length = s->dim * s->count;
  PetscReal *turned;
  EqmLocation location;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num * length, &turned));
  for (PetscInt n = 0; n < num; n++) {
    PetscCall(PetscArraycpy(turned + n * length, s->place, length));
    EqmRotate(s->dim, rotations + s->dim * s->dim * n, s->count, turned + n * length);
  }
  PetscCall(EqmLocatorFind(s->locator, num * s->count, turned, &location));
  PetscCall(EqmLocationInterpolate(location, s->r->b.mesh, 3, s->r->b.mesh->position, images));
  PetscCall(EqmLocationDestroy(&location));
  PetscCall(PetscFree(turned));
  PetscCall(Centre(s, num, images));
  PetscFunctionReturn(0);
}

/* The best rigid motion of A for each set of images: rotations, 9 each. */
static PetscErrorCode BestMotions(const EqmSample *s, PetscInt num, const PetscReal *images, PetscReal *motions)
{
  PetscReal *correlation;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(9 * num, &correlation));
  for (PetscInt n = 0; n < num; n++) {
    const PetscReal *const image = images + 3 * s->count * n;
    for (PetscInt i = 0; i < s->count; i++) {
      for (PetscInt k = 0; k < 9; k++)
        correlation[9 * n + k] += PetscSqr(s->root_weight[i]) * image[3 * i + k / 3] * s->point[3 * i + k % 3];
    }
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, correlation, (PetscMPIInt)(9 * num), MPIU_REAL, MPIU_SUM, s->r->comm));
  for (PetscInt n = 0; n < num; n++) PetscCall(EqmBestRotation(3, correlation + 9 * n, motions + 9 * n));
  PetscCall(PetscFree(correlation));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSampleResiduals(const EqmSample *s, PetscInt num, const PetscReal *rotations, PetscReal *residuals,
                                  PetscReal *squares)
{
  const PetscReal unit = EqmSideRadius(s->r, &s->r->b);
  PetscReal *motions;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(9 * num, &motions));
  PetscCall(Carry(s, num, rotations, residuals));
  PetscCall(BestMotions(s, num, residuals, motions));
  for (PetscInt n = 0; n < num; n++) {
    PetscReal *const residual = residuals + 3 * s->count * n;
    squares[n] = 0.;
    for (PetscInt i = 0; i < s->count; i++) {
      PetscReal v[3] = {s->point[3 * i], s->point[3 * i + 1], s->point[3 * i + 2]};
      EqmRotate(3, motions + 9 * n, 1, v);
      for (PetscInt k = 0; k < 3; k++) {
        residual[3 * i + k] = s->root_weight[i] * (v[k] - residual[3 * i + k]) / unit;
        squares[n] += PetscSqr(residual[3 * i + k]);
      }
    }
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, squares, (PetscMPIInt)num, MPIU_REAL, MPIU_SUM, s->r->comm));
  PetscCall(PetscFree(motions));
  PetscFunctionReturn(0);
}
