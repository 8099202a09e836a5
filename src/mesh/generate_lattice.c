/* Lattices of the test shapes: rectangles, open, closed or twisted, a hexagon in rings, the subdivided icosahedron in
   rows. Numbers run row by row. */
#include "mesh/generate.h"

/* ---- rectangles: size[0] columns, size[1] rows of vertices ---- */

typedef enum { EQM_SIDES_OPEN, EQM_SIDES_GLUED, EQM_SIDES_TWISTED } EqmSides;

static void PlanGrid(PetscInt n, EqmSides left_right, EqmSides bottom_top, PetscReal aspect, EqmLatticePlan *plan)
{
  const PetscInt columns = PetscMax(3, (PetscInt)(PetscSqrtReal(n * aspect) + 0.5));
  const PetscInt rows = PetscMax(3, (PetscInt)((PetscReal)n / columns + 0.5));

  plan->cell_size = 3;
  plan->size[0] = columns;
  plan->size[1] = rows;
  plan->num_vertices = columns * rows;
  plan->num_cells =
      2 * (left_right == EQM_SIDES_OPEN ? columns - 1 : columns) * (bottom_top == EQM_SIDES_OPEN ? rows - 1 : rows);
}

static PetscInt GridVertex(const EqmLatticePlan *plan, EqmSides left_right, PetscInt i, PetscInt j)
{
  if (i >= plan->size[0]) {
    i -= plan->size[0];
    if (left_right == EQM_SIDES_TWISTED) j = plan->size[1] - 1 - j;
  }
  if (j >= plan->size[1]) j -= plan->size[1];
  return j * plan->size[0] + i;
}

/* Diagonals point at random, but out of the corners of an open rectangle, so that no triangle has two boundary edges.
 */
static PetscBool GridDiagonalRises(const EqmLatticePlan *plan, PetscBool open, PetscInt i, PetscInt j)
{
  const PetscInt last[2] = {plan->size[0] - 2, plan->size[1] - 2};

  if (open && (i == 0 || i == last[0]) && (j == 0 || j == last[1])) return (PetscBool)((i == 0) == (j == 0));
  return (PetscBool)(plan->regular || EqmHashUniform(plan->seed, j * plan->size[0] + i, 7) < 0.5);
}

static void GridCell(const EqmLatticePlan *plan, EqmSides left_right, EqmSides bottom_top, PetscInt cell,
                     PetscInt vertices[])
{
  const PetscBool open = (PetscBool)(left_right == EQM_SIDES_OPEN && bottom_top == EQM_SIDES_OPEN);
  const PetscInt per_row = left_right == EQM_SIDES_OPEN ? plan->size[0] - 1 : plan->size[0];
  const PetscInt square = cell / 2, i = square % per_row, j = square / per_row;
  const PetscInt corner[4] = {GridVertex(plan, left_right, i, j), GridVertex(plan, left_right, i + 1, j),
                              GridVertex(plan, left_right, i + 1, j + 1), GridVertex(plan, left_right, i, j + 1)};
  const PetscInt first = GridDiagonalRises(plan, open, i, j) ? 0 : 1;

  vertices[0] = corner[first];
  vertices[1] = corner[(first + (cell % 2 ? 2 : 1)) % 4];
  vertices[2] = corner[(first + (cell % 2 ? 3 : 2)) % 4];
}

static void GridParameter(const EqmLatticePlan *plan, EqmSides left_right, EqmSides bottom_top, PetscInt vertex,
                          PetscReal parameter[3])
{
  const EqmSides side[2] = {left_right, bottom_top};
  const PetscInt place[2] = {vertex % plan->size[0], vertex / plan->size[0]};

  for (int k = 0; k < 2; k++) {
    const PetscBool open = (PetscBool)(side[k] == EQM_SIDES_OPEN);
    const PetscBool on_side = (PetscBool)(open && (place[k] == 0 || place[k] == plan->size[k] - 1));
    const PetscReal moved = on_side ? 0.0 : EqmLatticeJitter(plan, vertex, k);

    parameter[k] = (place[k] + moved) / (open ? plan->size[k] - 1 : plan->size[k]);
  }
  parameter[2] = 0.0;
}

#define EQM_DEFINE_RECTANGLE(Name, left_right, bottom_top, aspect)                                                     \
  static void Plan##Name(PetscInt n, EqmLatticePlan *plan)                                                             \
  {                                                                                                                    \
    PlanGrid(n, left_right, bottom_top, aspect, plan);                                                                 \
  }                                                                                                                    \
  static void Parameter##Name(const EqmLatticePlan *plan, PetscInt vertex, PetscReal parameter[3])                     \
  {                                                                                                                    \
    GridParameter(plan, left_right, bottom_top, vertex, parameter);                                                    \
  }                                                                                                                    \
  static void Cell##Name(const EqmLatticePlan *plan, PetscInt cell, PetscInt vertices[])                               \
  {                                                                                                                    \
    GridCell(plan, left_right, bottom_top, cell, vertices);                                                            \
  }                                                                                                                    \
  const EqmLattice EqmLattice##Name = {Plan##Name, Parameter##Name, Cell##Name};

EQM_DEFINE_RECTANGLE(Rectangle, EQM_SIDES_OPEN, EQM_SIDES_OPEN, 1.25)
EQM_DEFINE_RECTANGLE(Annulus, EQM_SIDES_GLUED, EQM_SIDES_OPEN, 5.0)
EQM_DEFINE_RECTANGLE(Moebius, EQM_SIDES_TWISTED, EQM_SIDES_OPEN, 6.0)
EQM_DEFINE_RECTANGLE(Torus, EQM_SIDES_GLUED, EQM_SIDES_GLUED, 2.5)

/* ---- hexagon: ring r of 6 r vertices around a centre, size[0] rings ---- */

static void PlanHexagon(PetscInt n, EqmLatticePlan *plan)
{
  const PetscInt rings = PetscMax(2, (PetscInt)(PetscSqrtReal(n / 3.0)));

  plan->cell_size = 3;
  plan->size[0] = rings;
  plan->num_vertices = 3 * rings * (rings + 1) + 1;
  plan->num_cells = 6 * rings * rings;
}

/* Largest r >= 0 with factor r (r + shift) <= value: which ring or row a number lies in. */
static PetscInt RingOf(PetscInt factor, PetscInt shift, PetscInt value)
{
  PetscInt64 r = (PetscInt64)PetscSqrtReal((PetscReal)value / factor);

  while (factor * r * (r + shift) > value) r--;
  while (factor * (r + 1) * (r + 1 + shift) <= value) r++;
  return (PetscInt)r;
}

static void ParameterHexagon(const EqmLatticePlan *plan, PetscInt vertex, PetscReal parameter[3])
{
  const PetscInt ring = vertex ? RingOf(3, 1, vertex - 1) + 1 : 0,
                 place = vertex ? vertex - 1 - 3 * ring * (ring - 1) : 0;
  const PetscBool on_boundary = (PetscBool)(ring == plan->size[0]);
  const PetscReal radius = (ring + (on_boundary || !ring ? 0.0 : EqmLatticeJitter(plan, vertex, 0))) / plan->size[0];
  const PetscReal angle = ring ? 2.0 * PETSC_PI * (place + EqmLatticeJitter(plan, vertex, 1)) / (6 * ring) : 0.0;

  parameter[0] = radius * PetscCosReal(angle);
  parameter[1] = radius * PetscSinReal(angle);
  parameter[2] = 0.0;
}

/* Triangle `index` of the ring between `inner` and `outer` = `inner` + sectors vertices; `start` are their first
   numbers. Anticlockwise seen from where the outer ring encircles the inner one. */
static void RingTriangle(PetscInt sectors, PetscInt step, const PetscInt start[2], PetscInt index, PetscInt vertices[])
{
  const PetscInt sector = index / (2 * step - 1), inside = index % (2 * step - 1), i = inside / 2;
  const PetscInt num_inner = step > 1 ? sectors * (step - 1) : 1, num_outer = sectors * step;
  const PetscInt inner = sector * (step - 1) + i, outer = sector * step + i;

  if (inside % 2 == 0) {
    vertices[0] = start[1] + outer;
    vertices[1] = start[1] + (outer + 1) % num_outer;
    vertices[2] = start[0] + inner % num_inner;
  } else {
    vertices[0] = start[0] + inner % num_inner;
    vertices[1] = start[1] + (outer + 1) % num_outer;
    vertices[2] = start[0] + (inner + 1) % num_inner;
  }
}

static void CellHexagon(const EqmLatticePlan *plan, PetscInt cell, PetscInt vertices[])
{
  const PetscInt ring = RingOf(6, 0, cell) + 1;
  const PetscInt start[2] = {ring > 1 ? 3 * (ring - 1) * (ring - 2) + 1 : 0, 3 * ring * (ring - 1) + 1};

  (void)plan;
  RingTriangle(6, ring, start, cell - 6 * (ring - 1) * (ring - 1), vertices);
}

const EqmLattice EqmLatticeHexagon = {PlanHexagon, ParameterHexagon, CellHexagon};

/* ---- icosahedron: every edge cut into f = size[0]; rows 0 .. 3 f from the north pole; 5 r vertices in row r of the
   northern cap, 5 f in each row of the belt (rows f .. 2 f), the southern cap mirrors the northern one ---- */

static void PlanIcosahedron(PetscInt n, EqmLatticePlan *plan)
{
  const PetscInt f = PetscMax(1, (PetscInt)(PetscSqrtReal(PetscMax(n - 2, 1) / 10.0) + 0.5));

  plan->cell_size = 3;
  plan->size[0] = f;
  plan->num_vertices = 10 * f * f + 2;
  plan->num_cells = 20 * f * f;
}

/* First vertex number of a row. */
static PetscInt RowStart(PetscInt f, PetscInt row)
{
  const PetscInt cap = 1 + 5 * f * (f - 1) / 2; /* vertices above row f */
  const PetscInt below = 3 * f - row;           /* rows from here to the south pole */

  if (row <= f) return row ? 1 + 5 * row * (row - 1) / 2 : 0;
  if (row <= 2 * f) return cap + 5 * f * (row - f);
  return 10 * f * f + 2 - (1 + 5 * below * (below + 1) / 2);
}

static PetscInt RowOf(PetscInt f, PetscInt vertex)
{
  PetscInt low = 0, high = 3 * f;

  while (low < high) {
    const PetscInt middle = (low + high + 1) / 2;

    if (RowStart(f, middle) <= vertex)
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

static void IcosahedronCorner(PetscInt corner, PetscReal x[3])
{
  /* 0 the north pole, 1 .. 5 the upper ring, 6 .. 10 the lower ring, 11 the south pole */
  const PetscReal height = 1.0 / PetscSqrtReal(5.0), radius = 2.0 / PetscSqrtReal(5.0);
  const PetscReal angle = 2.0 * PETSC_PI / 5.0 * (corner <= 5 ? corner - 1 : corner - 5.5);
  const PetscBool pole = (PetscBool)(corner == 0 || corner == 11);

  x[0] = pole ? 0.0 : radius * PetscCosReal(angle);
  x[1] = pole ? 0.0 : radius * PetscSinReal(angle);
  x[2] = (corner <= 5 ? 1.0 : -1.0) * (pole ? 1.0 : height);
}

/* The icosahedron's triangle that a vertex lies in, and its barycentric coordinates there times f. */
static void IcosahedronPlace(PetscInt f, PetscInt vertex, PetscInt corner[3], PetscInt weight[3])
{
  const PetscInt row = RowOf(f, vertex), place = vertex - RowStart(f, row);

  if (row <= f || row >= 2 * f) {
    const PetscInt length = row <= f ? row : 3 * f - row, ring = row <= f ? 1 : 6;
    const PetscInt sector = length ? place / length : 0, i = length ? place % length : 0;

    corner[0] = row <= f ? 0 : 11;
    corner[1] = ring + sector;
    corner[2] = ring + (sector + 1) % 5;
    weight[0] = f - length;
    weight[1] = length - i;
    weight[2] = i;
  } else {
    const PetscInt down = row - f, sector = place / f, i = place % f, next = (sector + 1) % 5;
    const PetscBool upper = (PetscBool)(i <= f - down);

    corner[0] = upper ? 6 + sector : 1 + next;
    corner[1] = upper ? 1 + sector : 6 + sector;
    corner[2] = upper ? 1 + next : 6 + next;
    weight[0] = upper ? down : f - down;
    weight[1] = f - weight[0] - (upper ? i : i - (f - down));
    weight[2] = upper ? i : i - (f - down);
  }
}

static void ParameterIcosahedron(const EqmLatticePlan *plan, PetscInt vertex, PetscReal parameter[3])
{
  const PetscInt f = plan->size[0];
  PetscInt corner[3], weight[3];
  PetscReal norm = 0.0;

  IcosahedronPlace(f, vertex, corner, weight);
  for (int k = 0; k < 3; k++) parameter[k] = EqmLatticeJitter(plan, vertex, k) / f;
  for (int c = 0; c < 3; c++) {
    PetscReal x[3];

    IcosahedronCorner(corner[c], x);
    for (int k = 0; k < 3; k++) parameter[k] += weight[c] * x[k] / f;
  }
  for (int k = 0; k < 3; k++) norm += parameter[k] * parameter[k];
  for (int k = 0; k < 3; k++) parameter[k] /= PetscSqrtReal(norm);
}

static void CellIcosahedron(const EqmLatticePlan *plan, PetscInt cell, PetscInt vertices[])
{
  const PetscInt f = plan->size[0], cap = 5 * f * f, width = 5 * f;

  if (cell < cap) {
    const PetscInt row = RingOf(5, 0, cell) + 1, start[2] = {RowStart(f, row - 1), RowStart(f, row)};

    RingTriangle(5, row, start, cell - 5 * (row - 1) * (row - 1), vertices);
  } else if (cell < 3 * cap) {
    const PetscInt strip = (cell - cap) / (2 * width), inside = (cell - cap) % (2 * width), j = inside / 2;
    const PetscInt upper = RowStart(f, f + strip), lower = RowStart(f, f + strip + 1), next = (j + 1) % width;

    vertices[0] = inside % 2 ? lower + j : upper + j;
    vertices[1] = inside % 2 ? lower + next : lower + j;
    vertices[2] = upper + next;
  } else {
    /* counted from the south pole, and seen from outside the orientation is reversed */
    const PetscInt mirrored = 4 * cap - 1 - cell, row = RingOf(5, 0, mirrored) + 1;
    const PetscInt start[2] = {RowStart(f, 3 * f - row + 1), RowStart(f, 3 * f - row)};
    PetscInt swap;

    RingTriangle(5, row, start, mirrored - 5 * (row - 1) * (row - 1), vertices);
    swap = vertices[1];
    vertices[1] = vertices[2];
    vertices[2] = swap;
  }
}

const EqmLattice EqmLatticeIcosahedron = {PlanIcosahedron, ParameterIcosahedron, CellIcosahedron};
