/* The unit square: corners fixed at (0,0), (1,0), (1,1), (0,1), side vertices slide, the rest free (002 section 4.1).
 */
#include "domain/domain_private.h"

/* Kinds of vertices. */
enum { FREE, SIDE_X, SIDE_Y, CORNER };

static const PetscReal corner_place[4][2] = {{0., 0.}, {1., 0.}, {1., 1.}, {0., 1.}};

/* Which side a boundary vertex lies on and how far along it, from arc lengths. At a corner the fraction is 0. */
static PetscInt SideOf(const PetscReal corner_arc[4], PetscReal arc, PetscReal *fraction)
{
  for (PetscInt side = 0; side < 4; side++) {
    const PetscReal begin = corner_arc[side];
    PetscReal length = corner_arc[(side + 1) % 4] - begin, along = arc - begin;
    if (length <= 0.) length += 1.;
    if (along < 0.) along += 1.;
    if (along < length) {
      *fraction = along / length;
      return side;
    }
  }
  *fraction = 0.;
  return 0;
}

static PetscErrorCode PlaceOnSides(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) {
    PetscReal t;
    if (domain->arc_length[v] < 0.) continue;
    const PetscInt side = SideOf(domain->corner_arc, domain->arc_length[v], &t);
    for (PetscInt c = 0; c < 2; c++) {
      place->x[2 * v + c] = (1. - t) * corner_place[side][c] + t * corner_place[(side + 1) % 4][c];
    }
  }
  PetscFunctionReturn(0);
}

/* Arc lengths of the user's corners; they must be boundary vertices in the boundary's order. */
static PetscErrorCode CornersFromInput(EqmMesh mesh, const PetscInt corners[4], const PetscReal *arc,
                                       PetscReal corner_arc[4])
{
  PetscReal found[4] = {-1., -1., -1., -1.};

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt k = 0; k < 4; k++) {
      if (mesh->vertex_input[v] == corners[k]) found[k] = arc[v];
    }
  }
  PetscCall(MPIU_Allreduce(found, corner_arc, 4, MPIU_REAL, MPIU_MAX, mesh->comm));
  for (PetscInt k = 0; k < 4; k++) {
    if (corner_arc[k] < 0.) {
      EqmFail(mesh->comm, EQM_ERR_USAGE,
              "-corners: vertex %" PetscInt_FMT " is not on the boundary; name four boundary vertices (counted from 0)",
              corners[k]);
    }
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckCornerOrder(EqmMesh mesh, const PetscReal corner_arc[4])
{
  PetscInt turns = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 4; k++) turns += corner_arc[(k + 1) % 4] <= corner_arc[k];
  if (turns != 1) {
    EqmFail(mesh->comm, EQM_ERR_USAGE,
            "-corners: the four vertices must be different and in the order in which the boundary runs round the "
            "surface (it lies "
            "on the left); try them in reverse");
  }
  PetscFunctionReturn(0);
}

/* The boundary vertices nearest to the quarters of the boundary's length. */
static PetscErrorCode CornersAtQuarters(EqmMesh mesh, const PetscReal *arc, PetscReal corner_arc[4])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < 4; k++) {
    PetscReal best[2] = {PETSC_MAX_REAL, PETSC_MAX_REAL}, nearest;
    for (PetscInt v = 0; v < mesh->num_owned; v++) {
      const PetscReal distance = PetscAbsReal(arc[v] - .25 * k);
      if (arc[v] >= 0. && (distance < best[0] || (distance == best[0] && arc[v] < best[1]))) {
        best[0] = distance;
        best[1] = arc[v];
      }
    }
    PetscCall(MPIU_Allreduce(&best[0], &nearest, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
    if (best[0] > nearest) best[1] = PETSC_MAX_REAL;
    PetscCall(MPIU_Allreduce(&best[1], &corner_arc[k], 1, MPIU_REAL, MPIU_MIN, mesh->comm));
    if (k > 0 && corner_arc[k] <= corner_arc[k - 1]) {
      EqmFail(mesh->comm, EQM_ERR_MESH,
              "the boundary has too few vertices for four corners at quarters of its length; name them with -corners "
              "i,j,k,l");
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
    PetscCall(CornersFromInput(mesh, corners, domain->arc_length, domain->corner_arc));
  else
    PetscCall(CornersAtQuarters(mesh, domain->arc_length, domain->corner_arc));
  PetscCall(CheckCornerOrder(mesh, domain->corner_arc));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    PetscReal t;
    if (domain->arc_length[v] < 0.) {
      domain->kind[v] = FREE;
      continue;
    }
    const PetscInt side = SideOf(domain->corner_arc, domain->arc_length[v], &t);
    domain->kind[v] = t == 0. ? CORNER : side % 2 == 0 ? SIDE_X : SIDE_Y;
  }
  PetscCall(EqmDomainNumber(domain));
  *out = domain;
  PetscFunctionReturn(0);
}
