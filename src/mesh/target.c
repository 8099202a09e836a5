/* The table of targets. */
#include "mesh/target.h"
#include <string.h>

static const EqmTarget targets[] = {
    {"disk", "area-preserving map of a disk-type surface to the unit disk", {[EQM_TOPOLOGY_DISK] = "disk"}},
    {"square", "area-preserving map of a disk-type surface to the unit square", {[EQM_TOPOLOGY_DISK] = "square"}},
    {"sphere",
     "area-preserving map of a closed genus-0 surface to the unit sphere",
     {[EQM_TOPOLOGY_SPHERE] = "sphere"}},
    {"ball", "volume-preserving map of a solid ball of tetrahedra to the unit ball", {[EQM_TOPOLOGY_BALL] = "ball"}},
    {"cube", "volume-preserving map of a solid ball of tetrahedra to the unit cube", {[EQM_TOPOLOGY_BALL] = "cube"}},
    {"conformal",
     "angle-preserving map: closed surface to the unit sphere, disk-type to the unit disk",
     {[EQM_TOPOLOGY_DISK] = "disk", [EQM_TOPOLOGY_SPHERE] = "sphere"}},
};
enum { NUM_TARGETS = sizeof(targets) / sizeof(targets[0]) };

static const struct {
  const char *name, *description;
} topologies[EQM_NUM_TOPOLOGIES] = {
    [EQM_TOPOLOGY_DISK] = {"disk", "a disk-type surface (one piece, one boundary loop, no handle)"},
    [EQM_TOPOLOGY_SPHERE] = {"sphere", "a closed surface without handles"},
    [EQM_TOPOLOGY_BALL] = {"ball", "a solid ball (one piece, one boundary surface)"},
    [EQM_TOPOLOGY_OTHER] = {"other", "neither a disk, a sphere nor a ball"},
};

void EqmTargetsGet(const EqmTarget **list, PetscInt *num_targets)
{
  *list = targets;
  *num_targets = NUM_TARGETS;
}

const EqmTarget *EqmTargetFind(const char *name)
{
  for (PetscInt t = 0; t < NUM_TARGETS; t++) {
    if (!strcmp(targets[t].name, name)) return &targets[t];
  }
  return NULL;
}

const EqmTarget *EqmTargetOfTopology(EqmTopology topology)
{
  for (PetscInt t = 0; t < NUM_TARGETS; t++) {
    if (targets[t].domain[topology]) return &targets[t];
  }
  return NULL;
}

const char *EqmTopologyName(EqmTopology topology)
{
  return topologies[topology].name;
}

const char *EqmTopologyDescription(EqmTopology topology)
{
  return topologies[topology].description;
}
