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

/* EqmMeshGetSizes - corners of a cell, vertices and cells of all ranks. Any pointer may be NULL. Not collective. */
PETSC_EXTERN PetscErrorCode EqmMeshGetSizes(EqmMesh mesh, PetscInt *cell_size, PetscInt *num_vertices,
                                            PetscInt *num_cells);
/* EqmMeshGetLocalSizes - vertices that this rank owns, those that it knows (owned first, then ghosts), and its cells
   (owned first). Any pointer may be NULL. Not collective. */
PETSC_EXTERN PetscErrorCode EqmMeshGetLocalSizes(EqmMesh mesh, PetscInt *num_owned, PetscInt *num_local,
                                                 PetscInt *num_owned_cells, PetscInt *num_local_cells);
/* EqmMeshGetCells - local vertex numbers of the local cells. Not collective. */
PETSC_EXTERN PetscErrorCode EqmMeshGetCells(EqmMesh mesh, const PetscInt **cells);
/* EqmMeshGetVertexInput - input number of every owned vertex. Not collective. */
PETSC_EXTERN PetscErrorCode EqmMeshGetVertexInput(EqmMesh mesh, const PetscInt **input);

/* EqmMeshCreate - the distributed mesh of a soup: partition, numbering, one layer of ghosts, boundary, measures.

   Collective. soup - must have passed EqmSoupDiagnose for a target (manifold, oriented or, for solids, any signs of
   volume); it may be destroyed afterwards. ledger - counts the work and must outlive the mesh. mesh - to be freed with
   EqmMeshDestroy. Option: -partition auto|metis|curve|slab|ptscotch. Errors: EQM_ERR_USAGE where METIS is asked
   for and the graph is too large for one rank. */
PETSC_EXTERN PetscErrorCode EqmMeshCreate(EqmSoup soup, EqmLedger ledger, EqmMesh *mesh);
/* EqmMeshHelpOptions - list the options of EqmMeshCreate, with help, for -help.

   Collective, between PetscOptionsBegin and PetscOptionsEnd, whose PetscOptionsObject it takes. */
PETSC_EXTERN PetscErrorCode EqmMeshHelpOptions(PetscOptionItems *PetscOptionsObject);
/* EqmMeshDestroy - free a mesh. Collective; NULL is fine. */
PETSC_EXTERN PetscErrorCode EqmMeshDestroy(EqmMesh *mesh);
/* EqmMeshUpdateGhosts - set the entries of the ghosts to those of their owners.

   Collective. array - `width` reals per local vertex. */
PETSC_EXTERN PetscErrorCode EqmMeshUpdateGhosts(EqmMesh mesh, PetscInt width, PetscReal *array);
/* EqmMeshVertexWeights - lumped weights: to each vertex an equal share of the weights of the cells around it.

   Not collective. weights - per owned vertex; they add up to one over all ranks. */
PETSC_EXTERN PetscErrorCode EqmMeshVertexWeights(EqmMesh mesh, PetscReal *weights);
/* EqmMeshBoundaryLoop - the order of the vertices of a disk-type surface along its one boundary loop.

   Collective; the edges of the loop are gathered on rank 0 for this. place - per local vertex: its position in the
   loop, from 0, in the direction that has the surface on its left; -1 inside. arc_length - per local vertex: length of
   the boundary from there, as a share of the whole, in [0, 1); -1 inside. The loop begins with the boundary edge that
   the file has first. Errors: EQM_ERR_MESH (the boundary is not one loop). */
PETSC_EXTERN PetscErrorCode EqmMeshBoundaryLoop(EqmMesh mesh, PetscInt *place, PetscReal *arc_length);
/* EqmMeshVerticesToInput - from the mesh's owned vertices to the slabs of the soup's numbering.

   Collective. owned - `width` reals per owned vertex; slab - `width` reals per vertex of this rank's slab; entries of
   vertices that no cell uses keep their values. */
PETSC_EXTERN PetscErrorCode EqmMeshVerticesToInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *owned,
                                                   PetscReal *slab);
/* EqmMeshCellsToInput - from the mesh's owned cells to the slabs of the soup's numbering.

   Collective. owned - `width` reals per owned cell; slab - `width` reals per cell of this rank's slab. */
PETSC_EXTERN PetscErrorCode EqmMeshCellsToInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *owned,
                                                PetscReal *slab);
/* EqmMeshVerticesFromInput - from the slabs of the soup to all local vertices, ghosts included.

   Collective. slab - `width` reals per vertex of this rank's slab; local - `width` reals per local vertex. */
PETSC_EXTERN PetscErrorCode EqmMeshVerticesFromInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *slab,
                                                     PetscReal *local);
/* EqmMeshFindVertices - local numbers of vertices given by their input numbers.

   Not collective. local - per entry of `input` the local number if this rank owns that vertex, else -1. */
PETSC_EXTERN PetscErrorCode EqmMeshFindVertices(EqmMesh mesh, PetscInt num, const PetscInt *input, PetscInt *local);

/* The closed surface around a solid, as a mesh of its own: its vertices are the solid's boundary vertices in input
   order, its triangles look outward. */
typedef struct _p_EqmSurface *EqmSurface;
/* Its soup, the same for any number of ranks, which belongs to the surface. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSurfaceGetSoup(EqmSurface surface, EqmSoup *soup);

/* EqmSurfaceCreate - the surface of a solid as a mesh of its own.

   Collective. solid - a mesh of tetrahedra. The surface's vertices are the solid's boundary vertices in input order,
   its triangles look outward; both are the same for any number of ranks and dealt in contiguous slabs. surface - to be
   freed with EqmSurfaceDestroy. Errors: EQM_ERR_USAGE (a mesh of triangles). */
PETSC_EXTERN PetscErrorCode EqmSurfaceCreate(EqmMesh solid, EqmSurface *surface);
/* EqmSurfaceDestroy - free a surface. Collective; NULL is fine. */
PETSC_EXTERN PetscErrorCode EqmSurfaceDestroy(EqmSurface *surface);
/* EqmSurfaceToSolid - carry values from the surface's vertices to the solid's boundary vertices, ghosts included.

   Collective. slab - `width` reals per vertex of the slab of surface->soup; local - `width` reals per local vertex of
   the solid; entries of interior vertices keep their values. */
PETSC_EXTERN PetscErrorCode EqmSurfaceToSolid(EqmSurface surface, PetscInt width, const PetscReal *slab,
                                              PetscReal *local);
/* EqmSurfaceFromSolid - carry values from the solid's boundary vertices to the surface's.

   Collective. local - `width` reals per local vertex of the solid, ghosts up to date; slab - `width` reals per vertex
   of the slab of surface->soup. */
PETSC_EXTERN PetscErrorCode EqmSurfaceFromSolid(EqmSurface surface, PetscInt width, const PetscReal *local,
                                                PetscReal *slab);

/* The double covering of a surface with a boundary, as a mesh of its own: the surface and its mirror image, glued along
   the boundary. */
typedef struct _p_EqmDouble *EqmDouble;
/* Its soup, closed, the same for any number of ranks, which belongs to the covering. Not collective. */
PETSC_EXTERN PetscErrorCode EqmDoubleGetSoup(EqmDouble covering, EqmSoup *soup);

/* EqmDoubleCreate - the double covering of a surface (004 section 2.2).

   Collective. surface - a mesh of triangles with a boundary. The covering's vertices are the surface's in input order,
   then the mirror images of the interior ones; its triangles are the surface's in input order, then their mirror
   images, turned over. Mirror images have the positions of the originals, so that lengths and angles are the same on
   both sides. An edge inside the surface that joins two boundary vertices appears twice. A density is not carried over.
   covering - to be freed with EqmDoubleDestroy. Errors: EQM_ERR_USAGE (a solid, a closed surface). */
PETSC_EXTERN PetscErrorCode EqmDoubleCreate(EqmMesh surface, EqmDouble *covering);
/* EqmDoubleDestroy - free a double covering. Collective; NULL is fine. */
PETSC_EXTERN PetscErrorCode EqmDoubleDestroy(EqmDouble *covering);
/* EqmDoubleFromHalves - set values of the covering from values of the surface and of its mirror image.

   Collective. original, twin - `width` reals per owned vertex of the surface; slab - `width` reals per vertex of the
   slab of covering->soup; boundary vertices, which both halves share, get `original`. */
PETSC_EXTERN PetscErrorCode EqmDoubleFromHalves(EqmDouble covering, PetscInt width, const PetscReal *original,
                                                const PetscReal *twin, PetscReal *slab);
/* EqmDoubleToOriginal - values of the covering's original half at the surface's vertices.

   Collective. slab - `width` reals per vertex of the slab of covering->soup; owned - `width` reals per owned vertex of
   the surface. */
PETSC_EXTERN PetscErrorCode EqmDoubleToOriginal(EqmDouble covering, PetscInt width, const PetscReal *slab,
                                                PetscReal *owned);

#endif
