/* Levels that all ranks share, for surfaces too large for one: each has a part of every level.

   The vertices of a level are numbered along Hilbert's curve and cut into pieces of about as many, which do not depend
   on the number of ranks; a rank owns some consecutive ones. A vertex goes only where all triangles around it and its
   neighbours' places are its piece's: pieces are decimated, and get their vertices back, each by itself, on the ranks
   and threads that there are. What is at the border of pieces stays for this level; on the next one the curve lies
   elsewhere, and so do the borders. So the levels are the same, to the last bit, on any number of ranks and threads.
   From a size on that one rank can hold, a hierarchy on the first rank goes on. */
#ifndef EQM_SHARED_H
#define EQM_SHARED_H

#include "hierarchy/level.h"

typedef struct {
  MPI_Comm comm;
  PetscInt num_vertices, num_cells, num_boundary; /* of all ranks */
  PetscInt first, num_owned;                      /* vertices that this rank owns, in the order along the curve */
  PetscInt *ghost;                                /* numbers of those that follow them in `level`, ascending */
  PetscSF halo;                                   /* roots: owned vertices; leaves: ghosts */
  PetscSF from_finer; /* roots: the finer level's owned vertices, or the mesh's; leaves: those owned here */

  /* This rank's part, in local numbers: all cells around its vertices, by the numbers of their corners along the curve,
     so that those come first whose lowest corner another rank owns, and which are that rank's. */
  EqmHierarchyLevel level;
  PetscInt num_foreign_cells;
  PetscInt *cell_order; /* of the finest level: place of each cell among the mesh's owned cells of all ranks, one rank's
                           after the other; else NULL */

  /* Pieces: per piece of this rank the first vertex, the first cell that has its lowest corner there, the first
     collapse; and where the last one ends. */
  PetscInt num_all_pieces, first_piece, num_pieces;
  PetscInt *vertex_start, *cell_start, *record_start;
} EqmSharedLevel;

typedef struct _p_EqmShared *EqmShared;
struct _p_EqmShared {
  MPI_Comm comm;
  PetscInt num_levels; /* level 0 is the finest */
  EqmSharedLevel level[EQM_MOST_LEVELS];
  EqmHierarchy coarser; /* its level 0 is the last of these, in the same order */
};

/* Share the mesh, a surface, and decimate it, then what is left on the first rank. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedCreate(EqmMesh mesh, const EqmHierarchyOptions *options, EqmShared *shared);
PETSC_INTERN PetscErrorCode EqmSharedDestroy(EqmShared *shared);
/* Bytes that the levels take on all ranks, those of the first rank's own included. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedMemory(EqmShared shared, PetscInt64 *bytes);

/* ---- for the files of this folder */
/* What a level is made of: the mesh, or what is left of the finer level. */
typedef struct {
  MPI_Comm comm;
  PetscSF halo; /* roots: its owned vertices; leaves: its ghosts, which follow in the local numbers */
  PetscInt num_owned, num_local;
  PetscInt num_kept;         /* vertices that the level has, of all ranks */
  const char *gone;          /* per owned vertex, or NULL */
  const PetscReal *position; /* three per owned vertex */
  const PetscInt *number;    /* per owned vertex: decides where two have the same place along the curve */
  const unsigned char *part; /* per owned vertex */
  PetscInt num_cells;        /* each on one rank alone */
  const char *dead;          /* per cell, or NULL */
  const PetscInt *cells;     /* local numbers */
  const PetscReal *weight;
  const PetscInt *place; /* per cell: becomes the level's cell_order; or NULL */
} EqmSharedSource;
/* `where`: which of the curves. `vertices_of_piece`: about so many. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedLevelCreate(const EqmSharedSource *source, PetscInt where,
                                                 PetscInt vertices_of_piece, EqmSharedLevel *to);
PETSC_INTERN PetscErrorCode EqmSharedLevelDestroy(EqmSharedLevel *level);
/* Number the source's vertices: first, num_owned, from_finer and the pieces' sizes of `to`; `number` per local vertex
   of the source, -1 where it is gone. `range`: where the numbers of each rank begin, and where the last ends.
   Collective. */
PETSC_INTERN PetscErrorCode EqmSharedNumber(const EqmSharedSource *source, PetscInt where, PetscInt vertices_of_piece,
                                            EqmSharedLevel *to, PetscInt *number, PetscInt *range);
/* Collapse edges, `least_boundary` of the boundary vertices stay; then the next level. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedDecimate(EqmSharedLevel *finer, const EqmHierarchyOptions *options,
                                              PetscInt least_boundary, PetscInt where, EqmSharedLevel *coarser);
/* Sums over pieces, `width` reals of each of this rank's, in the order of the pieces. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedSum(const EqmSharedLevel *level, PetscInt width, const PetscReal *piece,
                                         PetscReal *sum);
/* Set the entries of ghosts, `width` reals per local vertex. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedUpdateGhosts(const EqmSharedLevel *level, PetscInt width, PetscReal *array);

/* The piece that a number is in. Not collective. */
static inline PetscInt EqmSharedPiece(const EqmSharedLevel *level, PetscInt number)
{
  return (PetscInt)((((PetscInt64)number + 1) * level->num_all_pieces - 1) / level->num_vertices);
}

/* Number of a local vertex along the curve. Not collective. */
static inline PetscInt EqmSharedGlobal(const EqmSharedLevel *level, PetscInt vertex)
{
  return vertex < level->num_owned ? level->first + vertex : level->ghost[vertex - level->num_owned];
}

#endif
