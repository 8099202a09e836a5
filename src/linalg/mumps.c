/* MUMPS on any number of ranks, called directly: PETSc's interface cannot hand it an ordering, and Debian's MUMPS has
   none of METIS's, whose nested dissection halves the fill. */
#include "linalg/linalg.h"
#include "mesh/mesh_private.h"
#include "base/narrow.h"
#include <dmumps_c.h>

/* The manual counts from 1. */
#define ICNTL(k)  icntl[(k)-1]
#define INFOG(k)  infog[(k)-1]
#define RINFOG(k) rinfog[(k)-1]
#define INFO(k)   info[(k)-1]

enum { JOB_START = -1, JOB_END = -2, JOB_ANALYSE = 1, JOB_FACTOR = 2, JOB_SOLVE = 3, MOST_RETRIES = 4 };

typedef struct {
  DMUMPS_STRUC_C id;
  MUMPS_INT *row, *column, *rhs_row; /* counted from 1 */
  PetscReal *rhs, *solution;
  MUMPS_INT *solution_row;
  PetscInt num_rhs, num_solution;
  PetscSF to_owner; /* from MUMPS' distribution of the solution to ours; made anew after each factorisation */
} Mumps;

static PetscErrorCode Call(EqmLinear linear, MUMPS_INT job)
{
  Mumps *const m = linear->data;

  PetscFunctionBegin;
  m->id.job = job;
  dmumps_c(&m->id);
  PetscFunctionReturn(0);
}

/* Copy the triangle's values (and at the analysis its places) in MUMPS' triples. */
static PetscErrorCode TakeMatrix(EqmLinear linear, PetscBool places)
{
  Mumps *const m = linear->data;
  Mat matrix;
  PetscInt first, last;
  MUMPS_INT8 entry = 0;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  PetscCall(MatGetOwnershipRange(matrix, &first, &last));
  for (PetscInt i = first; i < last; i++) {
    PetscInt n;
    const PetscInt *column;
    const PetscScalar *value;
    PetscCall(MatGetRow(matrix, i, &n, &column, &value));
    for (PetscInt k = 0; k < n; k++) {
      if (places) {
        m->row[entry] = (MUMPS_INT)(i + 1);
        m->column[entry] = (MUMPS_INT)(column[k] + 1);
      }
      m->id.a_loc[entry++] = value[k];
    }
    PetscCall(MatRestoreRow(matrix, i, &n, &column, &value));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Analyse(EqmLinear linear, EqmOrdering ordering)
{
  Mumps *const m = linear->data;
  MUMPS_INT *pivot = NULL;
  PetscInt *position;
  MatInfo info;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  PetscCall(MatGetInfo(matrix, MAT_LOCAL, &info));
  /* every integer passed to MUMPS is the number of an unknown, from 1, or less */
  PetscCall(EqmCheckFits((PetscInt64)linear->num_unknowns + 1, sizeof(MUMPS_INT), "MUMPS", "unknowns"));
  m->id.n = (MUMPS_INT)linear->num_unknowns;
  m->id.nnz_loc = (MUMPS_INT8)info.nz_used;
  PetscCall(PetscMalloc3((size_t)m->id.nnz_loc, &m->row, (size_t)m->id.nnz_loc, &m->column, (size_t)m->id.nnz_loc,
                         &m->id.a_loc));
  m->id.irn_loc = m->row;
  m->id.jcn_loc = m->column;
  PetscCall(TakeMatrix(linear, PETSC_TRUE));
  PetscCall(EqmOrderingOfUnknowns(ordering, &linear->unknowns, &position));
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_FACTOR));
  if (linear->mesh->rank == 0) {
    PetscCall(PetscMalloc1(linear->num_unknowns, &pivot));
    for (PetscInt k = 0; k < linear->num_unknowns; k++) pivot[k] = (MUMPS_INT)(position[k] + 1);
    m->id.perm_in = pivot;
  }
  PetscCall(Call(linear, JOB_ANALYSE));
  PetscCall(PetscFree(pivot));
  PetscCall(PetscFree(position));
  m->id.perm_in = NULL;
  PetscCheck(m->id.INFOG(1) >= 0, linear->mesh->comm, PETSC_ERR_LIB,
             "MUMPS' analysis failed: INFOG(1) = %d, INFOG(2) = %d", m->id.INFOG(1), m->id.INFOG(2));
  PetscCheck(m->id.INFOG(7) == 1, linear->mesh->comm, PETSC_ERR_LIB,
             "MUMPS ignored the ordering it was given (INFOG(7) = %d)", m->id.INFOG(7));
  linear->estimate.nonzeros = m->id.INFOG(3) < 0 ? -1e6 * m->id.INFOG(3) : m->id.INFOG(3);
  linear->estimate.flops = m->id.RINFOG(1);
  linear->estimate.bytes_on_rank = 1e6 * (1. + m->id.INFO(15)); /* reported in whole megabytes */
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_FACTOR));

  PetscCall(PetscMalloc1(linear->num_owned, &m->rhs_row));
  for (PetscInt k = 0; k < linear->num_owned; k++) m->rhs_row[k] = (MUMPS_INT)(linear->unknowns.first + k + 1);
  m->id.nloc_rhs = (MUMPS_INT)linear->num_owned;
  m->id.lrhs_loc = (MUMPS_INT)PetscMax(1, linear->num_owned);
  m->id.irhs_loc = m->rhs_row;
  PetscFunctionReturn(0);
}

/* Too small a workspace (-8, -9, ...) is an estimate gone wrong, not a bad matrix: grow it and try again. */
static PetscErrorCode Factor(EqmLinear linear, PetscBool *success)
{
  Mumps *const m = linear->data;

  PetscFunctionBegin;
  PetscCall(TakeMatrix(linear, PETSC_FALSE));
  for (PetscInt attempt = 0; attempt < MOST_RETRIES; attempt++) {
    PetscCall(Call(linear, JOB_FACTOR));
    if (m->id.INFOG(1) != -8 && m->id.INFOG(1) != -9) break;
    m->id.ICNTL(14) *= 2;
  }
  PetscCall(PetscSFDestroy(&m->to_owner));
  PetscCheck(m->id.INFOG(1) >= 0 || m->id.INFOG(1) == -10 || m->id.INFOG(1) == -40, linear->mesh->comm, PETSC_ERR_MEM,
             "MUMPS' factorisation failed: INFOG(1) = %d, INFOG(2) = %d%s", m->id.INFOG(1), m->id.INFOG(2),
             m->id.INFOG(1) == -13 ? " (out of memory: use more ranks or nodes)" : "");
  *success = (PetscBool)(m->id.INFOG(1) >= 0 && m->id.INFOG(12) == 0); /* INFOG(12): negative pivots */
  PetscFunctionReturn(0);
}

/* Allocate for that many right-hand sides, for ours and MUMPS' arrays. */
static PetscErrorCode Reserve(EqmLinear linear, PetscInt num_rhs)
{
  Mumps *const m = linear->data;

  PetscFunctionBegin;
  if (m->num_rhs >= num_rhs && m->num_solution >= m->id.INFO(23)) PetscFunctionReturn(0);
  PetscCall(PetscFree3(m->rhs, m->solution, m->solution_row));
  m->num_rhs = PetscMax(num_rhs, m->num_rhs);
  m->num_solution = m->id.INFO(23);
  PetscCall(PetscMalloc3(m->num_rhs * linear->num_owned + 1, &m->rhs, m->num_rhs * m->num_solution + 1, &m->solution,
                         m->num_solution + 1, &m->solution_row));
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x, PetscBool *success)
{
  Mumps *const m = linear->data;

  PetscFunctionBegin;
  PetscCall(Reserve(linear, num_rhs));
  PetscCall(PetscArraycpy(m->rhs, b, num_rhs * linear->num_owned));
  PetscCall(EqmCheckFits(num_rhs, sizeof(MUMPS_INT), "MUMPS", "right-hand sides"));
  m->id.nrhs = (MUMPS_INT)num_rhs;
  m->id.rhs_loc = m->rhs;
  m->id.lsol_loc = (MUMPS_INT)PetscMax(1, m->num_solution);
  m->id.sol_loc = m->solution;
  m->id.isol_loc = m->solution_row;
  PetscCall(Call(linear, JOB_SOLVE));
  PetscCheck(m->id.INFOG(1) >= 0, linear->mesh->comm, PETSC_ERR_LIB,
             "MUMPS' solve failed: INFOG(1) = %d, INFOG(2) = %d", m->id.INFOG(1), m->id.INFOG(2));
  if (!m->to_owner) {
    const PetscInt count = m->id.INFO(23);
    PetscInt *root;
    PetscLayout layout;
    PetscCall(PetscMalloc1(count, &root));
    for (PetscInt k = 0; k < count; k++) root[k] = m->solution_row[k] - 1;
    PetscCall(PetscLayoutCreateFromSizes(linear->mesh->comm, linear->num_owned, PETSC_DECIDE, 1, &layout));
    PetscCall(PetscSFCreate(linear->mesh->comm, &m->to_owner));
    PetscCall(PetscSFSetGraphLayout(m->to_owner, layout, count, NULL, PETSC_OWN_POINTER, root));
    PetscCall(PetscSFSetUp(m->to_owner));
    PetscCall(PetscLayoutDestroy(&layout));
    PetscCall(PetscFree(root));
  }
  for (PetscInt k = 0; k < num_rhs; k++) {
    const PetscReal *const from = m->solution + (size_t)k * (size_t)m->id.lsol_loc;
    PetscCall(PetscSFReduceBegin(m->to_owner, MPIU_REAL, from, x + k * linear->num_owned, MPI_REPLACE));
    PetscCall(PetscSFReduceEnd(m->to_owner, MPIU_REAL, from, x + k * linear->num_owned, MPI_REPLACE));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmLinear linear)
{
  Mumps *const m = linear->data;

  PetscFunctionBegin;
  PetscCall(Call(linear, JOB_END));
  PetscCall(PetscFree3(m->row, m->column, m->id.a_loc));
  PetscCall(PetscFree(m->rhs_row));
  PetscCall(PetscFree3(m->rhs, m->solution, m->solution_row));
  PetscCall(PetscSFDestroy(&m->to_owner));
  PetscCall(PetscFree(linear->data));
  PetscFunctionReturn(0);
}

/* Make `linear` one of MUMPS'. Collective. */
PetscErrorCode EqmLinearSetUpMumps(EqmLinear linear)
{
  Mumps *m;

  PetscFunctionBegin;
  PetscCall(PetscNew(&m));
  linear->data = m;
  linear->analyse = Analyse;
  linear->factor = Factor;
  linear->solve = Solve;
  linear->destroy = Destroy;
  m->id.comm_fortran = (MUMPS_INT)MPI_Comm_c2f(linear->mesh->comm);
  m->id.par = 1;
  m->id.sym = 1; /* positive definite */
  PetscCall(Call(linear, JOB_START));
  for (int unit = 1; unit <= 3; unit++) m->id.ICNTL(unit) = -1; /* silent: failures are ours to tell */
  m->id.ICNTL(4) = 0;
  m->id.ICNTL(7) = 1; /* order: ours */
  m->id.ICNTL(13) = 0;
  m->id.ICNTL(14) = 30; /* spare workspace, per cent */
  m->id.ICNTL(18) = 3;  /* entries where they are */
  m->id.ICNTL(20) = 10; /* right-hand sides where they are */
  m->id.ICNTL(21) = 1;  /* solutions where MUMPS has them */
  m->id.ICNTL(28) = 1;
  PetscFunctionReturn(0);
}
