/* A level on its way to the next coarser one. */
#ifndef EQM_DECIMATION_H
#define EQM_DECIMATION_H

#include "hierarchy/level.h"

enum {
  EQM_MOST_SPOKES = EQM_MOST_RECORD - 1, /* a vertex with more triangles stays */
  EQM_MOST_VALENCE = 16 /* triangles around a vertex that another goes onto, those of the other included, at most */
};

typedef struct {
  PetscInt vertex, num_cells, size; /* size: ring vertices; num_cells, or one more on the boundary */
  PetscBool closed;
  PetscInt ring[EQM_MOST_SPOKES + 1], cell[EQM_MOST_SPOKES];
  PetscInt num_on_boundary; /* ring vertices on the boundary */
} EqmStar;

typedef struct {
  EqmHierarchyLevel *level; /* gets the records, for which it must have room */
  PetscInt *cells;
  PetscReal *weight;
  char *dead;         /* per cell */
  EqmCorners corners; /* of the level as it was; what a vertex absorbed since follows in its chain */
  PetscInt *next;     /* per vertex: the next of the chain of vertices that were absorbed, or -1 */
  PetscInt *place;    /* scratch of EqmOrderSpokes */
  PetscInt *mark, stamp;
  PetscInt *pass_kept; /* per vertex: the last pass in which one of its neighbours went */
  char *gone;
  const char *held; /* per vertex: stays, as triangles around it or its neighbours lack; NULL: none */
  PetscInt num_left, num_boundary;
} EqmDecimation;

/* Room for levels of so many vertices and cells, one after the other. Not collective. */
PETSC_INTERN PetscErrorCode EqmDecimationCreate(PetscInt most_vertices, PetscInt most_cells, EqmDecimation *d);
PETSC_INTERN PetscErrorCode EqmDecimationDestroy(EqmDecimation *d);
/* Begin with a level, then collapse edges until no more than `goal` vertices are left or none may go: the level's
   records have room for the difference, and EQM_MOST_RECORD ring vertices each. `quality`: as for EqmDecimate. Not
   collective; they call nothing of PETSc's, so that threads may each have their own. */
PETSC_INTERN void EqmDecimationBegin(EqmDecimation *d, EqmHierarchyLevel *level, const char *held);
PETSC_INTERN void EqmDecimationRun(EqmDecimation *d, PetscInt goal, PetscInt least_boundary, PetscReal *quality);

/* The star of a vertex; false where it is too large or no fan. Not collective. */
PETSC_INTERN PetscBool EqmDecimationStar(EqmDecimation *d, PetscInt vertex, EqmStar *star);
/* The triangle on the other side of the edge from a to b, or -1. Not collective. */
PETSC_INTERN PetscInt EqmDecimationAcross(const EqmDecimation *d, PetscInt a, PetscInt b, PetscInt cell);
/* Which vertex of the ring the centre may go onto, for triangles of at least this quality, or half the worst of the
   star: the best, or -1. Not collective. */
PETSC_INTERN PetscInt EqmChooseCollapse(EqmDecimation *d, const EqmStar *star, PetscReal quality);

/* Calls `visit` for the live triangles around a vertex: a loop over the vertex and what it absorbed. */
#define EQM_FOR_CELLS_AROUND(d, v, c)                                                                                  \
  for (PetscInt member_ = (v); member_ >= 0; member_ = (d)->next[member_])                                             \
    for (PetscInt slot_ = (d)->corners.start[member_], c = 0; slot_ < (d)->corners.start[member_ + 1]; slot_++)        \
      if (c = (d)->corners.corner[slot_] / 3, !(d)->dead[c])

#endif
