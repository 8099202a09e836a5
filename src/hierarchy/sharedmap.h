/* Maps of shared levels: evaluated, their vertices put back and relaxed, by all ranks and threads; the same bits on any
   number of these. An EqmLevelMap has the places of a rank's part, ghosts included. */
#ifndef EQM_SHAREDMAP_H
#define EQM_SHAREDMAP_H

#include "hierarchy/relax.h"
#include "hierarchy/shared.h"

/* A map of a shared level, whose places come from the finer level's, or the mesh's, owned vertices. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedMapCreate(const EqmSharedLevel *shared, EqmCascadeTarget target,
                                               const PetscReal *finer, EqmLevelMap *map);
/* The objective at x; sets `map->total`. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedEvaluate(const EqmSharedLevel *shared, EqmLevelMap *map, const PetscReal *x,
                                              EqmLevelValue *value);
/* Carry the map of the coarser level to the finer one, whose motions are set: as EqmReinsert. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedReinsert(const EqmSharedLevel *coarser, const EqmLevelMap *from,
                                              const EqmSharedLevel *finer, EqmLevelMap *to, PetscInt *hard);

/* The stars of the vertices of a rank. `group`: those inside each piece, whose neighbours are in it, too; then, by
   colours, those at the borders of pieces: no two of a colour are neighbours. */
typedef struct {
  EqmLevelStars stars;
  EqmLevelPieces group;
  PetscInt num_colors; /* on all ranks the same */
} EqmSharedStars;
PETSC_INTERN PetscErrorCode EqmSharedStarsCreate(const EqmSharedLevel *shared, EqmSharedStars *stars);
PETSC_INTERN PetscErrorCode EqmSharedStarsDestroy(EqmSharedStars *stars);
/* A colour for each of the vertices of this rank that `border` marks, among all of them on all ranks; ghosts are at
   borders. `color`: per local vertex. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedColor(const EqmSharedLevel *shared, const EqmLevelStars *stars, const char *border,
                                           PetscInt *color, PetscInt *num_colors);
/* Relax each vertex once, forwards and then backwards, in turn; never two neighbours at the same time. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedRelax(const EqmSharedLevel *shared, EqmLevelMap *map, const EqmSharedStars *stars,
                                           PetscInt sweeps);

#endif
