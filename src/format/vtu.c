/* VTK's XML files of unstructured grids (.vtu) and surfaces (.vtp). */
#define _GNU_SOURCE
#include "writers.h"
#include "vtu.h"

#include <stdlib.h>
#include <string.h>

/* An element VTKFile near the beginning. Not collective. */
static PetscBool RecogniseVtu(const char *bytes, size_t length)
{
  return memmem(bytes, PetscMin(length, 4096), "<VTKFile", 8) ? PETSC_TRUE : PETSC_FALSE;
}

/* Appended raw data is not XML: the document is what stands before it, with the open elements closed. */
static PetscErrorCode CutAppended(EqmVtuEncoding *encoding, char **document, size_t *length)
{
  static const char tail[] = "</AppendedData></VTKFile>";
  EqmInput *in = encoding->in;
  const char *tag = memmem(in->start, (size_t)(in->end - in->start), "<AppendedData", 13);
  const char *close = tag ? memchr(tag, '>', (size_t)(in->end - tag)) : NULL;
  const char *underscore = close ? memchr(close, '_', (size_t)(in->end - close)) : NULL;

  *document = NULL;
  *length = (size_t)(in->end - in->start);
  if (!tag) return 0;
  if (!underscore) return EqmRejectAt(in, tag, EQM_ERR_IO, "no data in AppendedData: the file is truncated");
  encoding->appended = underscore + 1;
  encoding->appended_length = (size_t)(in->end - underscore) - 1;
  *length = (size_t)(close + 1 - in->start);
  *document = malloc(*length + sizeof(tail));
  if (!*document) return PETSC_ERR_MEM;
  memcpy(*document, in->start, *length);
  memcpy(*document + *length, tail, sizeof(tail));
  *length += sizeof(tail) - 1;
  return 0;
}

static PetscErrorCode ParseMesh(EqmVtuEncoding *encoding, EqmBuilder *builder)
{
  xmlDocPtr document;
  char *copy;
  size_t length;
  PetscErrorCode code;

  EqmTry(CutAppended(encoding, &copy, &length));
  code = EqmXmlParse(encoding->in, copy ? copy : encoding->in->start, length, &document);
  if (!code) code = EqmVtuParseDocument(encoding, builder, xmlDocGetRootElement(document));
  if (document) xmlFreeDoc(document);
  free(copy);
  return code;
}

/* Read a VTU or VTP file. See EqmParser. */
static PetscErrorCode ParseVtu(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  EqmInput in;
  EqmBuilder builder;
  EqmVtuEncoding encoding = {.in = &in, .file_bytes = length};

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmBuilderOpen(&builder, &in);
  return EqmBuilderFinish(&builder, ParseMesh(&encoding, &builder), mesh);
}

EQM_DEFINE_FORMAT(Vtu) = {.name = "VTU",
                          .suffixes = "vtu",
                          .recognise = RecogniseVtu,
                          .parse = ParseVtu,
                          .parse_part = EqmVtuParsePart,
                          .write_stream = EqmWriteVtu,
                          .vertex_fields = PETSC_TRUE,
                          .cell_fields = PETSC_TRUE};

EQM_DEFINE_FORMAT(Vtp) = {
    .name = "VTP", .suffixes = "vtp", .recognise = RecogniseVtu, .parse = ParseVtu, .parse_part = EqmVtuParsePart};
