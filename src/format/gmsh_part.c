/* Gmsh's MSH files of which every rank reads a part of the nodes and of the elements. */
#include "gmsh.h"

#include <string.h>

enum { LONGEST_PREAMBLE = 1 << 24 };

/* On rank 0: where a line begins with the section of nodes; -1: nowhere near the beginning. */
static PetscInt64 FindNodes(const EqmPartFile *file)
{
  static const char *const names[] = {"$Nodes", "$ParametricNodes"};
  EqmFileWindow window = {.file = file};
  PetscInt64 at = -1;
  PetscBool found = PETSC_FALSE;

  while (!found && (at = EqmFileWindowFind(&window, at + 1, '$')) >= 0 && at < LONGEST_PREAMBLE) {
    for (int k = 0; k < 2; ++k) {
      const size_t length = strlen(names[k]);
      const char *const bytes = EqmFileWindowAt(&window, at - 1, length + 2);

      if (!bytes || (bytes[0] != '\n' && bytes[0] != '\r')) continue;
      if (!memcmp(bytes + 1, names[k], length) && EqmIsSpace(bytes[length + 1])) found = PETSC_TRUE;
    }
  }
  return EqmFileWindowReset(&window) || !found ? -1 : at;
}

/* What stands before the nodes, on every rank. Collective. */
static PetscErrorCode ReadPreamble(const EqmPartFile *file, EqmFilePart *preamble, PetscBool *understood)
{
  PetscInt64 length = 0;

  PetscFunctionBegin;
  *preamble = (EqmFilePart){0};
  if (file->rank == 0) {
    length = FindNodes(file);
    if (length >= 0) PetscCall(EqmPartFileBytes(file, 0, length, preamble));
    if (!preamble->bytes) length = -1;
  }
  PetscCallMPI(MPI_Bcast(&length, 1, MPIU_INT64, 0, file->comm));
  *understood = length >= 0 ? PETSC_TRUE : PETSC_FALSE;
  if (!*understood) PetscFunctionReturn(0);
  preamble->length = (size_t)length;
  if (file->rank) PetscCall(PetscMalloc1(preamble->length + 1, &preamble->bytes));
  PetscCallMPI(MPI_Bcast(preamble->bytes, (PetscMPIInt)length, MPI_CHAR, 0, file->comm));
  PetscFunctionReturn(0);
}

/* This rank's rows of a run: of text those among its lines, of bytes those among its share of all rows of that kind, of
   which `before` are those of earlier runs and `total` all. bytes - to be freed with PetscFree, or NULL. */
static PetscErrorCode OpenRows(const EqmGmshSurvey *survey, const EqmPartFile *file, const EqmGmshRun *run,
                               PetscInt64 before, PetscInt64 total, EqmInput *in, char **bytes, PetscInt64 *count)
{
  char *const error = in->error;
  const size_t error_length = in->error_length;
  const PetscInt64 first = run->row_bytes ? before : run->first;
  PetscInt64 low, high, own_first = survey->first_line, own_count = survey->num_lines;
  EqmFilePart part;

  *bytes = NULL;
  if (run->row_bytes) EqmPartFileShare(file, total, &own_first, &own_count);
  low = PetscMax(first, own_first);
  high = PetscMin(first + run->count, own_first + own_count);
  *count = PetscMax(0, high - low);
  EqmInputOpen(in, NULL, 0, error, error_length);
  if (!*count) return 0;
  if (!run->row_bytes) {
    const PetscInt64 *const line = survey->line + (low - own_first);

    EqmInputOpen(in, survey->part.bytes + line[0], (size_t)(line[*count] - line[0]), error, error_length);
    return 0;
  }
  EqmTry(EqmPartFileBytes(file, run->first + (low - first) * run->row_bytes, *count * run->row_bytes, &part));
  if (!part.bytes) return EQM_ERR_IO;
  *bytes = part.bytes;
  EqmInputOpen(in, part.bytes, part.length, error, error_length);
  in->binary = PETSC_TRUE;
  return 0;
}

/* This rank's rows of all runs of a kind. */
static PetscErrorCode ReadKind(EqmGmsh *gmsh, const EqmGmshSurvey *survey, const EqmPartFile *file, PetscInt64 kind)
{
  PetscInt64 total = 0, before = 0, count;
  PetscErrorCode code = 0;

  for (PetscInt64 r = 0; r < survey->num_runs; ++r) total += survey->runs[r].kind == kind ? survey->runs[r].count : 0;
  if (kind != EQM_GMSH_ELEMENTS && kind != EQM_GMSH_POINTS) /* room for the tags, at once */
    EqmTry(EqmTagMapReserve(&gmsh->tags, (size_t)PetscMin(total, total / file->size + 1 + survey->num_lines)));
  for (PetscInt64 r = 0; r < survey->num_runs && !code; ++r) {
    const EqmGmshRun *const run = &survey->runs[r];
    char *bytes;

    if (run->kind != kind) continue;
    code = OpenRows(survey, file, run, before, total, gmsh->in, &bytes, &count);
    if (!code && count) code = EqmGmshReadRows(gmsh, run, count);
    if (!code && gmsh->ascii) EqmSkipSpace(gmsh->in, 0);
    if (!code && gmsh->in->cursor != gmsh->in->end) code = EQM_ERR_IO; /* rows that do not keep to lines */
    EqmTry(PetscFree(bytes));
    before += run->count;
  }
  EqmInputOpen(gmsh->in, NULL, 0, gmsh->in->error, gmsh->in->error_length);
  return code;
}

static PetscErrorCode ReadAllNodes(EqmGmsh *gmsh, const EqmGmshSurvey *survey, const EqmPartFile *file)
{
  EqmTry(ReadKind(gmsh, survey, file, EQM_GMSH_NODES));
  EqmTry(ReadKind(gmsh, survey, file, EQM_GMSH_TAGS));
  return ReadKind(gmsh, survey, file, EQM_GMSH_POINTS);
}

/* So that elements find nodes by their tags. Collective. */
static PetscErrorCode ShareTags(EqmGmsh *gmsh, const EqmGmshSurvey *survey, const EqmPartFile *file,
                                PetscBool *understood)
{
  PetscBool consecutive, fine = PETSC_TRUE;
  PetscInt64 sums[2] = {(PetscInt64)gmsh->tags.count, (PetscInt64)gmsh->builder.num_vertices};

  PetscFunctionBegin;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_INT64, MPI_SUM, file->comm));
  gmsh->num_nodes = sums[0];
  PetscCall(EqmTagMapShare(file->comm, &gmsh->tags, &consecutive, understood));
  if (sums[0] != sums[1]) *understood = PETSC_FALSE;
  if (consecutive || !*understood) PetscFunctionReturn(0);
  gmsh->names_only = PETSC_TRUE;
  if (ReadKind(gmsh, survey, file, EQM_GMSH_ELEMENTS)) fine = PETSC_FALSE;
  gmsh->names_only = PETSC_FALSE;
  PetscCall(EqmTagMapShareNamed(file->comm, &gmsh->tags, gmsh->num_named, gmsh->named, understood));
  PetscCall(PetscFree(gmsh->named));
  if (!fine) *understood = PETSC_FALSE;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, understood, 1, MPIU_BOOL, MPI_LAND, file->comm));
  PetscFunctionReturn(0);
}

/* Collective. */
static PetscErrorCode ReadRuns(EqmGmsh *gmsh, const EqmGmshSurvey *survey, const EqmPartFile *file,
                               PetscBool *understood)
{
  PetscFunctionBegin;
  EqmBuilderSetGroup(&gmsh->builder, 0);
  if (ReadAllNodes(gmsh, survey, file)) *understood = PETSC_FALSE;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, understood, 1, MPIU_BOOL, MPI_LAND, file->comm));
  if (!*understood) PetscFunctionReturn(0);
  PetscCall(ShareTags(gmsh, survey, file, understood));
  if (*understood && ReadKind(gmsh, survey, file, EQM_GMSH_ELEMENTS)) *understood = PETSC_FALSE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGmshParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood)
{
  char unused[EQM_MESSAGE_MAX];
  EqmInput in;
  EqmGmsh gmsh = {.in = &in};
  EqmGmshSurvey survey = {0};
  EqmFilePart preamble;

  PetscFunctionBegin;
  PetscCall(ReadPreamble(file, &preamble, understood));
  EqmInputOpen(&in, preamble.bytes, preamble.length, unused, sizeof(unused));
  EqmBuilderOpen(&gmsh.builder, &in);
  if (*understood && (EqmGmshParseSections(&gmsh) || !gmsh.version || gmsh.has_nodes)) *understood = PETSC_FALSE;
  EqmInputOpen(&in, NULL, 0, unused, sizeof(unused));
  PetscCall(PetscFree(preamble.bytes));
  if (*understood) { /* the same on every rank, as the preamble is */
    PetscCall((gmsh.ascii ? EqmGmshSurveyLines : EqmGmshSurveyBytes)(&gmsh, file, (PetscInt64)preamble.length, &survey,
                                                                     understood));
  }
  if (*understood) PetscCall(ReadRuns(&gmsh, &survey, file, understood));
  PetscCall(PetscFree(survey.part.bytes));
  PetscCall(PetscFree(survey.line));
  PetscCall(PetscFree(survey.runs));
  PetscCall(EqmBuilderFinishPart(&gmsh.builder, file->comm, understood, mesh));
  if (*understood) EqmGmshTakeNames(&gmsh, mesh);
  PetscCall(EqmGmshReset(&gmsh));
  PetscFunctionReturn(0);
}
