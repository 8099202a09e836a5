/* Tutte's map to the sphere by two hemispheres (004 section 5.1): a closed curve cuts the surface in two disks, each is
   mapped to a round disk with the same boundary (hemisphere_map.c), and these become the two hemispheres.

   The curve is a level of the function that is one at one pole of the surface, zero at the other, and a mean of its
   neighbours elsewhere: what lies below and above is connected, as every vertex has a lower and a higher neighbour. The
   curve runs through triangles and edges, not through vertices, so no vertex is on it twice. */
#include "start/hemispheres.h"
#include "base/narrow.h"
#include "measure/quantile.h"
#include "unfold/unfold.h"

/* The vertex with the largest value, ties by input number; its input number and position. */
static PetscErrorCode Farthest(const EqmCut *cut, const PetscReal from[3], PetscInt *vertex, PetscReal position[3])
{
  const EqmMesh mesh = cut->problem->mesh;
  PetscReal best = -1., most, mine[3] = {0., 0., 0.};
  PetscInt found = -1, number, lowest;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscReal *const p = mesh->position + 3 * v;
    const PetscReal distance = PetscSqr(p[0] - from[0]) + PetscSqr(p[1] - from[1]) + PetscSqr(p[2] - from[2]);
    if (distance < best || (distance == best && cut->input[v] > cut->input[found])) continue;
    best = distance;
    found = v;
  }
  PetscCall(MPIU_Allreduce(&best, &most, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  number = found >= 0 && best == most ? mesh->vertex_input[found] : PETSC_MAX_INT;
  PetscCall(MPIU_Allreduce(&number, &lowest, 1, MPIU_INT, MPI_MIN, mesh->comm));
  for (PetscInt k = 0; k < 3 && number == lowest; k++) mine[k] = mesh->position[3 * found + k];
  PetscCall(MPIU_Allreduce(mine, position, 3, MPIU_REAL, MPIU_SUM, mesh->comm));
  *vertex = lowest;
  PetscFunctionReturn(0);
}

/* Two poles far apart, and the function between them. */
static PetscErrorCode ComputeHeight(EqmCut *cut, const PetscReal *weights, signed char *group)
{
  const EqmMesh mesh = cut->problem->mesh;
  PetscReal sum[3] = {0., 0., 0.}, middle[3], place[2][3];
  PetscInt pole[2];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * mesh->num_owned; k++) sum[k % 3] += mesh->position[k] / mesh->num_vertices;
  PetscCall(MPIU_Allreduce(sum, middle, 3, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscCall(Farthest(cut, middle, &pole[0], place[0]));
  PetscCall(Farthest(cut, place[0], &pole[1], place[1]));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscBool south = (PetscBool)(cut->input[v] == (PetscReal)pole[0]),
                    north = (PetscBool)(cut->input[v] == (PetscReal)pole[1]);
    group[v] = south || north ? EQM_GROUP_FIXED : 0;
    cut->height[v] = north ? 1. : 0.;
  }
  PetscCall(EqmHeldSolve(cut->problem, weights, group, 1, cut->height));
  PetscFunctionReturn(0);
}

static PetscBool IsCut(const EqmCut *cut, PetscInt cell)
{
  const PetscInt *const v = cut->problem->mesh->cells + 3 * cell;
  return (PetscBool)(EqmCutIsBelow(cut, v[0]) != EqmCutIsBelow(cut, v[1]) ||
                     EqmCutIsBelow(cut, v[0]) != EqmCutIsBelow(cut, v[2]));
}

/* The lower side is on the curve's left: in triangle (a, b, c) with a alone on its side it runs from edge ab to edge
   ca if a is above, else from ca to ab. */
static EqmCrossing CrossCell(const EqmCut *cut, PetscInt cell)
{
  const EqmMesh mesh = cut->problem->mesh;
  PetscInt alone = 0, edge[2][2];
  EqmCrossing crossing = {.angle = 0.};

  for (PetscInt k = 0; k < 3; k++) {
    const PetscInt *const v = mesh->cells + 3 * cell;
    if (EqmCutIsBelow(cut, v[(k + 1) % 3]) == EqmCutIsBelow(cut, v[(k + 2) % 3])) alone = k;
  }
  const PetscInt a = mesh->cells[3 * cell + alone];
  const PetscBool below = EqmCutIsBelow(cut, a);
  for (PetscInt k = 0; k < 2; k++) { /* if a is above, the curve enters through the edge to the next corner */
    const PetscInt other = mesh->cells[3 * cell + (alone + 1 + (below ? 1 - k : k)) % 3];
    edge[k][0] = below ? a : other;
    edge[k][1] = below ? other : a;
  }
  const PetscInt low = edge[0][0], high = edge[0][1];
  const PetscReal t = (cut->level - cut->height[low]) / (cut->height[high] - cut->height[low]);
  for (PetscInt k = 0; k < 3; k++)
    crossing.place[k] = (1. - t) * mesh->position[3 * low + k] + t * mesh->position[3 * high + k];
  for (PetscInt k = 0; k < 2; k++) {
    crossing.from[k] = (PetscInt)cut->input[edge[0][k]];
    crossing.to[k] = (PetscInt)cut->input[edge[1][k]];
  }
  return crossing;
}

/* Collect the curve at the present level on every rank. */
static PetscErrorCode CollectCurve(EqmCut *cut)
{
  const EqmMesh mesh = cut->problem->mesh;
  EqmCrossing *mine;
  PetscMPIInt *count, *place;
  PetscInt num_mine = 0;
  MPI_Datatype type;

  PetscFunctionBegin;
  PetscCall(PetscFree(cut->crossing));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) num_mine += IsCut(cut, c);
  PetscCall(PetscMalloc3(num_mine, &mine, mesh->size, &count, mesh->size + 1, &place));
  num_mine = 0;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    if (IsCut(cut, c)) mine[num_mine++] = CrossCell(cut, c);
  }
  PetscCall(EqmGatherCounts(mesh->comm, num_mine, "cells that a cut crosses", count, place));
  cut->count = place[mesh->size];
  PetscCall(PetscMalloc1(cut->count, &cut->crossing));
  PetscCallMPI(MPI_Type_contiguous(sizeof(EqmCrossing), MPI_BYTE, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  PetscCallMPI(MPI_Allgatherv(mine, count[mesh->rank], type, cut->crossing, count, place, type, mesh->comm));
  PetscCallMPI(MPI_Type_free(&type));
  PetscCall(PetscFree3(mine, count, place));
  EqmCutSort(cut);
  PetscFunctionReturn(0);
}

/* Angles by arc length. False if the crossings are not one closed curve. */
static PetscBool WalkCurve(EqmCut *cut)
{
  PetscReal length = 0.;
  EqmCrossing *here = cut->crossing;

  if (cut->count < 3) return PETSC_FALSE;
  for (PetscInt k = 0; k < cut->count; k++) {
    EqmCrossing *const next = EqmCutFindCrossing(cut, here->to[0], here->to[1]);
    if (!next || (next == cut->crossing) != (k == cut->count - 1)) return PETSC_FALSE;
    const PetscReal *const p = here->place, *const q = next->place;
    here->angle = length;
    length += PetscSqrtReal(PetscSqr(p[0] - q[0]) + PetscSqr(p[1] - q[1]) + PetscSqr(p[2] - q[2]));
    here = next;
  }
  for (PetscInt k = 0; k < cut->count; k++) cut->crossing[k].angle *= 2. * PETSC_PI / length;
  return (PetscBool)(length > 0.);
}

/* Levels between the quartiles, by the curve's length in triangles over the smaller side's number of vertices. */
enum { NUM_LEVELS = 15 };

static PetscErrorCode RankLevels(const EqmCut *cut, PetscReal level[NUM_LEVELS], PetscReal cost[NUM_LEVELS])
{
  const EqmMesh mesh = cut->problem->mesh;
  PetscReal *sample, sums[2 * NUM_LEVELS] = {0.};
  EqmStatistics statistics;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_owned, &sample));
  PetscCall(PetscArraycpy(sample, cut->height, mesh->num_owned));
  PetscCall(EqmStatisticsOf(mesh->comm, mesh->num_owned, sample, &statistics));
  PetscCall(PetscFree(sample));
  for (PetscInt l = 0; l < NUM_LEVELS; l++) {
    EqmCut at = *cut;
    at.level = level[l] = statistics.p25 + (statistics.p75 - statistics.p25) * (l + 1) / (NUM_LEVELS + 1);
    for (PetscInt v = 0; v < mesh->num_owned; v++) sums[2 * l] += EqmCutIsBelow(&at, v);
    for (PetscInt c = 0; c < mesh->num_owned_cells; c++) sums[2 * l + 1] += IsCut(&at, c);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sums, 2 * NUM_LEVELS, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt l = 0; l < NUM_LEVELS; l++)
    cost[l] = sums[2 * l + 1] / PetscMax(1., PetscMin(sums[2 * l], mesh->num_vertices - sums[2 * l]));
  PetscFunctionReturn(0);
}

/* The cheapest level whose curve closes. Where the function is flat, in limbs that hold neither pole, rounding can tear
   a curve to pieces. */
static PetscErrorCode ChooseLevel(EqmCut *cut, PetscBool *found)
{
  PetscReal level[NUM_LEVELS], cost[NUM_LEVELS];
  PetscBool closed = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(RankLevels(cut, level, cost));
  for (PetscInt trial = 0; trial < NUM_LEVELS && !closed; trial++) {
    PetscInt best = 0;
    for (PetscInt l = 1; l < NUM_LEVELS; l++) best = cost[l] < cost[best] ? l : best;
    cost[best] = PETSC_MAX_REAL;
    cut->level = level[best];
    PetscCall(CollectCurve(cut));
    closed = WalkCurve(cut);
  }
  *found = closed;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereTutte(EqmProblem problem, EqmIterate iterate, EqmHemisphereWeights kind, PetscBool *found)
{
  const EqmMesh mesh = problem->mesh;
  EqmCut cut = {.problem = problem};
  PetscReal *weights;
  signed char *group;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(mesh->num_local, &cut.input, mesh->num_local, &cut.height, 3 * mesh->num_local_cells, &weights,
                         mesh->num_local, &group));
  for (PetscInt v = 0; v < mesh->num_owned; v++) cut.input[v] = mesh->vertex_input[v];
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, cut.input));
  PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_UNIFORM, NULL, weights));
  PetscCall(ComputeHeight(&cut, weights, group));
  PetscCall(ChooseLevel(&cut, found));
  if (*found) PetscCall(EqmHemispheresMap(&cut, kind, iterate, group));
  PetscCall(PetscFree(cut.crossing));
  PetscCall(PetscFree4(cut.input, cut.height, weights, group));
  PetscFunctionReturn(0);
}

/* Fixed-point steps, and unfolding. */
static PetscErrorCode Run(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  PetscReal *weights;
  PetscBool found;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * problem->mesh->num_local_cells, &weights));
  PetscCall(EqmSphereTutte(problem, iterate, options->hemisphere_weights, &found));
  if (!found) {
    EqmFail(problem->comm, EQM_ERR_MESH,
            "-start tutte: no closed curve was found that cuts the surface in two disks; leave -start out");
  }
  for (PetscInt k = 0; k < options->steps; k++) PetscCall(EqmSphereFixedPointStep(problem, iterate, k, weights));
  PetscCall(EqmSphereUnfoldFirstMap(problem, iterate));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartSphereTutte = {EQM_STARTS_SPHERE, "tutte",
                                          "two hemispheres, each by -start_weights, and unfolding (004 section 5.1)", 0,
                                          Run};
