/* Equal runs on the same ranks give equal bits: mesh, start, method and history, whoever is first to send. */
#include "support/testing.h"
#include "domain/domain_private.h"

enum { REPETITIONS = 10 };

/* What a run leaves behind. */
typedef struct {
  PetscInt num_places, num_rows;
  PetscReal *places, *figures;
} Trace;

enum { FIGURES = 8 };

static PetscErrorCode Run(const char *shape, PetscInt n, const char *target, const char *options, Trace *trace)
{
  TestMesh test;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 3, &test));
  PetscCall(TestSolve(test.mesh, target, options, &solver));
  trace->num_places = solver->problem->domain->dim * test.mesh->num_owned;
  trace->num_rows = solver->num_history;
  PetscCall(PetscMalloc2(trace->num_places, &trace->places, FIGURES * trace->num_rows, &trace->figures));
  PetscCall(PetscArraycpy(trace->places, solver->iterate->place.x, trace->num_places));
  for (PetscInt k = 0; k < trace->num_rows; k++) {
    const EqmHistoryRow *const row = &solver->history[k];
    const PetscReal figures[FIGURES] = {row->energy,
                                        row->sd,
                                        (PetscReal)row->folds,
                                        row->step,
                                        row->gradient_norm,
                                        (PetscReal)row->work.evaluations,
                                        (PetscReal)row->work.factorizations,
                                        (PetscReal)row->work.solves};
    PetscCall(PetscArraycpy(trace->figures + FIGURES * k, figures, FIGURES));
  }
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestRepeats(const char *shape, PetscInt n, const char *target, const char *options)
{
  Trace first;

  PetscFunctionBegin;
  PetscCall(Run(shape, n, target, options, &first));
  for (PetscInt repetition = 1; repetition < REPETITIONS; repetition++) {
    Trace again;
    PetscBool same = PETSC_FALSE;
    PetscCall(Run(shape, n, target, options, &again));
    CHECK(again.num_rows == first.num_rows && again.num_places == first.num_places, "%s %s: %d iterations, then %d",
          target, options, (int)first.num_rows, (int)again.num_rows);
    PetscCall(PetscArraycmp(again.figures, first.figures, FIGURES * first.num_rows, &same));
    CHECK(same, "%s %s: another history in repetition %d", target, options, (int)repetition);
    PetscCall(PetscArraycmp(again.places, first.places, first.num_places, &same));
    CHECK(same, "%s %s: other places in repetition %d", target, options, (int)repetition);
    PetscCall(PetscFree2(again.places, again.figures));
  }
  PetscCall(PetscFree2(first.places, first.figures));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestRepeats("hills", 700, "disk", "-max_it 3"));
  PetscCall(TestRepeats("hills", 700, "square", "-method ncg -ncg_refresh 4 -max_it 8"));
  PetscCall(TestRepeats("head", 700, "sphere", "-max_it 3"));
  PetscCall(TestRepeats("starfish", 700, "sphere", "-method rgd -max_it 4")); /* folds at the start: unfolding */
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
