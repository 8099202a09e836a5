/* Coarser meshes of a surface: edges are collapsed in rounds, each level stands for the whole surface, and the records
   of the collapses tell how the vertices come back (Garland and Heckbert 1997; Hoppe 1996 for the way back).

   The first rank holds the hierarchy, gathered from all ranks; the others hold empty ones. Vertices are numbered along
   a space-filling curve and cells by their vertices, so that the same mesh gives the same hierarchy on any number of
   ranks. */
#ifndef EQM_HIERARCHY_H
#define EQM_HIERARCHY_H

#include <equimap/mesh.h>

/* Where a vertex lies; corners are boundary vertices that stay on every level. */
typedef enum { EQM_INSIDE, EQM_ON_BOUNDARY, EQM_CORNER } EqmVertexPart;

/* `vertex` went onto its neighbour `onto`. Its ring, anticlockwise, is ring[start] .. ring[start + size - 1] of the
   level; a boundary vertex's begins with the next boundary vertex and ends with the one before. Triangle k of its star
   joins it with ring vertices k and k + 1 and had the weight ring_weight[start + k]. */
typedef struct {
  PetscInt vertex, onto, start, size;
} EqmCollapse;

typedef struct {
  PetscInt num_vertices, num_cells, num_boundary;
  PetscInt *cells;     /* 3 per cell, turning as in the file */
  PetscReal *weight;   /* per cell: the share of the surface that it stands for; they add up to one */
  PetscReal *position; /* 3 per vertex: where it is on the surface itself */
  unsigned char *part; /* an EqmVertexPart per vertex */
  PetscInt *finer;     /* per vertex: its number on the next finer level; NULL on the finest */

  /* What leads from this level to the next coarser one, in this order; numbers are this level's. */
  PetscInt num_collapses, ring_length;
  EqmCollapse *collapse;
  PetscInt *ring;
  PetscReal *ring_weight;
} EqmHierarchyLevel;

enum {
  EQM_MOST_LEVELS = 64,
  EQM_MOST_RECORD = 11 /* ring vertices of a collapse */
};

typedef struct _p_EqmHierarchy *EqmHierarchy;
struct _p_EqmHierarchy {
  MPI_Comm comm;
  PetscMPIInt rank;
  PetscInt num_owned;  /* vertices of the mesh that this rank owns */
  PetscInt num_levels; /* 0 on all ranks but the first; level 0 is the finest */
  EqmHierarchyLevel level[EQM_MOST_LEVELS];
  PetscInt *order; /* global number in the mesh of each vertex of level 0 */
  PetscInt
      *cell_order; /* place of each cell of level 0 among the owned cells of all ranks, one rank's after the other */
};

typedef struct {
  PetscReal ratio;            /* vertices of a level to those of the next coarser one */
  PetscInt coarsest;          /* no level is made below a level with so few vertices; four is the least */
  PetscReal boundary_share;   /* boundary vertices are kept so many that the piece between chord and arc of the unit
                                 circle is below half a triangle of the surface, times this factor */
  const PetscBool *corner;    /* per local vertex: must stay; NULL: none */
  PetscInt gathered;          /* a mesh or a shared level (hierarchy/shared.h) with no more vertices goes to the first
                                 rank */
  PetscInt vertices_of_piece; /* and their pieces have about so many */
} EqmHierarchyOptions;

PETSC_INTERN PetscErrorCode EqmHierarchyOptionsDefault(EqmHierarchyOptions *options);
/* Gather the mesh, a surface, on the first rank and decimate it there. Collective. */
PETSC_INTERN PetscErrorCode EqmHierarchyCreate(EqmMesh mesh, const EqmHierarchyOptions *options,
                                               EqmHierarchy *hierarchy);
PETSC_INTERN PetscErrorCode EqmHierarchyDestroy(EqmHierarchy *hierarchy);
/* Bytes that the levels take on this rank. Not collective. */
PETSC_INTERN PetscErrorCode EqmHierarchyMemory(EqmHierarchy hierarchy, PetscInt64 *bytes);
/* From `width` reals per owned vertex of the mesh to the vertices of level 0, and back. Collective. */
PETSC_INTERN PetscErrorCode EqmHierarchyGather(EqmHierarchy hierarchy, PetscInt width, const PetscReal *owned,
                                               PetscReal *finest);
PETSC_INTERN PetscErrorCode EqmHierarchyScatter(EqmHierarchy hierarchy, PetscInt width, const PetscReal *finest,
                                                PetscReal *owned);

/* The worst 4 sqrt(3) area / (sum of squared edges) among the cells: one for regular triangles. Not collective. */
PETSC_INTERN PetscReal EqmLevelWorstQuality(const EqmHierarchyLevel *level);

#endif
