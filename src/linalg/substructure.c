/* Substructuring over the ranks (J. S. Przemieniecki, AIAA Journal 1, 1963): every rank eliminates the unknowns of its
   inner vertices with CHOLMOD, the separators' Schur complement goes to the tree of dense fronts. Nothing depends on
   the order in which messages arrive, so that equal runs give equal bits.

   CHOLMOD has no partial factorisation. It is given the rank's matrix with a diagonal D in place of the separators'
   block, D - A_SI A_II^-1 A_IS being definite whenever A is; the last block of its factor times its transpose, less D,
   is the wanted -A_SI A_II^-1 A_IS. As A is at most m diag(A) for m entries to a row, D is of the size of A's diagonal
   and costs no digits. */
#include "linalg/linalg.h"
#include "linalg/cholmod_name.h"
#include "linalg/interface.h"
#include <omp.h>
#include <petscblaslapack.h>

enum { MOST_VERTEX_UNKNOWNS = 3, PANEL = 96 };

/* Unknowns of this rank's matrix: first the inner ones, then those of the separators. */
typedef struct {
  cholmod_common common;
  cholmod_sparse matrix;
  cholmod_factor *factor; /* NULL: nothing is inner */
  cholmod_dense *right, *forward, *backward, *work_y, *work_e;
  PetscInt num_inner, num_edge;
  PetscInt *local;     /* per owned unknown */
  PetscInt *position;  /* per unknown: row of the factor */
  PetscInt *corner_at; /* per row of the factor: row of the corner, -1 for an inner unknown */
  PetscInt *source;    /* per entry of the matrix: place as in EqmBlocks, minus one minus that of the second block's */
  PetscInt num_direct, *direct; /* entries between separators: source, row, column among them */
  PetscInt *edge_vertex, *edge_component, *edge_links, *edge_unknown; /* per separator unknown; global number */
  PetscScalar *shift;                                                 /* D */
  PetscInt *place;     /* per separator unknown: which of them it is in the order of elimination */
  PetscScalar *corner; /* their block of the factor, by columns, in that order */
  EqmInterface interface;
} Substructure;

static PetscErrorCode CreateEdges(EqmLinear linear, const EqmSeparation *separation)
{
  Substructure *const s = linear->data;
  const EqmUnknowns *const u = &linear->unknowns;
  PetscInt n = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < separation->num_separators; k++) n += u->count[separation->vertex[k]];
  s->num_edge = n;
  PetscCall(
      PetscMalloc5(n, &s->edge_vertex, n, &s->edge_component, n, &s->edge_links, n, &s->edge_unknown, n, &s->shift));
  n = 0;
  for (PetscInt k = 0; k < separation->num_separators; k++) {
    const PetscInt v = separation->vertex[k];
    for (PetscInt c = 0; c < u->count[v]; c++, n++) {
      s->edge_vertex[n] = v;
      s->edge_component[n] = c;
      s->edge_links[n] = separation->links[k];
      s->edge_unknown[n] = u->start[v] + c;
    }
  }
  PetscFunctionReturn(0);
}

/* Inner unknowns keep their order, so that sorted rows stay sorted. */
static PetscErrorCode NumberOwned(EqmLinear linear, const EqmSeparation *separation)
{
  Substructure *const s = linear->data;
  const EqmUnknowns *const u = &linear->unknowns;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(linear->num_owned, &s->local));
  for (PetscInt i = 0; i < linear->num_owned; i++) s->local[i] = 0;
  for (PetscInt k = 0; k < s->num_edge; k++) {
    const PetscInt i = s->edge_unknown[k] - u->first;
    if (i >= 0 && i < linear->num_owned) s->local[i] = 1;
  }
  s->num_inner = 0;
  for (PetscInt i = 0; i < linear->num_owned; i++) s->local[i] = s->local[i] ? -1 : s->num_inner++;
  for (PetscInt k = 0; k < s->num_edge; k++) {
    const PetscInt i = s->edge_unknown[k] - u->first;
    if (i >= 0 && i < linear->num_owned) s->local[i] = s->num_inner + k;
  }
  PetscFunctionReturn(0);
}

/* This rank's number of the column of an entry. */
static PetscErrorCode LocalColumn(const Substructure *s, const EqmBlocks *blocks, int block, PetscInt column,
                                  PetscInt *local)
{
  PetscInt place;

  PetscFunctionBegin;
  if (block == 0) {
    *local = s->local[column];
  } else {
    PetscCall(PetscFindInt(blocks->global_column[column], s->num_edge, s->edge_unknown, &place));
    PetscCheck(place >= 0, PETSC_COMM_SELF, PETSC_ERR_PLIB, "a column of another rank is no separator's");
    *local = s->num_inner + place;
  }
  PetscFunctionReturn(0);
}

/* Go through the stored entries: count them (`next` NULL) or put them in their place. */
static PetscErrorCode PlaceEntries(EqmLinear linear, const EqmBlocks *blocks, PetscInt *count, PetscInt *next)
{
  Substructure *const s = linear->data;
  const PetscInt first_edge = s->num_inner;
  PetscInt *const column = s->matrix.i;

  PetscFunctionBegin;
  s->num_direct = 0;
  for (PetscInt i = 0; i < linear->num_owned; i++) {
    for (int block = 0; block < 2 && blocks->block[block]; block++) {
      for (PetscInt q = blocks->start[block][i]; q < blocks->start[block][i + 1]; q++) {
        const PetscInt source = block == 0 ? q : -1 - q;
        PetscInt a = s->local[i], b;
        PetscCall(LocalColumn(s, blocks, block, blocks->column[block][q], &b));
        if (a >= first_edge && b >= first_edge) {
          if (next) {
            s->direct[3 * s->num_direct] = source;
            s->direct[3 * s->num_direct + 1] = a - first_edge;
            s->direct[3 * s->num_direct + 2] = b - first_edge;
          }
          s->num_direct++;
          continue;
        }
        if (!next) {
          count[PetscMax(a, b)]++;
          continue;
        }
        const PetscInt place = next[PetscMax(a, b)]++;
        column[place] = PetscMin(a, b);
        s->source[place] = source;
      }
    }
  }
  PetscFunctionReturn(0);
}

/* The rank's matrix by rows, lower triangle, with room for D. */
static PetscErrorCode MakePattern(EqmLinear linear)
{
  Substructure *const s = linear->data;
  const PetscInt n = s->num_inner + s->num_edge;
  PetscInt *start, *next;
  EqmBlocks blocks;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  PetscCall(EqmBlocksGet(matrix, &blocks));
  PetscCall(PetscCalloc1(n + 1, &start));
  PetscCall(PlaceEntries(linear, &blocks, start + 1, NULL));
  for (PetscInt i = 0; i < n; i++) start[i + 1] += start[i] + (i >= s->num_inner);
  s->matrix = (cholmod_sparse){.nrow = (size_t)n,
                               .ncol = (size_t)n,
                               .nzmax = (size_t)start[n],
                               .p = start,
                               .stype = 1,
                               .itype = s->common.itype,
                               .xtype = CHOLMOD_REAL,
                               .dtype = CHOLMOD_DOUBLE,
                               .sorted = 1,
                               .packed = 1};
  PetscCall(PetscMalloc1(start[n], (PetscInt **)&s->matrix.i));
  PetscCall(PetscMalloc1(start[n], (PetscScalar **)&s->matrix.x));
  PetscCall(PetscMalloc1(start[n], &s->source));
  PetscCall(PetscMalloc1(3 * s->num_direct, &s->direct));
  PetscCall(PetscMalloc1(n, &next));
  PetscCall(PetscArraycpy(next, start, n));
  PetscCall(PlaceEntries(linear, &blocks, NULL, next));
  for (PetscInt k = s->num_inner; k < n; k++) ((PetscInt *)s->matrix.i)[next[k]] = k;
  PetscCall(PetscFree(next));
  PetscCall(EqmBlocksRestore(&blocks));
  PetscFunctionReturn(0);
}

/* Symbolic factor: inner vertices by nested dissection, then the separators. */
static PetscErrorCode AnalyseInner(EqmLinear linear, const EqmSeparation *separation)
{
  Substructure *const s = linear->data;
  const EqmUnknowns *const u = &linear->unknowns;
  const PetscInt n = s->num_inner + s->num_edge;
  PetscInt *order, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &s->position));
  for (PetscInt k = 0; k < n; k++) s->position[k] = k;
  if (s->num_inner > 0) {
    PetscCall(PetscMalloc1(n, &order));
    for (PetscInt k = 0; k < separation->num_inner; k++) {
      const PetscInt v = separation->inner[k];
      for (PetscInt c = 0; c < u->count[v]; c++) order[count++] = s->local[u->start[v] - u->first + c];
    }
    for (PetscInt k = s->num_inner; k < n; k++) order[count++] = k;
    s->common.nmethods = 1;
    s->common.method[0].ordering = CHOLMOD_GIVEN;
    s->factor = CHOLMOD(analyze_p)(&s->matrix, order, NULL, 0, &s->common);
    PetscCall(PetscFree(order));
    for (PetscInt k = 0; s->factor && k < n; k++) s->position[((PetscInt *)s->factor->Perm)[k]] = k;
  }
  PetscFunctionReturn(0);
}

/* The separators' order of elimination, and with it their tree of fronts. */
static PetscErrorCode CreateInterface(EqmLinear linear, const EqmSeparation *separation)
{
  Substructure *const s = linear->data;
  const PetscInt n = s->num_edge;
  PetscInt *position, *edge, *unknown, *span, *of_edge, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc5(n, &position, n, &edge, n, &unknown, 2 * n, &span, n, &of_edge));
  for (PetscInt k = 0; k < separation->num_separators; k++) {
    for (PetscInt c = 0; c < linear->unknowns.count[separation->vertex[k]]; c++) of_edge[count++] = k;
  }
  for (PetscInt k = 0; k < n; k++) {
    position[k] = s->position[s->num_inner + k];
    edge[k] = k;
  }
  PetscCall(PetscSortIntWithArray(n, position, edge));
  PetscCall(PetscMalloc1(n, &s->place));
  PetscCall(PetscMalloc1(s->num_inner + n, &s->corner_at));
  for (PetscInt k = 0; k < s->num_inner + n; k++) s->corner_at[k] = -1;
  for (PetscInt k = 0; k < n; k++) {
    s->place[edge[k]] = s->corner_at[position[k]] = k;
    unknown[k] = s->edge_unknown[edge[k]];
    span[2 * k] = separation->span[2 * of_edge[edge[k]]];
    span[2 * k + 1] = separation->span[2 * of_edge[edge[k]] + 1];
  }
  PetscCall(EqmInterfaceCreate(linear->mesh->comm, n, unknown, span, &s->interface));
  PetscCall(PetscFree5(position, edge, unknown, span, of_edge));
  PetscFunctionReturn(0);
}

static PetscErrorCode Agree(EqmLinear linear, const char *what)
{
  Substructure *const s = linear->data;
  char message[EQM_MESSAGE_MAX];

  PetscFunctionBegin;
  PetscCall(
      PetscSNPrintf(message, sizeof(message),
                    "CHOLMOD's %s failed on rank %d (status %d): too little memory for its share of the mesh; use "
                    "more ranks or nodes",
                    what, linear->mesh->rank, s->common.status));
  PetscCall(EqmAgree(linear->mesh->comm, s->common.status < 0 ? PETSC_ERR_MEM : 0, message));
  PetscFunctionReturn(0);
}

static PetscErrorCode Analyse(EqmLinear linear, EqmOrdering ordering)
{
  Substructure *const s = linear->data;
  EqmEstimate *const e = &linear->estimate;
  const EqmSeparation *separation;
  PetscReal local[2], sum[2], bytes, flops;

  PetscFunctionBegin;
  PetscCall(EqmOrderingGetSeparation(ordering, &separation));
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscCall(CreateEdges(linear, separation));
  PetscCall(NumberOwned(linear, separation));
  PetscCall(MakePattern(linear));
  PetscCall(AnalyseInner(linear, separation));
  PetscCall(Agree(linear, "analysis"));
  PetscCall(CreateInterface(linear, separation));
  PetscCall(EqmInterfaceGetCost(s->interface, &e->largest_front, &bytes, &flops));
  if (s->factor) EqmEstimateCholmod(s->factor, &s->common, e);
  local[0] = e->nonzeros;
  local[1] = e->flops + flops;
  PetscCall(MPIU_Allreduce(local, sum, 2, MPIU_REAL, MPIU_SUM, linear->mesh->comm));
  e->nonzeros = sum[0];
  e->flops = sum[1];
  e->bytes_on_rank += bytes + (PetscReal)sizeof(PetscScalar) * PetscSqr((PetscReal)s->num_edge);
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscFunctionReturn(0);
}

/* ---- factorisation */

static inline PetscScalar ValueAt(const EqmBlocks *blocks, PetscInt source)
{
  return source >= 0 ? blocks->value[0][source] : blocks->value[1][-1 - source];
}

/* D: the owner of a separator knows its diagonal and the length of its row, the other ranks ask it. */
static PetscErrorCode FillShift(EqmLinear linear, const EqmBlocks *blocks)
{
  Substructure *const s = linear->data;
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
static void TakeCorner(Substructure *s)
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
static PetscErrorCode MakeShare(Substructure *s, const EqmBlocks *blocks, PetscScalar **share)
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
  Substructure *const s = linear->data;
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
  PetscCall(Agree(linear, "factorisation"));
  PetscCall(MPIU_Allreduce(&mine, success, 1, MPIU_BOOL, MPI_LAND, linear->mesh->comm));
  PetscFunctionReturn(0);
}

static PetscErrorCode Factor(EqmLinear linear, PetscBool *success)
{
  Substructure *const s = linear->data;
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

/* ---- solves: b_I in the factor's order, y = L^-1 (b_I, 0), whose last part times the corner is -A_SI A_II^-1 b_I;
   with x_S from the tree, x = L^-T (y_I, corner^T x_S) */

static PetscErrorCode SolveTriangle(Substructure *s, int system, cholmod_dense *b, cholmod_dense **x)
{
  PetscFunctionBegin;
  PetscCheck(CHOLMOD(solve2)(system, s->factor, b, NULL, x, NULL, &s->work_y, &s->work_e, &s->common), PETSC_COMM_SELF,
             PETSC_ERR_LIB, "CHOLMOD's solve failed (status %d)", s->common.status);
  PetscFunctionReturn(0);
}

/* edge <- corner edge or corner^T edge; above its diagonal the corner is zero. */
static PetscErrorCode ApplyCorner(Substructure *s, const char *transpose, PetscInt num_rhs, PetscScalar *edge)
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
static PetscErrorCode Reserve(Substructure *s, PetscInt num_rhs)
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
  Substructure *const s = linear->data;
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
  Substructure *const s = linear->data;
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

static PetscErrorCode Solve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x, PetscBool *success)
{
  Substructure *const s = linear->data;
  PetscScalar *edge;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num_rhs * s->num_edge, &edge));
  PetscCall(SolveForward(linear, num_rhs, b, edge));
  PetscCall(EqmInterfaceSolve(s->interface, num_rhs, edge));
  PetscCall(SolveBackward(linear, num_rhs, edge, x));
  PetscCall(PetscFree(edge));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmLinear linear)
{
  Substructure *const s = linear->data;

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
  Substructure *s;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  linear->data = s;
  linear->analyse = Analyse;
  linear->factor = Factor;
  linear->solve = Solve;
  linear->destroy = Destroy;
  CHOLMOD(start)(&s->common);
  s->common.print = 0;
  s->common.supernodal = CHOLMOD_SUPERNODAL;
  s->common.quick_return_if_not_posdef = 1;
  PetscFunctionReturn(0);
}
