/* Solves by substructuring: b_I in the factor's order, y = L^-1 (b_I, 0), whose last part times the corner is -A_SI
   A_II^-1 b_I; with x_S from the tree, x = L^-T (y_I, corner^T x_S) */
#include "linalg/substructure.h"
#include <petscblaslapack.h>

static PetscErrorCode SolveTriangle(EqmSubstructure *s, int system, cholmod_dense *b, cholmod_dense **x)
{
  PetscFunctionBegin;
  PetscCheck(CHOLMOD(solve2)(system, s->factor, b, NULL, x, NULL, &s->work_y, &s->work_e, &s->common), PETSC_COMM_SELF,
             PETSC_ERR_LIB, "CHOLMOD's solve failed (status %d)", s->common.status);
  PetscFunctionReturn(0);
}

/* edge <- corner edge or corner^T edge; above its diagonal the corner is zero. */
static PetscErrorCode ApplyCorner(EqmSubstructure *s, const char *transpose, PetscInt num_rhs, PetscScalar *edge)
{
  const PetscScalar one = 1., zero = 0.;
  PetscScalar *copy;
  PetscBLASInt n, many;

  PetscFunctionBegin;
  if (s->num_edge == 0) PetscFunctionReturn(0);
  PetscCall(PetscBLASIntCast(s->num_edge, &n));
  PetscCall(PetscBLASIntCast(num_rhs, &many));
  PetscCall(PetscMalloc1(s->num_edge * num_rhs, &copy));
  PetscCall(PetscArraycpy(copy, edge, s->num_edge * num_rhs));
  PetscCallBLAS("BLASgemm", BLASgemm_(transpose, "N", &n, &many, &n, &one, s->corner, &n, copy, &n, &zero, edge, &n));
  PetscCall(PetscFree(copy));
  PetscFunctionReturn(0);
}

/* Room for as many right-hand sides; zero. */
static PetscErrorCode Reserve(EqmSubstructure *s, PetscInt num_rhs)
{
  const size_t n = (size_t)(s->num_inner + s->num_edge);

  PetscFunctionBegin;
  if (!s->right || (PetscInt)s->right->ncol != num_rhs) {
    CHOLMOD(free_dense)(&s->right, &s->common);
    s->right = CHOLMOD(allocate_dense)(n, (size_t)num_rhs, n, CHOLMOD_REAL, &s->common);
    PetscCheck(s->right, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for %" PetscInt_FMT " right-hand sides", num_rhs);
  }
  PetscCall(PetscArrayzero((PetscScalar *)s->right->x, n * (size_t)num_rhs));
  PetscFunctionReturn(0);
}

/* The inner unknowns' part forwards; `edge`: what it leaves for the separators. */
static PetscErrorCode SolveForward(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscScalar *edge)
{
  EqmSubstructure *const s = linear->data;
  const PetscInt n = s->num_inner + s->num_edge, first = linear->unknowns.first;

  PetscFunctionBegin;
  if (s->factor) {
    PetscCall(Reserve(s, num_rhs));
    for (PetscInt c = 0; c < num_rhs; c++) {
      for (PetscInt i = 0; i < linear->num_owned; i++) {
        if (s->local[i] < s->num_inner)
          ((PetscScalar *)s->right->x)[c * n + s->position[s->local[i]]] = b[c * linear->num_owned + i];
      }
    }
    PetscCall(SolveTriangle(s, CHOLMOD_L, s->right, &s->forward));
    for (PetscInt c = 0; c < num_rhs; c++) {
      for (PetscInt k = 0; k < s->num_edge; k++)
        edge[c * s->num_edge + s->place[k]] =
            ((const PetscScalar *)s->forward->x)[c * n + s->position[s->num_inner + k]];
    }
    PetscCall(ApplyCorner(s, "N", num_rhs, edge));
  } else {
    PetscCall(PetscArrayzero(edge, num_rhs * s->num_edge));
  }
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < s->num_edge; k++) {
      const PetscInt i = s->edge_unknown[k] - first;
      if (i >= 0 && i < linear->num_owned) edge[c * s->num_edge + s->place[k]] += b[c * linear->num_owned + i];
    }
  }
  PetscFunctionReturn(0);
}

/* And backwards, from the separators' solution in `edge`. */
static PetscErrorCode SolveBackward(EqmLinear linear, PetscInt num_rhs, PetscScalar *edge, PetscReal *x)
{
  EqmSubstructure *const s = linear->data;
  const PetscInt n = s->num_inner + s->num_edge, first = linear->unknowns.first;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < s->num_edge; k++) {
      const PetscInt i = s->edge_unknown[k] - first;
      if (i >= 0 && i < linear->num_owned) x[c * linear->num_owned + i] = edge[c * s->num_edge + s->place[k]];
    }
  }
  if (!s->factor) PetscFunctionReturn(0);
  PetscCall(ApplyCorner(s, "T", num_rhs, edge));
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < s->num_edge; k++)
      ((PetscScalar *)s->forward->x)[c * n + s->position[s->num_inner + k]] = edge[c * s->num_edge + s->place[k]];
  }
  PetscCall(SolveTriangle(s, CHOLMOD_Lt, s->forward, &s->backward));
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt i = 0; i < linear->num_owned; i++) {
      if (s->local[i] < s->num_inner)
        x[c * linear->num_owned + i] = ((const PetscScalar *)s->backward->x)[c * n + s->position[s->local[i]]];
    }
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSubstructureSolve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x,
                                    PetscBool *success)
{
  EqmSubstructure *const s = linear->data;
  PetscScalar *edge;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num_rhs * s->num_edge, &edge));
  PetscCall(SolveForward(linear, num_rhs, b, edge));
  PetscCall(EqmInterfaceSolve(s->interface, num_rhs, edge));
  PetscCall(SolveBackward(linear, num_rhs, edge, x));
  PetscCall(PetscFree(edge));
  PetscFunctionReturn(0);
}
