/* Where the rows of nodes and elements are in the text of an MSH file: every rank looks at its lines, and tells the
   others of sections and of the headers of blocks, each of which says where the next one is. */
#include "gmsh.h"

#include <string.h>

enum { MOST_MARKS = 64, MOST_RUNS = 1000000 };

/* Sections behind the preamble, by number: 1, 2, ... begin, -1, -2, ... end. */
static const char *const section_names[] = {
    "Nodes",           "ParametricNodes", "Elements",      "NodeData",         "ElementData",
    "ElementNodeData", "Periodic",        "GhostElements", "Parametrizations", "InterpolationScheme",
    "Comments"};
enum { NODES = 1, PARAMETRIC_NODES, ELEMENTS, NODE_DATA, ELEMENT_DATA, NUM_SECTIONS = 11, UNKNOWN };

/* A line that begins or ends a section. */
typedef struct {
  PetscInt64 line, section;
} Mark;

/* Where this rank's lines begin that are not blank. */
static PetscErrorCode FindLines(const EqmPartFile *file, EqmGmshSurvey *survey)
{
  PetscInt64 capacity = 1024, end;
  char unused[8];
  EqmInput in;

  PetscFunctionBegin;
  EqmInputOpen(&in, survey->part.bytes, survey->part.length, unused, sizeof(unused));
  PetscCall(PetscMalloc1(capacity, &survey->line));
  for (EqmSkipSpace(&in, 0); in.cursor < in.end; EqmSkipSpace(&in, 0)) {
    if (survey->num_lines + 1 >= capacity) {
      capacity += capacity / 2;
      PetscCall(PetscRealloc(sizeof(PetscInt64) * (size_t)capacity, &survey->line));
    }
    survey->line[survey->num_lines++] = in.cursor - in.start;
    EqmSkipLine(&in);
  }
  survey->line[survey->num_lines] = in.end - in.start;
  PetscCallMPI(MPI_Scan(&survey->num_lines, &end, 1, MPIU_INT64, MPI_SUM, file->comm));
  survey->first_line = end - survey->num_lines;
  PetscFunctionReturn(0);
}

/* The section that a word `$...` begins or ends. */
static PetscInt64 SectionOf(const char *word, size_t length)
{
  const PetscInt64 sign = length > 4 && !memcmp(word, "$End", 4) ? -1 : 1;
  const size_t skipped = sign < 0 ? 4 : 1;

  for (PetscInt64 k = 0; k < NUM_SECTIONS; ++k) {
    if (strlen(section_names[k]) == length - skipped && !memcmp(section_names[k], word + skipped, length - skipped))
      return sign * (k + 1);
  }
  return UNKNOWN;
}

/* The marks of all lines, on every rank. Collective. */
static PetscErrorCode FindMarks(const EqmPartFile *file, const EqmGmshSurvey *survey, PetscInt *num, Mark **marks,
                                PetscBool *understood)
{
  PetscMPIInt count = 0, total = 0, *counts, *starts;
  Mark own[MOST_MARKS] = {{0, 0}};
  MPI_Datatype type;

  PetscFunctionBegin;
  for (PetscInt64 k = 0; k < survey->num_lines; ++k) {
    const char *const word = survey->part.bytes + survey->line[k], *end = word;

    if (*word != '$') continue;
    while (end < survey->part.bytes + survey->part.length && !EqmIsSpace(*end)) ++end;
    if (count < MOST_MARKS) own[count] = (Mark){survey->first_line + k, SectionOf(word, (size_t)(end - word))};
    if (count == MOST_MARKS) own[0].section = UNKNOWN; /* too many */
    count = PetscMin(count + 1, MOST_MARKS);
  }
  PetscCall(PetscMalloc2(file->size, &counts, file->size, &starts));
  PetscCallMPI(MPI_Allgather(&count, 1, MPI_INT, counts, 1, MPI_INT, file->comm));
  for (PetscMPIInt r = 0; r < file->size; total += counts[r++]) starts[r] = total;
  PetscCall(PetscMalloc1(total, marks));
  PetscCallMPI(MPI_Type_contiguous(2, MPIU_INT64, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  PetscCallMPI(MPI_Allgatherv(own, count, type, *marks, counts, starts, type, file->comm));
  PetscCallMPI(MPI_Type_free(&type));
  PetscCall(PetscFree2(counts, starts));
  *num = total;
  for (PetscMPIInt k = 0; k < total; ++k) {
    if ((*marks)[k].section == UNKNOWN) *understood = PETSC_FALSE;
  }
  PetscFunctionReturn(0);
}

/* Sections that end where they should and follow each other without a gap, nodes first, elements once. */
static PetscBool IsSound(PetscInt num, const Mark *marks, PetscInt64 num_lines, PetscInt version)
{
  PetscInt num_elements = 0;

  if (num < 4 || num % 2 || marks[0].line || marks[num - 1].line != num_lines - 1) return PETSC_FALSE;
  for (PetscInt k = 0; k < num; k += 2) {
    const PetscInt64 section = marks[k].section;
    const PetscBool is_nodes = section == NODES || section == PARAMETRIC_NODES ? PETSC_TRUE : PETSC_FALSE;

    if (section < 0 || marks[k + 1].section != -section || is_nodes != (k == 0)) return PETSC_FALSE;
    if (section == PARAMETRIC_NODES && version != 2) return PETSC_FALSE;
    if (k && marks[k].line != marks[k - 1].line + 1) return PETSC_FALSE;
    if (section == ELEMENTS) ++num_elements;
  }
  return num_elements == 1 ? PETSC_TRUE : PETSC_FALSE;
}

/* On the way through a section. For MPI all members are of one type. */
typedef struct {
  PetscInt64 line;     /* of the next header */
  PetscInt64 blocks;   /* that are still to come; -1: the section's own header is */
  PetscInt64 rows;     /* of nodes that are still to come */
  PetscInt64 num_runs; /* found so far */
  PetscInt64 fine;
} Walk;

/* The `num` numbers of a line that has no others. bytes - not 0: what the number counts takes so many at least,
   for which the rest of the file must have room. */
static PetscBool ReadLine(const EqmGmshSurvey *survey, const EqmPartFile *file, PetscInt64 line, PetscInt num,
                          const PetscInt64 *bytes, PetscInt64 *numbers)
{
  const PetscInt64 *const start = survey->line + (line - survey->first_line);
  char unused[8];
  EqmInput in;

  EqmInputOpen(&in, survey->part.bytes + start[0], (size_t)(start[1] - start[0]), unused, sizeof(unused));
  for (PetscInt k = 0; k < num; ++k) {
    if (!EqmReadInteger(&in, &numbers[k])) return PETSC_FALSE;
    if (bytes[k] && !EqmGmshHasRoom(file, survey->part.before + (in.cursor - survey->part.bytes), bytes[k], numbers[k]))
      return PETSC_FALSE;
  }
  return EqmAtLineEnd(&in);
}

/* Of a section: in version 2 the number of rows, in version 4 of blocks and rows, in 4.1 two tags more. */
static PetscErrorCode TakeSectionHeader(EqmGmsh *gmsh, const EqmPartFile *file, EqmGmshSurvey *survey,
                                        PetscInt64 section, Walk *walk)
{
  const PetscInt64 bytes[4] = {8, section == ELEMENTS ? 4 : 8, 0, 0};
  PetscInt64 number[4];

  walk->fine = ReadLine(survey, file, walk->line++, gmsh->version == 2 ? 1 : gmsh->version_4_0 ? 2 : 4, bytes, number);
  if (!walk->fine) return 0;
  walk->blocks = gmsh->version == 2 ? 0 : number[0];
  walk->rows = number[gmsh->version == 2 ? 0 : 1];
  if (gmsh->version == 4) return 0;
  const EqmGmshRun run = {.kind = section == ELEMENTS ? EQM_GMSH_ELEMENTS : EQM_GMSH_NODES,
                          .count = walk->rows,
                          .parametric = section == PARAMETRIC_NODES,
                          .first = walk->line};

  walk->line += walk->rows;
  walk->rows = 0;
  return EqmGmshAddRun(survey, &run);
}

/* Of a block of version 4: an entity (in 4.0 tag and dimension, later the other way round), parametric or type, rows.
 */
static PetscErrorCode TakeBlockHeader(EqmGmsh *gmsh, const EqmPartFile *file, EqmGmshSurvey *survey, PetscInt64 section,
                                      Walk *walk)
{
  static const PetscInt64 bytes[4] = {0, 0, 0, 2};
  PetscInt64 number[4], dimension;
  PetscInt unused;

  walk->fine = ReadLine(survey, file, walk->line++, 4, bytes, number);
  if (!walk->fine) return 0;
  dimension = number[gmsh->version_4_0 ? 1 : 0];
  EqmGmshRun run = {.count = number[3], .first = walk->line};

  if (survey->num_runs > MOST_RUNS) walk->fine = 0;
  if (section == ELEMENTS && EqmGmshNodesOfType(gmsh, number[2], &unused)) walk->fine = 0;
  if (!walk->fine) return 0;
  --walk->blocks;
  walk->line += run.count;
  if (section == ELEMENTS) {
    run.kind = EQM_GMSH_ELEMENTS;
    run.type = number[2];
    run.group = EqmGmshGroupOf(gmsh, dimension, number[gmsh->version_4_0 ? 0 : 1]);
    return EqmGmshAddRun(survey, &run);
  }
  walk->rows -= run.count;
  run.kind = gmsh->version_4_0 ? EQM_GMSH_NODES : EQM_GMSH_TAGS;
  run.parametric = number[2];
  run.dimension = dimension;
  EqmTry(EqmGmshAddRun(survey, &run));
  if (gmsh->version_4_0) return 0;
  run.kind = EQM_GMSH_POINTS;
  run.first = walk->line;
  walk->line += run.count;
  return EqmGmshAddRun(survey, &run);
}

/* The runs of a section: rank after rank goes on as far as its lines reach, and tells the others. Collective. */
static PetscErrorCode WalkSection(EqmGmsh *gmsh, const EqmPartFile *file, EqmGmshSurvey *survey, const Mark *marks,
                                  PetscBool *understood)
{
  const PetscInt64 section = marks[0].section;
  Walk walk = {.line = marks[0].line + 1, .blocks = -1, .num_runs = survey->num_runs, .fine = 1};
  const PetscMPIInt width = sizeof(EqmGmshRun) / sizeof(PetscInt64);
  MPI_Datatype type;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_contiguous(width, MPIU_INT64, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  for (PetscMPIInt r = 0; r < file->size; ++r) {
    const PetscInt64 known = survey->num_runs;
    EqmGmshRun *more;
    PetscMPIInt count;

    while (file->rank == r && walk.fine && walk.blocks && walk.line < marks[1].line &&
           walk.line < survey->first_line + survey->num_lines) {
      PetscCall(walk.blocks < 0 ? TakeSectionHeader(gmsh, file, survey, section, &walk)
                                : TakeBlockHeader(gmsh, file, survey, section, &walk));
    }
    walk.num_runs = file->rank == r ? survey->num_runs : known;
    PetscCallMPI(MPI_Bcast(&walk, sizeof(walk) / sizeof(PetscInt64), MPIU_INT64, r, file->comm));
    PetscCall(PetscMPIIntCast((PetscInt)(walk.num_runs - known), &count));
    PetscCall(PetscMalloc1(count, &more));
    if (file->rank == r && count) PetscCall(PetscArraycpy(more, survey->runs + known, count));
    PetscCallMPI(MPI_Bcast(more, count, type, r, file->comm));
    for (PetscMPIInt k = 0; k < count && file->rank != r; ++k) PetscCall(EqmGmshAddRun(survey, &more[k]));
    PetscCall(PetscFree(more));
  }
  PetscCallMPI(MPI_Type_free(&type));
  if (!walk.fine || walk.blocks || walk.line != marks[1].line || (section != ELEMENTS && walk.rows))
    *understood = PETSC_FALSE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGmshSurveyLines(EqmGmsh *gmsh, const EqmPartFile *file, PetscInt64 begin, EqmGmshSurvey *survey,
                                  PetscBool *understood)
{
  PetscInt64 num_lines;
  PetscInt num;
  Mark *marks;

  PetscFunctionBegin;
  PetscCall(EqmPartFileLines(file, begin, NULL, &survey->part, understood));
  if (!*understood) PetscFunctionReturn(0);
  PetscCall(FindLines(file, survey));
  PetscCall(MPIU_Allreduce(&survey->num_lines, &num_lines, 1, MPIU_INT64, MPI_SUM, file->comm));
  PetscCall(FindMarks(file, survey, &num, &marks, understood));
  if (*understood) *understood = IsSound(num, marks, num_lines, gmsh->version);
  for (PetscInt k = 0; k < num && *understood; k += 2) {
    const PetscInt64 section = marks[k].section;

    if (section <= ELEMENTS) PetscCall(WalkSection(gmsh, file, survey, marks + k, understood));
    if (section == NODE_DATA) EqmBuilderNoteLeft(&gmsh->builder, "$NodeData");
    if (section == ELEMENT_DATA) EqmBuilderNoteLeft(&gmsh->builder, "$ElementData");
  }
  PetscCall(PetscFree(marks));
  PetscFunctionReturn(0);
}
