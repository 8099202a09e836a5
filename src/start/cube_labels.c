/* Which face of the cube each vertex is in: eight vertices become corners, and their arcs on the sphere divide the
 * others.
 */
#include "start/cube_faces.h"
#include "geometry/simplex.h"

static inline PetscReal SignOf(PetscInt corner, PetscInt axis)
{
  return corner >> axis & 1 ? 1. : -1.;
}

void EqmCubeFaceCorners(PetscInt face, PetscInt corners[4])
{
  const PetscInt a = face / 2, b = (a + 1) % 3, c = (a + 2) % 3, side = (face % 2) << a;

  corners[0] = side;
  corners[1] = side | 1 << (face % 2 ? b : c);
  corners[2] = side | 1 << b | 1 << c;
  corners[3] = side | 1 << (face % 2 ? c : b);
}

PetscErrorCode EqmCubeTooCoarse(EqmMesh mesh, const char *why)
{
  PetscFunctionBegin;
  EqmFail(mesh->comm, EQM_ERR_MESH,
          "the solid's surface, %" PetscInt_FMT
          " vertices, is too coarse for the twelve edges of the cube: %s; split its tetrahedra (equimap convert IN OUT "
          "-refine 1), or map to the ball",
          mesh->num_vertices, why);
}

/* The vertex that is nearest to a direction, ties by number, becomes a corner. */
static PetscErrorCode ChooseCorner(EqmCubeFaces *cube, PetscInt corner, const PetscReal direction[3])
{
  const EqmMesh mesh = cube->mesh;
  PetscReal best = -2., most, place[3] = {0.};
  PetscInt found = -1, number, lowest;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscReal near = EqmDot3(direction, cube->x + 3 * v);
    if (!(near > best)) continue;
    best = near;
    found = v;
  }
  PetscCall(MPIU_Allreduce(&best, &most, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  number = found >= 0 && best == most ? mesh->global[found] : PETSC_MAX_INT;
  PetscCall(MPIU_Allreduce(&number, &lowest, 1, MPIU_INT, MPI_MIN, mesh->comm));
  cube->corner_vertex[corner] = lowest;
  if (number == lowest) {
    if (cube->label[found] >= 0.) best = 3.; /* it is a corner already */
    cube->label[found] = EQM_CUBE_FACES + corner;
    for (PetscInt k = 0; k < 3; k++) place[k] = cube->x[3 * found + k];
  }
  PetscCall(MPIU_Allreduce(place, cube->corner + 3 * corner, 3, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscCall(MPIU_Allreduce(&best, &most, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  if (most > 2.) PetscCall(EqmCubeTooCoarse(mesh, "one vertex is nearest to two corners"));
  PetscFunctionReturn(0);
}

static PetscErrorCode ChooseCorners(EqmCubeFaces *cube, const PetscReal turn[9])
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < cube->mesh->num_local; v++) cube->label[v] = -1.;
  for (PetscInt corner = 0; corner < EQM_CUBE_CORNERS; corner++) {
    PetscReal direction[3] = {0.};
    for (PetscInt k = 0; k < 9; k++) direction[k % 3] += turn[k] * SignOf(corner, k / 3) / PetscSqrtReal(3.);
    PetscCall(ChooseCorner(cube, corner, direction));
  }
  PetscFunctionReturn(0);
}

/* How far inside a face's spherical quadrangle a point is: the smallest sine of its heights over the four arcs. */
static PetscReal Depth(const EqmCubeFaces *cube, PetscInt face, const PetscReal *x)
{
  PetscReal depth = PETSC_MAX_REAL;
  PetscInt corners[4];

  EqmCubeFaceCorners(face, corners);
  for (PetscInt k = 0; k < 4; k++) {
    PetscReal normal[3];
    EqmCross(cube->corner + 3 * corners[k], cube->corner + 3 * corners[(k + 1) % 4], normal);
    depth = PetscMin(depth, EqmDot3(normal, x) / PetscSqrtReal(EqmDot3(normal, normal)));
  }
  return depth;
}

static PetscErrorCode LabelFaces(EqmCubeFaces *cube)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < cube->mesh->num_owned; v++) {
    PetscReal best = -PETSC_MAX_REAL;
    if (cube->label[v] >= 0.) continue;
    for (PetscInt face = 0; face < EQM_CUBE_FACES; face++) {
      const PetscReal depth = Depth(cube, face, cube->x + 3 * v);
      if (!(depth > best)) continue;
      best = depth;
      cube->label[v] = face;
    }
  }
  PetscCall(EqmMeshUpdateGhosts(cube->mesh, 1, cube->label));
  PetscFunctionReturn(0);
}

/* The corner that three faces share. */
static PetscInt CommonCorner(const PetscInt face[3])
{
  PetscInt corner = 0;

  for (PetscInt k = 0; k < 3; k++) corner |= (face[k] % 2) << (face[k] / 2);
  return corner;
}

/* A triangle with a vertex in each of three faces that does not hold their corner: the side that is turned to the
   corner crosses the face of the vertex opposite, which has no vertex between. One end of that side, the one that is
   less deep in its own face, goes to the face that is crossed. */
static PetscBool FindMove(const EqmCubeFaces *cube, const PetscInt v[3], PetscInt *vertex, PetscInt *face)
{
  const PetscInt label[3] = {(PetscInt)cube->label[v[0]], (PetscInt)cube->label[v[1]], (PetscInt)cube->label[v[2]]};
  const PetscReal *const c = cube->corner + 3 * CommonCorner(label);

  if (PetscMax(label[0], PetscMax(label[1], label[2])) >= EQM_CUBE_FACES || label[0] / 2 == label[1] / 2 ||
      label[1] / 2 == label[2] / 2 || label[2] / 2 == label[0] / 2)
    return PETSC_FALSE;
  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal *p[2], *const r = cube->x + 3 * v[a];
    PetscReal loss[2];
    for (PetscInt k = 0; k < 2; k++) {
      const PetscInt b = (a + 1 + k) % 3;
      p[k] = cube->x + 3 * v[b];
      loss[k] = Depth(cube, label[b], p[k]) - Depth(cube, label[a], p[k]);
    }
    if (EqmHalfDet(p[0], p[1], r) * EqmHalfDet(p[0], p[1], c) > 0.) continue;
    *vertex = v[(a + 1 + (loss[1] < loss[0])) % 3];
    *face = label[a];
    return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Each face has a vertex between its two edges at each of its corners: one vertex at a time, that of the lowest number.
 */
static PetscErrorCode FillCorners(EqmCubeFaces *cube)
{
  const EqmMesh mesh = cube->mesh;
  PetscInt lowest[2] = {0, 0}; /* vertex, and the face that it goes to */

  PetscFunctionBegin;
  for (PetscInt step = 0; step < mesh->num_vertices && lowest[0] < PETSC_MAX_INT; step++) {
    PetscInt mine[2] = {PETSC_MAX_INT, PETSC_MAX_INT};
    for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
      PetscInt v, face;
      if (!FindMove(cube, mesh->cells + 3 * c, &v, &face) || mesh->global[v] > mine[0]) continue;
      mine[1] = mesh->global[v] < mine[0] ? face : PetscMin(mine[1], face);
      mine[0] = mesh->global[v];
    }
    PetscCall(MPIU_Allreduce(&mine[0], &lowest[0], 1, MPIU_INT, MPI_MIN, mesh->comm));
    if (mine[0] != lowest[0]) mine[1] = PETSC_MAX_INT;
    PetscCall(MPIU_Allreduce(&mine[1], &lowest[1], 1, MPIU_INT, MPI_MIN, mesh->comm));
    for (PetscInt v = 0; v < mesh->num_local; v++) {
      if (mesh->global[v] == lowest[0]) cube->label[v] = lowest[1];
    }
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCubeLabel(EqmCubeFaces *cube, const PetscReal turn[9])
{
  PetscFunctionBegin;
  PetscCall(ChooseCorners(cube, turn));
  PetscCall(LabelFaces(cube));
  PetscCall(FillCorners(cube));
  PetscFunctionReturn(0);
}
