/* What a mesh can be, and what it can be mapped to: one table for the diagnosis, the commands and the methods. */
#ifndef EQM_TARGET_H
#define EQM_TARGET_H

#include <equimap/soup.h>

/* What a mesh can be mapped to. A new target is one row in target.c. */
typedef struct {
  const char *name;    /* the command and the name in the interface: "disk" */
  const char *purpose; /* one line for lists of commands */
  const char
      *domain[EQM_NUM_TOPOLOGIES]; /* per topology of the mesh, the domain that its image fills; NULL: not taken */
} EqmTarget;

/* All targets, in the order in which they are listed. Not collective. */
PETSC_INTERN void EqmTargetsGet(const EqmTarget **targets, PetscInt *num_targets);
/* The target of a name; NULL where there is none. Not collective. */
PETSC_INTERN const EqmTarget *EqmTargetFind(const char *name);
/* The default target of a topology: the first that takes it; NULL where none does. Not
   collective. */
PETSC_INTERN const EqmTarget *EqmTargetOfTopology(EqmTopology topology);

/* "disk", as in summaries. Not collective. */
PETSC_INTERN const char *EqmTopologyName(EqmTopology topology);
/* "a disk-type surface (one piece, one boundary loop, no handle)". Not collective. */
PETSC_INTERN const char *EqmTopologyDescription(EqmTopology topology);

#endif
