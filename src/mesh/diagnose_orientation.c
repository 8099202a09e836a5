/* Can all triangles be turned the same way round, and which must be turned for that? */
#include "mesh/diagnose.h"
#include "base/exchange.h"

/* Orient the triangles through the edges that two of them share. Per cell: `label`, the lowest input number of the
   cells that can be reached, `turned`, whether it runs the other way round than that one, and `conflict`, set for some
   cells where going round comes back turned: their component is not orientable. Collective. */
PetscErrorCode EqmVicinityOrient(const EqmVicinity *vicinity, PetscInt *label, PetscBool *turned, PetscBool *conflict)
{
  EqmForest forest;
  EqmLink link;
  PetscSF sf = NULL;

  PetscFunctionBegin;
  PetscCall(EqmForestCreate(vicinity->num_cells, &forest));
  PetscCall(EqmLinkCreate(vicinity, &link));
  PetscCall(PetscArrayzero(conflict, vicinity->num_cells));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    EqmLinkCompute(vicinity, v, &link);
    for (PetscInt i = 0; i < link.num_vertices; i++) {
      const PetscInt *const cell = link.edge_cell + 2 * i;
      const PetscBool against = (PetscBool)(link.leaving[i] != 1);

      if (link.leaving[i] + link.entering[i] != 2) continue;
      if (!EqmForestJoin(&forest, cell[0], cell[1], against)) conflict[cell[0]] = PETSC_TRUE;
    }
  }
  PetscCall(EqmLinkReset(&link));
  if (vicinity->size > 1) PetscCall(EqmVicinityCellSF(vicinity, &sf));
  PetscCall(EqmForestLabel(vicinity->comm, sf, &forest, vicinity->cell_input, label, turned, conflict));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(EqmForestReset(&forest));
  PetscFunctionReturn(0);
}

/* Find the pieces of a triangle mesh that cannot be oriented: `where` is the lowest cell of each. The findings are this
   rank's, not yet merged. Collective. */
PetscErrorCode EqmDiagnoseOrientation(const EqmVicinity *vicinity, EqmFinding *finding)
{
  PetscInt *label, count = 0, num_received, *received;
  PetscBool *turned, *conflict;
  PetscMPIInt *destination;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(vicinity->num_cells, &label, vicinity->num_cells, &turned, vicinity->num_cells, &conflict,
                         vicinity->num_cells, &destination));
  PetscCall(EqmVicinityOrient(vicinity, label, turned, conflict));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    if (conflict[c]) label[count++] = label[c];
  }
  PetscCall(PetscSortRemoveDupsInt(&count, label));
  for (PetscInt k = 0; k < count; k++) destination[k] = (PetscMPIInt)(label[k] % vicinity->size);
  PetscCall(EqmExchange(vicinity->comm, count, 1, destination, label, &num_received, &received));
  PetscCall(PetscSortRemoveDupsInt(&num_received, received));
  for (PetscInt k = 0; k < num_received; k++) EqmFindingAdd(finding, received[k], -1, -1, -1);
  PetscCall(PetscFree(received));
  PetscCall(PetscFree4(label, turned, conflict, destination));
  PetscFunctionReturn(0);
}
