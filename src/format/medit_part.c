/* Medit's text of which every rank reads a part. The format is words and numbers between blanks, whatever the lines: a
   section's rows are known by their places among all of them, once the ranks have told each other of the keywords. */
#include "medit_part.h"

#include <ctype.h>

/* Of keywords: those of cells are their places in EqmMeditKinds. */
enum { DIMENSION = EQM_MEDIT_NUM_KINDS, VERTICES, END, NUM_KEYWORDS };
enum { MOST_KEYWORDS = 4096 }; /* of a file: others are left to one rank */

/* A keyword: where it stands among the words and numbers of the file, and the number behind it. */
typedef struct {
  PetscInt64 keyword, place, number, has_number; /* 1; 0: none; -1: it is another part's */
} Keyword;

/* What a rank has seen in its part. */
typedef struct {
  PetscInt64 num_words, num_keywords;
  PetscInt64 number, has_number; /* of the first word */
  Keyword keyword[MOST_KEYWORDS];
} Survey;

/* A section whose rows are read. */
typedef struct {
  const EqmMeditKind *kind; /* NULL: vertices */
  PetscInt64 first, count, width;
} Section;

typedef struct {
  EqmBuilder *builder;
  PetscInt64 dimension, num_vertices, num_sections;
  Section section[MOST_KEYWORDS];
} Plan;

static int KeywordOf(const char *word, size_t length)
{
  if (EqmWordIs(word, length, "End")) return END;
  if (EqmWordIs(word, length, "Dimension")) return DIMENSION;
  if (EqmWordIs(word, length, "Vertices")) return VERTICES;
  for (int k = 0; k < EQM_MEDIT_NUM_KINDS; ++k) {
    if (EqmWordIs(word, length, EqmMeditKinds[k].keyword)) return k;
  }
  return NUM_KEYWORDS;
}

/* The number at the cursor, which stays. */
static void LookAtNumber(EqmInput in, PetscInt64 *number, PetscInt64 *has_number)
{
  EqmSkipSpace(&in, '#');
  *has_number = in.cursor == in.end ? -1 : EqmReadInteger(&in, number) ? 1 : 0;
}

/* Count words, and note the keywords. False: too many. */
static PetscBool SurveyWords(EqmInput *in, Survey *survey)
{
  const char *word;

  LookAtNumber(*in, &survey->number, &survey->has_number);
  for (EqmSkipSpace(in, '#'); in->cursor < in->end; EqmSkipSpace(in, '#'), ++survey->num_words) {
    const size_t length = EqmReadWord(in, &word);
    const int keyword = isalpha((unsigned char)*word) ? KeywordOf(word, length) : NUM_KEYWORDS;
    Keyword *const found = &survey->keyword[survey->num_keywords];

    if (keyword == NUM_KEYWORDS) continue;
    if (survey->num_keywords == MOST_KEYWORDS) return PETSC_FALSE;
    *found = (Keyword){.keyword = keyword, .place = survey->num_words};
    LookAtNumber(*in, &found->number, &found->has_number);
    survey->num_keywords++;
  }
  return PETSC_TRUE;
}

/* The number behind the last keyword of a part is the first word of the next part that has any. */
static void CompleteKeywords(PetscMPIInt size, const PetscInt64 (*head)[4], PetscInt64 num, Keyword *keyword)
{
  PetscInt64 next = 0;

  for (PetscMPIInt r = 0; r < size; ++r) {
    next += head[r][1];
    if (!head[r][1] || keyword[next - 1].has_number >= 0) continue;
    for (PetscMPIInt s = r + 1; s < size && keyword[next - 1].has_number < 0; ++s) {
      keyword[next - 1].number = head[s][2];
      keyword[next - 1].has_number = head[s][3];
    }
  }
  for (PetscInt64 k = 0; k < num; ++k) keyword[k].has_number = PetscMax(0, keyword[k].has_number);
}

/* Bring all keywords to all ranks, in the order of the file, with their places in it: `num` in `all`, which is to be
   freed. `before` and `total` are counts of words. `fine` is false on every rank where there are too many. Collective.
 */
static PetscErrorCode ShareKeywords(MPI_Comm comm, Survey *survey, PetscInt64 *before, PetscInt64 *total,
                                    PetscInt64 *num, Keyword **all, PetscBool *fine)
{
  const PetscInt64 mine[4] = {survey->num_words, survey->num_keywords, survey->number, survey->has_number};
  PetscInt64(*head)[4];
  PetscMPIInt rank, size, *count, *start;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc3(size, &head, size, &count, size + 1, &start));
  PetscCallMPI(MPI_Allgather(mine, 4, MPIU_INT64, head, 4, MPIU_INT64, comm));
  *before = *total = *num = 0;
  for (PetscMPIInt r = 0; r < size; ++r) {
    if (r == rank) *before = *total;
    *total += head[r][0];
    start[r] = 4 * (PetscMPIInt)*num;
    count[r] = 4 * (PetscMPIInt)head[r][1];
    *num += head[r][1];
    if (*num > MOST_KEYWORDS) *fine = PETSC_FALSE;
    if (!*fine) break;
  }
  PetscCall(PetscMalloc1(*num, all));
  for (PetscInt64 k = 0; k < survey->num_keywords; ++k) survey->keyword[k].place += *before;
  if (*fine) {
    PetscCallMPI(MPI_Allgatherv(survey->keyword, count[rank], MPIU_INT64, *all, count, start, MPIU_INT64, comm));
    CompleteKeywords(size, (const PetscInt64(*)[4])head, *num, *all);
  }
  PetscCall(PetscFree3(head, count, start));
  PetscFunctionReturn(0);
}

/* The rows of a section behind its count, if the file has them; `next`: the word behind those that are read. */
static PetscBool AddSection(Plan *plan, const EqmMeditKind *kind, const Keyword *keyword, PetscInt64 total,
                            PetscInt64 *next)
{
  Section *const section = &plan->section[plan->num_sections];

  *section = (Section){.kind = kind,
                       .first = keyword->place + 2,
                       .count = keyword->number,
                       .width = 1 + (kind ? kind->num_corners : (PetscInt)plan->dimension)};
  if (section->count < 0 || section->count > (total - section->first) / section->width) return PETSC_FALSE;
  if (kind && !kind->wanted) return PETSC_TRUE;
  *next = section->first + section->count * section->width;
  plan->num_sections++;
  return PETSC_TRUE;
}

/* What the keywords say: the sections that are read, up to the end. False: one rank shall say what is wrong. */
static PetscBool MakePlan(PetscInt64 num, const Keyword *keyword, PetscInt64 total, Plan *plan)
{
  PetscInt64 next = 1; /* behind MeshVersionFormatted */
  PetscBool has_vertices = PETSC_FALSE;

  for (PetscInt64 k = 0; k < num; ++k) {
    const Keyword *const word = &keyword[k];
    const EqmMeditKind *const kind = word->keyword < EQM_MEDIT_NUM_KINDS ? &EqmMeditKinds[word->keyword] : NULL;

    if (word->place < next) continue; /* within rows: will not be read as a number */
    if (word->keyword == END) return has_vertices;
    if (!word->has_number) return PETSC_FALSE;
    next = word->place + 2;
    if (word->keyword == DIMENSION) {
      plan->dimension = word->number;
      if (plan->dimension != 2 && plan->dimension != 3) return PETSC_FALSE;
    } else if (word->keyword == VERTICES) {
      if (has_vertices || !plan->dimension || !AddSection(plan, NULL, word, total, &next)) return PETSC_FALSE;
      has_vertices = PETSC_TRUE;
      plan->num_vertices = word->number;
      if (plan->num_vertices > PETSC_MAX_INT) return PETSC_FALSE;
    } else if (!AddSection(plan, kind, word, total, &next) ||
               EqmMeditStartCells(plan->builder, kind, plan->num_vertices, word->number)) {
      return PETSC_FALSE;
    }
  }
  return PETSC_FALSE;
}

/* Move over so many words. */
static void SkipWords(EqmInput *in, PetscInt64 count)
{
  const char *word;

  for (; count > 0; --count) {
    EqmSkipSpace(in, '#');
    (void)EqmReadWord(in, &word);
  }
}

/* The first row of a section that begins at a word or behind it. */
static PetscInt64 RowFrom(const Section *section, PetscInt64 word)
{
  const PetscInt64 row = word <= section->first ? 0 : (word - section->first + section->width - 1) / section->width;

  return PetscMin(row, section->count);
}

/* This rank's rows, whose words are those from `before` to `end` of the file. */
static PetscErrorCode ReadRows(EqmInput *in, Plan *plan, PetscInt64 before, PetscInt64 end)
{
  PetscInt64 at = before;

  for (PetscInt64 s = 0; s < plan->num_sections; ++s) {
    const Section *const section = &plan->section[s];
    const PetscInt64 low = RowFrom(section, before), high = RowFrom(section, end),
                     first = section->first + low * section->width;

    if (low == high) continue;
    if (section->first + high * section->width > end) return EQM_ERR_IO; /* a row in two parts */
    SkipWords(in, first - at);
    if (section->kind)
      EqmTry(EqmMeditReadCells(plan->builder, section->kind, plan->num_vertices, high - low));
    else
      EqmTry(EqmMeditReadVertices(plan->builder, section->width - 1, high - low));
    at = first + (high - low) * section->width;
  }
  return 0;
}

/* Survey, agree, read. Collective. */
static PetscErrorCode ReadPart(const EqmPartFile *file, EqmInput *in, Survey *survey, Plan *plan, PetscBool *understood)
{
  PetscInt64 before, total, num;
  Keyword *keyword;

  PetscFunctionBegin;
  if (!SurveyWords(in, survey)) *understood = PETSC_FALSE;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, understood, 1, MPIU_BOOL, MPI_LAND, file->comm));
  if (!*understood) PetscFunctionReturn(0);
  PetscCall(ShareKeywords(file->comm, survey, &before, &total, &num, &keyword, understood));
  if (*understood) *understood = MakePlan(num, keyword, total, plan);
  PetscCall(PetscFree(keyword));
  if (!*understood) PetscFunctionReturn(0);
  EqmBuilderSetGroup(plan->builder, 0);
  in->cursor = in->start;
  if (file->rank == 0) EqmSkipMark(in);
  if (ReadRows(in, plan, before, before + survey->num_words)) *understood = PETSC_FALSE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeditParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood)
{
  char unused[EQM_MESSAGE_MAX];
  EqmBuilder builder;
  EqmFilePart part;
  Survey *survey;
  EqmInput in;
  Plan *plan;

  PetscFunctionBegin;
  PetscCall(PetscNew(&survey));
  PetscCall(PetscNew(&plan));
  PetscCall(EqmPartFileLines(file, 0, NULL, &part, understood));
  EqmInputOpen(&in, part.bytes, *understood ? part.length : 0, unused, sizeof(unused));
  EqmBuilderOpen(&builder, &in);
  plan->builder = &builder;
  if (file->rank == 0) EqmSkipMark(&in);
  if (*understood && EqmMeditBegins(file->head, file->head_length))
    PetscCall(ReadPart(file, &in, survey, plan, understood));
  else
    *understood = PETSC_FALSE;
  PetscCall(PetscFree(part.bytes));
  EqmInputOpen(&in, NULL, 0, unused, sizeof(unused));
  PetscCall(EqmBuilderFinishPart(&builder, file->comm, understood, mesh));
  PetscCall(PetscFree(survey));
  PetscCall(PetscFree(plan));
  PetscFunctionReturn(0);
}
