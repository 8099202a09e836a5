/* PLY files of which every rank reads a part of each element's rows. */
#include "ply.h"

/* Parse this rank's rows of an element, which are all that `in` holds. */
static PetscBool ParseShare(EqmInput *in, const EqmPlyHeader *header, EqmPlyElement *element, PetscInt64 count,
                            EqmBuilder *builder)
{
  element->count = count;
  EqmBuilderSetRow(builder, -1);
  if (EqmPlyParseRows(in, header, element, builder)) return PETSC_FALSE;
  if (header->ascii) EqmSkipSpace(in, 0);
  return in->cursor == in->end ? PETSC_TRUE : PETSC_FALSE;
}

/* Rows in bytes. Collective. */
static PetscErrorCode ParseBinary(const EqmPartFile *file, PetscInt64 begin, EqmPlyHeader *header, EqmBuilder *builder,
                                  PetscBool *understood)
{
  char unused[EQM_MESSAGE_MAX];
  PetscBool fine = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < header->num_elements && *understood; ++e) {
    EqmPlyElement *const element = &header->element[e];
    EqmFilePart part;
    PetscInt64 count;

    if (!element->num_properties || !element->count) { /* no bytes in the file, but fields perhaps */
      PetscCall(EqmPartFileBytes(file, begin, 0, &part));
      count = 0;
    } else {
      PetscCall(EqmPlyRowsOfPart(file, header, element, begin, &part, &count, &begin, understood));
    }
    EqmInputOpen(builder->in, part.bytes, *understood ? part.length : 0, unused, sizeof(unused));
    if (fine && *understood) fine = ParseShare(builder->in, header, element, count, builder);
    PetscCall(PetscFree(part.bytes));
  }
  EqmInputOpen(builder->in, NULL, 0, unused, 0);
  if (!fine) *understood = PETSC_FALSE;
  PetscFunctionReturn(0);
}

/* Move over `count` lines that are not blank, and count those there are. */
static PetscInt64 SkipLines(EqmInput *in, PetscInt64 count)
{
  PetscInt64 done = 0;

  while (done < count) {
    EqmSkipSpace(in, 0);
    if (in->cursor == in->end) break;
    EqmSkipLine(in);
    ++done;
  }
  return done;
}

/* This rank's lines, the first of which is that number among all. A line has one row, or the file is not understood. */
static PetscBool ParseLines(const EqmFilePart *part, PetscInt64 first, PetscInt64 count, EqmPlyHeader *header,
                            EqmBuilder *builder)
{
  char unused[EQM_MESSAGE_MAX];
  PetscInt64 begin = 0; /* number of the element's first line */
  PetscBool fine = PETSC_TRUE;
  EqmInput lines;

  EqmInputOpen(&lines, part->bytes, part->length, unused, sizeof(unused));
  for (PetscInt e = 0; e < header->num_elements && fine; ++e) {
    EqmPlyElement *const element = &header->element[e];
    const PetscInt64 end = begin + (element->num_properties ? element->count : 0);
    const PetscInt64 mine = PetscMax(0, PetscMin(end, first + count) - PetscMax(begin, first));
    const char *const from = lines.cursor;

    (void)SkipLines(&lines, mine);
    EqmInputOpen(builder->in, from, (size_t)(lines.cursor - from), unused, sizeof(unused));
    fine = ParseShare(builder->in, header, element, mine, builder);
    begin = end;
  }
  EqmInputOpen(builder->in, NULL, 0, unused, 0);
  return fine;
}

/* Rows in lines. Collective. */
static PetscErrorCode ParseAscii(const EqmPartFile *file, PetscInt64 begin, EqmPlyHeader *header, EqmBuilder *builder,
                                 PetscBool *understood)
{
  PetscInt64 count = 0, before, total, wanted = 0;
  char unused[8];
  EqmFilePart part;
  EqmInput lines;

  PetscFunctionBegin;
  PetscCall(EqmPartFileLines(file, begin, NULL, &part, understood));
  EqmInputOpen(&lines, part.bytes, *understood ? part.length : 0, unused, sizeof(unused));
  count = SkipLines(&lines, INT64_MAX);
  PetscCallMPI(MPI_Scan(&count, &before, 1, MPIU_INT64, MPI_SUM, file->comm));
  PetscCall(MPIU_Allreduce(&count, &total, 1, MPIU_INT64, MPI_SUM, file->comm));
  for (PetscInt e = 0; e < header->num_elements; ++e) {
    const EqmPlyElement *const element = &header->element[e];

    if (!element->num_properties) continue;
    if (element->count > total - wanted) *understood = PETSC_FALSE;
    wanted += PetscMin(element->count, total); /* at most as many elements as fit the header: no overflow */
  }
  if (*understood) *understood = ParseLines(&part, before - count, count, header, builder);
  PetscCall(PetscFree(part.bytes));
  PetscFunctionReturn(0);
}

/* A header that the first bytes of the file hold, of a file whose cells are in one element and whose texture points are
   of one kind. */
static PetscBool ParseHead(EqmInput *in, EqmPlyHeader *header)
{
  PetscInt num_cells = 0;

  if (EqmPlyParseHeader(in, header) || header->num_vertices > PETSC_MAX_INT) return PETSC_FALSE;
  for (PetscInt e = 0; e < header->num_elements; ++e) {
    EqmPlyElement *const element = &header->element[e];

    element->position = NULL; /* rows are read from other bytes, in which the header's line is not */
    if (element->is_face || element->is_strips) ++num_cells;
    if (header->textured && element->has_texture) return PETSC_FALSE;
  }
  return num_cells == 1 ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode EqmPlyParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood)
{
  char unused[EQM_MESSAGE_MAX];
  EqmPlyHeader *header;
  EqmBuilder builder;
  EqmInput in;

  PetscFunctionBegin;
  EqmInputOpen(&in, file->head, file->head_length, unused, sizeof(unused));
  EqmBuilderOpen(&builder, &in);
  PetscCall(PetscCalloc1(1, &header));
  *understood = ParseHead(&in, header); /* the same on every rank, as the head is */
  builder.texture_of_part = header->textured ? PETSC_FALSE : PETSC_TRUE;
  if (*understood) {
    const PetscInt64 begin = in.cursor - in.start;

    PetscCall((header->ascii ? ParseAscii : ParseBinary)(file, begin, header, &builder, understood));
  }
  PetscCall(EqmBuilderFinishPart(&builder, file->comm, understood, mesh));
  PetscCall(PetscFree(header));
  PetscFunctionReturn(0);
}
