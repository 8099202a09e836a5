#include "base/rows.h"

PetscErrorCode EqmRowsOfToLeaves(PetscSF sf, MPI_Datatype unit, PetscInt width, const void *roots, void *leaves)
{
  MPI_Datatype row;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)width, unit, &row));
  PetscCallMPI(MPI_Type_commit(&row));
  PetscCall(PetscSFBcastBegin(sf, row, roots, leaves, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, row, roots, leaves, MPI_REPLACE));
  PetscCallMPI(MPI_Type_free(&row));
  PetscFunctionReturn(0);
}

static PetscErrorCode ToRoots(PetscSF sf, MPI_Datatype unit, PetscInt width, const void *leaves, void *roots)
{
  MPI_Datatype row;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)width, unit, &row));
  PetscCallMPI(MPI_Type_commit(&row));
  PetscCall(PetscSFReduceBegin(sf, row, leaves, roots, MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(sf, row, leaves, roots, MPI_REPLACE));
  PetscCallMPI(MPI_Type_free(&row));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRowsToLeaves(PetscSF sf, PetscInt width, const PetscReal *roots, PetscReal *leaves)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsOfToLeaves(sf, MPIU_REAL, width, roots, leaves));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRowsToRoots(PetscSF sf, PetscInt width, const PetscReal *leaves, PetscReal *roots)
{
  PetscFunctionBegin;
  PetscCall(ToRoots(sf, MPIU_REAL, width, leaves, roots));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRowsCreateSF(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers, PetscSF *sf)
{
  PetscLayout layout;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(comm, count, PETSC_DETERMINE, 1, &layout));
  PetscCall(PetscSFCreate(comm, sf));
  PetscCall(PetscSFSetGraphLayout(*sf, layout, num, NULL, PETSC_COPY_VALUES, numbers));
  PetscCall(PetscSFSetUp(*sf));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFetchRows(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers, MPI_Datatype unit,
                            PetscInt width, const void *slab, void *rows)
{
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(EqmRowsCreateSF(comm, count, num, numbers, &sf));
  PetscCall(EqmRowsOfToLeaves(sf, unit, width, slab, rows));
  PetscCall(PetscSFDestroy(&sf));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFetchSlab(MPI_Comm comm, PetscInt count, PetscInt num, PetscInt start, MPI_Datatype unit,
                            PetscInt width, const void *slab, void *rows)
{
  PetscInt *numbers;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num, &numbers));
  for (PetscInt i = 0; i < num; i++) numbers[i] = start + i;
  PetscCall(EqmFetchRows(comm, count, num, numbers, unit, width, slab, rows));
  PetscCall(PetscFree(numbers));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPutRows(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers, MPI_Datatype unit,
                          PetscInt width, const void *rows, void *slab)
{
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(EqmRowsCreateSF(comm, count, num, numbers, &sf));
  PetscCall(ToRoots(sf, unit, width, rows, slab));
  PetscCall(PetscSFDestroy(&sf));
  PetscFunctionReturn(0);
}
