/* The unit square: corners fixed at (0,0), (1,0), (1,1), (0,1), side vertices slide, the rest free (002 section 4.1).
 */
#include "domain/corners.h"
#include "domain/domain_private.h"

/* Kinds of vertices. */
enum { FREE, SIDE_X, SIDE_Y, CORNER };

static const PetscReal corner_place[4][2] = {{0., 0.}, {1., 0.}, {1., 1.}, {0., 1.}};

static PetscErrorCode PlaceOnSides(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) {
    PetscReal t;
    if (domain->arc_length[v] < 0.) continue;
    const PetscInt side = EqmSquareSide(domain->corner_arc, domain->arc_length[v], &t);
    for (PetscInt c = 0; c < 2; c++) {
      place->x[2 * v + c] = (1. - t) * corner_place[side][c] + t * corner_place[(side + 1) % 4][c];
    }
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCreateSquare(EqmMesh mesh, const PetscInt corners[4], EqmDomain *out)
{
  EqmDomain domain;

  PetscFunctionBegin;
  if (mesh->num_boundary_vertices < 4) {
    EqmFail(mesh->comm, EQM_ERR_MESH,
            "a map to the square needs at least four boundary vertices, this mesh has %" PetscInt_FMT,
            mesh->num_boundary_vertices);
  }
  PetscCall(EqmDomainCreatePlanar(mesh, "square", &domain));
  domain->motion[FREE] = &EqmMotionFree;
  domain->motion[SIDE_X] = &EqmMotionSideX;
  domain->motion[SIDE_Y] = &EqmMotionSideY;
  domain->motion[CORNER] = &EqmMotionCorner;
  domain->target_measure = 1.;
  domain->boundary_length = 4.;
  domain->place_boundary = PlaceOnSides;
  if (corners)
    PetscCall(EqmCornersFromInput(mesh, corners, domain->arc_length, domain->corner_arc));
  else
    PetscCall(EqmCornersChoose(mesh, domain->arc_length, domain->corner_arc));
  PetscCall(EqmCornersCheckOrder(mesh, domain->corner_arc));
  PetscCall(EqmCornersCheckCells(mesh, domain->arc_length, domain->corner_arc));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    PetscReal t;
    if (domain->arc_length[v] < 0.) {
      domain->kind[v] = FREE;
      continue;
    }
    const PetscInt side = EqmSquareSide(domain->corner_arc, domain->arc_length[v], &t);
    domain->kind[v] = t == 0. ? CORNER : side % 2 == 0 ? SIDE_X : SIDE_Y;
  }
  PetscCall(EqmDomainNumber(domain));
  *out = domain;
  PetscFunctionReturn(0);
}
