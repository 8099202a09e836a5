#include "obj_groups.h"
#include "metadata.h"
#include "base/narrow.h"

#include <stdio.h>
#include <string.h>

void EqmObjReadGroupName(EqmInput *in, char name[EQM_OBJ_LONGEST_GROUP])
{
  const char *start;
  size_t length;

  EqmSkipBlanks(in);
  start = in->cursor;
  while (in->cursor < in->end && *in->cursor != '\n' && *in->cursor != '\r') ++in->cursor;
  for (length = (size_t)(in->cursor - start); length && EqmIsBlank(start[length - 1]);) --length;
  snprintf(name, EQM_OBJ_LONGEST_GROUP, "%.*s", (int)PetscMin(length, EQM_OBJ_LONGEST_GROUP - 1), start);
}

/* What we wrote for unnamed groups has its number in it. */
static PetscBool IsNumbered(const char *name, long long *number)
{
  int length = 0;

  return sscanf(name, "group_%lld%n", number, &length) == 1 && !name[length] ? PETSC_TRUE : PETSC_FALSE;
}

/* Faces after an empty name, and those of this one, are in no group. */
static PetscBool IsNone(const char *name)
{
  return !name[0] || !strcmp(name, "default") ? PETSC_TRUE : PETSC_FALSE;
}

/* Numbers count for themselves until the first other name; all names then count from `first`. */
PetscInt64 EqmObjGroupOfName(const char *name, EqmObjGroups *groups)
{
  long long number;

  if (IsNone(name)) return 0;
  if (!groups->num && IsNumbered(name, &number)) {
    groups->first = PetscMax(groups->first, EQM_OBJ_MOST_GROUPS + PetscMin(number, PETSC_MAX_INT / 2));
    return number;
  }
  for (PetscInt64 k = 0; k < groups->num; ++k) {
    if (!strcmp(name, groups->name[k])) return groups->first + k;
  }
  if (groups->num == EQM_OBJ_MOST_GROUPS) return 0;
  strcpy(groups->name[groups->num], name);
  return groups->first + groups->num++;
}

PetscErrorCode EqmObjKeepNames(const EqmObjGroups *groups, char **metadata)
{
  char key[40];

  for (PetscInt64 k = 0; k < groups->num; ++k) {
    snprintf(key, sizeof(key), EQM_GROUP_KEY, (long long)(groups->first + k));
    EqmTry(EqmMetadataAdd(metadata, key, groups->name[k]));
  }
  return 0;
}

/* What counts of the others is that they come last. */
void EqmObjAddName(const char *name, EqmObjNames *names)
{
  long long number;
  const PetscBool is_first =
      names->first_name < 0 && !IsNone(name) && !IsNumbered(name, &number) ? PETSC_TRUE : PETSC_FALSE;

  snprintf(names->last, sizeof(names->last), "%s", name);
  for (PetscInt64 k = PetscMax(names->first_name, 0); k < names->num && !is_first; ++k) {
    if (!strcmp(name, names->name[k])) return;
  }
  if (names->num == 2 * EQM_OBJ_MOST_GROUPS) {
    names->overflow = PETSC_TRUE;
    return;
  }
  if (is_first) names->first_name = names->num;
  strcpy(names->name[names->num++], name);
}

/* Where the names of each rank's part begin; those of all ranks on rank 0. */
static PetscErrorCode GatherNames(MPI_Comm comm, const EqmObjNames *names, PetscMPIInt **start, char **all)
{
  const PetscInt64 bytes = (names->num + (names->num > 0)) * EQM_OBJ_LONGEST_GROUP;
  PetscMPIInt size, rank, *count;
  char *mine;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscMalloc2(size, &count, bytes, &mine));
  PetscCall(PetscMalloc1(size + 1, start));
  PetscCall(PetscArraycpy(mine, names->name[0], names->num * EQM_OBJ_LONGEST_GROUP));
  if (names->num) PetscCall(PetscArraycpy(mine + bytes - EQM_OBJ_LONGEST_GROUP, names->last, EQM_OBJ_LONGEST_GROUP));
  PetscCall(EqmGatherCounts(comm, bytes, "bytes of groups' names", count, *start));
  PetscCall(PetscMalloc1(rank == 0 ? (*start)[size] : 0, all));
  PetscCallMPI(MPI_Gatherv(mine, (PetscMPIInt)bytes, MPI_CHAR, *all, count, *start, MPI_CHAR, 0, comm));
  PetscCall(PetscFree2(count, mine));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmObjShareNames(MPI_Comm comm, const EqmObjNames *names, EqmObjGroups *before, PetscInt64 *group,
                                EqmObjGroups *all)
{
  enum { STATE = 3 }; /* names known, number of the first, group */
  PetscInt64 now = 0, mine[STATE], (*state)[STATE];
  PetscMPIInt size, rank, *start;
  char *text;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(GatherNames(comm, names, &start, &text));
  PetscCall(PetscMalloc1(size, &state));
  all->num = 0;
  all->first = 1;
  for (PetscMPIInt r = 0; r < size && rank == 0; ++r) {
    state[r][0] = all->num;
    state[r][1] = all->first;
    state[r][2] = now;
    for (PetscMPIInt k = start[r]; k < start[r + 1]; k += EQM_OBJ_LONGEST_GROUP) now = EqmObjGroupOfName(text + k, all);
  }
  PetscCallMPI(MPI_Scatter(state, STATE, MPIU_INT64, mine, STATE, MPIU_INT64, 0, comm));
  PetscCallMPI(MPI_Bcast(&all->num, 1, MPIU_INT64, 0, comm));
  PetscCallMPI(MPI_Bcast(&all->first, 1, MPIU_INT64, 0, comm));
  PetscCallMPI(MPI_Bcast(all->name, (PetscMPIInt)all->num * EQM_OBJ_LONGEST_GROUP, MPI_CHAR, 0, comm));
  PetscCall(PetscArraycpy(before->name[0], all->name[0], all->num * EQM_OBJ_LONGEST_GROUP));
  before->num = mine[0];
  before->first = mine[1];
  *group = mine[2];
  PetscCall(PetscFree(state));
  PetscCall(PetscFree(start));
  PetscCall(PetscFree(text));
  PetscFunctionReturn(0);
}
