/* EqmSoupWrite, and the one-rank writer below it. */
#include "format.h"
#include "mesh/soup_private.h"
#include "mesh/fields.h"
#include "input.h"
#include "stream.h"
#include "base/nearest.h"

#include <stdio.h>
#include <string.h>

static PetscErrorCode RejectSuffix(const char *file, char *error, size_t length)
{
  const char *const suffix = strrchr(file, '.');
  char suffixes[256], hint[64];

  EqmFormatListSuffixes(PETSC_TRUE, suffixes, sizeof(suffixes));
  PetscCall(EqmDidYouMean(suffix ? suffix : "", suffixes, hint, sizeof(hint)));
  snprintf(error, length, "%s: no mesh format with this suffix can be written; choose one of %s%s", file, suffixes,
           hint);
  return EQM_ERR_USAGE;
}

/* Is there a field of that name among those of the writer? They go before the mesh's own. */
static PetscBool IsTaken(const EqmMeshField *field, const EqmField *fields, PetscInt num_fields)
{
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (fields[f].on_cells == field->on_cells && !strcmp(fields[f].name, field->name)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* The given fields, those of the mesh, and texture coordinates as a field where the format has no place for them. */
static PetscErrorCode JoinFields(const EqmFormat *format, const EqmSerialMesh *mesh, const EqmField *fields,
                                 PetscInt num_fields, EqmField **all, PetscInt *num_all)
{
  EqmTry(PetscMalloc1(num_fields + mesh->num_fields + 1, all));
  *num_all = 0;
  for (PetscInt f = 0; f < num_fields; ++f) (*all)[(*num_all)++] = fields[f];
  for (PetscInt f = 0; f < mesh->num_fields; ++f) {
    const EqmMeshField *const field = &mesh->fields[f];

    if (!IsTaken(field, fields, num_fields))
      (*all)[(*num_all)++] = (EqmField){field->name, field->on_cells, field->width, field->values};
  }
  if (mesh->texture && !format->writes_texture)
    (*all)[(*num_all)++] = (EqmField){EQM_FIELD_TEXTURE, PETSC_TRUE, 2 * mesh->cell_size, mesh->texture};
  return 0;
}

/* On rank 0: the whole file, or nothing. A writer that does not take rows one by one gets a mesh that one rank has. */
static PetscErrorCode WriteFile(const char *file, const EqmFormat *format, EqmMeshStream *stream, char *error,
                                size_t length)
{
  EqmAtomicFile out;
  char reason[256] = "";
  PetscErrorCode code = EqmAtomicOpen(file, &out, error, length);

  if (code) return code;
  code = format->write_stream
             ? format->write_stream(&out, stream, reason, sizeof(reason))
             : format->write(&out, &stream->mesh, stream->fields, stream->num_fields, reason, sizeof(reason));
  if (!code) return EqmAtomicCommit(&out, error, length);
  snprintf(error, length, "cannot write %s: %s", file, reason);
  EqmAtomicAbort(&out);
  return code;
}

/* EqmFormatWriteSerial - write a mesh, the fields given and its own, the format by suffix, from this rank.

   Not collective. The file is there complete or not at all. Errors (quiet, reason in `error`): EQM_ERR_USAGE (unknown
   suffix, a format that all ranks must write, tetrahedra in a surface format), EQM_ERR_IO. */
PetscErrorCode EqmFormatWriteSerial(const char *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                    PetscInt num_fields, char *error, size_t length)
{
  const EqmFormat *format = EqmFormatOfSuffix(file);
  EqmMeshStream stream;
  EqmField *all;
  PetscInt num_all;
  PetscErrorCode code;

  if (!format || !(format->write || format->write_stream)) return RejectSuffix(file, error, length);
  EqmTry(JoinFields(format, mesh, fields, num_fields, &all, &num_all));
  EqmTry(EqmStreamOpenWhole(&stream, mesh, format->writes_texture, all, num_all));
  code = WriteFile(file, format, &stream, error, length);
  EqmTry(EqmStreamReset(&stream));
  EqmTry(PetscFree(all));
  return code;
}

static PetscBool Holds(const EqmFormat *format, PetscBool is_map, const EqmMeshField *field)
{
  if (is_map && EqmMeshFieldIsOfResult(field->name)) return PETSC_TRUE; /* there is a newer one */
  if (format->write_parallel) return PETSC_TRUE;                        /* HDF5 */
  if (!strcmp(field->name, EQM_FIELD_TEXTURE) && field->on_cells && format->writes_texture)
    return is_map ? PETSC_FALSE : PETSC_TRUE;
  if (!strcmp(field->name, EQM_FIELD_POLYGON) && field->on_cells) return PETSC_TRUE; /* the reader's, not the file's */
  if (!strcmp(field->name, EQM_FIELD_GROUP) && field->on_cells && format->groups) return PETSC_TRUE;
  return field->on_cells ? format->cell_fields : format->vertex_fields;
}

void EqmFormatDescribeDropped(const char *file, PetscBool is_map, PetscInt num_fields, const EqmMeshField *fields,
                              char *text, size_t length)
{
  const EqmFormat *const format = EqmFormatOfSuffix(file);
  size_t used = 0;

  text[0] = '\0';
  for (PetscInt f = 0; f < num_fields && format && used < length; ++f) {
    if (!Holds(format, is_map, &fields[f]))
      used += (size_t)snprintf(text + used, length - used, "%s%s", used ? ", " : "", fields[f].name);
  }
}

/* Gather on rank 0 and write there. */
static PetscErrorCode WriteFromRoot(EqmMeshStream *stream, const char *file)
{
  EqmSerialMesh mesh;
  char error[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;

  PetscFunctionBegin;
  PetscCall(EqmStreamGather(stream, &mesh));
  PetscCall(EqmMeshFieldsGiveTexture(&mesh));
  if (stream->rank == 0) code = EqmFormatWriteSerial(file, &mesh, NULL, 0, error, sizeof(error));
  PetscCall(EqmSerialMeshReset(&mesh));
  PetscCall(EqmAgree(stream->comm, code, error));
  PetscFunctionReturn(0);
}

/* Rank 0 writes the rows that the others send. */
static PetscErrorCode WriteRows(EqmMeshStream *stream, const EqmFormat *format, const char *file)
{
  char error[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;

  PetscFunctionBegin;
  if (stream->rank) {
    PetscCall(EqmStreamServe(stream));
  } else {
    code = WriteFile(file, format, stream, error, sizeof(error));
    PetscCall(EqmStreamEnd(stream));
  }
  PetscCall(EqmAgree(stream->comm, code, error));
  PetscFunctionReturn(0);
}

/* Texture coordinates of the corners? */
static PetscBool IsTexture(const char *name, PetscBool on_cells, PetscInt width, PetscInt cell_size)
{
  return on_cells && width == 2 * cell_size && !strcmp(name, EQM_FIELD_TEXTURE) ? PETSC_TRUE : PETSC_FALSE;
}

/* Is it left out of a map's file, as the map's own or as what would be taken for it? */
static PetscBool IsLeftOut(const EqmFormat *format, const EqmMeshField *field, PetscBool is_texture)
{
  return EqmMeshFieldIsOfResult(field->name) || (is_texture && format->writes_texture) ? PETSC_TRUE : PETSC_FALSE;
}

/* The given fields, then the soup's, a texture last, or apart where the format has a place for it. */
static PetscErrorCode JoinSlabs(const EqmFormat *format, EqmSoup soup, const EqmField *fields, PetscInt num_fields,
                                PetscBool is_map, EqmField **all, PetscInt *num_all, const PetscReal **texture)
{
  EqmField last = {.name = NULL};

  PetscFunctionBegin;
  *texture = NULL;
  PetscCall(PetscMalloc1(num_fields + soup->num_fields + 1, all));
  *num_all = 0;
  for (PetscInt f = 0; f < num_fields + soup->num_fields; ++f) {
    const EqmMeshField *const own = f < num_fields ? NULL : &soup->fields[f - num_fields];
    const EqmField field = own ? (EqmField){own->name, own->on_cells, own->width, own->values} : fields[f];
    const PetscBool is_texture = IsTexture(field.name, field.on_cells, field.width, soup->cell_size);

    if (own && (IsTaken(own, fields, num_fields) || (is_map && IsLeftOut(format, own, is_texture)))) continue;
    if (is_texture)
      last = field;
    else
      (*all)[(*num_all)++] = field;
  }
  if (last.name && format->writes_texture)
    *texture = last.values;
  else if (last.name)
    (*all)[(*num_all)++] = last;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFormatWriteSlabs(EqmSoup soup, const PetscReal *vertices, const EqmField *fields, PetscInt num_fields,
                                   PetscBool is_map, const char *file)
{
  const EqmFormat *const format = EqmFormatOfSuffix(file);
  char error[EQM_MESSAGE_MAX] = "";
  const PetscReal *texture;
  EqmMeshStream stream;
  EqmField *all;
  PetscInt num_all;
  PetscBool with_corners;

  PetscFunctionBegin;
  if (!format || !(format->write || format->write_stream))
    PetscCall(EqmAgree(soup->comm, RejectSuffix(file, error, sizeof(error)), error));
  PetscCall(JoinSlabs(format, soup, fields, num_fields, is_map, &all, &num_all, &texture));
  with_corners = format->write_stream && format->writes_corners ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(EqmStreamOpen(&stream, soup, vertices, texture, all, num_all, with_corners));
  PetscCall(format->write_stream ? WriteRows(&stream, format, file) : WriteFromRoot(&stream, file));
  PetscCall(EqmStreamReset(&stream));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(0);
}

/* EqmSoupWrite - write a mesh, the format by suffix; it is there complete or not at all.

   Collective. Errors: EQM_ERR_USAGE (unknown suffix, tetrahedra in a surface format), EQM_ERR_IO. */
PetscErrorCode EqmSoupWrite(EqmSoup soup, const char *file)
{
  const EqmFormat *format = EqmFormatOfSuffix(file);

  PetscFunctionBegin;
  if (format && format->write_parallel) {
    PetscCall(format->write_parallel(soup, file));
  } else {
    PetscCall(EqmFormatWriteSlabs(soup, soup->vertices, NULL, 0, PETSC_FALSE, file));
  }
  PetscFunctionReturn(0);
}
