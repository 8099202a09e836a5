/* The edges of the cube, as ways from vertex to vertex between its faces. */
#include "start/cube_faces.h"
#include "geometry/simplex.h"

/* The face that has corners p and q one after the other. */
static PetscInt FaceAlong(PetscInt p, PetscInt q)
{
  PetscInt found = -1, corners[4];

  for (PetscInt face = 0; face < EQM_CUBE_FACES; face++) {
    EqmCubeFaceCorners(face, corners);
    for (PetscInt k = 0; k < 4; k++) {
      if (corners[k] == p && corners[(k + 1) % 4] == q) found = face;
    }
  }
  return found;
}

static void MakeEdges(EqmCubeEdge edge[EQM_CUBE_EDGES])
{
  PetscInt count = 0;

  for (PetscInt corner = 0; corner < EQM_CUBE_CORNERS; corner++) {
    if (((corner & 1) + (corner >> 1 & 1) + (corner >> 2)) % 2) continue;
    for (PetscInt axis = 0; axis < 3; axis++) {
      const PetscInt to = corner ^ 1 << axis;
      edge[count++] = (EqmCubeEdge){
          .from = corner, .to = to, .axis = axis, .left = FaceAlong(corner, to), .right = FaceAlong(to, corner)};
    }
  }
}

/* Vertices of an edge's left face with a neighbour in the right one. */
static PetscErrorCode FindEdges(EqmCubeFaces *cube)
{
  const EqmMesh mesh = cube->mesh;
  PetscInt crossed = 0, any;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_local; v++) cube->on_edge[v] = -1.;
  for (PetscInt k = 0; k < 6 * mesh->num_local_cells; k++) {
    const PetscInt *const v = mesh->cells + 3 * (k / 6);
    const PetscInt i = v[k % 3], j = v[(k % 3 + 1 + k / 3 % 2) % 3];
    for (PetscInt e = 0; e < EQM_CUBE_EDGES; e++) {
      if (cube->label[i] != cube->edge[e].left || cube->label[j] != cube->edge[e].right) continue;
      crossed |= cube->on_edge[i] >= 0. && cube->on_edge[i] != e && i < mesh->num_owned;
      cube->on_edge[i] = e;
    }
  }
  PetscCall(MPIU_Allreduce(&crossed, &any, 1, MPIU_INT, MPI_MAX, mesh->comm));
  if (any) PetscCall(EqmCubeTooCoarse(mesh, "a face is one vertex wide"));
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, cube->on_edge));
  PetscFunctionReturn(0);
}

static PetscInt FacesOfCorner(PetscInt corner)
{
  PetscInt faces = 0;

  for (PetscInt axis = 0; axis < 3; axis++) faces |= 1 << (2 * axis + (corner >> axis & 1));
  return faces;
}

PetscInt EqmCubeFacesOf(const EqmCubeFaces *cube, PetscInt v)
{
  const PetscInt label = (PetscInt)cube->label[v], e = (PetscInt)cube->on_edge[v];

  if (label >= EQM_CUBE_FACES) return FacesOfCorner(label - EQM_CUBE_FACES);
  return e >= 0 ? 1 << cube->edge[e].left | 1 << cube->edge[e].right : 1 << label;
}

/* Where a vertex is along an edge, seen from the sphere's centre. */
static PetscReal Along(const EqmCubeFaces *cube, PetscInt e, PetscInt v)
{
  const PetscReal *const p = cube->corner + 3 * cube->edge[e].from, *const q = cube->corner + 3 * cube->edge[e].to;

  return EqmDot3(q, cube->x + 3 * v) - EqmDot3(p, cube->x + 3 * v);
}

/* Of a triangle with three vertices on one edge the middle one, in local numbers; -1: the triangle is none, or its
   middle vertex is a corner. */
static PetscInt MiddleOfFlat(const EqmCubeFaces *cube, const PetscInt v[3])
{
  const PetscInt common = EqmCubeFacesOf(cube, v[0]) & EqmCubeFacesOf(cube, v[1]) & EqmCubeFacesOf(cube, v[2]);
  PetscInt e = -1, middle = 0;
  PetscReal t[3];

  for (PetscInt a = 0; a < 3; a++) e = PetscMax(e, (PetscInt)cube->on_edge[v[a]]);
  if (e < 0 || common != (1 << cube->edge[e].left | 1 << cube->edge[e].right)) return -1;
  for (PetscInt a = 0; a < 3; a++) t[a] = Along(cube, e, v[a]);
  for (PetscInt a = 0; a < 3; a++) {
    if ((t[a] - t[(a + 1) % 3]) * (t[a] - t[(a + 2) % 3]) < 0.) middle = a;
  }
  return cube->on_edge[v[middle]] == e ? v[middle] : -1;
}

/* Per local vertex: has it a triangle in the left face of its edge? One without is the tip of a spike. */
static void FindSpikes(const EqmCubeFaces *cube, PetscBool *has_left)
{
  const EqmMesh mesh = cube->mesh;

  for (PetscInt v = 0; v < mesh->num_local; v++) has_left[v] = PETSC_FALSE;
  for (PetscInt k = 0; k < 3 * mesh->num_local_cells; k++) {
    const PetscInt *const v = mesh->cells + 3 * (k / 3), e = (PetscInt)cube->on_edge[v[k % 3]];
    if (e >= 0 && (EqmCubeFacesOf(cube, v[0]) & EqmCubeFacesOf(cube, v[1]) & EqmCubeFacesOf(cube, v[2])) ==
                      1 << cube->edge[e].left)
      has_left[v[k % 3]] = PETSC_TRUE;
  }
}

/* Per edge the vertex of the lowest number that should go to the right face: where the edge goes round two sides of a
   triangle it takes the third, as three vertices on one edge are flat; and spikes are cut off. */
static PetscErrorCode FindSuperfluous(const EqmCubeFaces *cube, PetscInt lowest[EQM_CUBE_EDGES])
{
  const EqmMesh mesh = cube->mesh;
  PetscBool *has_left;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < EQM_CUBE_EDGES; e++) lowest[e] = PETSC_MAX_INT;
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt middle = MiddleOfFlat(cube, mesh->cells + 3 * c);
    if (middle < 0) continue;
    const PetscInt e = (PetscInt)cube->on_edge[middle];
    lowest[e] = PetscMin(lowest[e], mesh->global[middle]);
  }
  PetscCall(PetscMalloc1(mesh->num_local, &has_left));
  FindSpikes(cube, has_left);
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscInt e = (PetscInt)cube->on_edge[v];
    if (e >= 0 && !has_left[v]) lowest[e] = PetscMin(lowest[e], mesh->global[v]);
  }
  PetscCall(PetscFree(has_left));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, lowest, EQM_CUBE_EDGES, MPIU_INT, MPI_MIN, mesh->comm));
  PetscFunctionReturn(0);
}

/* One vertex of each edge at a time goes to the right face. */
static PetscErrorCode StraightenEdges(EqmCubeFaces *cube, PetscBool *changed)
{
  const EqmMesh mesh = cube->mesh;
  PetscInt lowest[EQM_CUBE_EDGES];

  PetscFunctionBegin;
  PetscCall(FindSuperfluous(cube, lowest));
  *changed = PETSC_FALSE;
  for (PetscInt e = 0; e < EQM_CUBE_EDGES; e++) {
    if (lowest[e] == PETSC_MAX_INT) continue;
    *changed = PETSC_TRUE;
    for (PetscInt v = 0; v < mesh->num_local; v++) {
      if (mesh->global[v] == lowest[e]) cube->label[v] = cube->edge[e].right;
    }
  }
  if (*changed) PetscCall(FindEdges(cube));
  PetscFunctionReturn(0);
}

/* Every triangle in one face, and not flat there. */
static PetscErrorCode CheckTriangles(const EqmCubeFaces *cube)
{
  const EqmMesh mesh = cube->mesh;
  PetscInt bad = 0, any;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    const PetscInt faces = EqmCubeFacesOf(cube, v[0]) & EqmCubeFacesOf(cube, v[1]) & EqmCubeFacesOf(cube, v[2]);
    bad |= faces == 0 || (faces & (faces - 1)) != 0;
  }
  PetscCall(MPIU_Allreduce(&bad, &any, 1, MPIU_INT, MPI_MAX, mesh->comm));
  if (any) PetscCall(EqmCubeTooCoarse(mesh, "a triangle lies across an edge, or flat along one"));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCubeFacesCreate(EqmMesh mesh, const PetscReal *x, const PetscReal turn[9], EqmCubeFaces *cube)
{
  PetscBool changed = PETSC_TRUE;

  PetscFunctionBegin;
  *cube = (EqmCubeFaces){.mesh = mesh, .x = x};
  MakeEdges(cube->edge);
  PetscCall(PetscMalloc2(mesh->num_local, &cube->label, mesh->num_local, &cube->on_edge));
  PetscCall(EqmCubeLabel(cube, turn));
  PetscCall(FindEdges(cube));
  for (PetscInt k = 0; k < mesh->num_vertices && changed; k++) PetscCall(StraightenEdges(cube, &changed));
  PetscCall(CheckTriangles(cube));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCubeFacesDestroy(EqmCubeFaces *cube)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(cube->label, cube->on_edge));
  PetscFunctionReturn(0);
}
