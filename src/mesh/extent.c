/* How far the vertices extend: products of lengths must neither overflow nor vanish. */
#include "mesh/build.h"
#include "mesh/soup_private.h"
#include <math.h>

/* Exponents of ten between which squares of areas (volumes) and their quotients are numbers, and between which areas
   (volumes) are. */
enum { MOST_OF_SURFACE = 60, MOST_OF_SOLID = 40, MOST_OF_AREA = 150, MOST_OF_VOLUME = 101 };

/* The longest side of the box around all vertices that are finite. Collective. */
static PetscErrorCode ExtentOf(EqmSoup soup, PetscReal *extent)
{
  PetscReal box[6];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 6; k++) box[k] = PETSC_MAX_REAL;
  for (PetscInt i = 0; i < 3 * (soup->vertex_end - soup->vertex_start); i++) {
    if (PetscIsInfOrNanReal(soup->vertices[i])) continue;
    box[i % 3] = PetscMin(box[i % 3], soup->vertices[i]);
    box[3 + i % 3] = PetscMin(box[3 + i % 3], -soup->vertices[i]);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, box, 6, MPIU_REAL, MPIU_MIN, soup->comm));
  *extent = 0.;
  for (PetscInt k = 0; k < 3; k++) *extent = PetscMax(*extent, -box[3 + k] - box[k]);
  PetscFunctionReturn(0);
}

/* Refuse an extent beyond 10^+-most. */
static PetscErrorCode CheckExtent(EqmSoup soup, PetscReal extent, PetscInt most)
{
  PetscReal exponent;

  PetscFunctionBegin;
  if (!(extent > 0.)) PetscFunctionReturn(0);
  exponent = PetscIsInfReal(extent) ? 308. : PetscLog10Real(extent);
  if (PetscAbsReal(exponent) <= (PetscReal)most) PetscFunctionReturn(0);
  EqmFail(
      soup->comm, EQM_ERR_MESH,
      "%s: the vertices extend over about 1e%d; %s of that size %s. Scale the mesh: equimap convert %s OUT -scale 1e%d",
      soup->file, (int)exponent, soup->cell_size == 3 ? "areas" : "volumes",
      exponent > 0. ? "overflow" : "vanish in rounding", soup->file, -(int)exponent);
}

PetscErrorCode EqmSoupCheckExtent(EqmSoup soup)
{
  PetscReal extent;

  PetscFunctionBegin;
  PetscCall(ExtentOf(soup, &extent));
  PetscCall(CheckExtent(soup, extent, soup->cell_size == 3 ? MOST_OF_SURFACE : MOST_OF_SOLID));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupBringIntoRange(EqmSoup soup, PetscInt *exponent)
{
  const PetscBool is_surface = (PetscBool)(soup->cell_size == 3);
  PetscReal extent;
  int binary;

  PetscFunctionBegin;
  *exponent = 0;
  PetscCall(ExtentOf(soup, &extent));
  PetscCall(CheckExtent(soup, extent, is_surface ? MOST_OF_AREA : MOST_OF_VOLUME));
  if (!(extent > 0.) || PetscAbsReal(PetscLog10Real(extent)) <= (is_surface ? MOST_OF_SURFACE : MOST_OF_SOLID))
    PetscFunctionReturn(0);
  (void)frexp(extent, &binary);
  *exponent = binary;
  PetscCall(EqmSoupShift(soup, -*exponent));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupShift(EqmSoup soup, PetscInt exponent)
{
  PetscFunctionBegin;
  if (exponent == 0) PetscFunctionReturn(0);
  for (PetscInt i = 0; i < 3 * (soup->vertex_end - soup->vertex_start); i++)
    soup->vertices[i] = ldexp(soup->vertices[i], (int)exponent);
  for (PetscInt i = 0; soup->edge_length && i < 3 * (soup->cell_end - soup->cell_start); i++)
    soup->edge_length[i] = ldexp(soup->edge_length[i], (int)exponent);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupScale(EqmSoup soup, PetscReal factor)
{
  PetscFunctionBegin;
  if (!(factor > 0.) || PetscIsInfReal(factor))
    EqmFail(soup->comm, EQM_ERR_USAGE, "a mesh cannot be scaled by %.6g: the factor must be positive", (double)factor);
  for (PetscInt i = 0; i < 3 * (soup->vertex_end - soup->vertex_start); i++) soup->vertices[i] *= factor;
  for (PetscInt i = 0; soup->edge_length && i < 3 * (soup->cell_end - soup->cell_start); i++)
    soup->edge_length[i] *= factor;
  PetscCall(EqmSoupComputeChecksum(soup));
  PetscFunctionReturn(0);
}
