/* The linear homotopy from A to its correspondence on B (000 (51), 001 (6.7), 003 (46)) as a series of frames. */
#include "register/registration.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"
#include "store/store.h"
#include <string.h>

static PetscReal TimeOf(const EqmRegistration r, PetscInt frame)
{
  return (PetscReal)frame / (r->set.frames - 1);
}

/* (1 - t) v + t phi(v). */
static void Blend(PetscInt length, PetscReal t, const PetscReal *from, const PetscReal *to, PetscReal *x)
{
  for (PetscInt k = 0; k < length; k++) x[k] = (1. - t) * from[k] + t * to[k];
}

/* Number of tetrahedra that are flat or inverted. */
static PetscInt64 TurnedTetrahedra(EqmMesh mesh, const PetscReal *x)
{
  PetscInt64 turned = 0;

  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscInt *const v = mesh->cells + 4 * c;
    turned += !(EqmVolume(x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]) > 0.);
  }
  return turned;
}

static void NormalOf(EqmMesh mesh, const PetscReal *x, PetscInt cell, PetscReal normal[3])
{
  const PetscInt *const v = mesh->cells + 3 * cell;
  PetscReal u[3], w[3];

  for (PetscInt k = 0; k < 3; k++) {
    u[k] = x[3 * v[1] + k] - x[3 * v[0] + k];
    w[k] = x[3 * v[2] + k] - x[3 * v[0] + k];
  }
  EqmCross(u, w, normal);
}

/* Number of triangles that are flat or oriented against the surface around them, which is the sum of the normals at
   their corners.
 */
static PetscErrorCode TurnedTriangles(EqmMesh mesh, const PetscReal *x, PetscInt64 *turned)
{
  PetscReal *sum, normal[3];

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * mesh->num_local, &sum));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    NormalOf(mesh, x, c, normal);
    for (PetscInt k = 0; k < 9; k++) sum[3 * mesh->cells[3 * c + k / 3] + k % 3] += normal[k % 3];
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 3, sum)); /* not all triangles of a ghost are here */
  *turned = 0;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    PetscReal along = 0.;
    NormalOf(mesh, x, c, normal);
    for (PetscInt k = 0; k < 9; k++) along += normal[k % 3] * sum[3 * mesh->cells[3 * c + k / 3] + k % 3];
    *turned += !(along > 0.);
  }
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(0);
}

/* Cells of the frame at time t that are folded. */
static PetscErrorCode CountFolds(EqmRegistration r, PetscReal t, PetscInt64 *folds)
{
  const EqmMesh mesh = r->a.mesh;
  PetscReal *x;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * mesh->num_local, &x));
  Blend(3 * mesh->num_local, t, mesh->position, r->image, x);
  if (mesh->cell_size == 4)
    *folds = TurnedTetrahedra(mesh, x);
  else
    PetscCall(TurnedTriangles(mesh, x, folds));
  PetscCall(PetscFree(x));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, folds, 1, MPIU_INT64, MPI_SUM, r->comm));
  PetscFunctionReturn(0);
}

/* Points and folds of every frame into the result. Collective. */
PetscErrorCode EqmAddFrames(EqmRegistration r)
{
  const EqmSoup soup = r->a.soup;
  const PetscInt count = soup->vertex_end - soup->vertex_start;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < r->set.frames; f++) {
    char path[64], key[64];
    PetscReal *points;
    PetscInt64 folds;
    PetscCall(PetscMalloc1(3 * count + 1, &points));
    Blend(3 * count, TimeOf(r, f), soup->vertices, r->map->coordinates, points);
    PetscCall(PetscSNPrintf(path, sizeof(path), EQM_FRAME_PATH, f));
    PetscCall(EqmMapAddReals(r->map, path, soup->num_vertices, soup->vertex_start, count, 3, points));
    PetscCall(CountFolds(r, TimeOf(r, f), &folds));
    PetscCall(PetscSNPrintf(key, sizeof(key), "register.frames.folds.%03" PetscInt_FMT, f));
    PetscCall(EqmMapAddCount(r->map, key, folds));
    r->figures.most_frame_folds = PetscMax(r->figures.most_frame_folds, folds);
  }
  PetscFunctionReturn(0);
}

/* A's mesh with the points of one frame, as NAME. */
static PetscErrorCode WriteFrame(EqmRegistration r, PetscReal t, const char *name)
{
  EqmSoup frame;

  PetscFunctionBegin;
  PetscCall(EqmSoupCopy(r->a.soup, &frame));
  Blend(3 * (frame->vertex_end - frame->vertex_start), t, r->a.soup->vertices, r->map->coordinates, frame->vertices);
  PetscCall(EqmSoupWrite(frame, name));
  PetscCall(EqmSoupDestroy(&frame));
  PetscFunctionReturn(0);
}

/* Beside the first name of `files`, without its suffix: NAME.morph.xmf for a result file, NAME.frameNNN.obj (solids:
   .vtu). Collective. */
PetscErrorCode EqmRegistrationWriteFrames(EqmRegistration r, const char *files)
{
  char base[PETSC_MAX_PATH_LEN], name[PETSC_MAX_PATH_LEN + 32], **names, *dot;
  int count;

  PetscFunctionBegin;
  if (r->set.frames == 0) PetscFunctionReturn(0);
  PetscCall(PetscStrToArray(files, ',', &count, &names));
  PetscCall(PetscStrncpy(base, names[0], sizeof(base)));
  for (int k = 0; k < count; k++) {
    if (EqmHasSuffix(names[k], ".h5")) PetscCall(EqmMapWriteMorph(r->map, names[k], r->set.frames));
  }
  PetscCall(PetscStrToArrayDestroy(count, names));
  dot = strrchr(base, '.');
  if (dot && !strchr(dot, '/')) *dot = '\0';
  for (PetscInt f = 0; f < r->set.frames; f++) {
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s.frame%03" PetscInt_FMT ".%s", base, f,
                            r->a.mesh->cell_size == 4 ? "vtu" : "obj"));
    PetscCall(WriteFrame(r, TimeOf(r, f), name));
  }
  PetscFunctionReturn(0);
}
