/* Handles of a surface: a short loop around one. */
#ifndef EQM_HANDLES_H
#define EQM_HANDLES_H

#include <equimap/soup.h>

/* The search holds a whole mesh on one rank: only for so many cells, some hundred megabytes. */
enum { EQM_MOST_CELLS_FOR_HANDLES = 4000000 };

/* EqmHandleFind - a short loop of edges that does not separate the surface: tree-cotree decompositions (Eppstein 2003;
   Erickson and Whittlesey 2005) from a few roots, the shortest of their loops.

   Not collective. mesh - triangles; those that name a vertex twice or one that does not exist are ignored. loop -
   `length` vertices in order, PetscMalloc'ed; length is 0 where there is no handle or the surface is not a manifold. */
PETSC_INTERN PetscErrorCode EqmHandleFind(const EqmSerialMesh *mesh, PetscInt *length, PetscInt **loop);

/* EqmDiagnosisPlaceHandle - add to the diagnosis of a surface with handles where one is: in `where` of the finding
   EQM_FINDING_GENUS a short loop, four vertices an entry, as far as there is room.

   Collective. Nothing is added for a surface of more than EQM_MOST_CELLS_FOR_HANDLES cells. */
PETSC_INTERN PetscErrorCode EqmDiagnosisPlaceHandle(EqmSoup soup, EqmDiagnosis *diagnosis);

#endif
