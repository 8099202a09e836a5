/* A mesh that lies in slabs on the ranks, as rank 0 writes it to a file: row by row, of which it holds a block at a
 * time. */
#ifndef EQM_FORMAT_STREAM_H
#define EQM_FORMAT_STREAM_H

#include "format.h"
#include "seam.h"

typedef struct EqmMeshStream EqmMeshStream;

/* An array of as many rows as vertices or cells. */
typedef struct {
  EqmMeshStream *stream;
  PetscInt number, width, total; /* which of the stream's columns it is; numbers in a row; rows */
  size_t row_bytes;
  const PetscInt *start; /* the first rows of the ranks' slabs, and the total; NULL: all rows are here */
  const char *slab;      /* this rank's */
  PetscInt first, count; /* the rows at hand, */
  const char *rows;      /* and where they are */
  char *block;
} EqmColumn;

struct EqmMeshStream {
  MPI_Comm comm;
  PetscMPIInt rank, size;
  EqmSerialMesh mesh; /* sizes and metadata; arrays only where one rank has all */
  PetscInt num_fields;
  const EqmField *fields; /* values are this rank's */
  PetscInt *vertex_start, *cell_start, *more_start;
  PetscInt num_columns; /* those of the list below, and one per field */
  EqmColumn *columns;
  float *corner_points; /* on several ranks, if wanted: 3 per corner of this rank's cells */
  PetscBool has_texture;
  PetscInt num_more;  /* texture points beside one per vertex */
  EqmSeamSlabs seams; /* of the texture, where it lies in slabs, */
  EqmSeams whole;     /* or where one rank has all */
};

/* Which column is which; EQM_COLUMN_FIELDS + f is that of field f. Of a texture: its coordinates, two per corner of
   every cell; the first point of every vertex; further points; the points of every cell's corners, among these. */
enum {
  EQM_COLUMN_VERTICES,
  EQM_COLUMN_CELLS,
  EQM_COLUMN_CORNERS,
  EQM_COLUMN_TEXTURE,
  EQM_COLUMN_POINTS,
  EQM_COLUMN_MORE_POINTS,
  EQM_COLUMN_POINTS_OF_CELLS,
  EQM_COLUMN_FIELDS
};

/* EqmStreamOpenWhole - of a mesh that this rank has, with its texture if wanted; not collective. EqmStreamOpen - of the
   slabs of a soup, with these vertices (3 per vertex), texture (2 per corner of each cell, or NULL) and fields, of
   which a rank has its slab; collective. with_corners - the column of the points of each cell's corners is wanted. All
   that is given must stay. EqmStreamReset must follow. */
PETSC_INTERN PetscErrorCode EqmStreamOpenWhole(EqmMeshStream *stream, const EqmSerialMesh *mesh, PetscBool with_texture,
                                               const EqmField *fields, PetscInt num_fields);
PETSC_INTERN PetscErrorCode EqmStreamOpen(EqmMeshStream *stream, EqmSoup soup, const PetscReal *vertices,
                                          const PetscReal *texture, const EqmField *fields, PetscInt num_fields,
                                          PetscBool with_corners);
PETSC_INTERN PetscErrorCode EqmStreamReset(EqmMeshStream *stream);

/* EqmStreamServe - the ranks other than 0 send the rows that it asks for, until it calls EqmStreamEnd. */
PETSC_INTERN PetscErrorCode EqmStreamServe(EqmMeshStream *stream);
PETSC_INTERN PetscErrorCode EqmStreamEnd(EqmMeshStream *stream);
/* EqmColumnFetch - on rank 0: bring row `row`, and what follows it, to hand. */
PETSC_INTERN void EqmColumnFetch(EqmColumn *column, PetscInt row);
/* EqmStreamGather - all on rank 0, for writers that need it: a mesh and its fields, `num_fields`, which are to be freed
   by EqmSerialMeshReset; elsewhere nothing. Collective. */
PETSC_INTERN PetscErrorCode EqmStreamGather(EqmMeshStream *stream, EqmSerialMesh *mesh);

/* A row, on rank 0. The pointer is good until another row of the column is asked for. Not collective. */
static inline const void *EqmColumnRow(EqmColumn *column, PetscInt row)
{
  if (row < column->first || row >= column->first + column->count) EqmColumnFetch(column, row);
  return column->rows + (size_t)(row - column->first) * column->row_bytes;
}

static inline const PetscReal *EqmStreamVertex(EqmMeshStream *stream, PetscInt row)
{
  return (const PetscReal *)EqmColumnRow(&stream->columns[EQM_COLUMN_VERTICES], row);
}

static inline const PetscInt *EqmStreamCell(EqmMeshStream *stream, PetscInt row)
{
  return (const PetscInt *)EqmColumnRow(&stream->columns[EQM_COLUMN_CELLS], row);
}

/* A texture point by its number. */
static inline const PetscReal *EqmStreamPoint(EqmMeshStream *stream, PetscInt number)
{
  const PetscInt more = number - stream->mesh.num_vertices;

  return (const PetscReal *)EqmColumnRow(&stream->columns[more < 0 ? EQM_COLUMN_POINTS : EQM_COLUMN_MORE_POINTS],
                                         more < 0 ? number : more);
}

static inline const PetscReal *EqmStreamField(EqmMeshStream *stream, PetscInt field, PetscInt row)
{
  return (const PetscReal *)EqmColumnRow(&stream->columns[EQM_COLUMN_FIELDS + field], row);
}

/* The number of a field among the stream's, -1 for NULL. Not collective. */
static inline PetscInt EqmStreamIndexOf(const EqmMeshStream *stream, const EqmField *field)
{
  return field ? (PetscInt)(field - stream->fields) : -1;
}

/* The group of a cell by the field of that number, 0 for -1. On rank 0. Not collective. */
static inline int EqmStreamGroup(EqmMeshStream *stream, PetscInt field, PetscInt cell)
{
  return field < 0 ? 0 : EqmGroupOf(*EqmStreamField(stream, field, cell));
}

#endif
