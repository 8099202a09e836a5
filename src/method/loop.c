#include "method/loop.h"
#include "mesh/mesh_private.h"
#include "base/rows.h"

PetscErrorCode EqmLoopCreate(EqmMesh mesh, PetscInt num, const PetscInt *vertex, EqmLoop *out)
{
  EqmLoop loop;
  PetscInt *place;
  PetscReal *arc_length;
  PetscSFNode *root;

  PetscFunctionBegin;
  PetscCall(PetscNew(&loop));
  loop->comm = mesh->comm;
  loop->count = mesh->rank == 0 ? mesh->num_boundary_vertices : 0;
  loop->num = num;
  PetscCall(PetscMalloc2(num, &loop->vertex, 2 * num, &loop->mine));
  PetscCall(PetscMalloc3(mesh->num_local, &place, mesh->num_local, &arc_length, num, &root));
  PetscCall(EqmMeshBoundaryLoop(mesh, place, arc_length));
  for (PetscInt b = 0; b < num; b++) {
    loop->vertex[b] = vertex[b];
    root[b] = (PetscSFNode){.rank = 0, .index = place[vertex[b]]};
  }
  PetscCall(PetscSFCreate(mesh->comm, &loop->gather));
  PetscCall(PetscSFSetGraph(loop->gather, loop->count, num, NULL, PETSC_COPY_VALUES, root, PETSC_COPY_VALUES));
  PetscCall(PetscFree3(place, arc_length, root));
  *out = loop;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLoopDestroy(EqmLoop *loop)
{
  PetscFunctionBegin;
  if (!*loop) PetscFunctionReturn(0);
  PetscCall(PetscSFDestroy(&(*loop)->gather));
  PetscCall(PetscFree2((*loop)->vertex, (*loop)->mine));
  PetscCall(PetscFree(*loop));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLoopGather(EqmLoop loop, const PetscReal *values, PetscReal *whole)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsToRoots(loop->gather, 1, values, whole));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLoopScatter(EqmLoop loop, const PetscReal *whole, PetscReal *values)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsToLeaves(loop->gather, 1, whole, values));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLoopGaps(EqmLoop loop, const PetscReal *x, PetscReal *point, PetscReal *gap)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < loop->num; b++) {
    for (PetscInt k = 0; k < 2; k++) loop->mine[2 * b + k] = x[2 * loop->vertex[b] + k];
  }
  PetscCall(EqmRowsToRoots(loop->gather, 2, loop->mine, point));
  for (PetscInt k = 0; k < loop->count; k++) {
    const PetscReal *const p = point + 2 * k, *const q = point + 2 * ((k + 1) % loop->count);
    gap[k] = PetscAtan2Real(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]);
  }
  PetscFunctionReturn(0);
}
