/* The distributed simplicial complex: owned and ghost vertices, the cells around the owned ones, measures. */
#ifndef EQUIMAP_MESH_H
#define EQUIMAP_MESH_H

#include <petscsf.h>
#include <equimap/soup.h>

/* Vertices are numbered 0 .. num_owned-1 (owned; reverse Cuthill-McKee within
   the rank, of solids within each block), then num_owned .. num_local-1
   (ghosts, by global number). Globally a rank's owned vertices are contiguous from vertex_start. Every cell that
   touches an owned vertex is here: one ghost layer, so that an owned vertex's gradient needs no reverse exchange. */
typedef struct _p_EqmMesh *EqmMesh;
struct _p_EqmMesh {
  MPI_Comm comm;
  PetscMPIInt rank, size;
  EqmLedger ledger;

  PetscInt cell_size;               /* 3 triangles, 4 tetrahedra */
  PetscInt num_vertices, num_cells; /* global */
  PetscInt vertex_start;            /* global number of the first owned vertex */
  PetscInt num_owned, num_local;
  PetscInt *global; /* global vertex number per local vertex */
  PetscSF halo;     /* roots: owned vertices; leaves: ghosts */

  PetscInt num_local_cells; /* those that this rank owns come first */
  PetscInt num_owned_cells; /* a cell belongs to the owner of its vertex of smallest global number */
  PetscInt *cells; /* cell_size * num_local_cells, local vertex numbers; triangles turn as in the file, the volume of
                              tetrahedra is positive */

  PetscReal *position;     /* 3 * num_local: the surface or solid itself */
  PetscReal *weight;       /* per local cell: measure times density, sum over owned cells of all ranks = 1 */
  PetscReal *cell_measure; /* per local cell: measure alone, in the mesh's own units */
  PetscReal *edge_length;  /* per local cell and corner, of the edge opposite; NULL: edges are straight in space */
  PetscReal measure;       /* W: total measure, density included, in the mesh's own units */

  /* Boundary. Of surfaces: edges that run with the surface on their left; of solids: triangles that look outward. */
  PetscInt num_boundary_vertices; /* global */
  PetscBool *on_boundary;         /* per local vertex */
  PetscInt num_boundary_facets; /* local: every boundary edge (of tetrahedra: triangle) that touches an owned vertex */
  PetscInt *boundary_facets; /* (cell_size - 1) * num_boundary_facets, local vertex numbers, oriented as the boundary */
  PetscInt64
      *boundary_order; /* per facet: its place in the file, when first all first facets of the cells are listed, ... */

  /* Owner-computes blocks for threads: block b owns the vertices block_vertex[b] .. block_vertex[b+1]-1 and visits the
     cells block_cell[block_start[b]] .. in ascending order; the same for every number of threads. */
  PetscInt num_blocks;
  PetscInt *block_vertex, *block_start, *block_cell;

  /* Way back to input numbering. */
  PetscInt *vertex_input; /* per owned vertex */
  PetscInt *cell_input;   /* per local cell */
  PetscInt soup_vertices; /* vertices of the soup, unreferenced ones included */

  char file[PETSC_MAX_PATH_LEN]; /* where the soup came from */
  PetscInt64 identity;           /* CRC-32 of the soup's vertices, cells and density: tells it from other meshes */
};

/* Build the distributed mesh of a soup: partition, renumber, exchange one ghost layer. The soup must have passed the
   diagnosis (manifold, oriented, referenced). Option: -partition metis|slab. Collective. */
PETSC_EXTERN PetscErrorCode EqmMeshCreate(EqmSoup soup, EqmLedger ledger, EqmMesh *mesh);
/* Ask for its options, with help. Collective. */
PETSC_EXTERN PetscErrorCode EqmMeshAskOptions(PetscOptionItems *PetscOptionsObject);
PETSC_EXTERN PetscErrorCode EqmMeshDestroy(EqmMesh *mesh);
/* Fill the ghosts of an array with `width` reals per local vertex from their owners. Collective. */
PETSC_EXTERN PetscErrorCode EqmMeshUpdateGhosts(EqmMesh mesh, PetscInt width, PetscReal *array);
/* Lumped weights: to each owned vertex its share of the weights of the cells around it; they add up to one over all
   ranks. Not collective. */
PETSC_EXTERN PetscErrorCode EqmMeshVertexWeights(EqmMesh mesh, PetscReal *weights);
/* Order the one boundary loop of a disk-type surface: for every local vertex on it, position in the loop (0 for the
   vertex of the lowest input number, then along the boundary's direction) and arc length from there, in [0, 1); -1
   elsewhere. Arrays of num_local. Collective. */
PETSC_EXTERN PetscErrorCode EqmMeshBoundaryLoop(EqmMesh mesh, PetscInt *place, PetscReal *arc_length);
/* From per-owned-vertex (per-owned-cell) values to slabs of the soup's numbering, `width` reals each. Slab entries of
   vertices that no cell uses keep their value. Collective. */
PETSC_EXTERN PetscErrorCode EqmMeshVerticesToInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *owned,
                                                   PetscReal *slab);
PETSC_EXTERN PetscErrorCode EqmMeshCellsToInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *owned,
                                                PetscReal *slab);
/* The other way: from slabs of the soup to all local vertices, ghosts included. Collective. */
PETSC_EXTERN PetscErrorCode EqmMeshVerticesFromInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *slab,
                                                     PetscReal *local);

/* Local numbers of those of `num` vertices (input numbers) that this rank owns, -1 for the others. Not collective. */
PETSC_EXTERN PetscErrorCode EqmMeshFindVertices(EqmMesh mesh, PetscInt num, const PetscInt *input, PetscInt *local);

/* The closed surface around a solid, as a mesh of its own: its vertices are the solid's boundary vertices in input
   order, its triangles look outward. */
typedef struct _p_EqmSurface *EqmSurface;
struct _p_EqmSurface {
  EqmSoup soup;     /* the same for any number of ranks */
  PetscSF vertices; /* roots: the vertices of the soup's slab; leaves: the solid's local boundary vertices */
};

/* The surface of a mesh of tetrahedra. Errors: EQM_ERR_USAGE (a mesh of triangles). Collective. */
PETSC_EXTERN PetscErrorCode EqmSurfaceCreate(EqmMesh solid, EqmSurface *surface);
PETSC_EXTERN PetscErrorCode EqmSurfaceDestroy(EqmSurface *surface);
/* Carry `width` reals per vertex of the surface's slab to the solid's local boundary vertices, ghosts included; what
   stands at other vertices stays. Collective. */
PETSC_EXTERN PetscErrorCode EqmSurfaceToSolid(EqmSurface surface, PetscInt width, const PetscReal *slab,
                                              PetscReal *local);
/* The other way, from all local vertices of the solid, ghosts up to date. Collective. */
PETSC_EXTERN PetscErrorCode EqmSurfaceFromSolid(EqmSurface surface, PetscInt width, const PetscReal *local,
                                                PetscReal *slab);

/* The double covering of a surface with a boundary, as a mesh of its own: the surface and its mirror image, glued along
   the boundary. */
typedef struct _p_EqmDouble *EqmDouble;
struct _p_EqmDouble {
  EqmSoup soup;           /* closed; the same for any number of ranks */
  PetscSF original, twin; /* roots: the vertices of the soup's slab; leaves: the surface's owned vertices */
};

/* The double covering of a mesh of triangles (004 section 2.2). Errors: EQM_ERR_USAGE (a solid, a closed surface).
   Collective. */
PETSC_EXTERN PetscErrorCode EqmDoubleCreate(EqmMesh surface, EqmDouble *covering);
PETSC_EXTERN PetscErrorCode EqmDoubleDestroy(EqmDouble *covering);
/* Put `width` reals per owned vertex of the surface, one for it and one for its twin, on the covering's slab; boundary
   vertices, which are their own twins, get the first. Collective. */
PETSC_EXTERN PetscErrorCode EqmDoubleFromHalves(EqmDouble covering, PetscInt width, const PetscReal *original,
                                                const PetscReal *twin, PetscReal *slab);
/* Carry `width` reals per vertex of the covering's slab to the surface's owned vertices: those of the original half.
   Collective. */
PETSC_EXTERN PetscErrorCode EqmDoubleToOriginal(EqmDouble covering, PetscInt width, const PetscReal *slab,
                                                PetscReal *owned);

#endif
