/* What a mesh file says and nothing more: vertices and cells in input numbering, dealt to the ranks in contiguous
   slabs. Readers make it, the diagnosis looks at it, the mesh is built from it. */
#ifndef EQUIMAP_SOUP_H
#define EQUIMAP_SOUP_H

#include <equimap/base.h>

/* Longest note of a reader, terminating zero included. */
#define EQM_SOUP_NOTE 256

/* A mesh on one rank, as a parser makes it and as a writer takes it. Indices count from 0 in input numbering. */
typedef struct {
  PetscInt num_vertices;
  PetscInt num_cells;
  PetscInt cell_size;  /* vertices per cell: 3 triangles, 4 tetrahedra; 0 while unknown */
  PetscReal *vertices; /* 3 * num_vertices; PetscMalloc'ed */
  PetscInt *cells;     /* cell_size * num_cells; PetscMalloc'ed */
  PetscReal *texture;  /* 2 * cell_size * num_cells, the texture coordinates of each corner, or NULL; PetscMalloc'ed */
  char note[EQM_SOUP_NOTE]; /* what the reader changed, in plain words; "": nothing */
} EqmSerialMesh;

/* A slab of the file's mesh on each rank. Public fields, read-only after creation. */
typedef struct _p_EqmSoup *EqmSoup;
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
  PetscInt64 checksum;           /* CRC-32 of vertices and cells in input order, rank-independent */
};

/* Deal a mesh that rank 0 holds (NULL elsewhere) to all ranks; the arrays of `serial` are taken over and freed.
   Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupCreateFromRoot(MPI_Comm comm, EqmSerialMesh *serial, const char *file,
                                                  EqmSoup *soup);
/* Wrap slabs that every rank already holds (a parallel reader's); arrays are taken over. Slabs are contiguous in rank
   order. Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupCreateFromSlabs(MPI_Comm comm, PetscInt cell_size, PetscInt num_local_vertices,
                                                   PetscReal *vertices, PetscInt num_local_cells, PetscInt *cells,
                                                   const char *file, EqmSoup *soup);
/* Gather on rank 0 (for formats that one rank must write); elsewhere `serial` is empty. Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupGather(EqmSoup soup, EqmSerialMesh *serial);
/* A soup of its own with the same mesh, slabs and density. Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupCopy(EqmSoup soup, EqmSoup *copy);
PETSC_EXTERN PetscErrorCode EqmSoupDestroy(EqmSoup *soup);
PETSC_EXTERN PetscErrorCode EqmSerialMeshReset(EqmSerialMesh *serial);

/* Read a mesh file, its format by content and suffix. Errors: EQM_ERR_IO (missing, unreadable, not a mesh, truncated;
   the message names file and line or byte), EQM_ERR_MESH (well-formed, but no triangles or tetrahedra). Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupRead(MPI_Comm comm, const char *file, EqmSoup *soup);
/* Write a mesh, the format by suffix. Never leaves a half-written file. Errors: EQM_ERR_USAGE (unknown suffix),
   EQM_ERR_IO. Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupWrite(EqmSoup soup, const char *file);
/* Read one positive number per cell: CSV with a header line (last column), or /cell/density of an HDF5 file. Fills
   soup->density. Errors: EQM_ERR_IO, EQM_ERR_MESH (wrong count, not positive). Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupReadDensity(EqmSoup soup, const char *file);

/* Move every vertex of a surface along its normal by sigma, a length in the mesh's own units, times a random number of
   the standard normal distribution that depends on seed and input vertex number alone (001 section 6.5). The checksum
   becomes that of the noisy mesh. Errors: EQM_ERR_USAGE (sigma negative, not a surface). Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupAddNoise(EqmSoup soup, PetscReal sigma, PetscInt seed);

/* Test shapes of about n vertices; `shape` is one of the names that EqmGenerateShapes lists. Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupGenerate(MPI_Comm comm, const char *shape, PetscInt n, PetscInt seed, EqmSoup *soup);
/* Names and descriptions of those shapes; the arrays are the caller's to PetscFree. Not collective. */
PETSC_EXTERN PetscErrorCode EqmGenerateShapes(const char *const **names, const char *const **descriptions, int *n);
/* Split every triangle into four (every tetrahedron into eight) `times` times. Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupRefine(EqmSoup *soup, PetscInt times);

/* The intrinsic Delaunay triangulation of a surface: the same vertices and the same metric, as many cells, edges
   flipped until no cotangent weight is negative. Edges are then known by edge_length alone, and two of them may join
   the same vertices. Cell densities are dropped. `flips`: how many edges were flipped. Errors: none of its own.
   Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupFlip(EqmSoup soup, EqmSoup *flipped, PetscInt64 *flips);

/* What the diagnosis found. `count` findings of a kind, the first few in input numbering. */
typedef enum {
  EQM_FINDING_NOT_FINITE,               /* vertices with a NaN or infinite coordinate */
  EQM_FINDING_BAD_INDEX,                /* cells that name a vertex that does not exist */
  EQM_FINDING_UNREFERENCED,             /* vertices of no cell */
  EQM_FINDING_DUPLICATE_VERTEX,         /* vertices at the same place as another, both in use */
  EQM_FINDING_DEGENERATE_CELL,          /* repeated vertex, or measure zero */
  EQM_FINDING_DUPLICATE_CELL,           /* same vertices as another cell */
  EQM_FINDING_NON_MANIFOLD_EDGE,        /* edge (triangle mesh) or face (tet mesh) of more than two cells */
  EQM_FINDING_NON_MANIFOLD_VERTEX,      /* link is not one path or one circle */
  EQM_FINDING_INCONSISTENT_ORIENTATION, /* edges that two cells run through in the same direction */
  EQM_FINDING_NOT_ORIENTABLE,
  EQM_FINDING_OVERLAP,            /* faces with both their tetrahedra on the same side */
  EQM_FINDING_COMPONENTS,         /* more than one connected component */
  EQM_FINDING_HOLES,              /* boundary loops beyond the one that a disk has */
  EQM_FINDING_GENUS,              /* handles */
  EQM_FINDING_CLOSED,             /* no boundary, where the command wants one */
  EQM_FINDING_OPEN,               /* a boundary, where the command wants none */
  EQM_FINDING_WRONG_CELLS,        /* triangles where tetrahedra are wanted, or the other way round */
  EQM_FINDING_NO_INTERIOR_VERTEX, /* cells whose vertices all lie on the boundary */
  EQM_FINDING_CHORD,              /* interior edges between two boundary vertices */
  EQM_NUM_FINDINGS
} EqmFindingKind;

#define EQM_FINDING_SHOWN 5
typedef struct {
  PetscInt64 count;
  PetscInt shown;                       /* how many of `where` are filled */
  PetscInt where[EQM_FINDING_SHOWN][4]; /* vertex or cell numbers in input numbering, -1 where unused */
} EqmFinding;

/* What a mesh is, as far as maps are concerned. */
typedef enum {
  EQM_TOPOLOGY_DISK,   /* surface: one piece, one boundary loop, no handle */
  EQM_TOPOLOGY_SPHERE, /* surface: one piece, closed, no handle */
  EQM_TOPOLOGY_BALL,   /* solid: one piece, one boundary surface, no tunnel */
  EQM_TOPOLOGY_OTHER,
  EQM_NUM_TOPOLOGIES
} EqmTopology;

typedef struct {
  PetscInt cell_size; /* 3 triangles, 4 tetrahedra */
  EqmFinding finding[EQM_NUM_FINDINGS];
  PetscInt64 num_vertices, num_edges, num_faces, num_cells, num_boundary_vertices, num_boundary_edges;
  /* of a solid: the surfaces of its boundary in place of loops, and their genus; genus is -1 where it means nothing */
  PetscInt64 num_components, num_boundary_loops, euler_characteristic, genus;
  PetscReal measure, smallest_cell, largest_cell; /* area or volume */
  PetscReal worst_cell_quality;                   /* 0 flat ... 1 equilateral */
  EqmTopology topology;
} EqmDiagnosis;

/* Look at a mesh: everything that EqmDiagnosis holds. Never fails for what the mesh is like. Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupDiagnose(EqmSoup soup, EqmDiagnosis *diagnosis);
/* Say what is wrong with the mesh for a target ("disk", "square", "sphere", "ball", "conformal", or NULL: any): one
   line a finding, with what, where, how many and what to do. `fatal` tells whether a map is out of the question, `text`
   is written on every rank. Not collective. */
PETSC_EXTERN PetscErrorCode EqmDiagnosisDescribe(const EqmDiagnosis *diagnosis, const char *target, PetscBool *fatal,
                                                 char *text, size_t length);
/* What was mended. */
typedef struct {
  PetscInt64 duplicate_cells_removed, degenerate_cells_removed, cells_flipped, cells_split, vertices_added,
      vertices_unreferenced;
} EqmRepair;
/* Mend what is safe to mend; the soup is replaced. Added vertices follow the input's, kept ones keep their numbers.
   `parent` (of the new slab of cells, input cell number of each cell) is allocated. Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupRepair(EqmSoup *soup, EqmRepair *repair, PetscInt **parent);

#endif
