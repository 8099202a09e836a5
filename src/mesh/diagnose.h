/* The diagnosis's view of a soup: each rank's vertices with everything around them, and what can be read off that.
   Shared by diagnosis, repair and refinement. */
#ifndef EQM_DIAGNOSE_H
#define EQM_DIAGNOSE_H

#include <petscsf.h>
#include <equimap/soup.h>
#include "mesh/cells.h"

/* A cell of a lower quality than this is flat: rounding alone decides its measure. */
#define EQM_FLAT_TRIANGLE    1e-13
#define EQM_FLAT_TETRAHEDRON 1e-9

/* The usable cells (existing, distinct vertices) around the vertices of this rank's slab. Local vertices: the slab's
   first, then ghosts by input number. A cell and an edge belong to the rank of their vertex of lowest input number. */
typedef struct {
  MPI_Comm comm;
  PetscMPIInt rank, size;
  PetscLayout layout; /* of the vertices */
  PetscInt cell_size;
  PetscInt num_owned, num_local;
  PetscInt *input;     /* input number per local vertex */
  PetscReal *position; /* 3 * num_local */
  PetscSF ghosts;      /* roots: owned vertices; leaves: ghosts, at their local numbers */
  PetscInt num_cells;
  PetscInt *cells;      /* cell_size * num_cells, local vertex numbers */
  PetscInt *cell_input; /* input number per cell, ascending */
  signed char *side;    /* tetrahedra: the sign of the volume, else NULL */
  PetscInt *star_start; /* num_owned + 1 */
  PetscInt *star;       /* the cells around owned vertex v: star[star_start[v]] .. */
} EqmVicinity;

PETSC_INTERN PetscErrorCode EqmVicinityCreateCells(EqmSoup soup, EqmVicinity *vicinity);
PETSC_INTERN PetscErrorCode EqmVicinityCreate(EqmSoup soup, EqmVicinity *vicinity);
PETSC_INTERN PetscErrorCode EqmVicinityReset(EqmVicinity *vicinity);
PETSC_INTERN PetscErrorCode EqmVicinityFindDuplicates(const EqmVicinity *vicinity, PetscInt *first);
PETSC_INTERN PetscErrorCode EqmVicinityDropDuplicates(EqmVicinity *vicinity, PetscInt *first);
PETSC_INTERN PetscErrorCode EqmVicinityCellSF(const EqmVicinity *vicinity, PetscSF *sf);
PETSC_INTERN PetscInt EqmVicinityCellOwnerVertex(const EqmVicinity *vicinity, PetscInt cell);
PETSC_INTERN PetscReal EqmCellMeasure(const EqmVicinity *vicinity, PetscInt cell, PetscReal *quality);

/* The link of a vertex: the boundary of its star. Arrays are reused from vertex to vertex. */
typedef struct {
  PetscInt num_vertices;
  PetscInt *vertex;       /* local vertex numbers of the neighbours */
  PetscInt *leaving;      /* triangles: cells that run along the edge away from the centre, */
  PetscInt *entering;     /* and towards it */
  PetscInt *edge_cell;    /* triangles: the first two cells of the edge to neighbour i: 2 i, 2 i + 1 */
  PetscBool *on_boundary; /* the edge to this neighbour lies in the boundary */
  PetscInt num_edges;     /* tetrahedra: edges of the link, that is faces of the star */
  PetscInt *edge;         /* 2 * num_edges, places in `vertex` */
  PetscInt *edge_count;   /* cells at that face */
  PetscInt *edge_sides;   /* sum over them of the side they lie on, +1 or -1, 0 for a flat one */
  PetscBool manifold;     /* no edge (face) has more than two cells */
  PetscBool regular;      /* one path or circle; for tetrahedra one disk or sphere */
  PetscInt *place;        /* private from here on: place in `vertex` per local vertex, or -1 */
  PetscInt *vertex_root, *corner_root, *edge_corner, *edge_head, *edge_next;
} EqmLink;

PETSC_INTERN PetscErrorCode EqmLinkCreate(const EqmVicinity *vicinity, EqmLink *link);
PETSC_INTERN PetscErrorCode EqmLinkReset(EqmLink *link);
PETSC_INTERN void EqmLinkCompute(const EqmVicinity *vicinity, PetscInt vertex, EqmLink *link);

/* Disjoint sets of items, each item turned or not against its set's root. */
typedef struct {
  PetscInt num_items;
  PetscInt *parent;
  unsigned char *turned; /* against the parent */
} EqmForest;

PETSC_INTERN PetscErrorCode EqmForestCreate(PetscInt num_items, EqmForest *forest);
PETSC_INTERN PetscErrorCode EqmForestReset(EqmForest *forest);
PETSC_INTERN PetscBool EqmForestJoin(EqmForest *forest, PetscInt a, PetscInt b, PetscBool turned);
PETSC_INTERN PetscErrorCode EqmForestLabel(MPI_Comm comm, PetscSF sf, EqmForest *forest, const PetscInt *number,
                                           PetscInt *label, PetscBool *turned, PetscBool *conflict);

PETSC_INTERN void EqmFindingAdd(EqmFinding *finding, PetscInt a, PetscInt b, PetscInt c, PetscInt d);
PETSC_INTERN PetscErrorCode EqmFindingsMerge(MPI_Comm comm, PetscInt num_findings, EqmFinding *finding);

PETSC_INTERN PetscErrorCode EqmDiagnoseDuplicateVertices(const EqmVicinity *vicinity, EqmFinding *finding);
PETSC_INTERN PetscErrorCode EqmDiagnoseCells(EqmSoup soup, const EqmVicinity *vicinity, EqmDiagnosis *diagnosis);
PETSC_INTERN PetscErrorCode EqmDiagnoseBoundary(const EqmVicinity *vicinity, const PetscBool *on_boundary,
                                                const PetscInt *component, EqmDiagnosis *diagnosis);
PETSC_INTERN PetscErrorCode EqmDiagnoseOrientation(const EqmVicinity *vicinity, EqmFinding *finding);
PETSC_INTERN PetscErrorCode EqmVicinityOrient(const EqmVicinity *vicinity, PetscInt *label, PetscBool *turned,
                                              PetscBool *conflict);
PETSC_INTERN PetscErrorCode EqmVicinityLabelComponents(const EqmVicinity *vicinity, PetscInt *label);
PETSC_INTERN PetscErrorCode EqmVicinityShareFlags(const EqmVicinity *vicinity, PetscBool *flag);
PETSC_INTERN PetscErrorCode EqmVicinityMarkBoundary(const EqmVicinity *vicinity, PetscBool *on_boundary);

#endif
