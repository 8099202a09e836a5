/* A program that uses the installed library: generate a spherical cap, map it to the disk through the C API, check the
   energy. Lambert's azimuthal map of the smooth cap keeps area exactly, so what is left comes from the mesh alone. */
#include <equimap.h>

static PetscErrorCode MapCap(PetscReal *initial, PetscReal *final, PetscInt64 *folds)
{
  EqmLedger ledger;
  EqmSoup soup;
  EqmMesh mesh;
  EqmSolver solver;
  EqmMap map;
  const EqmDistortion *distortion;

  PetscFunctionBegin;
  PetscCall(EqmLedgerCreate(PETSC_COMM_WORLD, &ledger));
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "cap", 2000, 1, &soup));
  PetscCall(EqmMeshCreate(soup, ledger, &mesh));
  PetscCall(EqmSolverCreate(mesh, "disk", &solver));
  PetscCall(EqmSolverSetFromOptions(solver));
  PetscCall(EqmSolverSolve(solver));
  PetscCall(EqmSolverGetMap(solver, soup, &map));
  PetscCall(EqmMapGetEnergies(map, initial, final));
  PetscCall(EqmMapGetDistortion(map, &distortion));
  *folds = distortion->folds;
  PetscCall(EqmMapDestroy(&map));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(EqmMeshDestroy(&mesh));
  PetscCall(EqmSoupDestroy(&soup));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscReal initial, final;
  PetscInt64 folds;
  PetscBool fine;

  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(MapCap(&initial, &final, &folds));
  fine = (PetscBool)(final >= 0.0 && final < 1e-2 * initial && folds == 0);
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "equimap %s: energy %.3e -> %.3e, %d folds: %s\n", EqmVersion(),
                        (double)initial, (double) final, (int)folds, fine ? "fine" : "WRONG"));
  PetscCall(EqmFinalize());
  return fine ? 0 : 1;
}
