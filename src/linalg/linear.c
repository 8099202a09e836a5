/* One face for the direct solvers and multigrid: which of them a matrix gets. What it does then: linear_solve.c. */
#include "linalg/linalg.h"
#include "linalg/interface.h"
#include "mesh/mesh_private.h"

/* Larger fronts on one rank take half a gigabyte, and minutes that the other ranks wait. */
enum { MOST_FRONT = 8000 };
/* Unknowns of a solid's scalar Laplacian and of its metric, beyond which a set-up of multigrid and the solves with it
   cost less than a factor, or than its ordering alone. On surfaces they never do. */
enum { MOST_IN_SOLID = 50000, MOST_IN_METRIC = 60000 };
/* Factors of fewer unknowns stay in the processor's cache whatever their precision. */
enum { LEAST_SINGLE = 10000 };
/* Relative residual of an iteration that stands for an exact solve. */
static const PetscReal exact = 1e-10;
static const PetscReal gib = 1024. * 1024. * 1024.;

/* Undo what Try has done. */
static PetscErrorCode Release(EqmLinear linear)
{
  PetscFunctionBegin;
  PetscCall(linear->destroy(linear));
  PetscCall(EqmAssemblyDestroy(&linear->assembly));
  PetscFunctionReturn(0);
}

/* Make a solver of one kind, up to what it knows before it sees numbers. */
static PetscErrorCode Try(EqmLinear linear, EqmOrdering ordering, EqmSolverKind kind)
{
  EqmEstimate *const e = &linear->estimate;
  PetscReal mine;

  PetscFunctionBegin;
  linear->kind = kind;
  *e = (EqmEstimate){0};
  linear->rows = linear->unknowns;
  linear->padded_cell = NULL;
  linear->set_fields = NULL;
  switch (kind) {
  case EQM_SOLVER_CHOLMOD:
    PetscCall(EqmLinearSetUpCholmod(linear));
    break;
  case EQM_SOLVER_MULTIFRONTAL:
    PetscCall(EqmLinearSetUpMultifrontal(linear));
    break;
  case EQM_SOLVER_SUBSTRUCTURE:
    PetscCall(EqmLinearSetUpSubstructure(linear));
    break;
  case EQM_SOLVER_MUMPS:
    PetscCall(EqmLinearSetUpMumps(linear));
    break;
  case EQM_SOLVER_PETSC:
    PetscCall(EqmLinearSetUpPetsc(linear));
    break;
  default:
    PetscCall(EqmLinearSetUpMultigrid(linear));
  }
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_ASSEMBLE));
  PetscCall(
      EqmAssemblyCreate(linear->mesh, &linear->rows,
                        kind == EQM_SOLVER_MULTIGRID || kind == EQM_SOLVER_PETSC ? EQM_STORE_FULL : EQM_STORE_LOWER,
                        &linear->assembly));
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_ASSEMBLE));
  PetscCall(linear->analyse(linear, ordering));
  mine = e->bytes_on_rank;
  PetscCall(MPIU_Allreduce(&mine, &e->bytes, 1, MPIU_REAL, MPIU_SUM, linear->mesh->comm));
  PetscCall(MPIU_Allreduce(&mine, &e->most_bytes_on_rank, 1, MPIU_REAL, MPIU_MAX, linear->mesh->comm));
  PetscFunctionReturn(0);
}

/* Has every rank the memory? */
static PetscErrorCode FitsInMemory(EqmLinear linear, PetscReal limit, PetscBool *fits)
{
  const PetscBool mine = (PetscBool)(linear->estimate.bytes_on_rank <= limit);

  PetscFunctionBegin;
  PetscCall(MPIU_Allreduce(&mine, fits, 1, MPIU_BOOL, MPI_LAND, linear->mesh->comm));
  PetscFunctionReturn(0);
}

/* Would a factor cost more than multigrid? */
static PetscBool IsCostly(EqmLinear linear)
{
  if (linear->use == EQM_MATRIX_METRIC) return (PetscBool)(linear->num_unknowns > MOST_IN_METRIC);
  return (PetscBool)(linear->use == EQM_MATRIX_SCALAR && linear->mesh->cell_size == 4 &&
                     linear->num_unknowns > MOST_IN_SOLID);
}

/* In the plane and on surfaces an exact Cholesky factor beats multigrid at every size that fits in memory. On one rank
   the multifrontal factor is the fastest on one thread already, and the one that uses several; on several ranks
   substructuring gives the same bits in every run, as long as what is left between the ranks is no burden. MUMPS needs
   the order of all vertices on one rank, which large meshes do not get: with fronts shared it has nothing to offer
   there. */
static PetscErrorCode Choose(EqmLinear linear, EqmOrdering ordering, PetscReal limit)
{
  static const EqmSolverKind alone[] = {EQM_SOLVER_MULTIFRONTAL},
                             together[] = {EQM_SOLVER_SUBSTRUCTURE, EQM_SOLVER_MUMPS};
  const PetscBool is_alone = (PetscBool)(linear->mesh->size == 1);
  const EqmSolverKind *const direct = is_alone ? alone : together;
  const PetscBool is_large = (PetscBool)(linear->mesh->num_vertices > EQM_MOST_ON_ONE_RANK);
  const PetscInt num_direct = is_alone || (is_large && EqmInterfaceCanShare()) ? 1 : 2;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < num_direct && !IsCostly(linear); k++) {
    PetscBool fits;
    PetscCall(Try(linear, ordering, direct[k]));
    PetscCall(FitsInMemory(linear, limit, &fits));
    if (fits && linear->estimate.largest_front_on_one <= MOST_FRONT) PetscFunctionReturn(0);
    PetscCall(Release(linear));
  }
  PetscCall(Try(linear, ordering, EQM_SOLVER_MULTIGRID));
  PetscFunctionReturn(0);
}

/* The user's choice. */
static PetscErrorCode Obey(EqmLinear linear, EqmOrdering ordering, EqmSolverKind kind, PetscReal limit)
{
  const MPI_Comm comm = linear->mesh->comm;
  PetscBool fits;

  PetscFunctionBegin;
  if ((kind == EQM_SOLVER_CHOLMOD || kind == EQM_SOLVER_MULTIFRONTAL) && linear->mesh->size > 1) {
    EqmFail(comm, EQM_ERR_USAGE,
            "-linear_solver %s works on one rank only; on several take substructure, mumps or multigrid",
            EqmSolverKinds[kind]);
  }
  PetscCall(Try(linear, ordering, kind));
  PetscCall(FitsInMemory(linear, limit, &fits));
  if (!fits) {
    EqmFail(comm, EQM_ERR_USAGE,
            "-linear_solver %s would take %.3g GiB on a rank, of %.3g GiB that it may use; give more ranks or nodes, "
            "-linear_solver multigrid, or a larger -memory_limit",
            EqmSolverKinds[kind], (double)(linear->estimate.most_bytes_on_rank / gib), (double)(limit / gib));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLinearBegin(EqmMesh mesh, const EqmUnknowns *unknowns, EqmMatrixUse use, EqmLinear *linear)
{
  PetscEnum precision = (PetscEnum)EQM_PRECISION_AUTO;
  PetscFunctionBegin;
  PetscCall(PetscNew(linear));
  (*linear)->mesh = mesh;
  (*linear)->use = use;
  (*linear)->unknowns = *unknowns;
  (*linear)->num_owned = unknowns->num_owned;
  (*linear)->tolerance = exact;
  PetscCall(PetscOptionsGetEnum(NULL, NULL, "-linear_precision", EqmPrecisions, &precision, NULL));
  PetscCall(MPIU_Allreduce(&unknowns->num_owned, &(*linear)->num_unknowns, 1, MPIU_INT, MPI_SUM, mesh->comm));
  if (precision == (PetscEnum)EQM_PRECISION_AUTO)
    precision = (PetscEnum)((*linear)->num_unknowns < LEAST_SINGLE ? EQM_PRECISION_DOUBLE : EQM_PRECISION_SINGLE);
  (*linear)->is_single = (PetscBool)(precision == (PetscEnum)EQM_PRECISION_SINGLE && use == EQM_MATRIX_STEP);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLinearWantedKind(EqmSolverKind *kind)
{
  PetscEnum wanted = (PetscEnum)EQM_SOLVER_AUTO;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetEnum(NULL, NULL, "-linear_solver", EqmSolverKinds, &wanted, NULL));
  *kind = (EqmSolverKind)wanted;
  PetscFunctionReturn(0);
}

/* A solver for matrices with the given unknowns (whose arrays must outlive it). Options: -linear_solver,
   -linear_precision, -memory_limit; of kind hierarchy are only those that EqmLinearCreateOnLevels makes. Errors:
   EQM_ERR_USAGE if the solver asked for does not fit. Collective. */
PetscErrorCode EqmLinearCreate(EqmMesh mesh, EqmOrdering ordering, const EqmUnknowns *unknowns, EqmMatrixUse use,
                               EqmLinear *out)
{
  EqmSolverKind kind;
  PetscReal limit;

  PetscFunctionBegin;
  PetscCall(EqmLinearWantedKind(&kind));
  PetscCall(EqmMemoryLimit(mesh->comm, &limit));
  PetscCall(EqmLinearBegin(mesh, unknowns, use, out));
  if (kind == EQM_SOLVER_AUTO || kind == EQM_SOLVER_HIERARCHY)
    PetscCall(Choose(*out, ordering, limit));
  else
    PetscCall(Obey(*out, ordering, kind, limit));
  PetscFunctionReturn(0);
}

/* One line on what solves and what it takes. Not collective. */
PetscErrorCode EqmLinearDescribe(EqmLinear linear, char *text, size_t length)
{
  const EqmEstimate *const e = &linear->estimate;
  char between[64] = "", shared[64] = "";

  PetscFunctionBegin;
  if (linear->kind >= EQM_SOLVER_MULTIGRID) {
    PetscCall(PetscSNPrintf(text, length, "%s (%" PetscInt_FMT " unknowns)", EqmSolverKinds[linear->kind],
                            linear->num_unknowns));
    PetscFunctionReturn(0);
  }
  if (linear->kind == EQM_SOLVER_SUBSTRUCTURE)
    PetscCall(PetscSNPrintf(between, sizeof(between), ", largest front %" PetscInt_FMT, e->largest_front));
  if (e->front_ranks > 1)
    PetscCall(PetscSNPrintf(shared, sizeof(shared), " on %" PetscInt_FMT " ranks", e->front_ranks));
  PetscCall(PetscSNPrintf(text, length,
                          "%s (%" PetscInt_FMT
                          " unknowns%s%s, factor of %.3g nonzeros, %.3g operations, at most %.3g GiB "
                          "per rank)",
                          EqmSolverKinds[linear->kind], linear->num_unknowns, between, shared, (double)e->nonzeros,
                          (double)e->flops, (double)(e->most_bytes_on_rank / gib)));
  PetscFunctionReturn(0);
}

/* End what EqmLinearSetInexact has begun. For the factorisations to come. Not collective. */
PetscErrorCode EqmLinearSetExact(EqmLinear linear)
{
  PetscFunctionBegin;
  linear->inexact = PETSC_FALSE;
  linear->tolerance = exact;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmLinearDestroy(EqmLinear *linear)
{
  PetscFunctionBegin;
  if (!*linear) PetscFunctionReturn(0);
  PetscCall(Release(*linear));
  PetscCall(PetscFree(*linear));
  PetscFunctionReturn(0);
}
