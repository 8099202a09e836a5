/* Substructuring over the ranks (J. S. Przemieniecki, AIAA Journal 1, 1963): every rank eliminates the unknowns of its
   inner vertices with CHOLMOD, the separators' Schur complement goes to the tree of dense fronts. Nothing depends on
   the order in which messages arrive, so that equal runs give equal bits.

   CHOLMOD has no partial factorisation. It is given the rank's matrix with a diagonal D in place of the separators'
   block, D - A_SI A_II^-1 A_IS being definite whenever A is; the last block of its factor times its transpose, less D,
   is the wanted -A_SI A_II^-1 A_IS. As A is at most m diag(A) for m entries to a row, D is of the size of A's diagonal
   and costs no digits. */
#include "linalg/substructure.h"
#include <omp.h>
#include <petscblaslapack.h>

enum { MOST_VERTEX_UNKNOWNS = 3, PANEL = 96 };

static inline PetscScalar ValueAt(const EqmBlocks *blocks, PetscInt source)
{
  return source >= 0 ? blocks->value[0][source] : blocks->value[1][-1 - source];
}

/* D: the owner of a separator knows its diagonal and the length of its row, the other ranks ask it. */
static PetscErrorCode FillShift(EqmLinear linear, const EqmBlocks *blocks)
{
  EqmSubstructure *const s = linear->data;
  const EqmMesh mesh = linear->mesh;
  PetscReal *by_vertex;
  PetscInt most = 1;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(MOST_VERTEX_UNKNOWNS * mesh->num_local, &by_vertex));
  for (PetscInt k = 0; k < s->num_edge; k++) most = PetscMax(most, s->edge_component[k] + 1);
  for (PetscInt q = 0; q < s->num_direct; q++) {
    const PetscInt k = s->direct[3 * q + 1];
    if (k != s->direct[3 * q + 2]) continue;
    by_vertex[MOST_VERTEX_UNKNOWNS * s->edge_vertex[k] + s->edge_component[k]] =
        (PetscReal)(most * s->edge_links[k]) * ValueAt(blocks, s->direct[3 * q]);
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, MOST_VERTEX_UNKNOWNS, by_vertex));
  for (PetscInt k = 0; k < s->num_edge; k++)
    s->shift[k] = by_vertex[MOST_VERTEX_UNKNOWNS * s->edge_vertex[k] + s->edge_component[k]];
  PetscCall(PetscFree(by_vertex));
  PetscFunctionReturn(0);
}

/* The separators' block of CHOLMOD's factor. */
static void TakeCorner(EqmSubstructure *s)
{
  const cholmod_factor *const f = s->factor;
  const PetscInt *const first = f->super, *const row_start = f->pi, *const value_start = f->px, *const row = f->s;
  const PetscInt n = s->num_edge;

  for (size_t j = 0; j < (size_t)n * (size_t)n; j++) s->corner[j] = 0.;
  for (PetscInt k = 0; k < (PetscInt)f->nsuper; k++) {
    const PetscInt rows = row_start[k + 1] - row_start[k];
    for (PetscInt j = 0; j < first[k + 1] - first[k]; j++) {
      const PetscInt column = s->corner_at[first[k] + j];
      if (column < 0) continue;
      for (PetscInt i = j; i < rows; i++) { /* relaxed supernodes hold zeros of inner unknowns, too */
        const PetscInt to = s->corner_at[row[row_start[k] + i]];
        if (to < 0) continue;
        s->corner[(size_t)column * (size_t)n + (size_t)to] =
            ((const PetscScalar *)f->x)[(size_t)value_start[k] + (size_t)j * (size_t)rows + (size_t)i];
      }
    }
  }
}

/* This rank's share of the Schur complement: corner corner^T - D and the entries between separators. */
static PetscErrorCode MakeShare(EqmSubstructure *s, const EqmBlocks *blocks, PetscScalar **share)
{
  const size_t n = (size_t)s->num_edge;
  const PetscScalar one = 1.;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n * n, share));
  for (PetscInt j = 0; s->factor && j < s->num_edge; j += PANEL) { /* the zeros above the diagonal are left out */
    const size_t corner = (size_t)j * n + (size_t)j;
    const PetscBLASInt rows = (PetscBLASInt)(s->num_edge - j), columns = PetscMin(PANEL, rows),
                       stride = (PetscBLASInt)n;
    PetscCallBLAS("BLASsyrk", BLASsyrk_("L", "N", &rows, &columns, &one, s->corner + corner, &stride, &one,
                                        *share + corner, &stride));
  }
  for (PetscInt k = 0; s->factor && k < s->num_edge; k++) (*share)[(size_t)s->place[k] * (n + 1)] -= s->shift[k];
  for (PetscInt q = 0; q < s->num_direct; q++) {
    const PetscInt a = s->place[s->direct[3 * q + 1]], b = s->place[s->direct[3 * q + 2]];
    (*share)[(size_t)PetscMin(a, b) * n + (size_t)PetscMax(a, b)] += ValueAt(blocks, s->direct[3 * q]);
  }
  PetscFunctionReturn(0);
}

/* CHOLMOD on the rank's matrix. */
static PetscErrorCode FactorInner(EqmLinear linear, const EqmBlocks *blocks, PetscBool *success)
{
  EqmSubstructure *const s = linear->data;
  const PetscInt n = s->num_inner + s->num_edge, *const start = s->matrix.p;
  PetscScalar *const value = s->matrix.x;
  PetscBool mine = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(FillShift(linear, blocks));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt end = start[i + 1] - (i >= s->num_inner);
    for (PetscInt q = start[i]; q < end; q++) value[q] = ValueAt(blocks, s->source[q]);
    if (i >= s->num_inner) value[end] = s->shift[i - s->num_inner];
  }
  if (s->factor) {
    /* its own team of threads, whose number was fixed when it was built, costs more than it brings */
    const int levels = omp_get_max_active_levels();
    omp_set_max_active_levels(0);
    CHOLMOD(factorize)(&s->matrix, s->factor, &s->common);
    omp_set_max_active_levels(levels);
    mine = (PetscBool)(s->common.status == CHOLMOD_OK && s->factor->minor == s->factor->n);
  }
  PetscCall(EqmSubstructureAgree(linear, "factorisation"));
  PetscCall(MPIU_Allreduce(&mine, success, 1, MPIU_BOOL, MPI_LAND, linear->mesh->comm));
  PetscFunctionReturn(0);
}

static PetscErrorCode Factor(EqmLinear linear, PetscBool *success)
{
  EqmSubstructure *const s = linear->data;
  PetscScalar *share;
  EqmBlocks blocks;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  PetscCall(EqmBlocksGet(matrix, &blocks));
  PetscCall(FactorInner(linear, &blocks, success));
  if (*success) {
    if (s->factor && !s->corner) PetscCall(PetscMalloc1((size_t)s->num_edge * (size_t)s->num_edge, &s->corner));
    if (s->factor) TakeCorner(s);
    PetscCall(MakeShare(s, &blocks, &share));
    PetscCall(EqmInterfaceFactor(s->interface, &share, success));
  }
  PetscCall(EqmBlocksRestore(&blocks));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmLinear linear)
{
  EqmSubstructure *const s = linear->data;

  PetscFunctionBegin;
  CHOLMOD(free_factor)(&s->factor, &s->common);
  CHOLMOD(free_dense)(&s->right, &s->common);
  CHOLMOD(free_dense)(&s->forward, &s->common);
  CHOLMOD(free_dense)(&s->backward, &s->common);
  CHOLMOD(free_dense)(&s->work_y, &s->common);
  CHOLMOD(free_dense)(&s->work_e, &s->common);
  CHOLMOD(finish)(&s->common);
  PetscCall(PetscFree(s->matrix.p));
  PetscCall(PetscFree(s->matrix.i));
  PetscCall(PetscFree(s->matrix.x));
  PetscCall(PetscFree5(s->edge_vertex, s->edge_component, s->edge_links, s->edge_unknown, s->shift));
  PetscCall(PetscFree(s->local));
  PetscCall(PetscFree(s->position));
  PetscCall(PetscFree(s->corner_at));
  PetscCall(PetscFree(s->source));
  PetscCall(PetscFree(s->direct));
  PetscCall(PetscFree(s->place));
  PetscCall(PetscFree(s->corner));
  PetscCall(EqmInterfaceDestroy(&s->interface));
  PetscCall(PetscFree(linear->data));
  PetscFunctionReturn(0);
}

/* Make `linear` one by substructuring. Not collective. */
PetscErrorCode EqmLinearSetUpSubstructure(EqmLinear linear)
{
  EqmSubstructure *s;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  linear->data = s;
  linear->analyse = EqmSubstructureAnalyse;
  linear->factor = Factor;
  linear->solve = EqmSubstructureSolve;
  linear->destroy = Destroy;
  CHOLMOD(start)(&s->common);
  s->common.print = 0;
  s->common.supernodal = CHOLMOD_SUPERNODAL;
  s->common.quick_return_if_not_posdef = 1;
  PetscFunctionReturn(0);
}
