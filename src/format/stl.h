/* STL files, whole or in parts. */
#ifndef EQM_FORMAT_STL_H
#define EQM_FORMAT_STL_H

#include "builder.h"
#include "part.h"

enum { EQM_STL_HEADER = 80, EQM_STL_TRIANGLE = 50 }; /* bytes; the number of triangles is behind the header */

/* EqmStlIsBinary - does the length of a file with these first bytes fit a binary one? Not collective. */
PETSC_INTERN PetscBool EqmStlIsBinary(const char *bytes, size_t length);
PETSC_INTERN PetscBool EqmStlIsAscii(const char *bytes, size_t length);
/* EqmStlParseTriangles, EqmStlParseFacets - three vertices per triangle, from bytes or from lines. Not collective.
   open_solids - how many solids more begin than end. Errors: EQM_ERR_IO (quiet). */
PETSC_INTERN PetscErrorCode EqmStlParseTriangles(const char *bytes, size_t num_triangles, EqmBuilder *builder);
PETSC_INTERN PetscErrorCode EqmStlParseFacets(EqmInput *in, EqmBuilder *builder, PetscInt64 *open_solids);
/* EqmStlParsePart - see EqmPartParser. */
PETSC_INTERN PetscErrorCode EqmStlParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood);

#endif
