/* Which boundary vertices go to the corners of the square, as arc lengths along the boundary. */
#include "domain/corners.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

/* Arc lengths of the user's corners; they must be boundary vertices in the boundary's order. */
PetscErrorCode EqmCornersFromInput(EqmMesh mesh, const PetscInt corners[4], const PetscReal *arc,
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

PetscErrorCode EqmCornersCheckOrder(EqmMesh mesh, const PetscReal corner_arc[4])
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

/* Are three arc lengths on one side, corners included? */
static PetscBool ShareSide(const PetscReal corner_arc[4], const PetscReal arc[3])
{
  unsigned common = 15;

  for (PetscInt k = 0; k < 3; k++) {
    PetscReal fraction;
    const PetscInt side = EqmSquareSide(corner_arc, arc[k], &fraction);
    common &= (1u << side) | (fraction == 0. ? 1u << (side + 3) % 4 : 0u);
  }
  return (PetscBool)(common != 0);
}

/* Triangles that are flat whatever the map, since their three vertices slide along one side: how many, and the lowest
   number. */
static PetscErrorCode CountFlatCells(EqmMesh mesh, const PetscReal *arc, const PetscReal corner_arc[4],
                                     PetscInt64 *count, PetscInt *lowest)
{
  PetscInt64 local = 0;
  PetscInt first = PETSC_MAX_INT;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    const PetscReal of[3] = {arc[v[0]], arc[v[1]], arc[v[2]]};
    if (of[0] >= 0. && of[1] >= 0. && of[2] >= 0. && ShareSide(corner_arc, of)) {
      local++;
      first = PetscMin(first, mesh->cell_input[c]);
    }
  }
  PetscCallMPI(MPI_Allreduce(&local, count, 1, MPIU_INT64, MPI_SUM, mesh->comm));
  PetscCall(MPIU_Allreduce(&first, lowest, 1, MPIU_INT, MPI_MIN, mesh->comm));
  PetscFunctionReturn(0);
}

/* Angle of the surface at every local vertex: the sum over its triangles, whole for owned vertices. */
static PetscErrorCode SumAngles(EqmMesh mesh, PetscReal *angle)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(angle, mesh->num_local));
  for (PetscInt k = 0; k < 3 * mesh->num_local_cells; k++) {
    const PetscInt *const v = mesh->cells + 3 * (k / 3);
    const PetscReal *const p = mesh->position + 3 * v[k % 3], *const q = mesh->position + 3 * v[(k + 1) % 3],
                           *const r = mesh->position + 3 * v[(k + 2) % 3];
    const PetscReal a[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, b[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
    PetscReal normal[3];
    EqmCross(a, b, normal);
    angle[v[k % 3]] += PetscAtan2Real(PetscSqrtReal(EqmDot3(normal, normal)), EqmDot3(a, b));
  }
  PetscFunctionReturn(0);
}

/* The boundary's sharp vertices, in its order, if there are four of them. */
static PetscErrorCode FindSharp(EqmMesh mesh, const PetscReal *arc, PetscReal corner_arc[4], PetscBool *found)
{
  const PetscReal sharp = 2. / 3. * PETSC_PI; /* between a corner's angle and a straight boundary's */
  PetscReal *angle, last = -1.;
  PetscInt count = 0, total;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local, &angle));
  PetscCall(SumAngles(mesh, angle));
  for (PetscInt v = 0; v < mesh->num_owned; v++) count += arc[v] >= 0. && angle[v] < sharp;
  PetscCall(MPIU_Allreduce(&count, &total, 1, MPIU_INT, MPI_SUM, mesh->comm));
  *found = (PetscBool)(total == 4);
  for (PetscInt k = 0; k < 4 && *found; k++) {
    PetscReal next = PETSC_MAX_REAL;
    for (PetscInt v = 0; v < mesh->num_owned; v++) {
      if (arc[v] > last && angle[v] < sharp) next = PetscMin(next, arc[v]);
    }
    PetscCall(MPIU_Allreduce(&next, &last, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
    corner_arc[k] = last;
  }
  PetscCall(PetscFree(angle));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCornersChoose(EqmMesh mesh, const PetscReal *arc, PetscReal corner_arc[4])
{
  PetscInt64 flat = 0;
  PetscInt lowest;
  PetscBool found;

  PetscFunctionBegin;
  PetscCall(FindSharp(mesh, arc, corner_arc, &found));
  if (found) PetscCall(CountFlatCells(mesh, arc, corner_arc, &flat, &lowest));
  if (!found || flat > 0) PetscCall(CornersAtQuarters(mesh, arc, corner_arc));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCornersCheckCells(EqmMesh mesh, const PetscReal *arc, const PetscReal corner_arc[4])
{
  PetscInt64 flat;
  PetscInt lowest;

  PetscFunctionBegin;
  PetscCall(CountFlatCells(mesh, arc, corner_arc, &flat, &lowest));
  if (flat == 0) PetscFunctionReturn(0);
  EqmFail(mesh->comm, EQM_ERR_MESH,
          "%" PetscInt64_FMT " triangles (the first is %" PetscInt_FMT
          ") have their three vertices on one side of the square: every map makes them flat. Name corners among these "
          "vertices with -corners, turn the triangles' inner edges, or map to the disk; with -repair their parts are "
          "mapped, but they themselves remain flat",
          flat, lowest);
}
