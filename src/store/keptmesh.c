#include "store/keptmesh.h"
#include "mesh/soup_private.h"
#include "base/checksum.h"
#include "base/lookup.h"
#include "base/quiet.h"
#include "format/hdf5.h"
#include "mesh/build.h"
#include "h5/h5.h"
#include "store/state.h"
#include "store/map_private.h"
#include "store/store.h"
#include <libgen.h>
#include <string.h>

static const char density_path[] = "/cell/density", checksum_key[] = "map_checksum";

PetscErrorCode EqmKeptMeshName(const char *checkpoint, const char *part, char *name, size_t length)
{
  char suffix[32];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(suffix, sizeof(suffix), "%s%s.mesh.h5", part ? "." : "", part ? part : ""));
  PetscCall(PetscStrtolower(suffix));
  PetscCall(EqmNameBeside(checkpoint, suffix, name, length));
  PetscFunctionReturn(0);
}

/* Does a copy hold a density? */
static PetscErrorCode HasDensity(MPI_Comm comm, const char *name, PetscBool *has)
{
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(EqmH5Open(comm, name, &h5));
  PetscCall(EqmH5HasDataset(h5, density_path, has));
  PetscCall(EqmH5Close(&h5));
  PetscFunctionReturn(0);
}

/* Of the map's coordinates, and of those of the repaired mesh. */
static PetscErrorCode ChecksumOfMap(EqmMap map, PetscInt64 *checksum)
{
  PetscFunctionBegin;
  *checksum = 0;
  for (EqmMap m = map; m; m = m->repaired) {
    const PetscInt64 count = (PetscInt64)m->dim * (m->soup->vertex_end - m->soup->vertex_start);
    EqmChecksum all;
    PetscCall(EqmChecksumJoin(m->soup->comm, EqmChecksumReals(count, m->coordinates), &all));
    *checksum = (*checksum << 31 ^ *checksum >> 31) ^ all.crc;
  }
  PetscFunctionReturn(0);
}

/* The checksum of its map that a copy holds; empty: it has none. */
static PetscErrorCode ReadMapChecksum(MPI_Comm comm, const char *name, char *text, size_t length)
{
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(EqmH5Open(comm, name, &h5));
  PetscCall(EqmH5GetText(h5, checksum_key, "", text, length));
  PetscCall(EqmH5Close(&h5));
  PetscFunctionReturn(0);
}

/* Is there an undamaged copy, and is it of this mesh with this density and map? All of the mesh is read. */
static PetscErrorCode CompareCopy(EqmSoup soup, const char *map_checksum, const char *file, PetscBool *sound,
                                  PetscBool *same)
{
  PetscInt64 wanted, found = 0;
  EqmSoup there = NULL;
  char message[EQM_MESSAGE_MAX], map_there[32] = "";
  PetscErrorCode error;
  PetscBool has_density, same_map;

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
  if (!error) error = ReadMapChecksum(soup->comm, file, map_there, sizeof(map_there));
  PetscCall(PetscPopErrorHandler());
  PetscCall(PetscStrcmp(map_there, map_checksum, &same_map));
  *sound = (PetscBool)!error;
  *same = (PetscBool)(!error && same_map && found == wanted && has_density == (PetscBool)(soup->density != NULL));
  PetscCall(EqmSoupDestroy(&there));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmKeptMeshWrite(EqmSoup soup, EqmMap map, const char *name, PetscBool resumed)
{
  char message[EQM_MESSAGE_MAX] = "", text[32] = "";
  PetscInt64 checksum;
  PetscErrorCode error;
  PetscMPIInt rank;
  PetscBool sound, same;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  if (rank == 0) EqmAtomicSweep(name);
  PetscCall(ChecksumOfMap(map, &checksum));
  if (map) PetscCall(PetscSNPrintf(text, sizeof(text), "%" PetscInt64_FMT, checksum));
  PetscCall(CompareCopy(soup, text, name, &sound, &same));
  if (same || (sound && resumed)) PetscFunctionReturn(0);
  if (map) PetscCall(EqmMapAddText(map, checksum_key, text));
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = map ? EqmMapWriteResult(map, name) : EqmSoupWriteHdf5(soup, name);
  PetscCall(PetscPopErrorHandler());
  if (error)
    PetscCall(EqmWarn(soup->comm, message, "; the run goes on, and to resume it the mesh itself must be there"));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmKeptMeshCheckMap(EqmMap map, const char *name)
{
  char was[32], is[32];
  PetscInt64 checksum;
  PetscBool same;

  PetscFunctionBegin;
  PetscCall(ReadMapChecksum(map->soup->comm, name, was, sizeof(was)));
  PetscCall(ChecksumOfMap(map, &checksum));
  PetscCall(PetscSNPrintf(is, sizeof(is), "%" PetscInt64_FMT, checksum));
  PetscCall(PetscStrcmp(was, is, &same));
  if (!same)
    EqmFail(map->soup->comm, EQM_ERR_CHECKPOINT,
            "'%s' is damaged: its map's checksum is wrong; name the files as before", name);
  PetscFunctionReturn(0);
}

/* The names of its copies that a checkpoint holds; empty: none, or it cannot be read. */
static PetscErrorCode ReadEntries(MPI_Comm comm, const char *checkpoint, char *names, size_t length)
{
  char message[EQM_MESSAGE_MAX];
  PetscErrorCode error;
  PetscBool there;
  EqmH5 h5;

  PetscFunctionBegin;
  names[0] = '\0';
  PetscCall(EqmFileIsThere(comm, checkpoint, &there));
  if (!there) PetscFunctionReturn(0);
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmH5Open(comm, checkpoint, &h5);
  PetscCall(PetscPopErrorHandler());
  if (error) PetscFunctionReturn(0);
  PetscCall(EqmH5GetText(h5, EQM_KEPT_MESH, "", names, length));
  PetscCall(EqmH5Close(&h5));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmKeptMeshGetEntry(MPI_Comm comm, const char *checkpoint, PetscInt number, char *entry, size_t length)
{
  char previous[PETSC_MAX_PATH_LEN], names[PETSC_MAX_PATH_LEN], *begin = names;
  PetscBool there, before;

  PetscFunctionBegin;
  PetscCall(EqmStatePreviousName(checkpoint, previous, sizeof(previous)));
  PetscCall(EqmFileIsThere(comm, checkpoint, &there));
  PetscCall(EqmFileIsThere(comm, previous, &before));
  if (!there && !before) EqmFail(comm, EQM_ERR_IO, "-restart %s: there is no such file", checkpoint);
  PetscCall(ReadEntries(comm, checkpoint, names, sizeof(names)));
  if (!names[0]) PetscCall(ReadEntries(comm, previous, names, sizeof(names)));
  for (PetscInt k = 0; k < number && begin; k++) {
    begin = strchr(begin, ',');
    if (begin) begin++;
  }
  PetscCall(PetscStrncpy(entry, begin ? begin : "", length));
  entry[strcspn(entry, ",")] = '\0';
  PetscFunctionReturn(0);
}

PetscErrorCode EqmKeptMeshFind(MPI_Comm comm, const char *checkpoint, PetscInt number, char *name, size_t length,
                               PetscBool *has_density)
{
  char folder[PETSC_MAX_PATH_LEN], copy[PETSC_MAX_PATH_LEN];
  PetscBool there;

  PetscFunctionBegin;
  PetscCall(EqmKeptMeshGetEntry(comm, checkpoint, number, copy, sizeof(copy)));
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
