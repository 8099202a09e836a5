/* Nodes and elements of MSH 2.2. */
#include "gmsh.h"

/* EqmGmshParseNodes2 - the section $Nodes, or $ParametricNodes, of version 2.2. Not collective. Errors: EQM_ERR_IO
   (quiet). */
PetscErrorCode EqmGmshParseNodes2(EqmGmsh *gmsh, PetscBool parametric)
{
  const size_t bytes_each = gmsh->ascii ? 8 : 28;
  PetscInt64 count;

  EqmSkipSpace(gmsh->in, 0);
  EqmTry(EqmReadCount(gmsh->in, "nodes", bytes_each, &count));
  EqmSkipLine(gmsh->in);
  return EqmGmshReadRows(gmsh, &(EqmGmshRun){.kind = EQM_GMSH_NODES, .parametric = parametric}, count);
}

/* A header and its elements of one type; `done` counts on. */
static PetscErrorCode ParseBinaryElements(EqmGmsh *gmsh, PetscInt64 *done)
{
  EqmGmshRun run = {.kind = EQM_GMSH_ELEMENTS};
  PetscInt unused;

  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the type of elements", &run.type));
  EqmTry(EqmGmshNodesOfType(gmsh, run.type, &unused));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_INT32, "the number of elements", 8, &run.count));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_INT32, "the number of tags", 4, &run.num_tags));
  if (!run.count) return EqmReject(gmsh->in, EQM_ERR_IO, "a block without elements: the file is damaged");
  *done += run.count;
  return EqmGmshReadRows(gmsh, &run, run.count);
}

/* EqmGmshParseElements2 - the section $Elements of version 2.2. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGmshParseElements2(EqmGmsh *gmsh)
{
  PetscInt64 count, done = 0;

  EqmSkipSpace(gmsh->in, 0);
  EqmTry(EqmReadCount(gmsh->in, "elements", 8, &count));
  EqmSkipLine(gmsh->in);
  if (gmsh->ascii) return EqmGmshReadRows(gmsh, &(EqmGmshRun){.kind = EQM_GMSH_ELEMENTS}, count);
  while (done < count) EqmTry(ParseBinaryElements(gmsh, &done));
  return 0;
}
