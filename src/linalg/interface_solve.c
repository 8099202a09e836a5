/* Solves on a tree of ranks: up with L, down with its transpose. */
#include "linalg/interface_private.h"
#include "base/narrow.h"

/* Columns of `count` numbers each, from and to rows of a front. */
static void AddRows(const PetscInt *place, PetscInt count, PetscInt num_rhs, const PetscScalar *from, PetscInt rows,
                    PetscScalar *to)
{
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < count; k++) to[(size_t)c * rows + place[k]] += from[(size_t)c * count + k];
  }
}

static void TakeRows(const PetscInt *place, PetscInt count, PetscInt num_rhs, PetscInt rows, const PetscScalar *from,
                     PetscScalar *to)
{
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < count; k++) to[(size_t)c * count + k] = from[(size_t)c * rows + place[k]];
  }
}

/* A front and right-hand sides as BLAS wants them. */
typedef struct {
  PetscBLASInt out, kept, rows, many;
} Shape;

static PetscErrorCode GetShape(const EqmFront *front, PetscInt num_rhs, Shape *shape)
{
  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(front->num_out, &shape->out));
  PetscCall(PetscBLASIntCast(front->num_kept, &shape->kept));
  PetscCall(PetscBLASIntCast(front->num_out + front->num_kept, &shape->rows));
  PetscCall(PetscBLASIntCast(num_rhs, &shape->many));
  PetscFunctionReturn(0);
}

/* L y = f on this front; what is left for the unknowns passed on goes to `columns`. */
static PetscErrorCode SolveUp(EqmInterface tree, EqmFront *front, PetscInt num_rhs, PetscScalar **columns)
{
  const PetscInt n = front->num_out + front->num_kept, other = front->num_from[1];
  const PetscScalar one = 1., minus_one = -1.;
  PetscScalar *received;
  Shape shape;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n * num_rhs, &front->columns));
  AddRows(front->place[0], front->num_from[0], num_rhs, *columns, n, front->columns);
  PetscCall(PetscFree(*columns));
  PetscCall(PetscMalloc1(other * num_rhs, &received));
  PetscCallMPI(MPI_Recv(received, (PetscMPIInt)(other * num_rhs), MPIU_SCALAR, front->right, EQM_TAG_UP, tree->comm,
                        MPI_STATUS_IGNORE));
  AddRows(front->place[1], other, num_rhs, received, n, front->columns);
  PetscCall(PetscFree(received));
  PetscCall(GetShape(front, num_rhs, &shape));
  if (shape.out > 0) {
    PetscCallBLAS("BLAStrsm", BLAStrsm_("L", "L", "N", "N", &shape.out, &shape.many, &one, front->panel, &shape.rows,
                                        front->columns, &shape.rows));
  }
  if (shape.out > 0 && shape.kept > 0) {
    PetscCallBLAS("BLASgemm",
                  BLASgemm_("N", "N", &shape.kept, &shape.many, &shape.out, &minus_one, front->panel + shape.out,
                            &shape.rows, front->columns, &shape.rows, &one, front->columns + shape.out, &shape.rows));
  }
  PetscCall(PetscMalloc1(front->num_kept * num_rhs, columns));
  for (PetscInt c = 0; c < num_rhs; c++)
    PetscCall(PetscArraycpy(*columns + c * front->num_kept, front->columns + c * n + front->num_out, front->num_kept));
  PetscFunctionReturn(0);
}

/* L^T x = y, given x of the unknowns passed on in `columns`, which leaves as x of the first group's. */
static PetscErrorCode SolveDown(EqmInterface tree, EqmFront *front, PetscInt num_rhs, PetscScalar **columns)
{
  const PetscInt n = front->num_out + front->num_kept, other = front->num_from[1];
  const PetscScalar one = 1., minus_one = -1.;
  PetscScalar *sent;
  Shape shape;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < num_rhs; c++)
    PetscCall(PetscArraycpy(front->columns + c * n + front->num_out, *columns + c * front->num_kept, front->num_kept));
  PetscCall(PetscFree(*columns));
  PetscCall(GetShape(front, num_rhs, &shape));
  if (shape.out > 0 && shape.kept > 0) {
    PetscCallBLAS("BLASgemm",
                  BLASgemm_("T", "N", &shape.out, &shape.many, &shape.kept, &minus_one, front->panel + shape.out,
                            &shape.rows, front->columns + shape.out, &shape.rows, &one, front->columns, &shape.rows));
  }
  if (shape.out > 0) {
    PetscCallBLAS("BLAStrsm", BLAStrsm_("L", "L", "T", "N", &shape.out, &shape.many, &one, front->panel, &shape.rows,
                                        front->columns, &shape.rows));
  }
  PetscCall(PetscMalloc1(other * num_rhs, &sent));
  TakeRows(front->place[1], other, num_rhs, n, front->columns, sent);
  PetscCallMPI(MPI_Send(sent, (PetscMPIInt)(other * num_rhs), MPIU_SCALAR, front->right, EQM_TAG_DOWN, tree->comm));
  PetscCall(PetscFree(sent));
  PetscCall(PetscMalloc1(front->num_from[0] * num_rhs, columns));
  TakeRows(front->place[0], front->num_from[0], num_rhs, n, front->columns, *columns);
  PetscCall(PetscFree(front->columns));
  PetscFunctionReturn(0);
}

/* Does every message of a solve fit? */
static PetscErrorCode CheckMessages(EqmInterface tree, PetscInt num_rhs)
{
  static const char *const what = "numbers of a front's right-hand sides";

  PetscFunctionBegin;
  PetscCall(EqmCheckFits((PetscInt64)num_rhs * tree->num_left, sizeof(PetscMPIInt), "MPI", what));
  for (PetscInt k = 0; k < tree->num_fronts; k++)
    PetscCall(EqmCheckFits((PetscInt64)num_rhs * tree->front[k].num_from[1], sizeof(PetscMPIInt), "MPI", what));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceSolve(EqmInterface tree, PetscInt num_rhs, PetscScalar *columns)
{
  PetscScalar *now;
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(CheckMessages(tree, num_rhs));
  count = (PetscMPIInt)(tree->num_left * num_rhs);
  PetscCall(PetscMalloc1(tree->num_shared * num_rhs, &now));
  PetscCall(PetscArraycpy(now, columns, tree->num_shared * num_rhs));
  for (PetscInt k = 0; k < tree->num_fronts; k++) PetscCall(SolveUp(tree, &tree->front[k], num_rhs, &now));
  if (tree->parent >= 0) {
    PetscCallMPI(MPI_Send(now, count, MPIU_SCALAR, tree->parent, EQM_TAG_UP, tree->comm));
    PetscCallMPI(MPI_Recv(now, count, MPIU_SCALAR, tree->parent, EQM_TAG_DOWN, tree->comm, MPI_STATUS_IGNORE));
  }
  for (PetscInt k = tree->num_fronts - 1; k >= 0; k--) PetscCall(SolveDown(tree, &tree->front[k], num_rhs, &now));
  PetscCall(PetscArraycpy(columns, now, tree->num_shared * num_rhs));
  PetscCall(PetscFree(now));
  PetscFunctionReturn(0);
}
