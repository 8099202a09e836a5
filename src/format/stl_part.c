/* STL files of which every rank reads a part of the triangles. */
#include "scalar.h"
#include "stl.h"
#include "weld.h"

/* Collective. */
static PetscErrorCode ParseBinary(const EqmPartFile *file, EqmBuilder *builder, PetscBool *understood)
{
  const PetscInt64 total = EqmLoadInteger(file->head + EQM_STL_HEADER, EQM_SCALAR_UINT32, PETSC_FALSE);
  PetscInt64 first, count;
  EqmFilePart part;

  PetscFunctionBegin;
  EqmPartFileShare(file, total, &first, &count);
  PetscCall(EqmPartFileBytes(file, EQM_STL_HEADER + 4 + EQM_STL_TRIANGLE * first, EQM_STL_TRIANGLE * count, &part));
  if (!part.bytes || EqmStlParseTriangles(part.bytes, (size_t)count, builder)) *understood = PETSC_FALSE;
  PetscCall(PetscFree(part.bytes));
  PetscFunctionReturn(0);
}

/* The lines are cut before facets. Collective. */
static PetscErrorCode ParseAscii(const EqmPartFile *file, EqmBuilder *builder, PetscBool *understood)
{
  PetscInt64 open_solids = 0;
  EqmFilePart part;

  PetscFunctionBegin;
  PetscCall(EqmPartFileLines(file, 0, "facet", &part, understood));
  if (*understood) {
    EqmInputOpen(builder->in, part.bytes, part.length, builder->in->error, builder->in->error_length);
    if (EqmStlParseFacets(builder->in, builder, &open_solids)) *understood = PETSC_FALSE;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &open_solids, 1, MPIU_INT64, MPI_SUM, file->comm));
  if (open_solids) *understood = PETSC_FALSE;
  PetscCall(PetscFree(part.bytes));
  EqmInputOpen(builder->in, NULL, 0, builder->in->error, builder->in->error_length);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStlParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood)
{
  const PetscBool binary = EqmStlIsBinary(file->head, (size_t)file->length);
  char unused[EQM_MESSAGE_MAX];
  PetscInt *cells;
  EqmBuilder builder;
  EqmInput in;

  PetscFunctionBegin;
  EqmInputOpen(&in, file->head, file->head_length, unused, sizeof(unused));
  EqmBuilderOpen(&builder, &in);
  *understood = binary || EqmStlIsAscii(file->head, file->head_length) ? PETSC_TRUE : PETSC_FALSE;
  if (*understood) PetscCall((binary ? ParseBinary : ParseAscii)(file, &builder, understood));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, understood, 1, MPIU_BOOL, MPI_LAND, file->comm));
  if (*understood && EqmBuilderAddCells(&builder, 3, builder.num_vertices / 3, &cells)) *understood = PETSC_FALSE;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, understood, 1, MPIU_BOOL, MPI_LAND, file->comm));
  if (*understood) PetscCall(EqmWeldParts(file->comm, &builder.num_vertices, builder.vertices, cells, understood));
  PetscCall(EqmBuilderFinishPart(&builder, file->comm, understood, mesh));
  PetscFunctionReturn(0);
}
