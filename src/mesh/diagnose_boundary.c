/* The boundary: its loops (of a solid: its surfaces), chords between its vertices, cells without an interior vertex. */
#include "mesh/diagnose.h"

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

/* Fill in what the boundary tells: its loops or surfaces (in `finding[EQM_FINDING_HOLES]` one vertex of each, counted
   all), chords, cells without an interior vertex. `on_boundary` tells of all local vertices. The findings are this
   rank's, not yet merged. Collective. */
PetscErrorCode EqmDiagnoseBoundary(const EqmVicinity *vicinity, const PetscBool *on_boundary, EqmDiagnosis *diagnosis)
{
  EqmFinding *const finding = diagnosis->finding;
  EqmForest forest;
  PetscInt *label;

  PetscFunctionBegin;
  PetscCall(EqmForestCreate(vicinity->num_local, &forest));
  PetscCall(WalkBoundary(vicinity, on_boundary, &forest, &finding[EQM_FINDING_CHORD]));
  PetscCall(PetscMalloc1(vicinity->num_local, &label));
  PetscCall(EqmForestLabel(vicinity->comm, vicinity->ghosts, &forest, vicinity->input, label, NULL, NULL));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    if (on_boundary[v] && label[v] == vicinity->input[v]) {
      EqmFindingAdd(&finding[EQM_FINDING_HOLES], label[v], -1, -1, -1);
    }
  }
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
