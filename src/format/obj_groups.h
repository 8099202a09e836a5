/* The groups of an OBJ file: what its g and o lines say. */
#ifndef EQM_FORMAT_OBJ_GROUPS_H
#define EQM_FORMAT_OBJ_GROUPS_H

#include "input.h"

enum { EQM_OBJ_MOST_GROUPS = 1000, EQM_OBJ_LONGEST_GROUP = 128 }; /* of names that are kept */

/* Groups by name, as far as the file has been read; faces of group 0 are in none. */
typedef struct {
  PetscInt64 num, first; /* number of the first name */
  char name[EQM_OBJ_MOST_GROUPS][EQM_OBJ_LONGEST_GROUP];
} EqmObjGroups;

/* The name that a statement has after its keyword; moves to the end of the line. Not collective. */
PETSC_INTERN void EqmObjReadGroupName(EqmInput *in, char name[EQM_OBJ_LONGEST_GROUP]);
/* The number of a name, which is added if it is new. Not collective. */
PETSC_INTERN PetscInt64 EqmObjGroupOfName(const char *name, EqmObjGroups *groups);
/* The names as metadata. Not collective. */
PETSC_INTERN PetscErrorCode EqmObjKeepNames(const EqmObjGroups *groups, char **metadata);

/* The names of a part of a file, each where it is new: those before the first that is no number's, and from this on. */
typedef struct {
  PetscInt64 num, first_name; /* -1: there is none so far */
  PetscBool overflow;         /* there are more than can be kept */
  char last[EQM_OBJ_LONGEST_GROUP], name[2 * EQM_OBJ_MOST_GROUPS][EQM_OBJ_LONGEST_GROUP];
} EqmObjNames;
/* Not collective. */
PETSC_INTERN void EqmObjAddName(const char *name, EqmObjNames *names);
/* From the names of all ranks' parts, in rank order: the groups that are known where this rank's part begins, and that
   which its first faces belong to; the groups of the whole file. Collective. */
PETSC_INTERN PetscErrorCode EqmObjShareNames(MPI_Comm comm, const EqmObjNames *names, EqmObjGroups *before,
                                             PetscInt64 *group, EqmObjGroups *all);

#endif
