/* Noise for studies of stability (001 section 6.5): every vertex moves along its normal by a random length. */
#include "mesh/diagnose.h"
#include "mesh/soup_private.h"
#include "mesh/build.h"
#include "base/random.h"
#include "geometry/simplex.h"

/* The cell's normal, as long as twice its area. */
static void CellNormal(const EqmVicinity *vicinity, PetscInt cell, PetscReal normal[3])
{
  const PetscInt *const v = vicinity->cells + 3 * cell;
  const PetscReal *const p = vicinity->position + 3 * v[0], *const q = vicinity->position + 3 * v[1],
                         *const r = vicinity->position + 3 * v[2];
  const PetscReal a[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, b[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};

  EqmCross(a, b, normal);
}

/* A number of the standard normal distribution that belongs to the vertex, by Box and Muller. */
static PetscReal Gaussian(PetscInt seed, PetscInt vertex)
{
  const PetscReal u = 1. - EqmHashUniform(seed, vertex, 0), turn = EqmHashUniform(seed, vertex, 1);

  return PetscSqrtReal(-2. * PetscLogReal(u)) * PetscCosReal(2. * PETSC_PI * turn);
}

PetscErrorCode EqmSoupAddNoise(EqmSoup soup, PetscReal sigma, PetscInt seed)
{
  EqmVicinity vicinity;

  PetscFunctionBegin;
  if (!(sigma >= 0.) || PetscIsInfReal(sigma))
    EqmFail(soup->comm, EQM_ERR_USAGE, "-noise %.6g: give a length, 0 or more", (double)sigma);
  if (sigma == 0.) PetscFunctionReturn(0);
  if (soup->cell_size != 3)
    EqmFail(soup->comm, EQM_ERR_USAGE, "-noise is for surfaces of triangles; %s is none", soup->file);
  PetscCall(EqmVicinityCreate(soup, &vicinity));
  for (PetscInt v = 0; v < vicinity.num_owned; v++) {
    PetscReal normal[3] = {0., 0., 0.}, length;
    for (PetscInt s = vicinity.star_start[v]; s < vicinity.star_start[v + 1]; s++) { /* in input order */
      PetscReal part[3];
      CellNormal(&vicinity, vicinity.star[s], part);
      for (int k = 0; k < 3; k++) normal[k] += part[k];
    }
    length = PetscSqrtReal(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    if (!(length > 0.)) continue;
    const PetscReal shift = sigma * Gaussian(seed, vicinity.input[v]) / length;
    for (int k = 0; k < 3; k++) soup->vertices[3 * v + k] += shift * normal[k];
  }
  PetscCall(EqmVicinityReset(&vicinity));
  PetscCall(EqmSoupComputeChecksum(soup));
  PetscFunctionReturn(0);
}
