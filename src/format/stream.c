#include "stream.h"
#include "input.h"
#include "base/rows.h"
#include "mesh/fields.h"
#include "mesh/soup_private.h"

#include <string.h>

enum { BLOCK_BYTES = 1 << 20, TAG = 7 };

/* What rank 0 asks for: `count` rows of a column from `first` on; column -1: nothing more. For MPI of one type. */
typedef struct {
  PetscInt column, first, count;
} Request;

/* A column of `total` rows, of which `start`, if not NULL, says where they are. */
static void SetColumn(EqmMeshStream *stream, PetscInt number, PetscInt total, const PetscInt *start, PetscInt width,
                      size_t number_bytes, const void *slab)
{
  EqmColumn *const column = &stream->columns[number];

  *column = (EqmColumn){.stream = stream,
                        .number = number,
                        .width = width,
                        .total = total,
                        .row_bytes = number_bytes * (size_t)width,
                        .start = start,
                        .slab = slab,
                        .count = total,
                        .rows = slab};
  if (column->start) {
    column->first = column->start[stream->rank];
    column->count = column->start[stream->rank + 1] - column->first;
  }
}

/* The columns of a texture. */
static void SetTexture(EqmMeshStream *stream, const PetscReal *texture, const PetscReal *points, const PetscReal *more,
                       const PetscInt *corners)
{
  const PetscInt n = stream->mesh.num_vertices, m = stream->mesh.num_cells;

  stream->has_texture = PETSC_TRUE;
  SetColumn(stream, EQM_COLUMN_TEXTURE, m, stream->cell_start, 6, sizeof(PetscReal), texture);
  SetColumn(stream, EQM_COLUMN_POINTS, n, stream->vertex_start, 2, sizeof(PetscReal), points);
  SetColumn(stream, EQM_COLUMN_MORE_POINTS, stream->num_more, stream->more_start, 2, sizeof(PetscReal), more);
  SetColumn(stream, EQM_COLUMN_POINTS_OF_CELLS, m, stream->cell_start, 3, sizeof(PetscInt), corners);
}

static PetscErrorCode SetColumns(EqmMeshStream *stream, const PetscReal *vertices, const PetscInt *cells)
{
  const PetscInt n = stream->mesh.num_vertices, m = stream->mesh.num_cells, size = stream->mesh.cell_size;

  stream->num_columns = EQM_COLUMN_FIELDS + stream->num_fields;
  EqmTry(PetscCalloc1(stream->num_columns, &stream->columns));
  SetColumn(stream, EQM_COLUMN_VERTICES, n, stream->vertex_start, 3, sizeof(PetscReal), vertices);
  SetColumn(stream, EQM_COLUMN_CELLS, m, stream->cell_start, size, sizeof(PetscInt), cells);
  SetColumn(stream, EQM_COLUMN_CORNERS, m, stream->cell_start, 3 * size, sizeof(float), stream->corner_points);
  for (PetscInt f = 0; f < stream->num_fields; ++f) {
    const EqmField *const field = &stream->fields[f];

    SetColumn(stream, EQM_COLUMN_FIELDS + f, field->on_cells ? m : n,
              field->on_cells ? stream->cell_start : stream->vertex_start, field->width, sizeof(PetscReal),
              field->values);
  }
  return 0;
}

/* The columns of a texture that one rank has. */
static PetscErrorCode OpenWholeTexture(EqmMeshStream *stream, const PetscInt *cells, const PetscReal *texture)
{
  const PetscInt n = stream->mesh.num_vertices;
  EqmSeams *const seams = &stream->whole;

  EqmTry(EqmSeamsFind(n, stream->mesh.num_cells, cells, texture, seams));
  stream->num_more = seams->num - n;
  SetTexture(stream, texture, seams->point, seams->point + 2 * (size_t)n, seams->corner);
  return 0;
}

PetscErrorCode EqmStreamOpenWhole(EqmMeshStream *stream, const EqmSerialMesh *mesh, PetscBool with_texture,
                                  const EqmField *fields, PetscInt num_fields)
{
  *stream =
      (EqmMeshStream){.comm = PETSC_COMM_SELF, .size = 1, .mesh = *mesh, .num_fields = num_fields, .fields = fields};
  EqmTry(SetColumns(stream, mesh->vertices, mesh->cells));
  return with_texture && mesh->texture && mesh->cell_size == 3 ? OpenWholeTexture(stream, mesh->cells, mesh->texture)
                                                               : 0;
}

/* First rows of all ranks' slabs. Collective. */
static PetscErrorCode ShareStarts(const EqmMeshStream *stream, PetscInt end, PetscInt **start)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(stream->size + 1, start));
  (*start)[0] = 0;
  PetscCallMPI(MPI_Allgather(&end, 1, MPIU_INT, *start + 1, 1, MPIU_INT, stream->comm));
  PetscFunctionReturn(0);
}

/* The points of the corners of this rank's cells, so many corners at a time. Collective. */
static PetscErrorCode FetchCorners(EqmMeshStream *stream, EqmSoup soup, const PetscReal *vertices)
{
  const PetscInt64 num_corners = (PetscInt64)soup->cell_size * (soup->cell_end - soup->cell_start), some = 1 << 17;
  PetscInt64 most;
  PetscReal *points;

  PetscFunctionBegin;
  PetscCall(MPIU_Allreduce(&num_corners, &most, 1, MPIU_INT64, MPI_MAX, soup->comm));
  PetscCall(PetscMalloc1(3 * (size_t)num_corners, &stream->corner_points));
  PetscCall(PetscMalloc1(3 * (size_t)some, &points));
  for (PetscInt64 at = 0; at < most; at += some) {
    const PetscInt64 count = PetscMax(0, PetscMin(some, num_corners - at));

    PetscCall(EqmFetchRows(soup->comm, soup->vertex_end - soup->vertex_start, (PetscInt)count,
                           count ? soup->cells + at : NULL, MPIU_REAL, 3, vertices, points));
    for (PetscInt64 k = 0; k < 3 * count; ++k) stream->corner_points[3 * at + k] = (float)points[k];
  }
  PetscCall(PetscFree(points));
  PetscFunctionReturn(0);
}

/* The same of one that lies in slabs. Collective. */
static PetscErrorCode OpenTexture(EqmMeshStream *stream, EqmSoup soup, const PetscReal *texture)
{
  PetscFunctionBegin;
  if (stream->size == 1) {
    PetscCall(OpenWholeTexture(stream, soup->cells, texture));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmSeamsFindSlabs(soup, texture, &stream->seams));
  PetscCall(ShareStarts(stream, stream->seams.more_end, &stream->more_start));
  stream->num_more = (PetscInt)stream->seams.num_more;
  SetTexture(stream, texture, stream->seams.point, stream->seams.more, stream->seams.corner);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStreamOpen(EqmMeshStream *stream, EqmSoup soup, const PetscReal *vertices, const PetscReal *texture,
                             const EqmField *fields, PetscInt num_fields, PetscBool with_corners)
{
  PetscFunctionBegin;
  *stream = (EqmMeshStream){.comm = soup->comm, .num_fields = num_fields, .fields = fields};
  PetscCallMPI(MPI_Comm_rank(soup->comm, &stream->rank));
  PetscCallMPI(MPI_Comm_size(soup->comm, &stream->size));
  stream->mesh = (EqmSerialMesh){.num_vertices = soup->num_vertices,
                                 .num_cells = soup->num_cells,
                                 .cell_size = soup->cell_size,
                                 .metadata = soup->metadata};
  PetscCall(ShareStarts(stream, soup->vertex_end, &stream->vertex_start));
  PetscCall(ShareStarts(stream, soup->cell_end, &stream->cell_start));
  if (with_corners && stream->size > 1) PetscCall(FetchCorners(stream, soup, vertices));
  PetscCall(SetColumns(stream, vertices, soup->cells));
  if (texture && soup->cell_size == 3) PetscCall(OpenTexture(stream, soup, texture));
  for (PetscInt c = 0; c < stream->num_columns && stream->size > 1 && stream->rank == 0; ++c)
    PetscCall(PetscMalloc(PetscMax((size_t)BLOCK_BYTES, stream->columns[c].row_bytes), &stream->columns[c].block));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStreamReset(EqmMeshStream *stream)
{
  for (PetscInt c = 0; c < stream->num_columns; ++c) EqmTry(PetscFree(stream->columns[c].block));
  EqmTry(PetscFree(stream->columns));
  EqmTry(PetscFree(stream->vertex_start));
  EqmTry(PetscFree(stream->cell_start));
  EqmTry(PetscFree(stream->more_start));
  EqmTry(EqmSeamSlabsReset(&stream->seams));
  EqmTry(EqmSeamsReset(&stream->whole));
  return PetscFree(stream->corner_points);
}

/* The rows of a request that a rank has: *count from *first on. */
static void Intersect(const EqmColumn *column, const Request *request, PetscMPIInt rank, PetscInt *first,
                      PetscInt *count)
{
  *first = PetscMax(request->first, column->start[rank]);
  *count = PetscMax(0, PetscMin(request->first + request->count, column->start[rank + 1]) - *first);
}

PetscErrorCode EqmStreamServe(EqmMeshStream *stream)
{
  Request request;
  PetscInt first, count;

  PetscFunctionBegin;
  for (;;) {
    PetscCallMPI(MPI_Bcast(&request, 3, MPIU_INT, 0, stream->comm));
    if (request.column < 0) PetscFunctionReturn(0);
    const EqmColumn *const column = &stream->columns[request.column];

    Intersect(column, &request, stream->rank, &first, &count);
    if (!count) continue;
    PetscCallMPI(MPI_Send(column->slab + (size_t)(first - column->start[stream->rank]) * column->row_bytes,
                          (PetscMPIInt)((size_t)count * column->row_bytes), MPI_BYTE, 0, TAG, stream->comm));
  }
}

PetscErrorCode EqmStreamEnd(EqmMeshStream *stream)
{
  Request request = {-1, 0, 0};

  PetscFunctionBegin;
  if (stream->size > 1) PetscCallMPI(MPI_Bcast(&request, 3, MPIU_INT, 0, stream->comm));
  PetscFunctionReturn(0);
}

static PetscErrorCode Receive(EqmColumn *column, Request request)
{
  const EqmMeshStream *const stream = column->stream;
  PetscInt first, count;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&request, 3, MPIU_INT, 0, stream->comm));
  for (PetscMPIInt r = 0; r < stream->size; ++r) {
    char *const rows = column->block;

    Intersect(column, &request, r, &first, &count);
    if (!count) continue;
    const size_t at = (size_t)(first - request.first) * column->row_bytes, bytes = (size_t)count * column->row_bytes;

    if (r == 0) {
      memcpy(rows + at, column->slab + (size_t)first * column->row_bytes, bytes);
    } else {
      PetscCallMPI(MPI_Recv(rows + at, (PetscMPIInt)bytes, MPI_BYTE, r, TAG, stream->comm, MPI_STATUS_IGNORE));
    }
  }
  PetscFunctionReturn(0);
}

void EqmColumnFetch(EqmColumn *column, PetscInt row)
{
  const PetscInt most = PetscMax(1, (PetscInt)((size_t)BLOCK_BYTES / column->row_bytes));
  Request request = {column->number, row, PetscMin(most, column->total - row)};

  if (row < column->start[1]) { /* rank 0 has it itself */
    column->first = 0;
    column->count = column->start[1];
    column->rows = column->slab;
    return;
  }
  PetscCallAbort(column->stream->comm, Receive(column, request)); /* the other ranks wait for rank 0 */
  column->first = request.first;
  column->count = request.count;
  column->rows = column->block;
}

/* On rank 0: all rows. */
static void CopyColumn(EqmColumn *column, void *all)
{
  for (PetscInt row = 0; row < column->total; row = column->first + column->count) {
    const char *const rows = EqmColumnRow(column, row);
    const size_t count = (size_t)(column->first + column->count - row);

    memcpy((char *)all + (size_t)row * column->row_bytes, rows, count * column->row_bytes);
  }
}

static PetscErrorCode GatherHere(EqmMeshStream *stream, EqmSerialMesh *mesh)
{
  PetscFunctionBegin;
  PetscCall(PetscStrallocpy(stream->mesh.metadata, &mesh->metadata));
  PetscCall(PetscMalloc1(3 * (size_t)mesh->num_vertices, &mesh->vertices));
  PetscCall(PetscMalloc1((size_t)mesh->cell_size * (size_t)mesh->num_cells, &mesh->cells));
  CopyColumn(&stream->columns[EQM_COLUMN_VERTICES], mesh->vertices);
  CopyColumn(&stream->columns[EQM_COLUMN_CELLS], mesh->cells);
  for (PetscInt f = 0; f < stream->num_fields; ++f) {
    const EqmField *const field = &stream->fields[f];
    EqmMeshField kind = {.on_cells = field->on_cells, .width = field->width};
    PetscReal *values;

    PetscCall(PetscStrncpy(kind.name, field->name, sizeof(kind.name)));
    PetscCall(EqmMeshFieldsAdd(&mesh->num_fields, &mesh->fields, &kind,
                               (size_t)(field->on_cells ? mesh->num_cells : mesh->num_vertices), &values));
    CopyColumn(&stream->columns[EQM_COLUMN_FIELDS + f], values);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStreamGather(EqmMeshStream *stream, EqmSerialMesh *mesh)
{
  PetscFunctionBegin;
  *mesh = (EqmSerialMesh){0};
  if (stream->rank) {
    PetscCall(EqmStreamServe(stream));
    PetscFunctionReturn(0);
  }
  *mesh = stream->mesh;
  PetscCall(GatherHere(stream, mesh));
  PetscCall(EqmStreamEnd(stream));
  PetscFunctionReturn(0);
}
