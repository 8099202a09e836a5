/* The fields of a soup, read-only after creation; programs have accessors. */
#ifndef EQM_SOUP_PRIVATE_H
#define EQM_SOUP_PRIVATE_H

#include <equimap/soup.h>

struct _p_EqmSoup {
  MPI_Comm comm;
  PetscInt cell_size;                /* 3 triangles, 4 tetrahedra */
  PetscInt num_vertices, num_cells;  /* global counts */
  PetscInt vertex_start, vertex_end; /* this rank's slab of vertices, input numbering */
  PetscInt cell_start, cell_end;     /* this rank's slab of cells, input numbering */
  PetscReal *vertices;               /* 3 * (vertex_end - vertex_start) */
  PetscInt *cells;                   /* cell_size * (cell_end - cell_start), input vertex numbers */
  PetscReal *density;                /* per cell of the slab, positive, or NULL: all one */
  PetscReal *edge_length; /* per cell of the slab and corner, of the edge opposite; NULL: edges are straight in space */
  char file[PETSC_MAX_PATH_LEN]; /* where it came from */
  char note[EQM_SOUP_NOTE];      /* what its reader changed, in plain words; "": nothing */
  char left[EQM_SOUP_NOTE];      /* what of the file its reader left out, a list; "": nothing */
  char *metadata;                /* what the file says beside the mesh, the same on every rank, or NULL */
  PetscInt num_fields;           /* what the file has per vertex and cell beside the mesh */
  EqmMeshField *fields;          /* names and widths are the same on every rank, values are those of the slabs */
  PetscInt64 checksum;           /* CRC-32 of vertices and cells in input order, rank-independent */
};

/* EqmSoupCreateFromParts - a soup in balanced slabs from the parts of a mesh that the ranks have read, in their order:
   the same as from one rank that has read all.

   Collective. part - taken over; fields, note, left and metadata are the same on every rank. Errors: EQM_ERR_IO (more
   vertices or cells than PetscInt can count). */
PETSC_INTERN PetscErrorCode EqmSoupCreateFromParts(MPI_Comm comm, EqmSerialMesh *part, const char *file, EqmSoup *soup);

#endif
