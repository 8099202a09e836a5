/* Symbolic work of substructuring (substructure.c says what it is). */
#include "linalg/substructure.h"
#include "mesh/mesh_private.h"

static PetscErrorCode CreateSeparatorUnknowns(EqmLinear linear, const EqmSeparation *separation)
{
  EqmSubstructure *const s = linear->data;
  const EqmUnknowns *const u = &linear->unknowns;
  PetscInt n = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < separation->num_separators; k++) n += u->count[separation->vertex[k]];
  s->num_separator_unknowns = n;
  PetscCall(PetscMalloc5(n, &s->separator_vertex, n, &s->separator_component, n, &s->separator_links, n,
                         &s->separator_unknown, n, &s->shift));
  n = 0;
  for (PetscInt k = 0; k < separation->num_separators; k++) {
    const PetscInt v = separation->vertex[k];
    for (PetscInt c = 0; c < u->count[v]; c++, n++) {
      s->separator_vertex[n] = v;
      s->separator_component[n] = c;
      s->separator_links[n] = separation->links[k];
      s->separator_unknown[n] = u->start[v] + c;
    }
  }
  PetscFunctionReturn(0);
}

/* Inner unknowns keep their order, so that sorted rows stay sorted. */
static PetscErrorCode NumberOwned(EqmLinear linear, const EqmSeparation *separation)
{
  EqmSubstructure *const s = linear->data;
  const EqmUnknowns *const u = &linear->unknowns;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(linear->num_owned, &s->local));
  for (PetscInt i = 0; i < linear->num_owned; i++) s->local[i] = 0;
  for (PetscInt k = 0; k < s->num_separator_unknowns; k++) {
    const PetscInt i = s->separator_unknown[k] - u->first;
    if (i >= 0 && i < linear->num_owned) s->local[i] = 1;
  }
  s->num_inner = 0;
  for (PetscInt i = 0; i < linear->num_owned; i++) s->local[i] = s->local[i] ? -1 : s->num_inner++;
  for (PetscInt k = 0; k < s->num_separator_unknowns; k++) {
    const PetscInt i = s->separator_unknown[k] - u->first;
    if (i >= 0 && i < linear->num_owned) s->local[i] = s->num_inner + k;
  }
  PetscFunctionReturn(0);
}

/* This rank's number of the column of an entry. */
static PetscErrorCode LocalColumn(const EqmSubstructure *s, const EqmBlocks *blocks, int block, PetscInt column,
                                  PetscInt *local)
{
  PetscInt place;

  PetscFunctionBegin;
  if (block == 0) {
    *local = s->local[column];
  } else {
    PetscCall(PetscFindInt(blocks->global_column[column], s->num_separator_unknowns, s->separator_unknown, &place));
    PetscCheck(place >= 0, PETSC_COMM_SELF, PETSC_ERR_PLIB, "a column of another rank is no separator's");
    *local = s->num_inner + place;
  }
  PetscFunctionReturn(0);
}

/* Go through the stored entries: count them (`next` NULL) or put them in their place. */
static PetscErrorCode PlaceEntries(EqmLinear linear, const EqmBlocks *blocks, PetscInt *count, PetscInt *next)
{
  EqmSubstructure *const s = linear->data;
  const PetscInt first_separator = s->num_inner;
  PetscInt *const column = s->matrix.i;

  PetscFunctionBegin;
  s->num_couplings = 0;
  for (PetscInt i = 0; i < linear->num_owned; i++) {
    for (int block = 0; block < 2 && blocks->block[block]; block++) {
      for (PetscInt q = blocks->start[block][i]; q < blocks->start[block][i + 1]; q++) {
        const PetscInt source = block == 0 ? q : -1 - q;
        PetscInt a = s->local[i], b;
        PetscCall(LocalColumn(s, blocks, block, blocks->column[block][q], &b));
        if (a >= first_separator && b >= first_separator) {
          if (next) {
            s->coupling[3 * s->num_couplings] = source;
            s->coupling[3 * s->num_couplings + 1] = a - first_separator;
            s->coupling[3 * s->num_couplings + 2] = b - first_separator;
          }
          s->num_couplings++;
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

/* The rank's matrix by rows, lower triangle, with entries for D. */
static PetscErrorCode MakePattern(EqmLinear linear)
{
  EqmSubstructure *const s = linear->data;
  const PetscInt n = s->num_inner + s->num_separator_unknowns;
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
                               .itype = sizeof(PetscInt) == sizeof(int) ? CHOLMOD_INT : CHOLMOD_LONG,
                               .xtype = CHOLMOD_REAL,
                               .dtype = CHOLMOD_DOUBLE,
                               .sorted = 1,
                               .packed = 1};
  PetscCall(PetscMalloc1(start[n], (PetscInt **)&s->matrix.i));
  PetscCall(PetscMalloc1(start[n], (PetscScalar **)&s->matrix.x));
  PetscCall(PetscMalloc1(start[n], &s->source));
  PetscCall(PetscMalloc1(3 * s->num_couplings, &s->coupling));
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
  EqmSubstructure *const s = linear->data;
  const EqmUnknowns *const u = &linear->unknowns;
  const PetscInt n = s->num_inner + s->num_separator_unknowns;
  PetscInt *order, count = 0;

  PetscFunctionBegin;
  if (s->num_inner == 0) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(n, &order));
  for (PetscInt k = 0; k < separation->num_inner; k++) {
    const PetscInt v = separation->inner[k];
    for (PetscInt c = 0; c < u->count[v]; c++) order[count++] = s->local[u->start[v] - u->first + c];
  }
  for (PetscInt k = s->num_inner; k < n; k++) order[count++] = k;
  PetscCall(EqmFrontalCreate(&s->matrix, order, &s->factor));
  if (linear->is_single) PetscCall(EqmFrontalKeepSingle(s->factor));
  PetscCall(PetscFree(order));
  PetscFunctionReturn(0);
}

/* The separators' order of elimination, and with it their tree of fronts. */
static PetscErrorCode CreateInterface(EqmLinear linear, const EqmSeparation *separation)
{
  EqmSubstructure *const s = linear->data;
  const PetscInt n = s->num_separator_unknowns;
  const PetscInt *eliminated = NULL;
  PetscInt *position, *in_order, *unknown, *span, *vertex_of, count = 0, shared_front;

  PetscFunctionBegin;
  if (s->factor) PetscCall(EqmFrontalGetPositions(s->factor, &eliminated));
  PetscCall(PetscMalloc5(n, &position, n, &in_order, n, &unknown, 2 * n, &span, n, &vertex_of));
  for (PetscInt k = 0; k < separation->num_separators; k++) {
    for (PetscInt c = 0; c < linear->unknowns.count[separation->vertex[k]]; c++) vertex_of[count++] = k;
  }
  for (PetscInt k = 0; k < n; k++) {
    position[k] = eliminated ? eliminated[s->num_inner + k] : s->num_inner + k;
    in_order[k] = k;
  }
  PetscCall(PetscSortIntWithArray(n, position, in_order));
  PetscCall(PetscMalloc1(n, &s->place));
  PetscCall(PetscMalloc1(s->num_inner + n, &s->separator_at));
  for (PetscInt k = 0; k < s->num_inner + n; k++) s->separator_at[k] = -1;
  for (PetscInt k = 0; k < n; k++) {
    s->place[in_order[k]] = s->separator_at[position[k]] = k;
    unknown[k] = s->separator_unknown[in_order[k]];
    span[2 * k] = separation->span[2 * vertex_of[in_order[k]]];
    span[2 * k + 1] = separation->span[2 * vertex_of[in_order[k]] + 1];
  }
  PetscCall(EqmLinearGetSharedFront(linear->mesh->comm, &shared_front));
  PetscCall(EqmInterfaceCreate(linear->mesh->comm, n, unknown, span, shared_front, &s->interface));
  PetscCall(PetscFree5(position, in_order, unknown, span, vertex_of));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSubstructureCheckMemory(EqmLinear linear, const char *what)
{
  EqmSubstructure *const s = linear->data;
  const PetscBool enough = (PetscBool)(!s->factor || EqmFrontalHasMemory(s->factor));
  char message[EQM_MESSAGE_MAX];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(message, sizeof(message),
                          "too little memory on rank %d for the %s of its share of a matrix; use more ranks or nodes",
                          linear->mesh->rank, what));
  PetscCall(EqmAgree(linear->mesh->comm, enough ? 0 : PETSC_ERR_MEM, message));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSubstructureAnalyse(EqmLinear linear, EqmOrdering ordering)
{
  EqmSubstructure *const s = linear->data;
  EqmEstimate *const e = &linear->estimate;
  const EqmSeparation *separation;
  EqmInterfaceCost cost;
  PetscReal local[2], sum[2];

  PetscFunctionBegin;
  PetscCall(EqmOrderingGetSeparation(ordering, &separation));
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscCall(CreateSeparatorUnknowns(linear, separation));
  PetscCall(NumberOwned(linear, separation));
  PetscCall(MakePattern(linear));
  PetscCall(AnalyseInner(linear, separation));
  PetscCall(EqmSubstructureCheckMemory(linear, "analysis"));
  PetscCall(CreateInterface(linear, separation));
  PetscCall(EqmInterfaceGetCost(s->interface, &cost));
  e->largest_front = cost.largest;
  e->largest_front_on_one = cost.largest_on_one;
  e->front_ranks = cost.most_ranks;
  if (s->factor) PetscCall(EqmFrontalGetCost(s->factor, e));
  local[0] = e->nonzeros;
  local[1] = e->flops + cost.flops;
  PetscCall(MPIU_Allreduce(local, sum, 2, MPIU_REAL, MPIU_SUM, linear->mesh->comm));
  e->nonzeros = sum[0];
  e->flops = sum[1];
  e->bytes_on_rank += cost.bytes + (PetscReal)sizeof(PetscScalar) * PetscSqr((PetscReal)s->num_separator_unknowns);
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscFunctionReturn(0);
}
