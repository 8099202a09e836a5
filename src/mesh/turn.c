/* Which cells to turn over, so that neighbours turn alike. */
#include "mesh/subdivide.h"
#include "mesh/soup_private.h"

/* Which of the oriented pieces' cells are to be turned: the minority of each piece. Votes are counted at the slab that
   holds the cell after which a piece is named. A piece that cannot be oriented stays as it is. */
static PetscErrorCode VoteOnTurning(EqmSoup soup, const EqmVicinity *vicinity, const PetscInt *label, PetscBool *turn,
                                    const PetscBool *conflict)
{
  const PetscInt num_cells = vicinity->num_cells, num_slab = soup->cell_end - soup->cell_start;
  PetscInt *vote, *votes, *spoilt, *spoils;
  PetscLayout layout;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(num_cells, &vote, num_slab, &votes, num_cells, &spoilt, num_slab, &spoils));
  PetscCall(PetscArrayzero(votes, num_slab));
  PetscCall(PetscArrayzero(spoils, num_slab));
  for (PetscInt c = 0; c < num_cells; c++) {
    const PetscBool own = (PetscBool)(EqmVicinityCellOwnerVertex(vicinity, c) < vicinity->num_owned);

    vote[c] = own ? (turn[c] ? 1 : -1) : 0;
    spoilt[c] = conflict[c] ? 1 : 0;
  }
  PetscCall(PetscLayoutCreateFromSizes(soup->comm, num_slab, soup->num_cells, 1, &layout));
  PetscCall(PetscSFCreate(soup->comm, &sf));
  PetscCall(PetscSFSetGraphLayout(sf, layout, num_cells, NULL, PETSC_OWN_POINTER, label));
  PetscCall(PetscSFReduceBegin(sf, MPIU_INT, vote, votes, MPI_SUM));
  PetscCall(PetscSFReduceEnd(sf, MPIU_INT, vote, votes, MPI_SUM));
  PetscCall(PetscSFReduceBegin(sf, MPIU_INT, spoilt, spoils, MPI_MAX));
  PetscCall(PetscSFReduceEnd(sf, MPIU_INT, spoilt, spoils, MPI_MAX));
  PetscCall(PetscSFBcastBegin(sf, MPIU_INT, votes, vote, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, MPIU_INT, votes, vote, MPI_REPLACE));
  PetscCall(PetscSFBcastBegin(sf, MPIU_INT, spoils, spoilt, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, MPIU_INT, spoils, spoilt, MPI_REPLACE));
  for (PetscInt c = 0; c < num_cells; c++) {
    if (spoilt[c])
      turn[c] = PETSC_FALSE;
    else if (vote[c] > 0)
      turn[c] = (PetscBool)!turn[c];
  }
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscCall(PetscFree4(vote, votes, spoilt, spoils));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmVicinityChooseTurns(EqmSoup soup, const EqmVicinity *vicinity, PetscBool *turn)
{
  PetscInt *label;
  PetscBool *conflict;

  PetscFunctionBegin;
  if (vicinity->cell_size == 4) {
    for (PetscInt c = 0; c < vicinity->num_cells; c++) turn[c] = (PetscBool)(vicinity->side[c] < 0);
    PetscFunctionReturn(0);
  }
  PetscCall(PetscMalloc2(vicinity->num_cells, &label, vicinity->num_cells, &conflict));
  PetscCall(EqmVicinityOrient(vicinity, label, turn, conflict));
  PetscCall(VoteOnTurning(soup, vicinity, label, turn, conflict));
  PetscCall(PetscFree2(label, conflict));
  PetscFunctionReturn(0);
}
