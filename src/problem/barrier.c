/* Folds of maps to the ball: a barrier beside the isovolumetric energy, after Garanzha, Kaporin, Kudryavtseva,
   Protais, Ray and Sokolov, Foldover-free maps in 50 lines of code (2021):

       T mean [ lambda (1 + J^2) / (2 chi) + sigma |F|^2 / (3 chi^(2/3)) ],   chi = (J + sqrt(eps^2 + J^2)) / 2

   over the cells, J the ratio of a cell's volume to what it should be and F the derivative of the map from its shape;
   and the first term over the cells between the centre and each boundary triangle, which keeps the boundary's own map
   unfolded. T is the target's measure. Every cell counts alike: by volume, slivers would be given up. With eps -> 0
   what is folded costs ever more, what is not folded stays so. */
#include "problem/barrier.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"

/* Each facet's share of the surface; its owner, that of its lowest vertex, adds it up. */
static PetscErrorCode MeasureFacets(EqmBarrier barrier, EqmMesh mesh)
{
  PetscReal area = 0.;
  PetscInt count = 0;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    const PetscInt *const v = mesh->boundary_facets + 3 * f;
    PetscInt lowest = v[0];
    for (PetscInt a = 1; a < 3; a++) lowest = mesh->global[v[a]] < mesh->global[lowest] ? v[a] : lowest;
    barrier->counts[f] = (PetscBool)(lowest < mesh->num_owned);
    barrier->share[f] = EqmArea3(mesh->position + 3 * v[0], mesh->position + 3 * v[1], mesh->position + 3 * v[2]);
    if (!barrier->counts[f]) continue;
    area += barrier->share[f];
    count++;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &area, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscCall(MPIU_Allreduce(&count, &barrier->num_facets, 1, MPIU_INT, MPI_SUM, mesh->comm));
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) barrier->share[f] /= area;
  PetscFunctionReturn(0);
}

/* Which facets belong to a cell: a facet's place in the file says which cell and face it is. */
static PetscErrorCode FindFacets(EqmBarrier barrier, EqmMesh mesh)
{
  const PetscInt n = mesh->num_local_cells;
  PetscInt *input, *cell;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &input, n, &cell));
  for (PetscInt c = 0; c < n; c++) {
    input[c] = mesh->cell_input[c];
    cell[c] = c;
  }
  PetscCall(PetscSortIntWithArray(n, input, cell));
  for (PetscInt k = 0; k < 4 * n; k++) barrier->facet_of[k] = -1;
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    PetscInt place;
    PetscCall(PetscFindInt((PetscInt)(mesh->boundary_order[f] % mesh->num_cells), n, input, &place));
    barrier->facet_of[4 * cell[place] + mesh->boundary_order[f] / mesh->num_cells] = f;
  }
  PetscCall(PetscFree2(input, cell));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBarrierDestroy(EqmBarrier *barrier)
{
  PetscFunctionBegin;
  if (!*barrier) PetscFunctionReturn(0);
  PetscCall(PetscFree3((*barrier)->share, (*barrier)->counts, (*barrier)->facet_of));
  PetscCall(PetscFree5((*barrier)->edge, (*barrier)->flow, (*barrier)->slope, (*barrier)->ambient, (*barrier)->part));
  PetscCall(PetscFree(*barrier));
  PetscFunctionReturn(0);
}

/* Cells: the value, slopes by the volumes and by the edges. */
static PetscReal AddCells(EqmBarrier barrier, EqmMesh mesh, const PetscReal *x, const PetscReal *image)
{
  PetscReal sum = 0.;

  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const EqmBarrierTerm term = EqmBarrierOfCell(barrier, image[c] / (mesh->weight[c] * barrier->total),
                                                 EqmBarrierStretch(barrier, mesh, x, c));
    barrier->slope[c] = term.first / (mesh->weight[c] * mesh->num_cells);
    for (PetscInt e = 0; e < 6; e++)
      barrier->flow[6 * c + e] = 2. * barrier->total * term.by_stretch * barrier->edge[6 * c + e] / mesh->num_cells;
    if (c < mesh->num_owned_cells) sum += term.value;
  }
  return sum / mesh->num_cells;
}

/* The cells between the centre and the boundary's triangles. */
static PetscReal SumBoundary(EqmBarrier barrier, EqmMesh mesh, const PetscReal *x)
{
  PetscReal sum = 0.;

  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    if (barrier->counts[f]) sum += EqmBarrierOfCell(barrier, EqmBarrierFacetRatio(barrier, mesh, x, f), 0.).value;
  }
  return sum / barrier->num_facets;
}

/* Their gradients at owned vertices. */
static void AddBoundaryGradient(EqmBarrier barrier, EqmMesh mesh, const PetscReal *x, PetscReal *ambient)
{
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    const PetscInt *const v = mesh->boundary_facets + 3 * f;
    const EqmBarrierTerm term = EqmBarrierOfCell(barrier, EqmBarrierFacetRatio(barrier, mesh, x, f), 0.);
    for (PetscInt a = 0; a < 3; a++) {
      PetscReal normal[3];
      if (v[a] >= mesh->num_owned) continue;
      EqmBarrierFacetNormal(barrier, mesh, x, f, a, normal);
      for (PetscInt k = 0; k < 3; k++)
        ambient[3 * v[a] + k] += term.first * normal[k] / (6. * barrier->share[f] * barrier->num_facets);
    }
  }
}

static PetscErrorCode Add(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                          PetscReal *value, Vec gradient)
{
  const EqmMesh mesh = problem->mesh;
  const EqmBarrier barrier = (EqmBarrier)term;
  PetscReal local, sum;

  PetscFunctionBegin;
  local = AddCells(barrier, mesh, place->x, image) + SumBoundary(barrier, mesh, place->x);
  PetscCall(MPIU_Allreduce(&local, &sum, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  *value += barrier->total * sum;
  if (!gradient) PetscFunctionReturn(0);
  PetscCall(EqmImageGradient(problem->domain, place, barrier->slope, barrier->ambient));
  PetscCall(EqmLaplacianApply(mesh, barrier->flow, 3, place->x, barrier->part));
  for (PetscInt k = 0; k < 3 * mesh->num_owned; k++) barrier->ambient[k] += barrier->part[k];
  AddBoundaryGradient(barrier, mesh, place->x, barrier->ambient);
  PetscCall(EqmDomainAddProjected(problem->domain, place, barrier->ambient, gradient));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBarrierCreate(EqmProblem problem, const EqmPlace *place, EqmBarrier *out)
{
  const EqmMesh mesh = problem->mesh;
  const PetscInt n = mesh->num_local_cells;
  EqmBarrier barrier;

  PetscFunctionBegin;
  PetscCall(PetscNew(&barrier));
  barrier->term = (struct _p_EqmTerm){.name = "barrier", .weight = 1., .add = Add, .add_matrix = EqmBarrierAddMatrix};
  barrier->total = problem->domain->target_measure;
  PetscCall(PetscArraycpy(barrier->center, problem->domain->center, 3));
  PetscCall(PetscMalloc3(mesh->num_boundary_facets, &barrier->share, mesh->num_boundary_facets, &barrier->counts, 4 * n,
                         &barrier->facet_of));
  PetscCall(PetscMalloc5(6 * n, &barrier->edge, 6 * n, &barrier->flow, n, &barrier->slope, 3 * mesh->num_owned,
                         &barrier->ambient, 3 * mesh->num_owned, &barrier->part));
  PetscCall(MeasureFacets(barrier, mesh));
  PetscCall(FindFacets(barrier, mesh));
  PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_COTANGENT, place, barrier->edge));
  for (PetscInt c = 0; c < n; c++) {
    const PetscReal length = PetscPowReal(mesh->weight[c] * barrier->total / mesh->cell_measure[c], 1. / 3.);
    for (PetscInt e = 0; e < 6; e++) barrier->edge[6 * c + e] /= mesh->cell_measure[c] * PetscSqr(length);
  }
  *out = barrier;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBarrierInspect(EqmBarrier barrier, EqmProblem problem, EqmIterate iterate, PetscReal *least,
                                 PetscInt64 *folds)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal smallest = INFINITY;
  PetscInt64 count = 0;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    smallest = PetscMin(smallest, iterate->image[c] / (mesh->weight[c] * barrier->total));
    count += !(iterate->image[c] > 0.);
  }
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    const PetscReal ratio = EqmBarrierFacetRatio(barrier, mesh, iterate->place.x, f);
    smallest = PetscMin(smallest, ratio);
    count += barrier->counts[f] && !(ratio > 0.);
  }
  PetscCall(MPIU_Allreduce(&smallest, least, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  PetscCall(MPIU_Allreduce(&count, folds, 1, MPIU_INT64, MPI_SUM, mesh->comm));
  PetscFunctionReturn(0);
}
