/* Where the rows of a binary PLY file begin. Rows with lists are of different lengths: where a row begins shows when
   all before it are known. In nearly all files they are as long as the first one after all, which all ranks see to
   together; otherwise one rank goes through them. */
#include "ply.h"

/* The end of the row at `offset`; -1: the file ends before. */
static PetscInt64 EndOfRow(EqmFileWindow *window, const EqmPlyHeader *header, const EqmPlyElement *element,
                           PetscInt64 offset)
{
  for (PetscInt p = 0; p < element->num_properties; ++p) {
    const EqmPlyProperty *const property = &element->property[p];
    const PetscInt64 size = (PetscInt64)EqmScalarSize(property->type);
    PetscInt64 count = 1;

    if (property->count_type) {
      const size_t count_size = EqmScalarSize(property->count_type);
      const char *const bytes = EqmFileWindowAt(window, offset, count_size);

      count = bytes ? EqmLoadInteger(bytes, property->count_type, header->big_endian) : -1;
      offset += (PetscInt64)count_size;
    }
    if (count < 0 || count > (window->file->length - offset) / size) return -1;
    offset += count * size;
  }
  return offset;
}

/* Are this rank's rows of that length? */
static PetscBool AreEqual(EqmFileWindow *window, const EqmPlyHeader *header, const EqmPlyElement *element,
                          PetscInt64 begin, PetscInt64 length)
{
  PetscInt64 first, count;

  EqmPartFileShare(window->file, element->count, &first, &count);
  for (PetscInt64 i = first; i < first + count; ++i) {
    if (EndOfRow(window, header, element, begin + i * length) != begin + (i + 1) * length) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The length of all rows, 0 where they differ or the file is too short for them. Collective. */
static PetscErrorCode CommonLength(EqmFileWindow *window, const EqmPlyHeader *header, const EqmPlyElement *element,
                                   PetscInt64 begin, PetscInt64 *length)
{
  PetscInt64 agreed = EndOfRow(window, header, element, begin) - begin; /* not positive where it cannot be read */
  PetscBool has_lists = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < element->num_properties; ++p) {
    if (element->property[p].count_type) has_lists = PETSC_TRUE;
  }
  if (agreed > 0 && element->count > (window->file->length - begin) / agreed) agreed = 0;
  if (agreed > 0 && has_lists && !AreEqual(window, header, element, begin, agreed)) agreed = 0;
  PetscCall(MPIU_Allreduce(&agreed, length, 1, MPIU_INT64, MPI_MIN, window->file->comm));
  PetscFunctionReturn(0);
}

/* On rank 0: where the rows of each rank begin, and where the last one ends; PETSC_FALSE: the file ends before. */
static PetscBool GoThrough(EqmFileWindow *window, const EqmPlyHeader *header, const EqmPlyElement *element,
                           PetscInt64 begin, PetscInt64 *start)
{
  EqmPartFile other = *window->file;
  PetscInt64 row = 0, first, count;

  for (other.rank = 0; other.rank < other.size; ++other.rank) {
    EqmPartFileShare(&other, element->count, &first, &count);
    start[other.rank] = begin;
    for (; row < first + count && begin >= 0; ++row) begin = EndOfRow(window, header, element, begin);
  }
  start[other.size] = begin;
  return begin >= 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* Where this rank's rows begin and end, and where all end. Collective. */
static PetscErrorCode FindRows(EqmFileWindow *window, const EqmPlyHeader *header, const EqmPlyElement *element,
                               PetscInt64 begin, PetscInt64 bounds[3], PetscBool *understood)
{
  const EqmPartFile *const file = window->file;
  PetscInt64 length, first, count, *start;

  PetscFunctionBegin;
  EqmPartFileShare(file, element->count, &first, &count);
  PetscCall(CommonLength(window, header, element, begin, &length));
  if (length > 0) {
    bounds[0] = begin + first * length;
    bounds[1] = begin + (first + count) * length;
    bounds[2] = begin + element->count * length;
    PetscFunctionReturn(0);
  }
  PetscCall(PetscMalloc1(file->size + 1, &start));
  if (file->rank == 0) *understood = GoThrough(window, header, element, begin, start);
  PetscCallMPI(MPI_Bcast(understood, 1, MPIU_BOOL, 0, file->comm));
  PetscCallMPI(MPI_Bcast(start, file->size + 1, MPIU_INT64, 0, file->comm));
  bounds[0] = start[file->rank];
  bounds[1] = start[file->rank + 1];
  bounds[2] = start[file->size];
  PetscCall(PetscFree(start));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPlyRowsOfPart(const EqmPartFile *file, const EqmPlyHeader *header, const EqmPlyElement *element,
                                PetscInt64 begin, EqmFilePart *part, PetscInt64 *count, PetscInt64 *end,
                                PetscBool *understood)
{
  EqmFileWindow window = {.file = file};
  PetscInt64 first, bounds[3] = {0, 0, 0};

  PetscFunctionBegin;
  *understood = PETSC_TRUE;
  EqmPartFileShare(file, element->count, &first, count);
  PetscCall(FindRows(&window, header, element, begin, bounds, understood));
  PetscCall(EqmFileWindowReset(&window));
  *end = bounds[2];
  PetscCall(EqmPartFileBytes(file, bounds[0], bounds[1] - bounds[0], part));
  if (!part->bytes) *understood = PETSC_FALSE;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, understood, 1, MPIU_BOOL, MPI_LAND, file->comm));
  PetscFunctionReturn(0);
}
