/* One side of a registration: a mesh with its map to the target, computed or read. */
#include "register/registration.h"
#include "register/closest.h"
#include "method/method.h"
#include "store/h5.h"
#include "store/store.h"
#include <math.h>
#include <string.h>

/* Does the file hold a map beside its mesh? */
static PetscErrorCode HoldsMap(MPI_Comm comm, const char *file, PetscBool *holds)
{
  EqmH5 h5;

  PetscFunctionBegin;
  *holds = PETSC_FALSE;
  if (!EqmHasSuffix(file, ".h5")) PetscFunctionReturn(0);
  PetscCall(EqmH5Open(comm, file, &h5));
  PetscCall(EqmH5HasDataset(h5, "/map/coordinates", holds));
  PetscCall(EqmH5Close(&h5));
  PetscFunctionReturn(0);
}

/* The target that the mesh's topology asks for; B must have A's. */
static PetscErrorCode ChooseTarget(EqmRegistration r, const EqmSide *side)
{
  static const char *const targets[] = {
      [EQM_SHAPE_DISK] = "disk", [EQM_SHAPE_SPHERE] = "sphere", [EQM_SHAPE_BALL] = "ball", [EQM_SHAPE_OTHER] = NULL};
  char text[4 * EQM_MESSAGE_MAX];
  EqmDiagnosis diagnosis;
  PetscBool fatal = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(r->ledger, EQM_PHASE_DIAGNOSE));
  PetscCall(EqmSoupDiagnose(side->soup, &diagnosis));
  PetscCall(EqmDiagnosisDescribe(&diagnosis, targets[diagnosis.topology], &fatal, text, sizeof(text)));
  if (!targets[diagnosis.topology] || fatal)
    EqmFail(r->comm, EQM_ERR_MESH, "%s is neither disk, sphere nor ball, or cannot be mapped to it:\n%s",
            side->soup->file, text);
  PetscCall(EqmPhaseEnd(r->ledger, EQM_PHASE_DIAGNOSE));
  if (r->target[0] && strcmp(r->target, targets[diagnosis.topology]))
    EqmFail(r->comm, EQM_ERR_MESH,
            "A is of the kind that maps to the %s, but %s maps to the %s: they do not correspond", r->target,
            side->soup->file, targets[diagnosis.topology]);
  PetscCall(PetscStrncpy(r->target, targets[diagnosis.topology], sizeof(r->target)));
  r->dim = diagnosis.topology == EQM_SHAPE_DISK ? 2 : 3;
  r->kind = diagnosis.topology == EQM_SHAPE_DISK     ? EQM_IMAGE_PLANE
            : diagnosis.topology == EQM_SHAPE_SPHERE ? EQM_IMAGE_SPHERE
                                                     : EQM_IMAGE_SPACE;
  PetscFunctionReturn(0);
}

/* Is a map that was read one to this target? Places on the sphere, or within the disk or ball and of boundary vertices
   on its boundary. */
static PetscErrorCode CheckMap(EqmRegistration r, EqmSide *side, const char *file)
{
  const EqmMesh mesh = side->mesh;
  PetscReal worst = 0.;

  PetscFunctionBegin;
  if (side->map->dim != r->dim)
    EqmFail(r->comm, EQM_ERR_USAGE,
            "the map in %s has %" PetscInt_FMT " coordinates; a map to the %s has %" PetscInt_FMT, file, side->map->dim,
            r->target, r->dim);
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    PetscReal squared = 0.;
    for (PetscInt k = 0; k < r->dim; k++) squared += PetscSqr(side->x[r->dim * v + k]);
    const PetscBool on_it = (PetscBool)(r->kind == EQM_IMAGE_SPHERE || mesh->on_boundary[v]);
    const PetscReal beyond = PetscSqrtReal(squared) - 1., off = on_it ? PetscAbsReal(beyond) : PetscMax(0., beyond);
    if (!(off <= worst)) worst = off < INFINITY ? off : PETSC_MAX_REAL; /* no number: as far off as can be */
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &worst, 1, MPIU_REAL, MPIU_MAX, r->comm));
  if (!(worst < 1e-6))
    EqmFail(r->comm, EQM_ERR_USAGE,
            "the map in %s is not one to the unit %s: vertices are off it by up to %.2g; map %s with equimap %s", file,
            r->target, (double)worst, side->soup->file, r->target);
  PetscFunctionReturn(0);
}

/* Maps that look at the target from behind cannot be composed with those that do not: turn them over. */
static PetscErrorCode TurnMirrored(EqmRegistration r, EqmSide *side)
{
  const EqmMesh mesh = side->mesh;
  PetscReal local = 0., total;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscReal *corner[4];
    for (PetscInt a = 0; a < mesh->cell_size; a++) corner[a] = side->x + r->dim * mesh->cells[mesh->cell_size * c + a];
    local += EqmSignedMeasure(r->kind, mesh->cell_size, corner);
  }
  PetscCall(MPIU_Allreduce(&local, &total, 1, MPIU_REAL, MPIU_SUM, r->comm));
  for (PetscInt v = 0; v < mesh->num_local && total < 0.; v++) side->x[r->dim * v] *= -1.;
  PetscFunctionReturn(0);
}

static PetscErrorCode WeighVertices(EqmSide *side)
{
  const EqmMesh mesh = side->mesh;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(mesh->num_local, &side->weight));
  for (PetscInt k = 0; k < mesh->cell_size * mesh->num_local_cells; k++)
    side->weight[mesh->cells[k]] += mesh->weight[k / mesh->cell_size] / mesh->cell_size;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSideRead(EqmRegistration r, EqmSide *side, const char *file, const char *density_file,
                           const char *map_file)
{
  PetscBool holds;

  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(r->ledger, EQM_PHASE_READ));
  PetscCall(EqmSoupRead(r->comm, file, &side->soup));
  if (density_file[0]) PetscCall(EqmSoupReadDensity(side->soup, density_file));
  PetscCall(HoldsMap(r->comm, file, &holds));
  if (map_file[0])
    PetscCall(EqmMapRead(side->soup, map_file, &side->map));
  else if (holds)
    PetscCall(EqmMapRead(side->soup, file, &side->map));
  PetscCall(EqmPhaseEnd(r->ledger, EQM_PHASE_READ));
  PetscCall(ChooseTarget(r, side));
  PetscCall(EqmPhaseBegin(r->ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(EqmMeshCreate(side->soup, r->ledger, &side->mesh));
  PetscCall(EqmPhaseEnd(r->ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(WeighVertices(side));
  if (!side->map) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(r->dim * side->mesh->num_local, &side->x));
  if (side->map->dim == r->dim)
    PetscCall(EqmMeshVerticesFromInput(side->mesh, side->soup, r->dim, side->map->coordinates, side->x));
  PetscCall(CheckMap(r, side, map_file[0] ? map_file : file));
  PetscCall(TurnMirrored(r, side));
  PetscCall(EqmMapMeasure(side->map, side->mesh, side->x));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationMinimise(EqmRegistration r, EqmSolver solver)
{
  PetscFunctionBegin;
  PetscCall(EqmSolverSetStage(solver, ++r->stage));
  PetscCall(EqmSolverSolve(solver));
  if (solver->status != EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  r->status = solver->status;
  PetscCall(PetscStrncpy(r->message, solver->message, sizeof(r->message)));
  PetscFunctionReturn(0);
}

/* Compute the map if it was not read. Collective. */
PetscErrorCode EqmSideSolve(EqmRegistration r, EqmSide *side)
{
  EqmSolver solver;

  PetscFunctionBegin;
  if (side->map) PetscFunctionReturn(0);
  if (!r->set.quiet)
    PetscCall(PetscPrintf(r->comm, "map of %s: %s to the %s\n", side->name, side->soup->file, r->target));
  PetscCall(EqmSolverCreate(side->mesh, r->target, &solver));
  if (side->mesh->cell_size == 3) {
    solver->settings.ratio_tol = EQM_REGISTER_RATIO_TOL;
    solver->settings.lm_inner = EQM_REGISTER_INNER;
  }
  PetscCall(EqmSolverSetFromOptions(solver));
  PetscCall(EqmRegistrationMinimise(r, solver));
  PetscCall(EqmSolverGetMap(solver, side->soup, &side->map));
  PetscCall(PetscMalloc1(r->dim * side->mesh->num_local, &side->x));
  PetscCall(PetscArraycpy(side->x, solver->place.x, r->dim * side->mesh->num_local));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmSideReset(EqmSide *side)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(side->x));
  PetscCall(PetscFree(side->weight));
  if (side->map) PetscCall(EqmMapDestroy(&side->map));
  if (side->mesh) PetscCall(EqmMeshDestroy(&side->mesh));
  if (side->soup) PetscCall(EqmSoupDestroy(&side->soup));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSideGather(const EqmSide *side, PetscInt num, const PetscInt *vertices, PetscInt width,
                             const PetscReal *values, PetscReal *gathered)
{
  PetscInt *local, *owners;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(num, &local, num, &owners));
  PetscCall(EqmMeshFindVertices(side->mesh, num, vertices, local));
  for (PetscInt i = 0; i < num; i++) {
    owners[i] = local[i] >= 0;
    for (PetscInt k = 0; k < width; k++) gathered[width * i + k] = local[i] >= 0 ? values[width * local[i] + k] : 0.;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, gathered, (PetscMPIInt)(width * num), MPIU_REAL, MPIU_SUM, side->mesh->comm));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, owners, (PetscMPIInt)num, MPIU_INT, MPI_SUM, side->mesh->comm));
  for (PetscInt i = 0; i < num; i++) {
    if (owners[i] == 1) continue;
    EqmFail(side->mesh->comm, EQM_ERR_USAGE, "landmark %" PetscInt_FMT ": vertex %" PetscInt_FMT " of %s is in no cell",
            i + 1, vertices[i], side->name);
  }
  PetscCall(PetscFree2(local, owners));
  PetscFunctionReturn(0);
}
