/* PLY: ASCII and binary of both byte orders, with any elements and properties beside the mesh. */
#include "builder.h"
#include "writers.h"
#include "ply.h"

#include <string.h>

/* The first line is "ply". Not collective. */
static PetscBool RecognisePly(const char *bytes, size_t length)
{
  return length >= 4 && !memcmp(bytes, "ply", 3) && EqmIsSpace(bytes[3]) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode ParseMesh(EqmInput *in, EqmPlyHeader *header, EqmBuilder *builder)
{
  EqmTry(EqmPlyParseHeader(in, header));
  in->binary = header->ascii ? PETSC_FALSE : PETSC_TRUE;
  for (PetscInt e = 0; e < header->num_elements; ++e) {
    EqmTry(EqmPlyParseRows(in, header, &header->element[e], builder));
  }
  return 0;
}

/* Read a PLY file. See EqmParser. */
static PetscErrorCode ParsePly(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  EqmInput in;
  EqmBuilder builder;
  EqmPlyHeader *header;
  PetscErrorCode code;

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmTry(PetscCalloc1(1, &header));
  EqmBuilderOpen(&builder, &in);
  code = ParseMesh(&in, header, &builder);
  EqmTry(PetscFree(header));
  return EqmBuilderFinish(&builder, code, mesh);
}

EQM_DEFINE_FORMAT(Ply) = {.name = "PLY",
                          .suffixes = "ply",
                          .recognise = RecognisePly,
                          .parse = ParsePly,
                          .parse_part = EqmPlyParsePart,
                          .write_stream = EqmWritePly,
                          .writes_texture = PETSC_TRUE,
                          .vertex_fields = PETSC_TRUE,
                          .cell_fields = PETSC_TRUE};
