/* A balanced tree of axis-parallel boxes: made by halving the cells along the longest side, searched nearest box first.
 */
#include "register/tree.h"
#include "geometry/simplex.h"
#include <math.h>

enum { LEAF = 4, MOST_LEVELS = 40 };

PetscReal EqmBoxSquaredDistance(const EqmBox *box, const PetscReal y[3])
{
  PetscReal sum = 0.;

  for (PetscInt k = 0; k < 3; k++) {
    const PetscReal outside = PetscMax(PetscMax(box->low[k] - y[k], y[k] - box->high[k]), 0.);
    sum += outside * outside;
  }
  return sum;
}

/* First cell of node k: the cells are shared evenly by the nodes of its level. */
static PetscInt NodeStart(const EqmTree *tree, PetscInt level, PetscInt k)
{
  return (PetscInt)((PetscInt64)tree->num_cells * (k - ((PetscInt)1 << level)) >> level);
}

/* On the sphere a point lies above its triangle by no more than the plane of the triangle lies below the sphere. */
static PetscReal Bulge(const EqmTree *tree, const PetscReal *p)
{
  const PetscReal u[3] = {p[3] - p[0], p[4] - p[1], p[5] - p[2]}, v[3] = {p[6] - p[0], p[7] - p[1], p[8] - p[2]};
  PetscReal n[3], length;

  if (tree->kind != EQM_IMAGE_SPHERE) return 0.;
  EqmCross(u, v, n);
  length = PetscSqrtReal(EqmDot3(n, n));
  return length > 0. ? PetscMax(0., 1. - PetscAbsReal(EqmDot3(n, p)) / length) : 1.;
}

static void CellBox(const EqmTree *tree, PetscInt cell, EqmBox *box)
{
  const PetscReal *const p = tree->corner + 3 * tree->cell_size * cell;
  const PetscReal margin = tree->tolerance + Bulge(tree, p);

  for (PetscInt k = 0; k < 3; k++) {
    box->low[k] = box->high[k] = p[k];
    for (PetscInt a = 1; a < tree->cell_size; a++) {
      box->low[k] = PetscMin(box->low[k], p[3 * a + k]);
      box->high[k] = PetscMax(box->high[k], p[3 * a + k]);
    }
    box->low[k] -= margin;
    box->high[k] += margin;
  }
}

/* The sort key of a cell: the sum of its corners along an axis, ties by label. */
static PetscReal Key(const EqmTree *tree, PetscInt cell, PetscInt axis)
{
  PetscReal sum = 0.;

  for (PetscInt a = 0; a < tree->cell_size; a++) sum += tree->corner[3 * (tree->cell_size * cell + a) + axis];
  return sum;
}

static PetscBool Precedes(const EqmTree *tree, PetscInt axis, PetscReal key, PetscInt cell, PetscReal other_key,
                          PetscInt other)
{
  return (PetscBool)(key < other_key || (key == other_key && tree->label[cell] < tree->label[other]));
}

/* Partial sort: the cell at `middle` of order[low .. high - 1] is in its place, smaller ones before it. */
static void Select(EqmTree *tree, PetscInt axis, PetscInt low, PetscInt high, PetscInt middle)
{
  PetscInt *const order = tree->order;

  for (high--; low < high;) {
    const PetscInt pivot = order[(low + high) / 2];
    const PetscReal pivot_key = Key(tree, pivot, axis);
    PetscInt i = low, j = high;
    while (i <= j) {
      while (Precedes(tree, axis, Key(tree, order[i], axis), order[i], pivot_key, pivot)) i++;
      while (Precedes(tree, axis, pivot_key, pivot, Key(tree, order[j], axis), order[j])) j--;
      if (i > j) break;
      const PetscInt swap = order[i];
      order[i++] = order[j];
      order[j--] = swap;
    }
    if (middle <= j)
      high = j;
    else if (middle >= i)
      low = i;
    else
      return;
  }
}

/* The axis along which the centroids of a node's cells are spread most. */
static PetscInt LongestAxis(const EqmTree *tree, PetscInt low, PetscInt high)
{
  PetscReal longest = -1.;
  PetscInt axis = 0;

  for (PetscInt k = 0; k < 3; k++) {
    PetscReal smallest = PETSC_MAX_REAL, largest = PETSC_MIN_REAL;
    for (PetscInt i = low; i < high; i++) {
      const PetscReal key = Key(tree, tree->order[i], k);
      smallest = PetscMin(smallest, key);
      largest = PetscMax(largest, key);
    }
    if (largest - smallest <= longest) continue;
    longest = largest - smallest;
    axis = k;
  }
  return axis;
}

static void Split(EqmTree *tree)
{
  for (PetscInt level = 0; level < tree->num_levels; level++) {
    for (PetscInt k = (PetscInt)1 << level; k < (PetscInt)2 << level; k++) {
      const PetscInt low = NodeStart(tree, level, k), high = NodeStart(tree, level, k + 1);
      if (low < high) Select(tree, LongestAxis(tree, low, high), low, high, NodeStart(tree, level + 1, 2 * k + 1));
    }
  }
}

/* Boxes of all nodes, from the leaves to the root. */
static void MakeBoxes(EqmTree *tree)
{
  const EqmBox empty = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  const PetscInt first_leaf = (PetscInt)1 << tree->num_levels;

  for (PetscInt k = 2 * first_leaf - 1; k >= 1; k--) {
    tree->box[k] = empty;
    for (PetscInt part = 0; k < first_leaf && part < 2; part++) {
      for (PetscInt i = 0; i < 3; i++) {
        tree->box[k].low[i] = PetscMin(tree->box[k].low[i], tree->box[2 * k + part].low[i]);
        tree->box[k].high[i] = PetscMax(tree->box[k].high[i], tree->box[2 * k + part].high[i]);
      }
    }
    if (k < first_leaf) continue;
    for (PetscInt c = NodeStart(tree, tree->num_levels, k); c < NodeStart(tree, tree->num_levels, k + 1); c++) {
      EqmBox box;
      CellBox(tree, tree->order[c], &box);
      for (PetscInt i = 0; i < 3; i++) {
        tree->box[k].low[i] = PetscMin(tree->box[k].low[i], box.low[i]);
        tree->box[k].high[i] = PetscMax(tree->box[k].high[i], box.high[i]);
      }
    }
  }
}

PetscErrorCode EqmTreeCreate(EqmImageKind kind, PetscInt cell_size, PetscInt num_cells, PetscReal *corner,
                             PetscInt *label, PetscReal tolerance, EqmTree *tree)
{
  PetscFunctionBegin;
  *tree = (EqmTree){.kind = kind,
                    .cell_size = cell_size,
                    .num_cells = num_cells,
                    .label = label,
                    .corner = corner,
                    .tolerance = tolerance};
  while (num_cells >> tree->num_levels > LEAF) tree->num_levels++;
  PetscCall(PetscMalloc1(num_cells, &tree->order));
  for (PetscInt c = 0; c < num_cells; c++) tree->order[c] = c;
  PetscCall(PetscMalloc1((size_t)2 << tree->num_levels, &tree->box));
  Split(tree);
  MakeBoxes(tree);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmTreeReset(EqmTree *tree)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(tree->order));
  PetscCall(PetscFree(tree->label));
  PetscCall(PetscFree(tree->corner));
  PetscCall(PetscFree(tree->box));
  PetscFunctionReturn(0);
}

/* Test one cell. */
static void TestCell(const EqmTree *tree, PetscInt cell, const PetscReal y[3], EqmHit *hit)
{
  const PetscReal *corner[4];
  PetscReal barycentric[4] = {0., 0., 0., 0.}, squared;

  for (PetscInt a = 0; a < tree->cell_size; a++) corner[a] = tree->corner + 3 * (tree->cell_size * cell + a);
  squared = EqmClosestOnCell(tree->kind, tree->cell_size, y, corner, barycentric);
  if (squared <= tree->tolerance * tree->tolerance) squared = 0.;
  if (!(squared < hit->squared || (squared == hit->squared && tree->label[cell] < hit->label))) return;
  hit->cell = cell;
  hit->label = tree->label[cell];
  hit->squared = squared;
  for (PetscInt a = 0; a < 4; a++) hit->barycentric[a] = barycentric[a];
}

void EqmTreeFind(const EqmTree *tree, const PetscReal y[3], EqmHit *hit)
{
  const PetscInt first_leaf = (PetscInt)1 << tree->num_levels;
  PetscInt stack[MOST_LEVELS + 2], depth = 0;

  stack[depth++] = 1;
  while (depth > 0) {
    const PetscInt k = stack[--depth];
    if (EqmBoxSquaredDistance(&tree->box[k], y) > hit->squared) continue;
    if (k < first_leaf) { /* the nearer child is searched first */
      const PetscBool swap =
          (PetscBool)(EqmBoxSquaredDistance(&tree->box[2 * k], y) < EqmBoxSquaredDistance(&tree->box[2 * k + 1], y));
      stack[depth++] = swap ? 2 * k + 1 : 2 * k;
      stack[depth++] = swap ? 2 * k : 2 * k + 1;
      continue;
    }
    for (PetscInt c = NodeStart(tree, tree->num_levels, k); c < NodeStart(tree, tree->num_levels, k + 1); c++)
      TestCell(tree, tree->order[c], y, hit);
  }
}
