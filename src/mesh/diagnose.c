/* What is this mesh, and what is wrong with it? */
#include "mesh/diagnose.h"
#include "mesh/soup_private.h"

/* Sums over all vertices' links. */
typedef struct {
  PetscInt64 vertices, edges, faces, cells; /* in use */
  PetscInt64 boundary_vertices, boundary_edges, boundary_faces;
} Counts;

static void CountTriangleEdges(const EqmVicinity *vicinity, PetscInt v, const EqmLink *link, EqmFinding *finding,
                               Counts *counts)
{
  for (PetscInt i = 0; i < link->num_vertices; i++) {
    const PetscInt cells = link->leaving[i] + link->entering[i];
    const PetscInt a = vicinity->input[v], b = vicinity->input[link->vertex[i]];

    if (b < a) continue;
    counts->edges++;
    if (cells == 1) counts->boundary_edges++;
    if (cells > 2) EqmFindingAdd(&finding[EQM_FINDING_NON_MANIFOLD_EDGE], a, b, -1, -1);
    if (cells == 2 && link->leaving[i] != 1) {
      EqmFindingAdd(&finding[EQM_FINDING_INCONSISTENT_ORIENTATION], a, b, -1, -1);
    }
  }
}

static void CountTetrahedronFaces(const EqmVicinity *vicinity, PetscInt v, const EqmLink *link, EqmFinding *finding,
                                  Counts *counts)
{
  const PetscInt a = vicinity->input[v];

  for (PetscInt i = 0; i < link->num_vertices; i++) {
    if (vicinity->input[link->vertex[i]] < a) continue;
    counts->edges++;
    if (link->on_boundary[i]) counts->boundary_edges++;
  }
  for (PetscInt e = 0; e < link->num_edges; e++) {
    const PetscInt b = vicinity->input[link->vertex[link->edge[2 * e]]];
    const PetscInt c = vicinity->input[link->vertex[link->edge[2 * e + 1]]];

    if (b < a || c < a) continue;
    counts->faces++;
    if (link->edge_count[e] == 1) counts->boundary_faces++;
    if (link->edge_count[e] > 2) {
      EqmFindingAdd(&finding[EQM_FINDING_NON_MANIFOLD_EDGE], a, PetscMin(b, c), PetscMax(b, c), -1);
    }
    if (link->edge_count[e] == 2 && PetscAbsInt(link->edge_sides[e]) == 2) {
      EqmFindingAdd(&finding[EQM_FINDING_OVERLAP], a, PetscMin(b, c), PetscMax(b, c), -1);
    }
  }
}

/* Also marks the boundary vertices among the owned ones. */
static PetscErrorCode DiagnoseLinks(const EqmVicinity *vicinity, PetscBool *on_boundary, EqmFinding *finding,
                                    Counts *counts)
{
  EqmLink link;

  PetscFunctionBegin;
  PetscCall(EqmLinkCreate(vicinity, &link));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    on_boundary[v] = PETSC_FALSE;
    EqmLinkCompute(vicinity, v, &link);
    if (!link.num_vertices) {
      EqmFindingAdd(&finding[EQM_FINDING_UNREFERENCED], vicinity->input[v], -1, -1, -1);
      continue;
    }
    counts->vertices++;
    if (vicinity->cell_size == 3)
      CountTriangleEdges(vicinity, v, &link, finding, counts);
    else
      CountTetrahedronFaces(vicinity, v, &link, finding, counts);
    /* where an edge has too many cells, its ends cannot be regular: that is reported of the edge alone */
    if (link.manifold && !link.regular) {
      EqmFindingAdd(&finding[EQM_FINDING_NON_MANIFOLD_VERTEX], vicinity->input[v], -1, -1, -1);
    }
    for (PetscInt i = 0; i < link.num_vertices && !on_boundary[v]; i++) on_boundary[v] = link.on_boundary[i];
    if (on_boundary[v]) counts->boundary_vertices++;
  }
  PetscCall(EqmLinkReset(&link));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    if (EqmVicinityCellOwnerVertex(vicinity, c) < vicinity->num_owned) counts->cells++;
  }
  if (vicinity->cell_size == 3) counts->faces = counts->cells;
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, counts, sizeof(*counts) / sizeof(PetscInt64), MPIU_INT64, MPI_SUM, vicinity->comm));
  PetscFunctionReturn(0);
}

/* Label all local vertices by the lowest input number of their connected component. Collective. */
PetscErrorCode EqmVicinityLabelComponents(const EqmVicinity *vicinity, PetscInt *label)
{
  const PetscInt cs = vicinity->cell_size;
  EqmForest forest;

  PetscFunctionBegin;
  PetscCall(EqmForestCreate(vicinity->num_local, &forest));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    for (PetscInt a = 1; a < cs; a++) {
      (void)EqmForestJoin(&forest, vicinity->cells[cs * c], vicinity->cells[cs * c + a], PETSC_FALSE);
    }
  }
  PetscCall(EqmForestLabel(vicinity->comm, vicinity->ghosts, &forest, vicinity->input, label, NULL, NULL));
  PetscCall(EqmForestReset(&forest));
  PetscFunctionReturn(0);
}

/* One vertex of every connected component, by a finding each. */
static PetscErrorCode DiagnoseComponents(const EqmVicinity *vicinity, PetscInt *label, EqmFinding *finding)
{
  PetscFunctionBegin;
  PetscCall(EqmVicinityLabelComponents(vicinity, label));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    const PetscBool in_use = (PetscBool)(vicinity->star_start[v] < vicinity->star_start[v + 1]);

    if (in_use && label[v] == vicinity->input[v]) EqmFindingAdd(finding, label[v], -1, -1, -1);
  }
  PetscFunctionReturn(0);
}

/* Twins are noted and left out of everything that follows. */
static PetscErrorCode DiagnoseDuplicateCells(EqmVicinity *vicinity, EqmFinding *finding)
{
  PetscInt *first;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(vicinity->num_cells, &first));
  PetscCall(EqmVicinityFindDuplicates(vicinity, first));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    if (first[c] == c || EqmVicinityCellOwnerVertex(vicinity, c) >= vicinity->num_owned) continue;
    EqmFindingAdd(finding, vicinity->cell_input[c], vicinity->cell_input[first[c]], -1, -1);
  }
  PetscCall(EqmVicinityDropDuplicates(vicinity, first));
  PetscCall(PetscFree(first));
  PetscFunctionReturn(0);
}

static PetscErrorCode DiagnoseVicinity(EqmVicinity *vicinity, EqmDiagnosis *diagnosis, Counts *counts)
{
  EqmFinding *const finding = diagnosis->finding;
  PetscBool *on_boundary;
  PetscInt *component;
  PetscInt64 inconsistent;

  PetscFunctionBegin;
  PetscCall(EqmDiagnoseDuplicateVertices(vicinity, &finding[EQM_FINDING_DUPLICATE_VERTEX]));
  PetscCall(PetscMalloc2(vicinity->num_local, &on_boundary, vicinity->num_local, &component));
  PetscCall(DiagnoseLinks(vicinity, on_boundary, finding, counts));
  PetscCall(DiagnoseComponents(vicinity, component, &finding[EQM_FINDING_COMPONENTS]));
  if (counts->boundary_edges) {
    PetscCall(EqmVicinityShareFlags(vicinity, on_boundary));
    PetscCall(EqmDiagnoseBoundary(vicinity, on_boundary, component, diagnosis));
  }
  PetscCall(PetscFree2(on_boundary, component));
  inconsistent = finding[EQM_FINDING_INCONSISTENT_ORIENTATION].count;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &inconsistent, 1, MPIU_INT64, MPI_SUM, vicinity->comm));
  if (vicinity->cell_size == 3 && inconsistent) {
    PetscCall(EqmDiagnoseOrientation(vicinity, &finding[EQM_FINDING_NOT_ORIENTABLE]));
  }
  PetscFunctionReturn(0);
}

/* Genus, from Euler's formula; of a solid: of its boundary. */
static PetscInt64 Genus(const EqmDiagnosis *diagnosis, const Counts *counts)
{
  const EqmFinding *const finding = diagnosis->finding;
  PetscInt64 twice;

  if (finding[EQM_FINDING_NON_MANIFOLD_EDGE].count || finding[EQM_FINDING_NON_MANIFOLD_VERTEX].count ||
      finding[EQM_FINDING_NOT_ORIENTABLE].count || !counts->cells) {
    return -1;
  }
  if (diagnosis->cell_size == 3) {
    twice = 2 * diagnosis->num_components - diagnosis->num_boundary_loops - diagnosis->euler_characteristic;
  } else {
    twice = 2 * diagnosis->num_boundary_loops -
            (counts->boundary_vertices - counts->boundary_edges + counts->boundary_faces);
  }
  return twice / 2;
}

static EqmTopology Classify(const EqmDiagnosis *diagnosis)
{
  if (diagnosis->genus != 0 || diagnosis->num_components != 1) return EQM_TOPOLOGY_OTHER;
  if (diagnosis->cell_size == 4) {
    return diagnosis->num_boundary_loops == 1 && diagnosis->euler_characteristic == 1 ? EQM_TOPOLOGY_BALL
                                                                                      : EQM_TOPOLOGY_OTHER;
  }
  if (diagnosis->num_boundary_loops > 1) return EQM_TOPOLOGY_OTHER;
  return diagnosis->num_boundary_loops == 1 ? EQM_TOPOLOGY_DISK : EQM_TOPOLOGY_SPHERE;
}

/* From counts and merged findings to what the mesh is. */
static void Conclude(const EqmSoup soup, const Counts *counts, EqmDiagnosis *diagnosis)
{
  EqmFinding *const finding = diagnosis->finding;

  diagnosis->cell_size = soup->cell_size;
  diagnosis->num_vertices = soup->num_vertices;
  diagnosis->num_cells = soup->num_cells;
  diagnosis->num_edges = counts->edges;
  diagnosis->num_faces = counts->faces;
  diagnosis->num_boundary_vertices = counts->boundary_vertices;
  diagnosis->num_boundary_edges = counts->boundary_edges;
  diagnosis->num_components = finding[EQM_FINDING_COMPONENTS].count;
  diagnosis->euler_characteristic = counts->vertices - counts->edges + counts->faces;
  if (soup->cell_size == 4) diagnosis->euler_characteristic -= counts->cells;
  diagnosis->genus = Genus(diagnosis, counts);
  diagnosis->topology = Classify(diagnosis);

  if (diagnosis->num_components <= 1) finding[EQM_FINDING_COMPONENTS] = (EqmFinding){0}; /* one piece is no finding */
  if (diagnosis->genus > 0) finding[EQM_FINDING_GENUS].count = diagnosis->genus;
  if (soup->cell_size == 3 && counts->cells) {
    finding[EQM_FINDING_CLOSED].count = counts->boundary_edges ? 0 : 1;
    finding[EQM_FINDING_OPEN].count = diagnosis->num_boundary_loops;
  }
}

PetscErrorCode EqmSoupDiagnose(EqmSoup soup, EqmDiagnosis *diagnosis)
{
  EqmVicinity vicinity;
  Counts counts = {0};

  PetscFunctionBegin;
  PetscCall(PetscMemzero(diagnosis, sizeof(*diagnosis)));
  PetscCall(EqmVicinityCreate(soup, &vicinity));
  PetscCall(DiagnoseDuplicateCells(&vicinity, &diagnosis->finding[EQM_FINDING_DUPLICATE_CELL]));
  PetscCall(EqmDiagnoseCells(soup, &vicinity, diagnosis));
  PetscCall(DiagnoseVicinity(&vicinity, diagnosis, &counts));
  PetscCall(EqmVicinityReset(&vicinity));
  PetscCall(EqmFindingsMerge(soup->comm, EQM_NUM_FINDINGS, diagnosis->finding));
  Conclude(soup, &counts, diagnosis);
  PetscFunctionReturn(0);
}
