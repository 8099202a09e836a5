/* Mesh formats behind one table. A new format is one file with a parser, a writer or both, a line below and a row in
   format.c. */
#ifndef EQM_FORMAT_H
#define EQM_FORMAT_H

#include <equimap/soup.h>
#include "base/atomicfile.h"

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
/* A writer into an open file. For one rank. Failures of the file are remembered by the file itself; what the format
   cannot hold is an EQM_ERR_USAGE, quietly, with a sentence in `error`. */
typedef PetscErrorCode (*EqmWriter)(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                    PetscInt num_fields, char *error, size_t error_length);
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
  EqmParser parse;                                          /* NULL: cannot be read by one rank */
  EqmWriter write;                                          /* NULL: cannot be written by one rank */
  EqmParallelReader read_parallel;                          /* used instead of `parse` where it is there */
  EqmParallelWriter write_parallel;                         /* used instead of `write` where it is there */
  EqmLoader load;                                           /* NULL: a mesh is one file */
} EqmFormat;

PETSC_INTERN const EqmFormat *EqmFormatAt(PetscInt row);
PETSC_INTERN const EqmFormat *EqmFormatOfContent(const char *bytes, size_t length);
PETSC_INTERN const EqmFormat *EqmFormatOfSuffix(const char *file);
PETSC_INTERN void EqmFormatListSuffixes(PetscBool writable, char *text, size_t length);
PETSC_INTERN PetscErrorCode EqmFormatWriteSerial(const char *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                                 PetscInt num_fields, char *error, size_t length);
PETSC_INTERN PetscErrorCode EqmRequireSmall(const EqmSerialMesh *mesh, const char *format, char *error, size_t length);
PETSC_INTERN PetscErrorCode EqmRequireTriangles(const EqmSerialMesh *mesh, const char *format, char *error,
                                                size_t length);
PETSC_INTERN PetscErrorCode EqmFormatLoadBytes(const char *file, char **bytes, size_t *length, char *error,
                                               size_t error_length);

#define EQM_DECLARE_PARSER(name)                                                                                       \
  PETSC_INTERN PetscBool EqmRecognise##name(const char *bytes, size_t length);                                         \
  PETSC_INTERN PetscErrorCode EqmParse##name(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error,       \
                                             size_t error_length)
#define EQM_DECLARE_WRITER(name)                                                                                       \
  PETSC_INTERN PetscErrorCode EqmWrite##name(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,   \
                                             PetscInt num_fields, char *error, size_t error_length)

EQM_DECLARE_PARSER(Obj);
EQM_DECLARE_PARSER(Off);
EQM_DECLARE_PARSER(Ply);
EQM_DECLARE_PARSER(Stl);
EQM_DECLARE_PARSER(Gmsh);
EQM_DECLARE_PARSER(Vtu);
EQM_DECLARE_PARSER(Vtk);
EQM_DECLARE_PARSER(Gifti);
EQM_DECLARE_PARSER(Medit);
EQM_DECLARE_PARSER(Meshb);
EQM_DECLARE_PARSER(Tetgen);
EQM_DECLARE_WRITER(Obj);
EQM_DECLARE_WRITER(Off);
EQM_DECLARE_WRITER(Ply);
EQM_DECLARE_WRITER(Stl);
EQM_DECLARE_WRITER(Gmsh);
EQM_DECLARE_WRITER(Vtu);
EQM_DECLARE_WRITER(Gifti);
EQM_DECLARE_WRITER(Vtk);
EQM_DECLARE_WRITER(Medit);
EQM_DECLARE_WRITER(Meshb);
EQM_DECLARE_WRITER(Tetgen);
PETSC_INTERN PetscErrorCode EqmLoadTetgen(const char *file, char **bytes, size_t *length, char *error,
                                          size_t error_length);
PETSC_INTERN PetscBool EqmRecogniseHdf5(const char *bytes, size_t length);
PETSC_INTERN PetscErrorCode EqmSoupReadHdf5(MPI_Comm comm, const char *file, EqmSoup *soup);
PETSC_INTERN PetscErrorCode EqmSoupWriteHdf5(EqmSoup soup, const char *file);
PETSC_INTERN PetscErrorCode EqmSoupReadDensityHdf5(EqmSoup soup, const char *file, PetscReal *density);

#endif
