/* Solves by substructuring: y = L^-1 (b_I, 0), whose part at the separators times their block of L is -A_SI A_II^-1
   b_I; with x_S from the tree, x = L^-T (y_I, block^T x_S). */
#include "linalg/substructure.h"
#include <petscblaslapack.h>

/* Columns over the separators' unknowns times their block of L, or its transpose; above its diagonal it is zero. */
static PetscErrorCode ApplyBlock(EqmSubstructure *s, const char *transpose, PetscInt num_rhs,
                                 PetscScalar *at_separators)
{
  const PetscScalar one = 1., zero = 0.;
  PetscScalar *copy;
  PetscBLASInt n, many;

  PetscFunctionBegin;
  if (s->num_separator_unknowns == 0) PetscFunctionReturn(0);
  PetscCall(PetscBLASIntCast(s->num_separator_unknowns, &n));
  PetscCall(PetscBLASIntCast(num_rhs, &many));
  PetscCall(PetscMalloc1(s->num_separator_unknowns * num_rhs, &copy));
  PetscCall(PetscArraycpy(copy, at_separators, s->num_separator_unknowns * num_rhs));
  PetscCallBLAS("BLASgemm",
                BLASgemm_(transpose, "N", &n, &many, &n, &one, s->block, &n, copy, &n, &zero, at_separators, &n));
  PetscCall(PetscFree(copy));
  PetscFunctionReturn(0);
}

/* Allocate for that many right-hand sides. */
static PetscErrorCode Reserve(EqmSubstructure *s, PetscInt num_rhs)
{
  PetscFunctionBegin;
  if (s->num_rhs >= num_rhs) PetscFunctionReturn(0);
  PetscCall(PetscFree(s->values));
  PetscCall(PetscMalloc1((s->num_inner + s->num_separator_unknowns) * num_rhs, &s->values));
  s->num_rhs = num_rhs;
  PetscFunctionReturn(0);
}

/* The inner unknowns' part forwards; `at_separators`: what it leaves for them, and their own right-hand sides. */
static PetscErrorCode SolveForward(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscScalar *at_separators)
{
  EqmSubstructure *const s = linear->data;
  const PetscInt separators = s->num_separator_unknowns, n = s->num_inner + separators;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(at_separators, num_rhs * separators));
  if (s->factor) {
    PetscCall(Reserve(s, num_rhs));
    PetscCall(PetscArrayzero(s->values, n * num_rhs));
    for (PetscInt c = 0; c < num_rhs; c++) {
      for (PetscInt i = 0; i < linear->num_owned; i++) {
        if (s->local[i] < s->num_inner) s->values[c * n + s->local[i]] = b[c * linear->num_owned + i];
      }
    }
    PetscCall(EqmFrontalSolve(s->factor, EQM_SOLVE_FORWARD, num_rhs, s->values, s->values));
    for (PetscInt c = 0; c < num_rhs; c++) {
      for (PetscInt k = 0; k < separators; k++)
        at_separators[c * separators + s->place[k]] = s->values[c * n + s->num_inner + k];
    }
    PetscCall(ApplyBlock(s, "N", num_rhs, at_separators));
  }
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < separators; k++) {
      const PetscInt i = s->separator_unknown[k] - linear->unknowns.first;
      if (i >= 0 && i < linear->num_owned) at_separators[c * separators + s->place[k]] += b[c * linear->num_owned + i];
    }
  }
  PetscFunctionReturn(0);
}

/* And backwards, from the separators' solution. */
static PetscErrorCode SolveBackward(EqmLinear linear, PetscInt num_rhs, PetscScalar *at_separators, PetscReal *x)
{
  EqmSubstructure *const s = linear->data;
  const PetscInt separators = s->num_separator_unknowns, n = s->num_inner + separators;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < separators; k++) {
      const PetscInt i = s->separator_unknown[k] - linear->unknowns.first;
      if (i >= 0 && i < linear->num_owned) x[c * linear->num_owned + i] = at_separators[c * separators + s->place[k]];
    }
  }
  if (!s->factor) PetscFunctionReturn(0);
  PetscCall(ApplyBlock(s, "T", num_rhs, at_separators));
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < separators; k++)
      s->values[c * n + s->num_inner + k] = at_separators[c * separators + s->place[k]];
  }
  PetscCall(EqmFrontalSolve(s->factor, EQM_SOLVE_BACKWARD, num_rhs, s->values, s->values));
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt i = 0; i < linear->num_owned; i++) {
      if (s->local[i] < s->num_inner) x[c * linear->num_owned + i] = s->values[c * n + s->local[i]];
    }
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSubstructureSolve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x,
                                    PetscBool *success)
{
  EqmSubstructure *const s = linear->data;
  PetscScalar *at_separators;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num_rhs * s->num_separator_unknowns, &at_separators));
  PetscCall(SolveForward(linear, num_rhs, b, at_separators));
  PetscCall(EqmInterfaceSolve(s->interface, num_rhs, at_separators));
  PetscCall(SolveBackward(linear, num_rhs, at_separators, x));
  PetscCheck(!s->factor || EqmFrontalHasMemory(s->factor), PETSC_COMM_SELF, PETSC_ERR_MEM,
             "too little memory for %" PetscInt_FMT " right-hand sides", num_rhs);
  PetscCall(PetscFree(at_separators));
  PetscFunctionReturn(0);
}
