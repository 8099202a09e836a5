/* Gmsh's MSH, versions 2.2, 4.0 and 4.1, ASCII and binary: header, sections, and what both versions share. All nodes
   are kept, in file order; tetrahedra are the cells if there are any, otherwise triangles. */
#include "gmsh.h"
#include "writers.h"

/* A section $MeshFormat (or $Comments before it). Not collective. */
static PetscBool RecogniseGmsh(const char *bytes, size_t length)
{
  EqmInput in;
  char unused[8];

  EqmInputOpen(&in, bytes, length, unused, sizeof(unused));
  EqmSkipSpace(&in, 0);
  return EqmReadKeyword(&in, "$MeshFormat") || EqmReadKeyword(&in, "$Comments") ? PETSC_TRUE : PETSC_FALSE;
}

/* Read an MSH file. See EqmParser. */
static PetscErrorCode ParseGmsh(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  EqmInput in;
  EqmGmsh gmsh = {0};
  PetscErrorCode code;

  EqmInputOpen(&in, bytes, length, error, error_length);
  gmsh.in = &in;
  EqmBuilderOpen(&gmsh.builder, &in);
  code = EqmGmshParseSections(&gmsh);
  if (!code && !gmsh.has_nodes)
    code = EqmReject(&in, EQM_ERR_IO, "the file has no section $Nodes: it is truncated or not a mesh");
  code = EqmBuilderFinish(&gmsh.builder, code, mesh);
  if (!code) EqmGmshTakeNames(&gmsh, mesh);
  EqmTry(EqmGmshReset(&gmsh));
  return code;
}

EQM_DEFINE_FORMAT(Gmsh) = {.name = "Gmsh MSH",
                           .suffixes = "msh",
                           .recognise = RecogniseGmsh,
                           .parse = ParseGmsh,
                           .parse_part = EqmGmshParsePart,
                           .write_stream = EqmWriteGmsh,
                           .vertex_fields = PETSC_TRUE,
                           .cell_fields = PETSC_TRUE,
                           .groups = PETSC_TRUE};
