/* What a mesh file says and nothing more: vertices and cells in input numbering, dealt to the ranks in contiguous
   slabs. Readers create it, the diagnosis examines it, the mesh is built from it. */
#ifndef EQUIMAP_SOUP_H
#define EQUIMAP_SOUP_H

#include <equimap/base.h>

/* Longest note of a reader, terminating zero included. */
#define EQM_SOUP_NOTE 256

/* Longest name of a field, terminating zero included. */
#define EQM_FIELD_NAME 128

/* Numbers per vertex or per cell that a file has beside its mesh, in input numbering. */
typedef struct {
  char name[EQM_FIELD_NAME];
  PetscBool on_cells;
  PetscInt width;    /* numbers per vertex or cell */
  PetscReal *values; /* width * vertices or cells; PetscMalloc'ed */
} EqmMeshField;

/* A mesh on one rank, as a parser makes it and as a writer takes it. Indices count from 0 in input numbering. */
typedef struct {
  PetscInt num_vertices;
  PetscInt num_cells;
  PetscInt cell_size;  /* vertices per cell: 3 triangles, 4 tetrahedra; 0 while unknown */
  PetscReal *vertices; /* 3 * num_vertices; PetscMalloc'ed */
  PetscInt *cells;     /* cell_size * num_cells; PetscMalloc'ed */
  PetscReal *texture;  /* 2 * cell_size * num_cells, the texture coordinates of each corner, or NULL; PetscMalloc'ed */
  char note[EQM_SOUP_NOTE]; /* what the reader changed, in plain words; "": nothing */
  char left[EQM_SOUP_NOTE]; /* what of the file the reader left out, a list; "": nothing */
  char *metadata;           /* what the file says beside the mesh, lines "key<tab>value", or NULL; PetscMalloc'ed */
  PetscInt num_fields;
  EqmMeshField *fields; /* what the file has per vertex and cell; PetscMalloc'ed, or NULL */
} EqmSerialMesh;

/* A slab of the file's mesh on each rank. */
typedef struct _p_EqmSoup *EqmSoup;

/* What a soup holds; arrays belong to it. Any pointer may be NULL. Not collective. */
/* EqmSoupGetSizes - corners of a cell (3 triangles, 4 tetrahedra), vertices and cells of all ranks. */
PETSC_EXTERN PetscErrorCode EqmSoupGetSizes(EqmSoup soup, PetscInt *cell_size, PetscInt *num_vertices,
                                            PetscInt *num_cells);
/* EqmSoupGetVertices - this rank's slab: input vertices `start` to `end` - 1, three coordinates each. */
PETSC_EXTERN PetscErrorCode EqmSoupGetVertices(EqmSoup soup, PetscInt *start, PetscInt *end,
                                               const PetscReal **vertices);
/* EqmSoupGetCells - this rank's slab: input cells `start` to `end` - 1, as input vertex numbers. */
PETSC_EXTERN PetscErrorCode EqmSoupGetCells(EqmSoup soup, PetscInt *start, PetscInt *end, const PetscInt **cells);
/* EqmSoupGetFields - what the file has per vertex and cell beside the mesh: this rank's slabs, names and widths the
   same on every rank. Texture coordinates are a field "texcoord" on cells, two numbers per corner. */
PETSC_EXTERN PetscErrorCode EqmSoupGetFields(EqmSoup soup, PetscInt *num_fields, const EqmMeshField **fields);
/* EqmSoupGetFile - where it came from. */
PETSC_EXTERN PetscErrorCode EqmSoupGetFile(EqmSoup soup, const char **file);

/* EqmSoupCreateFromRoot - distribute a mesh that rank 0 holds to all ranks, in balanced contiguous slabs.

   Collective. serial - on rank 0 the mesh, whose arrays are taken over and are freed or used; ignored on other ranks
   (may be NULL there). file - where it came from, for messages; may be NULL. soup - to be freed with EqmSoupDestroy.
   Errors: those of EqmSoupCreateFromSlabs. */
PETSC_EXTERN PetscErrorCode EqmSoupCreateFromRoot(MPI_Comm comm, EqmSerialMesh *serial, const char *file,
                                                  EqmSoup *soup);
/* EqmSoupCreateFromSlabs - a soup from slabs that the ranks already hold, as a parallel reader does.

   Collective. The slabs are contiguous in rank order. cell_size - 3 or 4; vertices - 3 * num_local_vertices; cells -
   cell_size * num_local_cells global vertex numbers; both PetscMalloc'ed (or NULL where empty) and taken over, also
   after a failure. soup - to be freed with EqmSoupDestroy. Errors: EQM_ERR_IO (more vertices or cells than PetscInt can
   count). */
PETSC_EXTERN PetscErrorCode EqmSoupCreateFromSlabs(MPI_Comm comm, PetscInt cell_size, PetscInt num_local_vertices,
                                                   PetscReal *vertices, PetscInt num_local_cells, PetscInt *cells,
                                                   const char *file, EqmSoup *soup);
/* EqmSoupGather - the whole mesh on rank 0, for formats that one rank must write.

   Collective. serial - filled on rank 0, empty elsewhere; to be freed with EqmSerialMeshReset. */
PETSC_EXTERN PetscErrorCode EqmSoupGather(EqmSoup soup, EqmSerialMesh *serial);
/* EqmSoupCopy - a copy with arrays of its own: mesh, slabs, density, edge lengths, file name. Collective. */
PETSC_EXTERN PetscErrorCode EqmSoupCopy(EqmSoup soup, EqmSoup *copy);
/* EqmSoupDestroy - free a soup. Collective; NULL is fine. */
PETSC_EXTERN PetscErrorCode EqmSoupDestroy(EqmSoup *soup);
/* EqmSerialMeshReset - free the arrays of a serial mesh and make it empty. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSerialMeshReset(EqmSerialMesh *serial);

/* EqmSoupRead - read a mesh file, its format known by content and suffix.

   Collective. soup - to be freed with EqmSoupDestroy. Errors: EQM_ERR_IO (missing, unreadable, not a mesh, truncated;
   the message names file and line or byte), EQM_ERR_MESH (well-formed, but no triangles or tetrahedra). */
PETSC_EXTERN PetscErrorCode EqmSoupRead(MPI_Comm comm, const char *file, EqmSoup *soup);
/* EqmSoupWrite - write a mesh, the format by suffix; the file appears whole or not at all.

   Collective. Errors: EQM_ERR_USAGE (unknown suffix), EQM_ERR_IO (cannot be written; a file of that name survives). */
PETSC_EXTERN PetscErrorCode EqmSoupWrite(EqmSoup soup, const char *file);
/* EqmSoupReadDensity - read one positive number per cell into soup->density.

   Collective. file - CSV with a header line, of which the last column is read, or /cell/density of an HDF5 file.
   Errors: EQM_ERR_IO (unreadable), EQM_ERR_MESH (wrong count, not positive). */
PETSC_EXTERN PetscErrorCode EqmSoupReadDensity(EqmSoup soup, const char *file);

/* EqmSoupScale - multiply all coordinates by `factor`; the checksum becomes that of the scaled mesh. Collective.
   Errors: EQM_ERR_USAGE (not positive and finite). */
PETSC_EXTERN PetscErrorCode EqmSoupScale(EqmSoup soup, PetscReal factor);
/* EqmSoupCheckExtent - refuse a mesh that is so large or so small, by a power of ten beyond 60 (solids: 40), that
   squares of areas or volumes are no numbers. Collective. Errors: EQM_ERR_MESH, with the command that scales the mesh.
 */
PETSC_EXTERN PetscErrorCode EqmSoupCheckExtent(EqmSoup soup);
/* EqmSoupBringIntoRange - divide the coordinates of such a mesh by a power of two, which changes no digit, so that it
   extends over about one; those of others stay.

   Collective. exponent - of that power, 0 where nothing was changed; EqmSoupShift with it brings the file's unit back.
   The checksum remains that of the file. Errors: EQM_ERR_MESH (areas or volumes in the file's unit are no numbers). */
PETSC_EXTERN PetscErrorCode EqmSoupBringIntoRange(EqmSoup soup, PetscInt *exponent);
/* EqmSoupShift - multiply the coordinates by 2^exponent; the checksum stays. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSoupShift(EqmSoup soup, PetscInt exponent);

/* EqmSoupAddNoise - move every vertex of a surface along its normal by a random length, for studies of stability (001
   section 6.5).

   Collective. sigma - standard deviation of the length, in the mesh's own units, not negative; 0 changes nothing. seed
   - another seed, other numbers; they depend on seed and input vertex number alone: the same bits on any number of
   ranks. The normal is the mean of those around the vertex, weighted by area; a vertex without one stays. The checksum
   becomes that of the noisy mesh. Errors: EQM_ERR_USAGE (sigma negative or not finite, not a surface). */
PETSC_EXTERN PetscErrorCode EqmSoupAddNoise(EqmSoup soup, PetscReal sigma, PetscInt seed);

/* EqmSoupGenerate - a test surface or solid of about `n` vertices.

   Collective. shape - one of the names that EqmGenerateShapes gives; seed - of irregularities and bumps. The result
   does not depend on the number of ranks. soup - to be freed with EqmSoupDestroy. Errors: EQM_ERR_USAGE (unknown shape,
   n out of range). */
PETSC_EXTERN PetscErrorCode EqmSoupGenerate(MPI_Comm comm, const char *shape, PetscInt n, PetscInt seed, EqmSoup *soup);
/* EqmGenerateShapes - names and one-line descriptions of those shapes, `n` of each.

   Not collective. The arrays are the caller's to PetscFree, the strings are constant; any output may be NULL. */
PETSC_EXTERN PetscErrorCode EqmGenerateShapes(const char *const **names, const char *const **descriptions, int *n);
/* EqmSoupRefine - split every triangle into four, every tetrahedron into eight, `times` times.

   Collective; the soup is replaced, the same on any number of ranks. New vertices, on the middles of the edges, follow
   the old ones, which keep their numbers; children stand where their parents stood and inherit their density. Errors:
   EQM_ERR_MESH (a cell that names a vertex twice or one that does not exist), EQM_ERR_USAGE (more cells than PetscInt
   can count). */
PETSC_EXTERN PetscErrorCode EqmSoupRefine(EqmSoup *soup, PetscInt times);

/* EqmSoupFlip - the intrinsic Delaunay triangulation of a surface: edges flipped until no cotangent weight is negative
   (Bobenko and Springborn 2007).

   Collective. The same vertices and the same metric, as many cells. Edges are then known by edge_length alone, and two
   of them may join the same vertices. Cell densities are dropped. flipped - to be freed with EqmSoupDestroy; flips -
   how many edges were flipped. */
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
  EQM_FINDING_GENUS,              /* handles; `where` is one short loop around or through one, vertex by vertex */
  EQM_FINDING_CLOSED,             /* no boundary, where the command wants one */
  EQM_FINDING_OPEN,               /* a boundary, where the command wants none */
  EQM_FINDING_WRONG_CELLS,        /* triangles where tetrahedra are wanted, or the other way round */
  EQM_FINDING_NO_INTERIOR_VERTEX, /* cells whose vertices all lie on the boundary */
  EQM_FINDING_CHORD,              /* interior edges between two boundary vertices */
  EQM_NUM_FINDINGS
} EqmFindingKind;

/* Of how many vertices or cells a finding tells the numbers, at most. */
#define EQM_FINDING_SHOWN 5
/* One kind of fault: how often it occurs, and where. */
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

/* What a mesh is and what is wrong with it; the same on every rank. */
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

/* EqmSoupDiagnose - what a mesh is, and what is wrong with it where.

   Collective; `diagnosis` is the same on every rank and for every number of ranks. Cells that name a vertex twice or
   one that does not exist, and later duplicates of a cell, are counted and then ignored. No rank holds more than its
   slab and what touches it. A mesh of any kind is no error. */
PETSC_EXTERN PetscErrorCode EqmSoupDiagnose(EqmSoup soup, EqmDiagnosis *diagnosis);
/* EqmDiagnosisDescribe - what a diagnosis means for a target, in words.

   Not collective; the same on every rank. target - a command's name ("disk", "square", "sphere", "ball", "conformal"),
   or NULL for any of them. fatal - no map to the target is possible. text - of `length` bytes, truncated if that is not
   enough: a line per finding (what, where, how many, what to do), the fatal ones first, without a newline at the end.
   Errors: PETSC_ERR_ARG_OUTOFRANGE (no such target). */
PETSC_EXTERN PetscErrorCode EqmDiagnosisDescribe(const EqmDiagnosis *diagnosis, const char *target, PetscBool *fatal,
                                                 char *text, size_t length);
/* What EqmSoupRepair has done, counted over all ranks. */
typedef struct {
  PetscInt64 duplicate_cells_removed, degenerate_cells_removed, cells_flipped, cells_split, vertices_added,
      vertices_unreferenced;
} EqmRepair;
/* EqmSoupRepair - repair what can be repaired without a choice.

   Collective; the soup is replaced, the same on any number of ranks. Removed: later duplicates of cells, and cells that
   repeat a vertex. Turned: the triangles that disagree with most of their piece, and all tetrahedra of negative volume.
   Split at their middle: interior edges between two boundary vertices, with all cells around them; at its centre: a
   cell without an interior vertex that this leaves. Added vertices follow the old ones, which keep their numbers, in
   use or not; children stand where their parent stood and inherit its density. parent - allocated (PetscFree it): per
   cell of the new slab the input number of the cell it comes from. */
PETSC_EXTERN PetscErrorCode EqmSoupRepair(EqmSoup *soup, EqmRepair *repair, PetscInt **parent);

#endif
