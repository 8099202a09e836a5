/* Dense fronts on several ranks by ScaLAPACK (L. S. Blackford et al., ScaLAPACK Users' Guide, SIAM 1997), whose BLACS
   get a context of the ranks' communicator. */
#include "linalg/interface_private.h"
#include "base/narrow.h"

#ifdef EQM_HAVE_SCALAPACK

/* ScaLAPACK and BLACS come without a header. Their integers are those of C. */
enum { DENSE = 1, DESCRIPTOR = 9, REPEATABLE = 15 }; /* REPEATABLE: no sums in the order of arrival */
int Csys2blacs_handle(MPI_Comm comm);
void Cfree_blacs_system_handle(int handle);
void Cblacs_gridinit(int *context, const char *order, int rows, int columns);
void Cblacs_gridexit(int context);
void Cblacs_set(int context, int what, int *value);
void pdpotrf_(const char *uplo, const int *n, double *a, const int *ia, const int *ja, const int *desca, int *info);
void pdtrsm_(const char *side, const char *uplo, const char *trans, const char *diag, const int *m, const int *n,
             const double *alpha, const double *a, const int *ia, const int *ja, const int *desca, double *b,
             const int *ib, const int *jb, const int *descb);
void pdsyrk_(const char *uplo, const char *trans, const int *n, const int *k, const double *alpha, const double *a,
             const int *ia, const int *ja, const int *desca, const double *beta, double *c, const int *ic,
             const int *jc, const int *descc);
void pdgemm_(const char *transa, const char *transb, const int *m, const int *n, const int *k, const double *alpha,
             const double *a, const int *ia, const int *ja, const int *desca, const double *b, const int *ib,
             const int *jb, const int *descb, const double *beta, double *c, const int *ic, const int *jc,
             const int *descc);

PetscBool EqmInterfaceCanShare(void)
{
  return PETSC_TRUE;
}

PetscErrorCode EqmSharedFrontSetUp(EqmFront *front)
{
  static const char *const what = "entries of a rank's part of a dense front";
  int repeatable = 1;

  PetscFunctionBegin;
  PetscCall(EqmCheckFits((PetscInt64)front->rows * front->out_columns, sizeof(int), "ScaLAPACK", what));
  PetscCall(EqmCheckFits((PetscInt64)front->kept_rows * front->kept_columns, sizeof(int), "ScaLAPACK", what));
  front->handle = Csys2blacs_handle(front->comm);
  front->context = front->handle;
  Cblacs_gridinit(&front->context, "Row", front->grid.rows, front->grid.columns);
  if (front->context >= 0) Cblacs_set(front->context, REPEATABLE, &repeatable);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedFrontReset(EqmFront *front)
{
  PetscFunctionBegin;
  if (front->context >= 0) Cblacs_gridexit(front->context);
  Cfree_blacs_system_handle(front->handle);
  PetscCallMPI(MPI_Comm_free(&front->comm));
  PetscFunctionReturn(0);
}

/* A matrix from the grid's first rank on. */
static void Describe(const EqmFront *front, PetscInt rows, PetscInt columns, PetscInt column_block, PetscInt stride,
                     int descriptor[DESCRIPTOR])
{
  const int block = (int)front->grid.block,
            all[DESCRIPTOR] = {DENSE, front->context,          (int)rows, (int)columns, block, (int)column_block, 0,
                               0,     (int)PetscMax(stride, 1)};

  for (int k = 0; k < DESCRIPTOR; k++) descriptor[k] = all[k];
}

PetscErrorCode EqmSharedFrontFactor(EqmFront *front, PetscScalar *rest, PetscBool *success)
{
  const int out = (int)front->num_out, kept = (int)front->num_kept, first = 1, below = (int)front->kept_begin + 1;
  const double one = 1., minus_one = -1.;
  int panel[DESCRIPTOR], passed[DESCRIPTOR], info = 0;

  PetscFunctionBegin;
  if (front->context < 0 || out == 0) PetscFunctionReturn(0);
  Describe(front, front->kept_begin + front->num_kept, front->num_out, front->grid.block, front->rows, panel);
  Describe(front, front->num_kept, front->num_kept, front->grid.block, front->kept_rows, passed);
  pdpotrf_("L", &out, front->panel, &first, &first, panel, &info);
  if (info != 0) *success = PETSC_FALSE;
  if (info != 0 || kept == 0) PetscFunctionReturn(0);
  pdtrsm_("R", "L", "T", "N", &kept, &out, &one, front->panel, &first, &first, panel, front->panel, &below, &first,
          panel);
  pdsyrk_("L", "N", &kept, &out, &minus_one, front->panel, &below, &first, panel, &one, rest, &first, &first, passed);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedFrontSolve(EqmFront *front, PetscBool transposed, PetscInt num_rhs)
{
  const int out = (int)front->num_out, kept = (int)front->num_kept, many = (int)num_rhs, first = 1,
            below = (int)front->kept_begin + 1;
  const double one = 1., minus_one = -1.;
  int panel[DESCRIPTOR], columns[DESCRIPTOR];

  PetscFunctionBegin;
  if (front->context < 0 || out == 0) PetscFunctionReturn(0);
  Describe(front, front->kept_begin + front->num_kept, front->num_out, front->grid.block, front->rows, panel);
  Describe(front, front->kept_begin + front->num_kept, num_rhs, PetscMax(num_rhs, 1), front->rows, columns);
  if (transposed && kept > 0) {
    pdgemm_("T", "N", &out, &many, &kept, &minus_one, front->panel, &below, &first, panel, front->columns, &below,
            &first, columns, &one, front->columns, &first, &first, columns);
  }
  pdtrsm_("L", "L", transposed ? "T" : "N", "N", &out, &many, &one, front->panel, &first, &first, panel, front->columns,
          &first, &first, columns);
  if (!transposed && kept > 0) {
    pdgemm_("N", "N", &kept, &many, &out, &minus_one, front->panel, &below, &first, panel, front->columns, &first,
            &first, columns, &one, front->columns, &below, &first, columns);
  }
  PetscFunctionReturn(0);
}

#else

PetscBool EqmInterfaceCanShare(void)
{
  return PETSC_FALSE;
}

PetscErrorCode EqmSharedFrontSetUp(EqmFront *front)
{
  SETERRQ(PETSC_COMM_SELF, PETSC_ERR_SUP, "a shared front without ScaLAPACK");
}

PetscErrorCode EqmSharedFrontReset(EqmFront *front)
{
  return EqmSharedFrontSetUp(front);
}

PetscErrorCode EqmSharedFrontFactor(EqmFront *front, PetscScalar *rest, PetscBool *success)
{
  return EqmSharedFrontSetUp(front);
}

PetscErrorCode EqmSharedFrontSolve(EqmFront *front, PetscBool transposed, PetscInt num_rhs)
{
  return EqmSharedFrontSetUp(front);
}

#endif
