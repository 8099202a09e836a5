/* The unit cube [0, 1]^3: boundary vertices slide in the face or along the edge that they are on, corners are fixed,
   the rest is free in space. Which is which, the given places say: coordinates of boundary vertices that are exactly 0
   or 1 stay so. */
#include "domain/domain_private.h"

/* Kinds of vertices: by axis, faces normal to it and edges along it. */
enum { FREE, FACE, EDGE = FACE + 3, CORNER = EDGE + 3 };

PetscInt EqmCubeSides(const PetscReal place[3])
{
  PetscInt sides = 0;

  for (PetscInt k = 0; k < 3; k++) sides |= place[k] == 0. ? 1 << (2 * k) : place[k] == 1. ? 1 << (2 * k + 1) : 0;
  return sides;
}

static PetscErrorCode PlaceOnCube(EqmDomain domain, EqmPlace *place)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * mesh->num_local; k++) {
    if (mesh->on_boundary[k / 3]) place->x[k] = domain->boundary_place[k];
  }
  PetscFunctionReturn(0);
}

/* The kind of a boundary vertex; -1: it is inside. */
static PetscInt KindOf(const PetscReal place[3])
{
  const PetscInt sides = EqmCubeSides(place);
  PetscInt fixed = 0, last_fixed = 0, last_free = 0;

  for (PetscInt k = 0; k < 3; k++) {
    const PetscBool on = (PetscBool)((sides >> (2 * k) & 3) != 0);
    fixed += on;
    if (on)
      last_fixed = k;
    else
      last_free = k;
  }
  return fixed == 0 ? -1 : fixed == 1 ? FACE + last_fixed : fixed == 2 ? EDGE + last_free : CORNER;
}

/* Tetrahedra with all vertices in one face are flat in every map. */
static PetscErrorCode CheckCells(EqmMesh mesh, const PetscReal *places)
{
  PetscInt64 local = 0, flat;
  PetscInt first = PETSC_MAX_INT, lowest;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscInt *const v = mesh->cells + 4 * c;
    PetscInt common = ~0;
    for (PetscInt a = 0; a < 4; a++) common &= mesh->on_boundary[v[a]] ? EqmCubeSides(places + 3 * v[a]) : 0;
    if (!common) continue;
    local++;
    first = PetscMin(first, mesh->cell_input[c]);
  }
  PetscCall(MPIU_Allreduce(&local, &flat, 1, MPIU_INT64, MPI_SUM, mesh->comm));
  PetscCall(MPIU_Allreduce(&first, &lowest, 1, MPIU_INT, MPI_MIN, mesh->comm));
  if (flat == 0) PetscFunctionReturn(0);
  EqmFail(mesh->comm, EQM_ERR_MESH,
          "%" PetscInt64_FMT " tetrahedra (the first is %" PetscInt_FMT
          ") have their four vertices in one face of the cube: every map makes them flat. -repair splits what hangs "
          "between boundary vertices; or map to the ball",
          flat, lowest);
}

PetscErrorCode EqmDomainCreateCube(EqmMesh mesh, const PetscReal *places, EqmDomain *out)
{
  EqmDomain domain;
  PetscInt inside = 0, total;

  PetscFunctionBegin;
  if (mesh->cell_size != 4)
    EqmFail(mesh->comm, EQM_ERR_MESH,
            "a map to the cube needs a solid, a mesh of tetrahedra; this is a surface: map it to the square");
  PetscCall(PetscNew(&domain));
  domain->mesh = mesh;
  domain->name = "cube";
  domain->dim = 3;
  domain->measure = EQM_MEASURE_VOLUME;
  domain->motion[FREE] = &EqmMotionFree;
  for (PetscInt k = 0; k < 3; k++) {
    domain->motion[FACE + k] = &EqmMotionFace[k];
    domain->motion[EDGE + k] = &EqmMotionEdge[k];
    domain->center[k] = .5;
  }
  domain->motion[CORNER] = &EqmMotionCubeCorner;
  domain->target_measure = 1.;
  domain->place_boundary = PlaceOnCube;
  PetscCall(PetscMalloc1(3 * mesh->num_local, &domain->boundary_place));
  PetscCall(PetscArraycpy(domain->boundary_place, places, 3 * mesh->num_local));
  PetscCall(PetscMalloc1(mesh->num_local, &domain->kind));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscInt kind = mesh->on_boundary[v] ? KindOf(places + 3 * v) : FREE;
    inside += kind < 0;
    domain->kind[v] = (unsigned char)PetscMax(kind, 0);
  }
  PetscCall(MPIU_Allreduce(&inside, &total, 1, MPIU_INT, MPI_SUM, mesh->comm));
  PetscCheck(total == 0, mesh->comm, PETSC_ERR_ARG_WRONG, "boundary vertices are not on the cube's boundary");
  PetscCall(CheckCells(mesh, places));
  PetscCall(EqmDomainNumber(domain));
  *out = domain;
  PetscFunctionReturn(0);
}
