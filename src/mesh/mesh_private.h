/* The fields of distributed meshes, read-only after creation; programs have accessors. */
#ifndef EQM_MESH_PRIVATE_H
#define EQM_MESH_PRIVATE_H

#include <equimap/mesh.h>
#include "mesh/soup_private.h"

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

  /* Input numbering. */
  PetscInt *vertex_input; /* per owned vertex */
  PetscInt *cell_input;   /* per local cell */
  EqmSoup soup;           /* the one that the mesh was made of, for as long as that lives */
  PetscInt soup_vertices; /* vertices of the soup, unreferenced ones included */

  char file[PETSC_MAX_PATH_LEN]; /* that the soup was read from */
  PetscInt64 identity;           /* CRC-32 of the soup's vertices, cells and density: tells it from other meshes */
};

struct _p_EqmSurface {
  EqmSoup soup;     /* the same for any number of ranks */
  PetscSF vertices; /* roots: the vertices of the soup's slab; leaves: the solid's local boundary vertices */
};

struct _p_EqmDouble {
  EqmSoup soup;           /* closed; the same for any number of ranks */
  PetscSF original, twin; /* roots: the vertices of the soup's slab; leaves: the surface's owned vertices */
};

#endif
