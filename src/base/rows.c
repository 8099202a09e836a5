#include "base/rows.h"
#include <petscsf.h>

/* The way between rows by number and slabs, and a whole row as a type. */
static PetscErrorCode Prepare(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers, MPI_Datatype unit,
                              PetscInt width, PetscSF *sf, MPI_Datatype *row)
{
  PetscLayout layout;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(comm, count, PETSC_DETERMINE, 1, &layout));
  PetscCall(PetscSFCreate(comm, sf));
  PetscCall(PetscSFSetGraphLayout(*sf, layout, num, NULL, PETSC_COPY_VALUES, numbers));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)width, unit, row));
  PetscCallMPI(MPI_Type_commit(row));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFetchRows(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers, MPI_Datatype unit,
                            PetscInt width, const void *slab, void *rows)
{
  MPI_Datatype row;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(Prepare(comm, count, num, numbers, unit, width, &sf, &row));
  PetscCall(PetscSFBcastBegin(sf, row, slab, rows, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, row, slab, rows, MPI_REPLACE));
  PetscCallMPI(MPI_Type_free(&row));
  PetscCall(PetscSFDestroy(&sf));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLeaveRows(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers, MPI_Datatype unit,
                            PetscInt width, const void *rows, void *slab)
{
  MPI_Datatype row;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(Prepare(comm, count, num, numbers, unit, width, &sf, &row));
  PetscCall(PetscSFReduceBegin(sf, row, rows, slab, MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(sf, row, rows, slab, MPI_REPLACE));
  PetscCallMPI(MPI_Type_free(&row));
  PetscCall(PetscSFDestroy(&sf));
  PetscFunctionReturn(0);
}
