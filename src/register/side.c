/* One side of a registration: a mesh with its map to the target, computed or read. */
#include "register/registration.h"
#include "mesh/mesh_private.h"
#include "register/closest.h"
#include "base/lookup.h"
#include "solver/inner.h"
#include "h5/h5.h"
#include "store/keptmesh.h"
#include "store/store.h"
#include <math.h>
#include <string.h>

/* Does the file have a map beside its mesh? */
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

/* A and B must have the same topology, and so the same target. */
static PetscErrorCode SetTarget(EqmRegistration r, const EqmSide *side)
{
  const EqmIntake *const intake = &side->intake;

  PetscFunctionBegin;
  if (r->target[0] && strcmp(r->target, intake->target))
    EqmFail(r->comm, EQM_ERR_MESH,
            "A is of the kind that maps to the %s, but %s maps to the %s: they do not correspond", r->target,
            side->soup->file, intake->target);
  PetscCall(PetscStrncpy(r->target, intake->target, sizeof(r->target)));
  r->dim = intake->topology == EQM_TOPOLOGY_DISK ? 2 : 3;
  r->kind = intake->topology == EQM_TOPOLOGY_DISK     ? EQM_IMAGE_PLANE
            : intake->topology == EQM_TOPOLOGY_SPHERE ? EQM_IMAGE_SPHERE
                                                      : EQM_IMAGE_SPACE;
  PetscFunctionReturn(0);
}

/* Check that a map from a file is one to this target: images on the sphere, or in the disk or ball with boundary
   vertices on its boundary. */
static PetscErrorCode CheckMap(EqmRegistration r, EqmSide *side, const char *file)
{
  const EqmMesh mesh = side->mesh;
  PetscReal worst = 0.;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    PetscReal squared = 0.;
    for (PetscInt k = 0; k < r->dim; k++) squared += PetscSqr(side->x[r->dim * v + k]);
    const PetscBool on_it = (PetscBool)(r->kind == EQM_IMAGE_SPHERE || mesh->on_boundary[v]);
    const PetscReal beyond = PetscSqrtReal(squared) - 1., off = on_it ? PetscAbsReal(beyond) : PetscMax(0., beyond);
    if (!(off <= worst)) worst = off < INFINITY ? off : PETSC_MAX_REAL; /* not a number: infinitely far off */
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &worst, 1, MPIU_REAL, MPIU_MAX, r->comm));
  if (!(worst < 1e-6))
    EqmFail(r->comm, EQM_ERR_USAGE,
            "the map in %s is not one to the unit %s: vertices are off it by up to %.2g; map %s with equimap %s", file,
            r->target, (double)worst, side->soup->file, r->target);
  PetscFunctionReturn(0);
}

/* Maps of opposite orientation cannot be composed: reflect the negative one. */
static PetscErrorCode ReflectMirrored(EqmRegistration r, EqmSide *side)
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
  PetscCall(PetscMalloc1(mesh->num_local, &side->weight));
  PetscCall(EqmMeshVertexWeights(mesh, side->weight));
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, side->weight));
  PetscFunctionReturn(0);
}

/* Read the images of the repaired mesh, if the result has them. */
static PetscErrorCode ReadRepaired(EqmRegistration r, EqmSide *side, const char *file, PetscBool *found)
{
  const EqmSoup repaired = side->intake.mapped;
  EqmSlab slab = {repaired->num_vertices, repaired->vertex_start, repaired->vertex_end - repaired->vertex_start,
                  r->dim};
  const char *const path = "/repaired/coordinates";
  PetscInt64 rows = 0, width = 0;
  PetscReal *places;
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(slab.width * slab.count + 1, &places));
  PetscCall(EqmH5Open(r->comm, file, &h5));
  PetscCall(EqmH5HasDataset(h5, path, found));
  if (*found) PetscCall(EqmH5GetShape(h5, path, &rows, &width));
  *found = (PetscBool)(rows == slab.total && width == slab.width);
  if (*found) PetscCall(EqmH5ReadReals(h5, path, slab, places));
  PetscCall(EqmH5Close(&h5));
  if (*found) PetscCall(EqmMeshVerticesFromInput(side->mesh, repaired, r->dim, places, side->x));
  PetscCall(PetscFree(places));
  PetscFunctionReturn(0);
}

/* The map of the repaired mesh: from the result if that has the same repaired mesh, else by linear interpolation in the
   cells of the file. */
static PetscErrorCode SetRepairedMap(EqmRegistration r, EqmSide *side, const char *file)
{
  const EqmIntake *const intake = &side->intake;
  PetscBool found = PETSC_FALSE;

  PetscFunctionBegin;
  if (EqmHasSuffix(file, ".h5")) PetscCall(ReadRepaired(r, side, file, &found));
  if (!found) PetscCall(EqmVerticesFromOrigin(side->origin, r->dim, side->read->coordinates, side->x));
  PetscCall(EqmMapCreate(intake->mapped, r->dim, &side->map));
  PetscCall(EqmMeshVerticesToInput(side->mesh, intake->mapped, r->dim, side->x, side->map->coordinates));
  PetscCall(PetscStrncpy(side->map->method, side->read->method, sizeof(side->map->method)));
  side->read->repaired = side->map;
  side->read->parent = intake->parent;
  side->read->repair = intake->repair;
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadMap(EqmRegistration r, EqmSide *side, const char *file, PetscBool is_copy)
{
  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(r->ledger, EQM_PHASE_READ));
  PetscCall(EqmMapRead(side->soup, file, &side->read));
  if (side->read->dim != r->dim)
    EqmFail(r->comm, EQM_ERR_USAGE,
            "the map in %s has %" PetscInt_FMT " coordinates; a map to the %s has %" PetscInt_FMT, file,
            side->read->dim, r->target, r->dim);
  PetscCall(PetscMalloc1(r->dim * side->mesh->num_local, &side->x));
  if (side->intake.mapped != side->intake.given) {
    PetscCall(SetRepairedMap(r, side, file));
  } else {
    side->map = side->read;
    PetscCall(EqmMeshVerticesFromInput(side->mesh, side->soup, r->dim, side->read->coordinates, side->x));
  }
  if (is_copy) PetscCall(EqmKeptMeshCheckMap(side->read, file));
  PetscCall(EqmPhaseEnd(r->ledger, EQM_PHASE_READ));
  PetscCall(CheckMap(r, side, file));
  PetscCall(ReflectMirrored(r, side));
  PetscCall(EqmMapMeasure(side->map, side->mesh, side->x));
  PetscFunctionReturn(0);
}

/* Which file has the map: the named one, the mesh's own, or the run's copy if the named one is gone; NULL: none has. */
static PetscErrorCode ChooseMap(EqmRegistration r, EqmIntakeOptions *options, const char *restart, const char *map_file,
                                const char **file, PetscBool *is_copy)
{
  PetscBool there, holds, has_density;

  PetscFunctionBegin;
  PetscCall(EqmFileIsThere(r->comm, map_file, &there));
  *file = map_file;
  *is_copy = PETSC_FALSE;
  if (map_file[0] && (there || !restart)) PetscFunctionReturn(0);
  if (map_file[0] && !options->copy[0])
    PetscCall(
        EqmKeptMeshFind(r->comm, restart, options->part[0] == 'B', options->copy, sizeof(options->copy), &has_density));
  *is_copy = (PetscBool)(map_file[0] || options->is_copy);
  *file = *is_copy ? options->copy : options->mesh;
  PetscCall(HoldsMap(r->comm, *file, &holds));
  if (!holds) *file = map_file[0] ? map_file : NULL;
  if (holds && *is_copy && !options->is_copy && !r->set.quiet)
    PetscCall(PetscPrintf(r->comm, "%s: the map is the run's own copy, '%s'\n", options->part, *file));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSideRead(EqmRegistration r, EqmSide *side, const char *file, const char *density_file,
                           const char *map_file, const char *usage)
{
  EqmIntakeOptions options = {.part = side->name,
                              .usage = usage,
                              .density = density_file[0] ? density_file : NULL,
                              .repair = r->set.repair,
                              .any_size = PETSC_TRUE,
                              .quiet = r->set.quiet};
  char name[PETSC_MAX_PATH_LEN];
  const char *restart, *with_map;
  PetscBool is_copy;

  PetscFunctionBegin;
  PetscCall(EqmFirstRestart(r, name, &restart));
  PetscCall(EqmIntakeChoose(r->comm, file, restart, &options));
  PetscCall(EqmIntakeRead(r->comm, &options, r->ledger, &side->intake));
  if (side == &r->b) PetscCall(EqmTakeUnitOfA(r));
  side->soup = side->intake.given;
  PetscCall(SetTarget(r, side));
  PetscCall(ChooseMap(r, &options, restart, map_file, &with_map, &is_copy));
  PetscCall(EqmPhaseBegin(r->ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(EqmMeshCreate(side->intake.mapped, r->ledger, &side->mesh));
  PetscCall(EqmOriginCreate(&side->intake, side->mesh, &side->origin));
  PetscCall(EqmPhaseEnd(r->ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(WeighVertices(side));
  if (with_map) PetscCall(ReadMap(r, side, with_map, is_copy));
  PetscFunctionReturn(0);
}

/* Compute the map if it was not read. Collective. */
PetscErrorCode EqmSideSolve(EqmRegistration r, EqmSide *side)
{
  EqmSolver solver;
  const EqmPlace *place;

  PetscFunctionBegin;
  if (side->map || r->status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  if (!r->set.quiet)
    PetscCall(PetscPrintf(r->comm, "map of %s: %s to the %s\n", side->name, side->soup->file, r->target));
  PetscCall(EqmSolverCreate(side->mesh, r->target, &solver));
  if (side->mesh->cell_size == 3) {
    PetscCall(EqmSolverSetTolerances(solver, PETSC_DEFAULT, EQM_REGISTER_RATIO_TOL, PETSC_DEFAULT, PETSC_DEFAULT));
    PetscCall(EqmSolverSetInnerSteps(solver, EQM_REGISTER_INNER));
  }
  PetscCall(EqmSolverSetMonitor(solver, EqmSolverMonitorText, NULL));
  PetscCall(EqmSolverSetFromOptions(solver));
  PetscCall(EqmRegistrationMinimise(r, solver));
  PetscCall(EqmSolverGetMap(solver, side->intake.mapped, &side->map));
  PetscCall(PetscMalloc1(r->dim * side->mesh->num_local, &side->x));
  PetscCall(EqmSolverGetPlaces(solver, &place));
  PetscCall(PetscArraycpy(side->x, place->x, r->dim * side->mesh->num_local));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmSideReset(EqmSide *side)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(side->x));
  PetscCall(PetscFree(side->weight));
  if (side->read != side->map) PetscCall(EqmMapDestroy(&side->read));
  PetscCall(EqmMapDestroy(&side->map));
  PetscCall(EqmOriginDestroy(&side->origin));
  if (side->mesh) PetscCall(EqmMeshDestroy(&side->mesh));
  if (side->intake.given) PetscCall(EqmIntakeDestroy(&side->intake));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSideCheckVertices(const EqmSide *side, PetscInt num, const PetscInt *vertices, PetscInt *inside)
{
  PetscInt *local, *owners;
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(PetscMPIIntCast(num, &count));
  PetscCall(PetscMalloc2(num, &local, num, &owners));
  PetscCall(EqmMeshFindVertices(side->mesh, num, vertices, local));
  for (PetscInt i = 0; i < num; i++) {
    owners[i] = local[i] >= 0;
    inside[i] = local[i] >= 0 && !side->mesh->on_boundary[local[i]];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, owners, count, MPIU_INT, MPI_SUM, side->mesh->comm));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, inside, count, MPIU_INT, MPI_SUM, side->mesh->comm));
  for (PetscInt i = 0; i < num; i++) {
    if (owners[i] == 1) continue;
    EqmFail(side->mesh->comm, EQM_ERR_USAGE, "landmark %" PetscInt_FMT ": vertex %" PetscInt_FMT " of %s is in no cell",
            i + 1, vertices[i], side->name);
  }
  PetscCall(PetscFree2(local, owners));
  PetscFunctionReturn(0);
}

/* Radius of the disk, sphere or ball that has the side's measure. Not collective. */
PetscReal EqmSideRadius(const EqmRegistration r, const EqmSide *side)
{
  const PetscReal measure = side->map->distortion.mesh_measure;

  if (r->kind == EQM_IMAGE_PLANE) return PetscSqrtReal(measure / PETSC_PI);
  if (r->kind == EQM_IMAGE_SPHERE) return PetscSqrtReal(measure / (4. * PETSC_PI));
  return PetscCbrtReal(.75 * measure / PETSC_PI);
}
