/* Domains by name. */
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"

static PetscErrorCode Disk(EqmMesh mesh, const EqmDomainOptions *options, EqmDomain *domain)
{
  PetscFunctionBegin;
  if (options && options->held_angles)
    PetscCall(EqmDomainCreateHeldDisk(mesh, options->held_angles, domain));
  else if (options && options->boundary_angles)
    PetscCall(EqmDomainReadHeldDisk(mesh, options, domain));
  else
    PetscCall(EqmDomainCreateDisk(mesh, domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode Square(EqmMesh mesh, const EqmDomainOptions *options, EqmDomain *domain)
{
  PetscFunctionBegin;
  PetscCall(EqmDomainCreateSquare(mesh, options ? options->corners : NULL, domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode Sphere(EqmMesh mesh, const EqmDomainOptions *options, EqmDomain *domain)
{
  (void)options;
  PetscFunctionBegin;
  PetscCall(EqmDomainCreateSphere(mesh, domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode Ball(EqmMesh mesh, const EqmDomainOptions *options, EqmDomain *domain)
{
  (void)options;
  PetscFunctionBegin;
  PetscCall(EqmDomainCreateBall(mesh, PETSC_FALSE, domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode SphericalBall(EqmMesh mesh, const EqmDomainOptions *options, EqmDomain *domain)
{
  (void)options;
  PetscFunctionBegin;
  PetscCall(EqmDomainCreateBall(mesh, PETSC_TRUE, domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode Cube(EqmMesh mesh, const EqmDomainOptions *options, EqmDomain *domain)
{
  PetscFunctionBegin;
  PetscCheck(options && (options->cube_places || mesh->num_local == 0), mesh->comm, PETSC_ERR_ARG_NULL,
             "the cube wants its boundary's places");
  PetscCall(EqmDomainCreateCube(mesh, options->cube_places, domain));
  PetscFunctionReturn(0);
}

enum { MAX_DOMAINS = 32 };
static const EqmDomainType disk = {"disk", Disk}, square = {"square", Square}, sphere = {"sphere", Sphere},
                           ball = {"ball", Ball}, spherical_ball = {"spherical-ball", SphericalBall},
                           cube = {"cube", Cube};
static const EqmDomainType *types[MAX_DOMAINS] = {&disk, &square, &sphere, &ball, &spherical_ball, &cube};

PetscErrorCode EqmDomainRegister(const EqmDomainType *type)
{
  PetscInt k = 0;

  PetscFunctionBegin;
  while (k < MAX_DOMAINS && types[k]) k++;
  PetscCheck(k < MAX_DOMAINS, PETSC_COMM_SELF, PETSC_ERR_SUP, "no room for more than %d domains", MAX_DOMAINS);
  types[k] = type;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCreate(EqmMesh mesh, const char *name, const EqmDomainOptions *options, EqmDomain *domain)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < MAX_DOMAINS && types[k]; k++) {
    PetscBool same;
    PetscCall(PetscStrcmp(types[k]->name, name, &same));
    if (!same) continue;
    PetscCall(types[k]->create(mesh, options, domain));
    PetscFunctionReturn(0);
  }
  EqmFail(mesh->comm, EQM_ERR_USAGE, "there is no domain '%s'", name);
}
