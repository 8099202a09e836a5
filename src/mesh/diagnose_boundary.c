/* The boundary: its loops (of a solid: its surfaces), chords between its vertices, cells without an interior vertex. */
#include "mesh/diagnose.h"
#include "base/rows.h"

/* Bring flags of the owned vertices to the ghosts. Collective. */
PetscErrorCode EqmVicinityShareFlags(const EqmVicinity *vicinity, PetscBool *flag)
{
  PetscFunctionBegin;
  PetscCall(PetscSFBcastBegin(vicinity->ghosts, MPIU_BOOL, flag, flag, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(vicinity->ghosts, MPIU_BOOL, flag, flag, MPI_REPLACE));
  PetscFunctionReturn(0);
}

/* Mark the boundary vertices among all local ones. Collective. */
PetscErrorCode EqmVicinityMarkBoundary(const EqmVicinity *vicinity, PetscBool *on_boundary)
{
  EqmLink link;

  PetscFunctionBegin;
  PetscCall(EqmLinkCreate(vicinity, &link));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    EqmLinkCompute(vicinity, v, &link);
    on_boundary[v] = PETSC_FALSE;
    for (PetscInt i = 0; i < link.num_vertices; i++) {
      on_boundary[v] = (PetscBool)(on_boundary[v] || link.on_boundary[i]);
    }
  }
  PetscCall(EqmLinkReset(&link));
  PetscCall(EqmVicinityShareFlags(vicinity, on_boundary));
  PetscFunctionReturn(0);
}

/* Join the boundary vertices along boundary edges, and note chords. */
static PetscErrorCode WalkBoundary(const EqmVicinity *vicinity, const PetscBool *on_boundary, EqmForest *forest,
                                   EqmFinding *chord)
{
  EqmLink link;

  PetscFunctionBegin;
  PetscCall(EqmLinkCreate(vicinity, &link));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    if (!on_boundary[v]) continue;
    EqmLinkCompute(vicinity, v, &link);
    for (PetscInt i = 0; i < link.num_vertices; i++) {
      const PetscInt w = link.vertex[i];

      if (link.on_boundary[i])
        (void)EqmForestJoin(forest, v, w, PETSC_FALSE);
      else if (on_boundary[w] && vicinity->input[v] < vicinity->input[w]) {
        EqmFindingAdd(chord, vicinity->input[v], vicinity->input[w], -1, -1);
      }
    }
  }
  PetscCall(EqmLinkReset(&link));
  PetscFunctionReturn(0);
}

/* Count the loops, and note those of pieces that have several: all but one of these are holes. `loop` (the loop's
   lowest vertex) and `component` (the piece's) are labels per local vertex. Collective. */
static PetscErrorCode CountLoops(const EqmVicinity *vicinity, const PetscBool *on_boundary, const PetscInt *loop,
                                 const PetscInt *component, EqmDiagnosis *diagnosis)
{
  EqmFinding *const holes = &diagnosis->finding[EQM_FINDING_HOLES];
  PetscInt num_loops = 0, *piece, *one, *loops_of_piece;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(vicinity->num_owned, &piece, vicinity->num_owned, &one));
  PetscCall(PetscCalloc1(vicinity->num_owned, &loops_of_piece));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    if (!on_boundary[v] || loop[v] != vicinity->input[v]) continue;
    one[num_loops] = 1;
    piece[num_loops++] = component[v];
  }
  PetscCall(EqmRowsCreateSF(vicinity->comm, vicinity->num_owned, num_loops, piece, &sf));
  PetscCall(PetscSFReduceBegin(sf, MPIU_INT, one, loops_of_piece, MPI_SUM));
  PetscCall(PetscSFReduceEnd(sf, MPIU_INT, one, loops_of_piece, MPI_SUM));
  PetscCall(PetscSFBcastBegin(sf, MPIU_INT, loops_of_piece, one, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, MPIU_INT, loops_of_piece, one, MPI_REPLACE));
  PetscCall(PetscSFDestroy(&sf));
  diagnosis->num_boundary_loops = num_loops;
  num_loops = 0;
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    if (loops_of_piece[v] > 1) holes->count--; /* the outer one */
    if (!on_boundary[v] || loop[v] != vicinity->input[v]) continue;
    if (one[num_loops++] > 1) EqmFindingAdd(holes, loop[v], -1, -1, -1);
  }
  PetscCall(PetscFree2(piece, one));
  PetscCall(PetscFree(loops_of_piece));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &diagnosis->num_boundary_loops, 1, MPIU_INT64, MPI_SUM, vicinity->comm));
  PetscFunctionReturn(0);
}

/* Fill in what the boundary shows: the number of its loops or surfaces, holes (`finding[EQM_FINDING_HOLES]`: one vertex
   of every loop of the pieces that have several), chords, cells without an interior vertex. `on_boundary` and
   `component` (label of the piece) are given for all local vertices. The findings are this rank's, not yet merged.
   Collective. */
PetscErrorCode EqmDiagnoseBoundary(const EqmVicinity *vicinity, const PetscBool *on_boundary, const PetscInt *component,
                                   EqmDiagnosis *diagnosis)
{
  EqmFinding *const finding = diagnosis->finding;
  EqmForest forest;
  PetscInt *label;

  PetscFunctionBegin;
  PetscCall(EqmForestCreate(vicinity->num_local, &forest));
  PetscCall(WalkBoundary(vicinity, on_boundary, &forest, &finding[EQM_FINDING_CHORD]));
  PetscCall(PetscMalloc1(vicinity->num_local, &label));
  PetscCall(EqmForestLabel(vicinity->comm, vicinity->ghosts, &forest, vicinity->input, label, NULL, NULL));
  PetscCall(CountLoops(vicinity, on_boundary, label, component, diagnosis));
  PetscCall(PetscFree(label));
  PetscCall(EqmForestReset(&forest));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    PetscBool interior = PETSC_FALSE;

    if (EqmVicinityCellOwnerVertex(vicinity, c) >= vicinity->num_owned) continue;
    for (PetscInt a = 0; a < vicinity->cell_size; a++) {
      interior = (PetscBool)(interior || !on_boundary[vicinity->cells[vicinity->cell_size * c + a]]);
    }
    if (!interior) EqmFindingAdd(&finding[EQM_FINDING_NO_INTERIOR_VERTEX], vicinity->cell_input[c], -1, -1, -1);
  }
  PetscFunctionReturn(0);
}
