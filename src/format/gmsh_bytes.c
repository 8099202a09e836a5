/* Where the rows of nodes and elements are in the bytes of an MSH file: the first rank goes from header to header. */
#include "gmsh.h"

#include <string.h>

enum { MOST_RUNS = 1000000 };

/* The next number. */
static PetscErrorCode Take(EqmFileWindow *window, const EqmGmsh *gmsh, PetscInt64 *at, EqmScalarType type,
                           PetscInt64 *value)
{
  const char *const bytes = EqmFileWindowAt(window, *at, EqmScalarSize(type));

  if (!bytes) return EQM_ERR_IO;
  *at += (PetscInt64)EqmScalarSize(type);
  *value = EqmLoadInteger(bytes, type, gmsh->big_endian);
  return 0;
}

/* The next number, which says how many of what takes `bytes_each` at least follow. */
static PetscErrorCode TakeNumber(EqmFileWindow *window, const EqmGmsh *gmsh, PetscInt64 *at, EqmScalarType type,
                                 PetscInt64 bytes_each, PetscInt64 *value)
{
  EqmTry(Take(window, gmsh, at, type, value));
  return EqmGmshHasRoom(window->file, *at, bytes_each, *value) ? 0 : EQM_ERR_IO;
}

/* Move over white space and a word that a line's end follows. */
static PetscErrorCode TakeWord(EqmFileWindow *window, PetscInt64 *at, const char *word)
{
  const size_t length = strlen(word);
  const char *bytes;

  while ((bytes = EqmFileWindowAt(window, *at, 1)) != NULL && EqmIsSpace(*bytes)) ++*at;
  bytes = EqmFileWindowAt(window, *at, length + 1);
  if (!bytes || memcmp(bytes, word, length) || bytes[length] != '\n') return EQM_ERR_IO;
  *at += (PetscInt64)length + 1;
  return 0;
}

/* A line with one number. */
static PetscErrorCode TakeCount(EqmFileWindow *window, PetscInt64 *at, PetscInt64 bytes_each, PetscInt64 *count)
{
  const PetscInt64 end = EqmFileWindowFind(window, *at, '\n');
  const char *bytes, *next;

  if (end < 0 || end - *at > 30) return EQM_ERR_IO;
  bytes = EqmFileWindowAt(window, *at, (size_t)(end - *at));
  next = bytes ? EqmParseInteger(bytes, bytes + (end - *at), count) : NULL;
  if (!next || next != bytes + (end - *at)) return EQM_ERR_IO;
  if (!EqmGmshHasRoom(window->file, end, bytes_each, *count)) return EQM_ERR_IO;
  *at = end + 1;
  return 0;
}

/* Rows begin here, if the file has them all. */
static PetscErrorCode TakeRun(const EqmFileWindow *window, PetscInt64 *at, EqmGmshRun *run, EqmGmshSurvey *survey)
{
  if (run->count < 0 || run->row_bytes < 1 || survey->num_runs > MOST_RUNS) return EQM_ERR_IO;
  if (run->count > (window->file->length - *at) / run->row_bytes) return EQM_ERR_IO;
  run->first = *at;
  *at += run->count * run->row_bytes;
  return EqmGmshAddRun(survey, run);
}

static PetscErrorCode TakeElements2(EqmFileWindow *window, EqmGmsh *gmsh, PetscInt64 *at, EqmGmshSurvey *survey)
{
  PetscInt64 count, done = 0;
  PetscInt num_nodes;

  EqmTry(TakeCount(window, at, 8, &count));
  while (done < count) {
    EqmGmshRun run = {.kind = EQM_GMSH_ELEMENTS};

    EqmTry(Take(window, gmsh, at, EQM_SCALAR_INT32, &run.type));
    EqmTry(TakeNumber(window, gmsh, at, EQM_SCALAR_INT32, 8, &run.count));
    EqmTry(TakeNumber(window, gmsh, at, EQM_SCALAR_INT32, 4, &run.num_tags));
    if (EqmGmshNodesOfType(gmsh, run.type, &num_nodes) || run.count < 1) return EQM_ERR_IO;
    run.row_bytes = 4 * (1 + run.num_tags + num_nodes);
    EqmTry(TakeRun(window, at, &run, survey));
    done += run.count;
  }
  return 0;
}

static PetscErrorCode TakeSection2(EqmFileWindow *window, EqmGmsh *gmsh, PetscInt64 *at, PetscBool elements,
                                   EqmGmshSurvey *survey)
{
  EqmGmshRun run = {.kind = EQM_GMSH_NODES, .row_bytes = 28};

  if (elements) return TakeElements2(window, gmsh, at, survey);
  EqmTry(TakeCount(window, at, run.row_bytes, &run.count));
  return TakeRun(window, at, &run, survey);
}

/* Parameters of a node on a curve, on a surface, in a volume. */
static PetscInt64 ParameterBytes(const EqmGmshRun *run)
{
  return run->parametric ? 8 * PetscMax(0, PetscMin(run->dimension, 3)) : 0;
}

static PetscErrorCode TakeNodeBlock(EqmFileWindow *window, EqmGmsh *gmsh, PetscInt64 *at, EqmGmshRun *run,
                                    EqmGmshSurvey *survey)
{
  run->kind = gmsh->version_4_0 ? EQM_GMSH_NODES : EQM_GMSH_TAGS;
  run->row_bytes = gmsh->version_4_0 ? 28 + ParameterBytes(run) : 8;
  EqmTry(TakeRun(window, at, run, survey));
  if (gmsh->version_4_0) return 0;
  run->kind = EQM_GMSH_POINTS;
  run->row_bytes = 24 + ParameterBytes(run);
  return TakeRun(window, at, run, survey);
}

static PetscErrorCode TakeElementBlock(EqmFileWindow *window, EqmGmsh *gmsh, PetscInt64 *at, PetscInt64 entity,
                                       EqmGmshRun *run, EqmGmshSurvey *survey)
{
  PetscInt num_nodes;

  run->kind = EQM_GMSH_ELEMENTS;
  run->type = run->parametric;
  run->group = EqmGmshGroupOf(gmsh, run->dimension, entity);
  if (EqmGmshNodesOfType(gmsh, run->type, &num_nodes)) return EQM_ERR_IO;
  run->row_bytes = (1 + num_nodes) * (gmsh->version_4_0 ? 4 : 8);
  return TakeRun(window, at, run, survey);
}

static PetscErrorCode TakeSection4(EqmFileWindow *window, EqmGmsh *gmsh, PetscInt64 *at, PetscBool elements,
                                   EqmGmshSurvey *survey)
{
  PetscInt64 num_blocks, rows, unused;

  EqmTry(TakeNumber(window, gmsh, at, EQM_SCALAR_UINT64, 20, &num_blocks));
  EqmTry(TakeNumber(window, gmsh, at, EQM_SCALAR_UINT64, elements ? 8 : 28, &rows));
  for (int k = 0; k < 2 && !gmsh->version_4_0; ++k) EqmTry(Take(window, gmsh, at, EQM_SCALAR_UINT64, &unused));
  for (PetscInt64 b = 0; b < num_blocks; ++b) {
    EqmGmshRun run = {0};
    PetscInt64 entity;

    EqmTry(Take(window, gmsh, at, EQM_SCALAR_INT32, gmsh->version_4_0 ? &entity : &run.dimension));
    EqmTry(Take(window, gmsh, at, EQM_SCALAR_INT32, gmsh->version_4_0 ? &run.dimension : &entity));
    EqmTry(Take(window, gmsh, at, EQM_SCALAR_INT32, &run.parametric));
    EqmTry(TakeNumber(window, gmsh, at, EQM_SCALAR_UINT64, 2, &run.count));
    EqmTry(elements ? TakeElementBlock(window, gmsh, at, entity, &run, survey)
                    : TakeNodeBlock(window, gmsh, at, &run, survey));
    if (!elements) rows -= run.count;
  }
  return rows && !elements ? EQM_ERR_IO : 0;
}

/* On rank 0: nodes, then elements, then nothing. */
static PetscErrorCode GoThrough(const EqmPartFile *file, EqmGmsh *gmsh, PetscInt64 at, EqmGmshSurvey *survey)
{
  static const char *const names[] = {"$Nodes", "$Elements"}, *const ends[] = {"$EndNodes", "$EndElements"};
  EqmFileWindow window = {.file = file};
  PetscErrorCode code = 0;
  const char *bytes;

  for (int k = 0; k < 2 && !code; ++k) {
    code = TakeWord(&window, &at, names[k]);
    if (!code)
      code =
          (gmsh->version == 2 ? TakeSection2 : TakeSection4)(&window, gmsh, &at, k ? PETSC_TRUE : PETSC_FALSE, survey);
    if (!code) code = TakeWord(&window, &at, ends[k]);
  }
  while (!code && (bytes = EqmFileWindowAt(&window, at, 1)) != NULL && EqmIsSpace(*bytes)) ++at;
  if (at < file->length) code = EQM_ERR_IO;
  EqmTry(EqmFileWindowReset(&window));
  return code;
}

PetscErrorCode EqmGmshSurveyBytes(EqmGmsh *gmsh, const EqmPartFile *file, PetscInt64 begin, EqmGmshSurvey *survey,
                                  PetscBool *understood)
{
  PetscInt64 facts[2] = {0, 0};
  PetscMPIInt count;
  MPI_Datatype type;

  PetscFunctionBegin;
  if (file->rank == 0) {
    facts[0] = GoThrough(file, gmsh, begin, survey) ? 0 : 1;
    facts[1] = survey->num_runs;
  }
  PetscCallMPI(MPI_Bcast(facts, 2, MPIU_INT64, 0, file->comm));
  *understood = facts[0] ? PETSC_TRUE : PETSC_FALSE;
  if (!*understood) PetscFunctionReturn(0);
  survey->num_runs = facts[1];
  if (file->rank) PetscCall(PetscMalloc1(survey->num_runs, &survey->runs));
  PetscCall(PetscMPIIntCast((PetscInt)survey->num_runs, &count));
  PetscCallMPI(MPI_Type_contiguous(sizeof(EqmGmshRun) / sizeof(PetscInt64), MPIU_INT64, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  PetscCallMPI(MPI_Bcast(survey->runs, count, type, 0, file->comm));
  PetscCallMPI(MPI_Type_free(&type));
  PetscFunctionReturn(0);
}
