/* Mesh formats in one list. A new format is one file, with a parser, a writer or both and a row that names them
   (EQM_DEFINE_FORMAT), and one line in formats.h. */
#ifndef EQM_FORMAT_H
#define EQM_FORMAT_H

#include <equimap/soup.h>
#include "base/atomicfile.h"
#include "part.h"

/* Numbers that belong to the vertices or to the cells of a mesh. Formats that cannot hold them leave them out. */
typedef struct {
  const char *name;
  PetscBool on_cells;
  PetscInt width;          /* numbers per vertex or cell */
  const PetscReal *values; /* width * num_vertices or num_cells */
} EqmField;

/* A parser: bytes of a file to a mesh. For one rank; fails quietly, with a sentence in `error`; nothing to free after a
   failure. Whatever the bytes are, it returns. */
typedef PetscErrorCode (*EqmParser)(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error,
                                    size_t error_length);
/* A parser on every rank, of a part of the file each: consecutive vertices and cells, in rank order, that name vertices
   by their numbers in the whole file; fields, names and metadata are the same on every rank. `understood` is false on
   every rank if the file is not as it should be on one, or not in a form that can be read in parts: the parser of the
   whole file then reads it, or says what is wrong. Collective. */
typedef PetscErrorCode (*EqmPartParser)(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood);
/* A writer into an open file. For one rank. Failures of the file are remembered by the file itself; what the format
   cannot hold is an EQM_ERR_USAGE, quietly, with a sentence in `error`. */
typedef PetscErrorCode (*EqmWriter)(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                    PetscInt num_fields, char *error, size_t error_length);
struct EqmMeshStream;
/* The same of a mesh that it takes row by row (stream.h), wherever the rows are. */
typedef PetscErrorCode (*EqmStreamWriter)(EqmAtomicFile *file, struct EqmMeshStream *stream, char *error,
                                          size_t error_length);
/* Reader and writer of a format that all ranks read and write together. Collective. */
typedef PetscErrorCode (*EqmParallelReader)(MPI_Comm comm, const char *file, EqmSoup *soup);
typedef PetscErrorCode (*EqmParallelWriter)(EqmSoup soup, const char *file);
/* For a mesh that lies in several files: replaces the bytes of the named one by those of all, as the parser wants them.
   For one rank; fails quietly, with a sentence in `error`. */
typedef PetscErrorCode (*EqmLoader)(const char *file, char **bytes, size_t *length, char *error, size_t error_length);

typedef struct {
  const char *name;
  const char *suffixes;                                     /* separated by blanks */
  PetscBool (*recognise)(const char *bytes, size_t length); /* by the file's first bytes; NULL: by suffix alone */
  PetscBool by_length;                                      /* `recognise` wants to know the length of the whole file */
  EqmParser parse;                                          /* NULL: cannot be read by one rank */
  EqmPartParser parse_part;                                 /* used on several ranks; NULL: one parses all */
  EqmWriter write;                                          /* NULL: cannot be written by one rank */
  EqmStreamWriter write_stream;                             /* used instead of `write` where it is there */
  EqmParallelReader read_parallel;                          /* used instead of `parse` where it is there */
  EqmParallelWriter write_parallel;                         /* used instead of `write` where it is there */
  EqmLoader load;                                           /* NULL: a mesh is one file */
  PetscBool writes_corners;                                 /* the writer wants the points of cells' corners */
  PetscBool writes_texture;                                 /* mesh->texture is written */
  PetscBool vertex_fields, cell_fields;                     /* which fields are written */
  PetscBool groups;                                         /* of cell fields the field "group" is written */
} EqmFormat;

/* A row of the list of formats, in the order of recognition; NULL outside the list. Not collective. */
PETSC_INTERN const EqmFormat *EqmFormatAt(int row);
/* The row that the bytes of a file, or the suffix of its name, identify; -1: none. Not collective. */
PETSC_INTERN int EqmFormatRowOfContent(const char *bytes, size_t length);
PETSC_INTERN int EqmFormatRowOfSuffix(const char *file);
/* The same as a format, or NULL. Not collective. */
PETSC_INTERN const EqmFormat *EqmFormatOfContent(const char *bytes, size_t length);
PETSC_INTERN const EqmFormat *EqmFormatOfSuffix(const char *file);
/* ".ply .vtu ..." of the formats that can be written (or read), for messages. Not collective. */
PETSC_INTERN void EqmFormatListSuffixes(PetscBool writable, char *text, size_t length);
/* Read and parse a file on this rank, unless all ranks must read its format; see read.c. Not collective. */
PETSC_INTERN PetscErrorCode EqmFormatReadOnRank(const char *file, int *row, EqmSerialMesh *mesh, char *error,
                                                size_t error_length);
/* Write a mesh and its fields from this rank, the format by suffix; see write.c. Not collective. */
PETSC_INTERN PetscErrorCode EqmFormatWriteSerial(const char *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                                 PetscInt num_fields, char *error, size_t length);
/* EqmFormatWriteSlabs - write a mesh from all ranks: the cells and fields of a soup, with these vertices, 3 per vertex
   of its slab, and first of all these fields, of which values are those of the slab; see write.c. Collective. is_map -
   it is the map that is written: fields of the soup that a result has itself, and a texture where it would be taken for
   the map, are left out. Errors: EQM_ERR_USAGE, EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmFormatWriteSlabs(EqmSoup soup, const PetscReal *vertices, const EqmField *fields,
                                                PetscInt num_fields, PetscBool is_map, const char *file);
/* Can files of the format be written? Not collective. */
PETSC_INTERN PetscBool EqmFormatIsWritable(const EqmFormat *format);
/* EqmFormatDescribeDropped - which of a soup's fields a file of this name will not hold: their names, separated by
   commas; "" if it holds them all. is_map - it is the map that is written. Not collective. */
PETSC_INTERN void EqmFormatDescribeDropped(const char *file, PetscBool is_map, PetscInt num_fields,
                                           const EqmMeshField *fields, char *text, size_t length);
/* The field "polygon" or "group" on cells among the fields of a writer, or NULL. Not collective. */
PETSC_INTERN const EqmField *EqmFieldPolygon(const EqmField *fields, PetscInt num_fields);
PETSC_INTERN const EqmField *EqmFieldGroup(const EqmField *fields, PetscInt num_fields);
/* The number of a group as an int; 0 where it is no such number. Not collective. */
PETSC_INTERN int EqmGroupOf(PetscReal number);
/* Refuse what a format cannot hold: more than 2^31 rows; tetrahedra. EQM_ERR_USAGE (quiet). Not collective. */
PETSC_INTERN PetscErrorCode EqmRequireSmall(const EqmSerialMesh *mesh, const char *format, char *error, size_t length);
PETSC_INTERN PetscErrorCode EqmRequireTriangles(const EqmSerialMesh *mesh, const char *format, char *error,
                                                size_t length);
/* Read a file into memory on this rank; see load.c. Not collective. */
PETSC_INTERN PetscErrorCode EqmFormatLoadBytes(const char *file, char **bytes, size_t *length, char *error,
                                               size_t error_length);

/* Begin the definition of a format's row: EQM_DEFINE_FORMAT(Obj) = {.name = "OBJ", ...}; */
#define EQM_DEFINE_FORMAT(id)                                                                                          \
  PETSC_INTERN const EqmFormat EqmFormat##id;                                                                          \
  const EqmFormat EqmFormat##id

#endif
