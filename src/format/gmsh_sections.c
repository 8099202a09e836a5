/* Header and sections of Gmsh's MSH format. */
#define _GNU_SOURCE
#include "gmsh.h"

#include <stdio.h>
#include <string.h>

static PetscErrorCode ParseFormat(EqmGmsh *gmsh)
{
  EqmInput *in = gmsh->in;
  PetscReal number;
  PetscInt64 binary, size;

  EqmSkipLine(in);
  if (!EqmReadReal(in, &number) || !EqmReadInteger(in, &binary) || !EqmReadInteger(in, &size)) {
    return EqmReject(in, EQM_ERR_IO, "a version, a file type and a data size are missing");
  }
  gmsh->version = number == 4.1 || number == 4.0 ? 4 : number >= 2 && number < 3 ? 2 : 0;
  gmsh->version_4_0 = number == 4.0 ? PETSC_TRUE : PETSC_FALSE;
  if (!gmsh->version)
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
static PetscErrorCode ParseNodes(EqmGmsh *gmsh, PetscBool parametric)
{
  if (gmsh->has_nodes) return EqmReject(gmsh->in, EQM_ERR_IO, "a second section $Nodes");
  gmsh->has_nodes = PETSC_TRUE;
  EqmSkipLine(gmsh->in);
  EqmTry(gmsh->version == 2 ? EqmGmshParseNodes2(gmsh, parametric) : EqmGmshParseNodes4(gmsh));
  return EqmGmshCloseNodes(gmsh);
}

static PetscErrorCode ParseElements(EqmGmsh *gmsh)
{
  if (!gmsh->has_nodes) return EqmReject(gmsh->in, EQM_ERR_IO, "the section $Elements comes before the section $Nodes");
  EqmSkipLine(gmsh->in);
  return gmsh->version == 2 ? EqmGmshParseElements2(gmsh) : EqmGmshParseElements4(gmsh);
}

PetscErrorCode EqmGmshParseSections(EqmGmsh *gmsh)
{
  EqmInput *in = gmsh->in;

  for (EqmSkipSpace(in, 0); in->cursor < in->end; EqmSkipSpace(in, 0)) {
    const char *word;
    size_t length = EqmReadWord(in, &word);

    if (*word != '$')
      return EqmRejectAt(in, word, EQM_ERR_IO, "a section must begin here, with a $: the file is damaged");
    if (EqmWordIs(word, length, "$MeshFormat")) {
      EqmTry(ParseFormat(gmsh));
    } else if (gmsh->version && EqmWordIs(word, length, "$Nodes")) {
      EqmTry(ParseNodes(gmsh, PETSC_FALSE));
    } else if (gmsh->version == 2 && EqmWordIs(word, length, "$ParametricNodes")) {
      EqmTry(ParseNodes(gmsh, PETSC_TRUE));
    } else if (gmsh->version && EqmWordIs(word, length, "$Elements")) {
      EqmTry(ParseElements(gmsh));
    } else if (gmsh->version && EqmWordIs(word, length, "$PhysicalNames")) {
      EqmTry(EqmGmshParseNames(gmsh));
    } else if (gmsh->version == 4 && EqmWordIs(word, length, "$Entities")) {
      EqmTry(EqmGmshParseEntities(gmsh));
    } else if (EqmWordIs(word, length, "$NodeData") || EqmWordIs(word, length, "$ElementData")) {
      EqmBuilderNoteLeft(&gmsh->builder, EqmWordIs(word, length, "$NodeData") ? "$NodeData" : "$ElementData");
    } else if (!gmsh->version && !EqmWordIs(word, length, "$Comments")) {
      return EqmRejectAt(in, word, EQM_ERR_IO, "a section before $MeshFormat");
    }
    EqmTry(SkipToEnd(in, word + 1, length - 1));
  }
  return 0;
}

void EqmGmshTakeNames(EqmGmsh *gmsh, EqmSerialMesh *mesh)
{
  mesh->metadata = gmsh->names[mesh->cell_size - 3];
  gmsh->names[mesh->cell_size - 3] = NULL;
}

PetscErrorCode EqmGmshReset(EqmGmsh *gmsh)
{
  EqmTry(EqmTagMapReset(&gmsh->tags));
  EqmTry(PetscFree(gmsh->entities));
  EqmTry(PetscFree(gmsh->named));
  EqmTry(PetscFree(gmsh->names[0]));
  return PetscFree(gmsh->names[1]);
}
