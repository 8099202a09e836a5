/* Substructuring over the ranks (J. S. Przemieniecki, AIAA Journal 1, 1963): every rank eliminates the unknowns of its
   inner vertices on its threads, the separators' Schur complement goes to the tree of dense fronts. Nothing depends on
   the order in which messages arrive, so that equal runs give equal bits.

   The multifrontal factor is one of a whole matrix. It is made of the rank's matrix with a diagonal D in place of the
   separators' block, D - A_SI A_II^-1 A_IS being definite whenever A is; the last block of its factor times its
   transpose, less D, is the wanted -A_SI A_II^-1 A_IS. As A is at most m diag(A) for m entries to a row, D is of the
   size of A's diagonal and costs no digits. */
#include "linalg/substructure.h"
#include "mesh/mesh_private.h"
#include <petscblaslapack.h>

enum { MOST_VERTEX_UNKNOWNS = 3, PANEL = 96 };

static inline PetscScalar ValueAt(const EqmBlocks *blocks, PetscInt source)
{
  return source >= 0 ? blocks->value[0][source] : blocks->value[1][-1 - source];
}

/* D: the owner of a separator has its diagonal and the length of its row, the other ranks fetch them. */
static PetscErrorCode FillShift(EqmLinear linear, const EqmBlocks *blocks)
{
  EqmSubstructure *const s = linear->data;
  const EqmMesh mesh = linear->mesh;
  PetscReal *by_vertex;
  PetscInt most = 1;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(MOST_VERTEX_UNKNOWNS * mesh->num_local, &by_vertex));
  for (PetscInt k = 0; k < s->num_separator_unknowns; k++) most = PetscMax(most, s->separator_component[k] + 1);
  for (PetscInt q = 0; q < s->num_couplings; q++) {
    const PetscInt k = s->coupling[3 * q + 1];
    if (k != s->coupling[3 * q + 2]) continue;
    by_vertex[MOST_VERTEX_UNKNOWNS * s->separator_vertex[k] + s->separator_component[k]] =
        (PetscReal)(most * s->separator_links[k]) * ValueAt(blocks, s->coupling[3 * q]);
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, MOST_VERTEX_UNKNOWNS, by_vertex));
  for (PetscInt k = 0; k < s->num_separator_unknowns; k++)
    s->shift[k] = by_vertex[MOST_VERTEX_UNKNOWNS * s->separator_vertex[k] + s->separator_component[k]];
  PetscCall(PetscFree(by_vertex));
  PetscFunctionReturn(0);
}

/* This rank's share of the Schur complement: block block^T - D and the entries between separators. */
static PetscErrorCode MakeShare(EqmSubstructure *s, const EqmBlocks *blocks, PetscScalar **share)
{
  const size_t n = (size_t)s->num_separator_unknowns;
  const PetscScalar one = 1.;
  PetscBLASInt stride;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(s->num_separator_unknowns, &stride));
  PetscCall(PetscCalloc1(n * n, share));
  for (PetscBLASInt j = 0; s->factor && j < stride; j += PANEL) { /* the zeros above the diagonal are left out */
    const size_t diagonal = (size_t)j * (n + 1);
    const PetscBLASInt rows = stride - j, columns = PetscMin(PANEL, rows);
    PetscCallBLAS("BLASsyrk", BLASsyrk_("L", "N", &rows, &columns, &one, s->block + diagonal, &stride, &one,
                                        *share + diagonal, &stride));
  }
  for (PetscInt k = 0; s->factor && k < s->num_separator_unknowns; k++)
    (*share)[(size_t)s->place[k] * (n + 1)] -= s->shift[k];
  for (PetscInt q = 0; q < s->num_couplings; q++) {
    const PetscInt a = s->place[s->coupling[3 * q + 1]], b = s->place[s->coupling[3 * q + 2]];
    (*share)[(size_t)PetscMin(a, b) * n + (size_t)PetscMax(a, b)] += ValueAt(blocks, s->coupling[3 * q]);
  }
  PetscFunctionReturn(0);
}

/* The factor of the rank's matrix. */
static PetscErrorCode FactorInner(EqmLinear linear, const EqmBlocks *blocks, PetscBool *success)
{
  EqmSubstructure *const s = linear->data;
  const PetscInt n = s->num_inner + s->num_separator_unknowns, *const start = s->matrix.p;
  PetscScalar *const value = s->matrix.x;
  PetscBool mine = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(FillShift(linear, blocks));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt end = start[i + 1] - (i >= s->num_inner);
    for (PetscInt q = start[i]; q < end; q++) value[q] = ValueAt(blocks, s->source[q]);
    if (i >= s->num_inner) value[end] = s->shift[i - s->num_inner];
  }
  if (s->factor && !s->block) {
    const size_t separators = (size_t)s->num_separator_unknowns;
    PetscCall(PetscMalloc1(separators * separators, &s->block));
    PetscCall(EqmFrontalKeepBlock(s->factor, s->num_separator_unknowns, s->separator_at, s->block));
  }
  if (s->factor) PetscCall(EqmFrontalFactor(s->factor, value, &mine));
  PetscCall(EqmSubstructureCheckMemory(linear, "factorisation"));
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
  PetscCall(EqmFrontalDestroy(&s->factor));
  PetscCall(PetscFree(s->values));
  PetscCall(PetscFree(s->matrix.p));
  PetscCall(PetscFree(s->matrix.i));
  PetscCall(PetscFree(s->matrix.x));
  PetscCall(
      PetscFree5(s->separator_vertex, s->separator_component, s->separator_links, s->separator_unknown, s->shift));
  PetscCall(PetscFree(s->local));
  PetscCall(PetscFree(s->separator_at));
  PetscCall(PetscFree(s->source));
  PetscCall(PetscFree(s->coupling));
  PetscCall(PetscFree(s->place));
  PetscCall(PetscFree(s->block));
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
  PetscFunctionReturn(0);
}
