/* The rotation that is best in the sense of least squares. */
#include "geometry/rotation.h"

enum { N = 4, MOST_SWEEPS = 50 };

/* Turn rows and columns p, q of the symmetric matrix so that its entry (p, q) vanishes; the vectors are turned along.
 */
static void Annihilate(PetscReal a[N][N], PetscReal vectors[N][N], PetscInt p, PetscInt q)
{
  const PetscReal theta = .5 * (a[q][q] - a[p][p]) / a[p][q];
  const PetscReal t = (theta >= 0. ? 1. : -1.) / (PetscAbsReal(theta) + PetscSqrtReal(theta * theta + 1.));
  const PetscReal c = 1. / PetscSqrtReal(t * t + 1.), s = t * c;

  for (PetscInt k = 0; k < N; k++) {
    const PetscReal x = a[k][p], y = a[k][q], u = vectors[k][p], v = vectors[k][q];
    a[k][p] = c * x - s * y;
    a[k][q] = s * x + c * y;
    vectors[k][p] = c * u - s * v;
    vectors[k][q] = s * u + c * v;
  }
  for (PetscInt k = 0; k < N; k++) {
    const PetscReal x = a[p][k], y = a[q][k];
    a[p][k] = c * x - s * y;
    a[q][k] = s * x + c * y;
  }
}

/* The eigenvector of the largest eigenvalue of a symmetric matrix, by Jacobi's method. */
static void LargestEigenvector(PetscReal a[N][N], PetscReal vector[N])
{
  PetscReal vectors[N][N] = {{1., 0., 0., 0.}, {0., 1., 0., 0.}, {0., 0., 1., 0.}, {0., 0., 0., 1.}};
  PetscInt largest = 0;

  for (PetscInt sweep = 0; sweep < MOST_SWEEPS; sweep++) {
    PetscReal off = 0., on = 0.;
    for (PetscInt p = 0; p < N; p++) {
      on += PetscSqr(a[p][p]);
      for (PetscInt q = p + 1; q < N; q++) off += PetscSqr(a[p][q]);
    }
    if (off <= PetscSqr(PETSC_MACHINE_EPSILON) * on) break;
    for (PetscInt p = 0; p < N; p++) {
      for (PetscInt q = p + 1; q < N; q++) {
        if (a[p][q] != 0.) Annihilate(a, vectors, p, q);
      }
    }
  }
  for (PetscInt k = 1; k < N; k++) {
    if (a[k][k] > a[largest][largest]) largest = k;
  }
  for (PetscInt k = 0; k < N; k++) vector[k] = vectors[k][largest];
}

void EqmRotationOfQuaternion(const PetscReal q[4], PetscReal rotation[9])
{
  const PetscReal w = q[0], x = q[1], y = q[2], z = q[3];

  rotation[0] = 1. - 2. * (y * y + z * z);
  rotation[1] = 2. * (x * y - w * z);
  rotation[2] = 2. * (x * z + w * y);
  rotation[3] = 2. * (x * y + w * z);
  rotation[4] = 1. - 2. * (x * x + z * z);
  rotation[5] = 2. * (y * z - w * x);
  rotation[6] = 2. * (x * z - w * y);
  rotation[7] = 2. * (y * z + w * x);
  rotation[8] = 1. - 2. * (x * x + y * y);
}

/* With the unit quaternion q for R, sum w q . R p = q^T K q, K made of the correlation (Horn; Davenport): its largest
   eigenvector is the answer, a rotation in every case. */
static void BestInSpace(const PetscReal *c, PetscReal *rotation)
{
  PetscReal k[N][N] = {
      {c[0] + c[4] + c[8], c[7] - c[5], c[2] - c[6], c[3] - c[1]},
      {c[7] - c[5], c[0] - c[4] - c[8], c[1] + c[3], c[2] + c[6]},
      {c[2] - c[6], c[1] + c[3], c[4] - c[0] - c[8], c[5] + c[7]},
      {c[3] - c[1], c[2] + c[6], c[5] + c[7], c[8] - c[0] - c[4]},
  };
  PetscReal q[N], length = 0.;

  LargestEigenvector(k, q);
  for (PetscInt i = 0; i < N; i++) length += q[i] * q[i];
  for (PetscInt i = 0; i < N; i++) q[i] /= PetscSqrtReal(length);
  EqmRotationOfQuaternion(q, rotation);
}

PetscErrorCode EqmBestRotation(PetscInt dim, const PetscReal *correlation, PetscReal *rotation)
{
  PetscFunctionBegin;
  if (dim == 2) {
    const PetscReal angle = PetscAtan2Real(correlation[2] - correlation[1], correlation[0] + correlation[3]);
    rotation[0] = rotation[3] = PetscCosReal(angle);
    rotation[2] = PetscSinReal(angle);
    rotation[1] = -rotation[2];
  } else {
    BestInSpace(correlation, rotation);
  }
  PetscFunctionReturn(0);
}

void EqmRotate(PetscInt dim, const PetscReal *rotation, PetscInt count, PetscReal *x)
{
  for (PetscInt p = 0; p < count; p++) {
    PetscReal turned[3] = {0., 0., 0.};
    for (PetscInt i = 0; i < dim; i++) {
      for (PetscInt j = 0; j < dim; j++) turned[i] += rotation[dim * i + j] * x[dim * p + j];
    }
    for (PetscInt i = 0; i < dim; i++) x[dim * p + i] = turned[i];
  }
}
