/* Maps to the disk whose boundary is held at given angles (-boundary_angles, 000 section 6). */
#include "support/runs.h"
#include "mesh/mesh_private.h"
#include <stdio.h>

/* By the number of ranks: tests on other numbers may run beside this one. */
static char angles[64];

/* Angles that grow with the arc length, not evenly: t + .3 sin t, times `sign`; to a file, as users have them. */
static PetscErrorCode WriteAngles(EqmMesh mesh, PetscReal sign)
{
  PetscReal *angle, *all, *arc;
  PetscInt *order;
  FILE *file;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(mesh->soup_vertices, &angle, mesh->soup_vertices, &all));
  PetscCall(PetscMalloc2(mesh->num_local, &order, mesh->num_local, &arc));
  PetscCall(EqmMeshBoundaryLoop(mesh, order, arc));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscReal t = 2. * PETSC_PI * arc[v];
    if (mesh->on_boundary[v]) angle[mesh->vertex_input[v]] = 10. + sign * (t + .3 * PetscSinReal(t));
  }
  PetscCall(MPIU_Allreduce(angle, all, (PetscMPIInt)mesh->soup_vertices, MPIU_REAL, MPIU_SUM, mesh->comm));
  if (mesh->rank == 0) {
    file = fopen(angles, "w");
    CHECK(file, "cannot write %s", angles);
    fprintf(file, "vertex,angle\n");
    for (PetscInt i = 0; i < mesh->soup_vertices; i++) {
      if (all[i] != 0.) fprintf(file, "%d,%.17g\n", (int)i, (double)all[i]);
    }
    fclose(file);
  }
  PetscCallMPI(MPI_Barrier(mesh->comm));
  PetscCall(PetscFree2(order, arc));
  PetscCall(PetscFree2(angle, all));
  PetscFunctionReturn(0);
}

/* The boundary stays where the file has it, and the area energy falls all the same, without folds: by less than where
   the boundary slides, as the held one has a minimum of its own. */
static PetscErrorCode TestMethod(EqmMesh mesh, const char *method)
{
  char options[128];
  EqmSolver solver;
  EqmDomain domain;
  EqmPlace start;
  const EqmPlace *place;
  const EqmHistoryRow *rows;
  PetscInt num_rows;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), "-max_it 20 -boundary_angles %s -method %s", angles, method));
  PetscCall(TestSolve(mesh, "disk", options, &solver));
  PetscCall(EqmSolverGetDomain(solver, &domain));
  PetscCall(EqmSolverGetPlaces(solver, &place));
  PetscCall(EqmSolverGetHistory(solver, &num_rows, &rows));
  PetscCall(EqmPlaceCreate(domain, &start));
  PetscCall(EqmDomainPlaceBoundary(domain, &start));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    for (PetscInt k = 0; k < 2 && mesh->on_boundary[v]; k++)
      CHECK(place->x[2 * v + k] == start.x[2 * v + k], "%s: a boundary vertex has moved", method);
  }
  CHECK(rows[num_rows - 1].energy < .7 * rows[0].energy, "%s: energy %g, at the start %g", method,
        (double)rows[num_rows - 1].energy, (double)rows[0].energy);
  CHECK(rows[num_rows - 1].folds == 0, "%s: %d folds", method, (int)rows[num_rows - 1].folds);
  PetscCall(EqmPlaceDestroy(&start));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* Against the boundary's direction. */
static PetscErrorCode TestBackwards(EqmMesh mesh)
{
  char text[128];
  PetscOptions options;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(WriteAngles(mesh, -1.));
  PetscCall(PetscSNPrintf(text, sizeof(text), "-quiet -boundary_angles %s", angles));
  PetscCall(TestOptionsBegin(text, &options));
  PetscCall(EqmSolverCreate(mesh, "disk", &solver));
  PetscCall(EqmSolverSetFromOptions(solver));
  CHECK_FAILS(EQM_ERR_USAGE, EqmSolverSetUp(solver));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  TestMesh test;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 400, 3, &test));
  PetscCall(PetscSNPrintf(angles, sizeof(angles), "held_disk_angles.%d.csv", (int)test.mesh->size));
  PetscCall(WriteAngles(test.mesh, 1.));
  PetscCall(TestMethod(test.mesh, "lm"));
  PetscCall(TestMethod(test.mesh, "ncg"));
  PetscCall(TestMethod(test.mesh, "fixed-point"));
  PetscCall(TestBackwards(test.mesh));
  if (test.mesh->rank == 0) (void)remove(angles);
  PetscCall(TestMeshDestroy(&test));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
