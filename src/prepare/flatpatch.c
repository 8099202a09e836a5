/* Triangles without area on one rank: needles, two of whose vertices lie at the same place, collapse; of caps, one of
   whose vertices lies on the opposite edge, that edge is flipped: its other triangle is cut in two there, which does
   not change the surface. */
#include "prepare/flat.h"
#include "geometry/simplex.h"
#include "mesh/diagnose.h"

static PetscErrorCode AddCell(EqmFlatPatch *patch, PetscInt cell, PetscInt a, PetscInt b, PetscInt c)
{
  const PetscInt corner[3] = {a, b, c}, k = patch->num_cells;

  PetscFunctionBegin;
  if (k == patch->cell_capacity) {
    patch->cell_capacity = PetscMax(64, 2 * k);
    PetscCall(PetscRealloc((size_t)patch->cell_capacity * sizeof(PetscInt), &patch->cell));
    PetscCall(PetscRealloc((size_t)patch->cell_capacity * sizeof(PetscBool), &patch->alive));
    PetscCall(PetscRealloc((size_t)(3 * patch->cell_capacity) * sizeof(PetscInt), &patch->corner));
    PetscCall(PetscRealloc((size_t)(3 * patch->cell_capacity) * sizeof(PetscInt), &patch->next));
  }
  patch->cell[k] = cell;
  patch->alive[k] = PETSC_TRUE;
  for (PetscInt i = 0; i < 3; i++) {
    patch->corner[3 * k + i] = corner[i];
    patch->next[3 * k + i] = patch->head[corner[i]];
    patch->head[corner[i]] = 3 * k + i;
  }
  patch->num_cells++;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlatPatchCreate(PetscInt num, const EqmFlatRecord *record, EqmFlatPatch *patch)
{
  PetscInt count = 3 * num;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(patch, sizeof(*patch)));
  PetscCall(PetscMalloc1(count, &patch->number));
  for (PetscInt k = 0; k < count; k++) patch->number[k] = record[k / 3].vertex[k % 3];
  PetscCall(PetscSortRemoveDupsInt(&count, patch->number));
  patch->num_vertices = count;
  PetscCall(PetscMalloc4(3 * count, &patch->x, count, &patch->head, count, &patch->joined, count, &patch->onto));
  for (PetscInt v = 0; v < count; v++) patch->head[v] = -1;
  for (PetscInt c = 0; c < num; c++) {
    PetscInt place[3];

    for (int i = 0; i < 3; i++) {
      PetscCall(PetscFindInt(record[c].vertex[i], count, patch->number, &place[i]));
      PetscCall(PetscArraycpy(patch->x + 3 * place[i], record[c].x + 3 * i, 3));
    }
    PetscCall(AddCell(patch, record[c].cell, place[0], place[1], place[2]));
  }
  patch->num_given = num;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlatPatchReset(EqmFlatPatch *patch)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(patch->cell));
  PetscCall(PetscFree(patch->alive));
  PetscCall(PetscFree(patch->corner));
  PetscCall(PetscFree(patch->next));
  PetscCall(PetscFree(patch->number));
  PetscCall(PetscFree4(patch->x, patch->head, patch->joined, patch->onto));
  PetscFunctionReturn(0);
}

static PetscReal SquaredLength(const EqmFlatPatch *patch, PetscInt v, PetscInt w)
{
  PetscReal u[3];

  for (int k = 0; k < 3; k++) u[k] = patch->x[3 * v + k] - patch->x[3 * w + k];
  return EqmDot3(u, u);
}

static PetscBool IsFlat(const EqmFlatPatch *patch, PetscInt cell)
{
  const PetscInt *const v = patch->corner + 3 * cell;
  const PetscReal squares =
      SquaredLength(patch, v[0], v[1]) + SquaredLength(patch, v[1], v[2]) + SquaredLength(patch, v[2], v[0]);
  const PetscReal area = EqmArea3(patch->x + 3 * v[0], patch->x + 3 * v[1], patch->x + 3 * v[2]);

  return (PetscBool) !(4. * PetscSqrtReal(3.) * area >= EQM_FLAT_TRIANGLE * squares && squares > 0.);
}

/* Is there an edge, and how many living triangles have it? `along` gets one that runs from v to w, or -1. */
static PetscInt CountEdge(const EqmFlatPatch *patch, PetscInt v, PetscInt w, PetscInt *along)
{
  PetscInt count = 0;

  *along = -1;
  for (PetscInt k = patch->head[v]; k >= 0; k = patch->next[k]) {
    const PetscInt after = patch->corner[k - k % 3 + (k + 1) % 3], before = patch->corner[k - k % 3 + (k + 2) % 3];

    if (!patch->alive[k / 3] || (after != w && before != w)) continue;
    count++;
    if (after == w) *along = k / 3;
  }
  return count;
}

/* Vertices that both ends of an edge have as neighbours: where these are more than its triangles, a collapse would not
   leave a surface. */
static PetscInt CountCommon(const EqmFlatPatch *patch, PetscInt v, PetscInt w)
{
  PetscInt count = 0, along;

  for (PetscInt k = patch->head[v]; k >= 0; k = patch->next[k]) {
    for (int i = 1; i < 3 && patch->alive[k / 3]; i++) {
      const PetscInt u = patch->corner[k - k % 3 + (k + i) % 3];

      /* as the first of a triangle's two only, but at a boundary, where it is met once anyway */
      if (u != w && (i == 1 || CountEdge(patch, v, u, &along) == 1) && CountEdge(patch, w, u, &along)) count++;
    }
  }
  return count;
}

/* Take vertex w to v, at the same place. */
static PetscErrorCode Collapse(EqmFlatPatch *patch, PetscInt v, PetscInt w, PetscBool *done)
{
  PetscInt along;

  PetscFunctionBegin;
  *done = (PetscBool)(CountCommon(patch, v, w) == CountEdge(patch, v, w, &along));
  if (!*done) PetscFunctionReturn(0);
  for (PetscInt k = patch->head[w]; k >= 0; k = patch->next[k]) {
    const PetscInt cell = k / 3, *const corner = patch->corner + 3 * cell, a = corner[(k + 1) % 3],
                   b = corner[(k + 2) % 3];

    if (!patch->alive[cell]) continue;
    patch->alive[cell] = PETSC_FALSE;
    if (a != v && b != v) PetscCall(AddCell(patch, patch->cell[cell], v, a, b));
  }
  patch->joined[patch->num_joined] = w;
  patch->onto[patch->num_joined++] = v;
  PetscFunctionReturn(0);
}

/* Flip the edge from a to b of a triangle whose vertex c lies on it; at the boundary the triangle goes. */
static PetscErrorCode Flip(EqmFlatPatch *patch, PetscInt cell, PetscInt c, PetscInt a, PetscInt b, PetscBool *done)
{
  PetscInt other, unused, d = -1;
  const PetscInt count = CountEdge(patch, b, a, &other);

  PetscFunctionBegin;
  *done = PETSC_FALSE;
  if (count == 1) {
    patch->alive[cell] = PETSC_FALSE;
    *done = PETSC_TRUE;
  }
  if (count != 2 || other < 0) PetscFunctionReturn(0);
  for (int i = 0; i < 3; i++) {
    if (patch->corner[3 * other + i] != a && patch->corner[3 * other + i] != b) d = patch->corner[3 * other + i];
  }
  if (d < 0 || d == c || CountEdge(patch, c, d, &unused)) PetscFunctionReturn(0);
  /* beside another flat one, edges must become shorter, so that this comes to an end */
  if (IsFlat(patch, other) && SquaredLength(patch, c, d) >= SquaredLength(patch, a, b)) PetscFunctionReturn(0);
  patch->alive[cell] = patch->alive[other] = PETSC_FALSE;
  PetscCall(AddCell(patch, patch->cell[other], c, a, d));
  PetscCall(AddCell(patch, patch->cell[other], c, d, b));
  *done = PETSC_TRUE;
  PetscFunctionReturn(0);
}

static PetscErrorCode MendOne(EqmFlatPatch *patch, PetscInt cell, PetscBool *done)
{
  PetscInt v[3], shortest = 0, longest = 0;
  PetscReal length[3];

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(v, patch->corner + 3 * cell, 3)); /* the array moves when cells are added */
  for (int i = 0; i < 3; i++) length[i] = SquaredLength(patch, v[(i + 1) % 3], v[(i + 2) % 3]); /* opposite of i */
  for (int i = 1; i < 3; i++) {
    if (length[i] < length[shortest]) shortest = i;
    if (length[i] > length[longest]) longest = i;
  }
  if (length[shortest] <= PetscSqr(EQM_FLAT_TRIANGLE) * length[longest]) {
    const PetscInt a = v[(shortest + 1) % 3], b = v[(shortest + 2) % 3];
    PetscCall(Collapse(patch, PetscMin(a, b), PetscMax(a, b), done));
  } else {
    PetscCall(Flip(patch, cell, v[longest], v[(longest + 1) % 3], v[(longest + 2) % 3], done));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFlatPatchMend(EqmFlatPatch *patch, PetscInt64 *mended)
{
  PetscInt64 before = -1;

  PetscFunctionBegin;
  while (before != *mended) {
    before = *mended;
    for (PetscInt c = 0; c < patch->num_cells; c++) {
      PetscBool done = PETSC_FALSE;

      if (patch->alive[c] && IsFlat(patch, c)) PetscCall(MendOne(patch, c, &done));
      *mended += done;
    }
  }
  PetscFunctionReturn(0);
}
