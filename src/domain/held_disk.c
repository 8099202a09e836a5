/* The unit disk with its boundary held at given angles: 000 section 6 has h_B = R f_B, the places that another map gave
   to the boundary. */
#include "domain/domain_private.h"
#include "format/table.h"

/* The angles must increase along the boundary: otherwise every map folds. */
static PetscErrorCode CheckOrder(EqmDomain domain)
{
  EqmPlace place;
  PetscBool in_order;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(domain, &place));
  PetscCall(EqmDomainPlaceOnCircle(domain, &place));
  PetscCall(EqmDomainBoundaryInOrder(domain, &place, &in_order));
  PetscCall(EqmPlaceDestroy(&place));
  if (!in_order)
    EqmFail(domain->mesh->comm, EQM_ERR_USAGE,
            "the angles of the boundary must grow, once round, in the order in which the boundary runs round the "
            "surface (it lies on the left); try them with the other sign");
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCreateHeldDisk(EqmMesh mesh, const PetscReal *angle, EqmDomain *out)
{
  EqmDomain domain;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreatePlanar(mesh, "disk", &domain));
  domain->motion[0] = &EqmMotionFree;
  domain->motion[1] = &EqmMotionHeldOnCircle;
  domain->target_measure = PETSC_PI;
  domain->boundary_length = 2. * PETSC_PI;
  domain->place_boundary = EqmDomainPlaceOnCircle; /* `arc_length` holds angles over 2 pi */
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    domain->kind[v] = mesh->on_boundary[v] ? 1 : 0;
    if (mesh->on_boundary[v]) domain->arc_length[v] = angle[v] / (2. * PETSC_PI);
  }
  PetscCall(EqmDomainNumber(domain));
  PetscCall(CheckOrder(domain));
  *out = domain;
  PetscFunctionReturn(0);
}

/* Angles of this rank's boundary vertices from the table, which rank 0 has read; each must be there once. */
static PetscErrorCode TakeAngles(EqmMesh mesh, const char *file, EqmTable *table, PetscReal *angle)
{
  PetscInt *vertex, *local, found = 0, total;
  PetscReal *value;
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&table->rows, 1, MPIU_INT, 0, mesh->comm));
  PetscCall(PetscMPIIntCast(table->rows, &count));
  PetscCall(PetscMalloc3(table->rows, &vertex, table->rows, &local, table->rows, &value));
  for (PetscInt i = 0; i < table->rows && mesh->rank == 0; i++) {
    vertex[i] = (PetscInt)table->values[2 * i];
    value[i] = table->values[2 * i + 1];
  }
  PetscCallMPI(MPI_Bcast(vertex, count, MPIU_INT, 0, mesh->comm));
  PetscCallMPI(MPI_Bcast(value, count, MPIU_REAL, 0, mesh->comm));
  PetscCall(EqmMeshFindVertices(mesh, table->rows, vertex, local));
  for (PetscInt i = 0; i < table->rows; i++) {
    if (local[i] < 0 || !mesh->on_boundary[local[i]]) continue;
    found++;
    angle[local[i]] = value[i];
  }
  PetscCall(PetscFree3(vertex, local, value));
  PetscCall(MPIU_Allreduce(&found, &total, 1, MPIU_INT, MPI_SUM, mesh->comm));
  if (total != mesh->num_boundary_vertices)
    EqmFail(mesh->comm, EQM_ERR_USAGE,
            "-boundary_angles %s: it names %" PetscInt_FMT " boundary vertices, and the mesh has %" PetscInt_FMT
            "; each must be there once",
            file, total, mesh->num_boundary_vertices);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainReadHeldDisk(EqmMesh mesh, const EqmDomainOptions *options, EqmDomain *domain)
{
  EqmTable table = {0};
  PetscReal *angle;

  PetscFunctionBegin;
  PetscCall(EqmTableRead(mesh->comm, options->boundary_angles, 2, 2,
                         "a boundary vertex (input number from 0) and its angle in radians are wanted", &table));
  PetscCall(PetscCalloc1(mesh->num_local, &angle));
  PetscCall(TakeAngles(mesh, options->boundary_angles, &table, angle));
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, angle));
  PetscCall(EqmDomainCreateHeldDisk(mesh, angle, domain));
  PetscCall(PetscFree(angle));
  PetscCall(PetscFree(table.values));
  PetscFunctionReturn(0);
}
