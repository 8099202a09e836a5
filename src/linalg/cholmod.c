/* CHOLMOD on one rank. */
#include "linalg/linalg.h"
#include "mesh/mesh_private.h"
#include "linalg/cholmod_name.h"
#include <omp.h>

typedef struct {
  cholmod_common common;
  cholmod_sparse view; /* of PETSc's arrays, taken for the time of a call */
  cholmod_factor *factor;
  cholmod_dense *solution, *work_y, *work_e;
} Cholmod;

static PetscErrorCode Analyse(EqmLinear linear, EqmOrdering ordering)
{
  Cholmod *const c = linear->data;
  PetscInt *order;

  PetscFunctionBegin;
  PetscCall(EqmOrderingOfFactor(linear, ordering, &order));
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscCall(EqmCholmodGetView(linear, &c->view));
  c->common.nmethods = 1;
  c->common.method[0].ordering = CHOLMOD_GIVEN;
  c->factor = CHOLMOD(analyze_p)(&c->view, order, NULL, 0, &c->common);
  PetscCall(EqmCholmodRestoreView(linear, &c->view));
  PetscCall(PetscFree(order));
  PetscCheck(c->factor, PETSC_COMM_SELF, PETSC_ERR_MEM,
             "CHOLMOD's analysis failed (status %d): too little memory for this mesh on one rank; use more",
             c->common.status);
  EqmEstimateCholmod(c->factor, &c->common, &linear->estimate);
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscFunctionReturn(0);
}

static PetscErrorCode Factor(EqmLinear linear, PetscBool *success)
{
  Cholmod *const c = linear->data;

  PetscFunctionBegin;
  PetscCall(EqmCholmodGetView(linear, &c->view));
  /* its own team of threads, whose number was fixed when it was built, costs more than it brings */
  const int levels = omp_get_max_active_levels();
  omp_set_max_active_levels(0);
  CHOLMOD(factorize)(&c->view, c->factor, &c->common);
  omp_set_max_active_levels(levels);
  PetscCall(EqmCholmodRestoreView(linear, &c->view));
  PetscCheck(c->common.status >= 0, PETSC_COMM_SELF, PETSC_ERR_MEM,
             "CHOLMOD's factorisation failed (status %d): too little memory for this mesh on one rank; use more",
             c->common.status);
  *success = (PetscBool)(c->common.status == CHOLMOD_OK && c->factor->minor == c->factor->n);
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x, PetscBool *success)
{
  Cholmod *const c = linear->data;
  const size_t n = (size_t)linear->num_unknowns;
  cholmod_dense rhs = {.nrow = n,
                       .ncol = (size_t)num_rhs,
                       .nzmax = n * (size_t)num_rhs,
                       .d = n,
                       .x = (void *)b,
                       .xtype = CHOLMOD_REAL,
                       .dtype = CHOLMOD_DOUBLE};

  PetscFunctionBegin;
  PetscCheck(CHOLMOD(solve2)(CHOLMOD_A, c->factor, &rhs, NULL, &c->solution, NULL, &c->work_y, &c->work_e, &c->common),
             PETSC_COMM_SELF, PETSC_ERR_LIB, "CHOLMOD's solve failed (status %d)", c->common.status);
  PetscCall(PetscArraycpy(x, (PetscReal *)c->solution->x, linear->num_unknowns * num_rhs));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmLinear linear)
{
  Cholmod *const c = linear->data;

  PetscFunctionBegin;
  CHOLMOD(free_factor)(&c->factor, &c->common);
  CHOLMOD(free_dense)(&c->solution, &c->common);
  CHOLMOD(free_dense)(&c->work_y, &c->common);
  CHOLMOD(free_dense)(&c->work_e, &c->common);
  CHOLMOD(finish)(&c->common);
  PetscCall(PetscFree(linear->data));
  PetscFunctionReturn(0);
}

/* Make `linear` one of CHOLMOD's. Not collective: one rank. */
PetscErrorCode EqmLinearSetUpCholmod(EqmLinear linear)
{
  Cholmod *c;

  PetscFunctionBegin;
  PetscCall(PetscNew(&c));
  linear->data = c;
  linear->analyse = Analyse;
  linear->factor = Factor;
  linear->solve = Solve;
  linear->destroy = Destroy;
  CHOLMOD(start)(&c->common);
  c->common.print = 0;
  c->common.supernodal = CHOLMOD_SUPERNODAL;
  c->common.quick_return_if_not_posdef = 1;
  PetscFunctionReturn(0);
}
