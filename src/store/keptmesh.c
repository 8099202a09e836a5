#include "store/keptmesh.h"
#include "base/lookup.h"
#include "base/quiet.h"
#include "format/format.h"
#include "mesh/build.h"
#include "store/h5.h"
#include "store/state.h"
#include "store/store.h"
#include <libgen.h>

static const char density_path[] = "/cell/density";

PetscErrorCode EqmKeptMeshName(const char *checkpoint, char *name, size_t length)
{
  PetscFunctionBegin;
  PetscCall(EqmNameBeside(checkpoint, ".mesh.h5", name, length));
  PetscFunctionReturn(0);
}

/* Does a copy come with a density? */
static PetscErrorCode HasDensity(MPI_Comm comm, const char *name, PetscBool *has)
{
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(EqmH5Open(comm, name, &h5));
  PetscCall(EqmH5HasDataset(h5, density_path, has));
  PetscCall(EqmH5Close(&h5));
  PetscFunctionReturn(0);
}

/* Is a sound copy there, and is it of this mesh with this density? All of it is read. */
static PetscErrorCode Look(EqmSoup soup, const char *file, PetscBool *sound, PetscBool *same)
{
  PetscInt64 wanted, found = 0;
  EqmSoup there = NULL;
  char message[EQM_MESSAGE_MAX];
  PetscErrorCode error;
  PetscBool has_density;

  PetscFunctionBegin;
  *same = PETSC_FALSE;
  PetscCall(EqmFileIsThere(soup->comm, file, sound));
  if (!*sound) PetscFunctionReturn(0);
  PetscCall(EqmSoupComputeIdentity(soup, &wanted));
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmKeptMeshRead(soup->comm, file, &there);
  if (!error) error = HasDensity(soup->comm, file, &has_density);
  if (!error && has_density) error = EqmSoupReadDensity(there, file);
  if (!error) error = EqmSoupComputeIdentity(there, &found);
  PetscCall(PetscPopErrorHandler());
  *sound = (PetscBool)!error;
  *same = (PetscBool)(!error && found == wanted && has_density == (PetscBool)(soup->density != NULL));
  PetscCall(EqmSoupDestroy(&there));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmKeptMeshWrite(EqmSoup soup, const char *checkpoint, PetscBool resumed)
{
  char name[PETSC_MAX_PATH_LEN], message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error;
  PetscMPIInt rank;
  PetscBool sound, same;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(EqmKeptMeshName(checkpoint, name, sizeof(name)));
  if (rank == 0) EqmAtomicSweep(name);
  PetscCall(Look(soup, name, &sound, &same));
  if (same || (sound && resumed)) PetscFunctionReturn(0);
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmSoupWriteHdf5(soup, name);
  PetscCall(PetscPopErrorHandler());
  if (error)
    PetscCall(EqmWarn(soup->comm, message, "; the run goes on, and to resume it the mesh itself must be there"));
  PetscFunctionReturn(0);
}

/* What a checkpoint says of the copy; empty: nothing, or it cannot be read. */
static PetscErrorCode Ask(MPI_Comm comm, const char *checkpoint, char *name, size_t length)
{
  char message[EQM_MESSAGE_MAX];
  PetscErrorCode error;
  PetscBool there;
  EqmH5 h5;

  PetscFunctionBegin;
  name[0] = '\0';
  PetscCall(EqmFileIsThere(comm, checkpoint, &there));
  if (!there) PetscFunctionReturn(0);
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmH5Open(comm, checkpoint, &h5);
  PetscCall(PetscPopErrorHandler());
  if (error) PetscFunctionReturn(0);
  PetscCall(EqmH5GetText(h5, EQM_KEPT_MESH, "", name, length));
  PetscCall(EqmH5Close(&h5));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmKeptMeshFind(MPI_Comm comm, const char *checkpoint, char *name, size_t length, PetscBool *has_density)
{
  char previous[PETSC_MAX_PATH_LEN], folder[PETSC_MAX_PATH_LEN], copy[PETSC_MAX_PATH_LEN];
  PetscBool there, before;

  PetscFunctionBegin;
  PetscCall(EqmStatePreviousName(checkpoint, previous, sizeof(previous)));
  PetscCall(EqmFileIsThere(comm, checkpoint, &there));
  PetscCall(EqmFileIsThere(comm, previous, &before));
  if (!there && !before) EqmFail(comm, EQM_ERR_IO, "-restart %s: there is no such file", checkpoint);
  PetscCall(Ask(comm, checkpoint, copy, sizeof(copy)));
  if (!copy[0]) PetscCall(Ask(comm, previous, copy, sizeof(copy)));
  if (!copy[0]) {
    EqmFail(comm, EQM_ERR_CHECKPOINT, "-restart %s: it has no mesh of its own, or is damaged; name the mesh as before",
            checkpoint);
  }
  PetscCall(PetscStrncpy(folder, checkpoint, sizeof(folder)));
  PetscCall(PetscSNPrintf(name, length, "%s/%s", dirname(folder), basename(copy)));
  PetscCall(EqmFileIsThere(comm, name, &there));
  if (!there) {
    EqmFail(comm, EQM_ERR_CHECKPOINT, "-restart %s: its mesh, '%s', is gone; name the mesh as before", checkpoint,
            name);
  }
  PetscCall(HasDensity(comm, name, has_density));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmKeptMeshRead(MPI_Comm comm, const char *name, EqmSoup *soup)
{
  PetscInt64 checksum;
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(EqmSoupReadHdf5(comm, name, soup));
  PetscCall(EqmH5Open(comm, name, &h5));
  PetscCall(EqmH5GetInteger(h5, "mesh_checksum", -1, &checksum));
  PetscCall(EqmH5Close(&h5));
  if (checksum == (*soup)->checksum) PetscFunctionReturn(0);
  PetscCall(EqmSoupDestroy(soup));
  EqmFail(comm, EQM_ERR_CHECKPOINT, "'%s' is damaged: its checksum is wrong; name the mesh as before", name);
}
