/* Gmsh's MSH, versions 2.2, 4.0 and 4.1, ASCII and binary: header, sections, and what both versions share. All nodes
   are kept, in file order; tetrahedra are the cells if there are any, otherwise triangles. */
#define _GNU_SOURCE
#include "gmsh.h"
#include "writers.h"

#include <stdio.h>
#include <string.h>

/* A section $MeshFormat (or $Comments before it). Not collective. */
static PetscBool RecogniseGmsh(const char *bytes, size_t length)
{
  EqmInput in;
  char unused[8];

  EqmInputOpen(&in, bytes, length, unused, sizeof(unused));
  EqmSkipSpace(&in, 0);
  return EqmReadKeyword(&in, "$MeshFormat") || EqmReadKeyword(&in, "$Comments") ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode ParseFormat(EqmGmsh *gmsh, PetscInt *version)
{
  EqmInput *in = gmsh->in;
  PetscReal number;
  PetscInt64 binary, size;

  EqmSkipLine(in);
  if (!EqmReadReal(in, &number) || !EqmReadInteger(in, &binary) || !EqmReadInteger(in, &size)) {
    return EqmReject(in, EQM_ERR_IO, "a version, a file type and a data size are missing");
  }
  *version = number == 4.1 || number == 4.0 ? 4 : number >= 2 && number < 3 ? 2 : 0;
  gmsh->version_4_0 = number == 4.0 ? PETSC_TRUE : PETSC_FALSE;
  if (!*version)
    return EqmReject(in, EQM_ERR_IO, "MSH version %g is not supported; save as 4.1 or 2.2", (double)number);
  if (size != 8) return EqmReject(in, EQM_ERR_IO, "a data size of %lld is not supported; 8 is", (long long)size);
  gmsh->ascii = binary ? PETSC_FALSE : PETSC_TRUE;
  EqmSkipLine(in);
  if (binary) { /* the number 1 shows the byte order */
    const char *one;

    in->binary = PETSC_TRUE;
    EqmTry(EqmTakeBytes(in, 4, "byte order", &one));
    gmsh->big_endian = EqmLoadInteger(one, EQM_SCALAR_INT32, PETSC_TRUE) == 1 ? PETSC_TRUE : PETSC_FALSE;
    if (!gmsh->big_endian && EqmLoadInteger(one, EQM_SCALAR_INT32, PETSC_FALSE) != 1) {
      return EqmReject(in, EQM_ERR_IO, "the byte order mark is damaged");
    }
  }
  return 0;
}

/* Move behind the line $EndNAME that closes a section. */
static PetscErrorCode SkipToEnd(EqmInput *in, const char *name, size_t length)
{
  char closing[96];
  const char *found;

  snprintf(closing, sizeof(closing), "$End%.*s", (int)PetscMin(length, sizeof(closing) - 5), name);
  found = memmem(in->cursor, EqmRemaining(in), closing, strlen(closing));
  if (!found) return EqmReject(in, EQM_ERR_IO, "%s is missing: the file is truncated", closing);
  in->cursor = found;
  EqmSkipLine(in);
  return 0;
}

/* Programs that keep the parameters of nodes on curves and surfaces write $ParametricNodes for $Nodes. */
static PetscErrorCode ParseNodes(EqmGmsh *gmsh, PetscInt version, PetscBool parametric)
{
  if (gmsh->has_nodes) return EqmReject(gmsh->in, EQM_ERR_IO, "a second section $Nodes");
  gmsh->has_nodes = PETSC_TRUE;
  EqmSkipLine(gmsh->in);
  EqmTry(version == 2 ? EqmGmshParseNodes2(gmsh, parametric) : EqmGmshParseNodes4(gmsh));
  return EqmGmshCloseNodes(gmsh);
}

static PetscErrorCode ParseElements(EqmGmsh *gmsh, PetscInt version)
{
  if (!gmsh->has_nodes) return EqmReject(gmsh->in, EQM_ERR_IO, "the section $Elements comes before the section $Nodes");
  EqmSkipLine(gmsh->in);
  return version == 2 ? EqmGmshParseElements2(gmsh) : EqmGmshParseElements4(gmsh);
}

static PetscErrorCode ParseSections(EqmGmsh *gmsh)
{
  EqmInput *in = gmsh->in;
  PetscInt version = 0;

  for (EqmSkipSpace(in, 0); in->cursor < in->end; EqmSkipSpace(in, 0)) {
    const char *word;
    size_t length = EqmReadWord(in, &word);

    if (*word != '$')
      return EqmRejectAt(in, word, EQM_ERR_IO, "a section must begin here, with a $: the file is damaged");
    if (EqmWordIs(word, length, "$MeshFormat")) {
      EqmTry(ParseFormat(gmsh, &version));
    } else if (version && EqmWordIs(word, length, "$Nodes")) {
      EqmTry(ParseNodes(gmsh, version, PETSC_FALSE));
    } else if (version == 2 && EqmWordIs(word, length, "$ParametricNodes")) {
      EqmTry(ParseNodes(gmsh, version, PETSC_TRUE));
    } else if (version && EqmWordIs(word, length, "$Elements")) {
      EqmTry(ParseElements(gmsh, version));
    } else if (version && EqmWordIs(word, length, "$PhysicalNames")) {
      EqmTry(EqmGmshParseNames(gmsh));
    } else if (version == 4 && EqmWordIs(word, length, "$Entities")) {
      EqmTry(EqmGmshParseEntities(gmsh));
    } else if (EqmWordIs(word, length, "$NodeData") || EqmWordIs(word, length, "$ElementData")) {
      EqmBuilderNoteLeft(&gmsh->builder, EqmWordIs(word, length, "$NodeData") ? "$NodeData" : "$ElementData");
    } else if (!version && !EqmWordIs(word, length, "$Comments")) {
      return EqmRejectAt(in, word, EQM_ERR_IO, "a section before $MeshFormat");
    }
    EqmTry(SkipToEnd(in, word + 1, length - 1));
  }
  if (gmsh->has_nodes) return 0;
  return EqmReject(in, EQM_ERR_IO, "the file has no section $Nodes: it is truncated or not a mesh");
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
  code = ParseSections(&gmsh);
  EqmTry(EqmTagMapReset(&gmsh.tags));
  EqmTry(PetscFree(gmsh.entities));
  code = EqmBuilderFinish(&gmsh.builder, code, mesh);
  if (!code) {
    mesh->metadata = gmsh.names[mesh->cell_size - 3];
    gmsh.names[mesh->cell_size - 3] = NULL;
  }
  EqmTry(PetscFree(gmsh.names[0]));
  EqmTry(PetscFree(gmsh.names[1]));
  return code;
}

EQM_DEFINE_FORMAT(Gmsh) = {.name = "Gmsh MSH",
                           .suffixes = "msh",
                           .recognise = RecogniseGmsh,
                           .parse = ParseGmsh,
                           .write = EqmWriteGmsh,
                           .vertex_fields = PETSC_TRUE,
                           .cell_fields = PETSC_TRUE,
                           .groups = PETSC_TRUE};
