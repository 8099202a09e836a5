/* VTU and VTP files of which every rank reads a part of each array. The first rank makes an outline of the document, in
   which the texts of arrays are replaced by where they are; all ranks parse that. Documents with characters outside
   ASCII, entities or comments are not understood. */
#include "format.h"
#include "vtu.h"

#include <string.h>

enum { LONGEST_OUTLINE = 1 << 24 };

/* A text that grows. */
typedef struct {
  size_t length;
  char *text; /* LONGEST_OUTLINE bytes */
} Outline;

/* Append bytes [from, to) of the file. */
static PetscBool Copy(EqmFileWindow *window, PetscInt64 from, PetscInt64 to, Outline *outline)
{
  const char *bytes;

  if (to - from > EQM_PART_HEAD || outline->length + (size_t)(to - from) > LONGEST_OUTLINE - 64) return PETSC_FALSE;
  bytes = EqmFileWindowAt(window, from, (size_t)(to - from));
  if (!bytes) return PETSC_FALSE;
  memcpy(outline->text + outline->length, bytes, (size_t)(to - from));
  outline->length += (size_t)(to - from);
  return PETSC_TRUE;
}

/* Say where the text [from, to) is, unless it is blank. Text that is no array's does not matter. */
static PetscBool PutPlace(EqmFileWindow *window, PetscInt64 from, PetscInt64 to, Outline *outline)
{
  const char *c;

  while (from < to && (c = EqmFileWindowAt(window, from, 1)) != NULL && EqmIsSpace(*c)) ++from;
  if (from == to) return PETSC_TRUE;
  if (outline->length > LONGEST_OUTLINE - 128) return PETSC_FALSE;
  outline->length +=
      (size_t)snprintf(outline->text + outline->length, 64, "@%lld %lld", (long long)from, (long long)(to - from));
  return PETSC_TRUE;
}

/* Appended data follows its tag and an underscore; the document ends here. */
static PetscBool CloseAppended(EqmFileWindow *window, PetscInt64 tag_end, PetscInt64 *appended, Outline *outline)
{
  static const char tail[] = "</AppendedData></VTKFile>";
  const PetscInt64 underscore = EqmFileWindowFind(window, tag_end, '_');

  if (underscore < 0) return PETSC_FALSE;
  *appended = underscore + 1;
  memcpy(outline->text + outline->length, tail, sizeof(tail) - 1);
  outline->length += sizeof(tail) - 1;
  return PETSC_TRUE;
}

/* On rank 0: tag by tag. Comments and the like may hold anything: files with them are not understood. */
static PetscBool MakeOutline(const EqmPartFile *file, Outline *outline, PetscInt64 *appended)
{
  static const char tag[] = "<AppendedData";
  EqmFileWindow window = {.file = file};
  PetscInt64 at = 0, begin, end;
  PetscBool fine = PETSC_TRUE, done = PETSC_FALSE;

  *appended = 0;
  while (fine && !done && (begin = EqmFileWindowFind(&window, at, '<')) >= 0) {
    const char *bytes = EqmFileWindowAt(&window, begin, 2);

    fine = bytes && bytes[1] != '!' && PutPlace(&window, at, begin, outline) ? PETSC_TRUE : PETSC_FALSE;
    end = EqmFileWindowFind(&window, begin, '>');
    if (end < 0 || !fine || !Copy(&window, begin, end + 1, outline)) fine = PETSC_FALSE;
    bytes = fine ? EqmFileWindowAt(&window, begin, sizeof(tag) - 1) : NULL;
    if (bytes && !memcmp(bytes, tag, sizeof(tag) - 1)) {
      fine = CloseAppended(&window, end, appended, outline);
      done = PETSC_TRUE;
    }
    at = end + 1;
  }
  return EqmFileWindowReset(&window) ? PETSC_FALSE : fine;
}

/* The outline on all ranks; PetscFree its text. Collective. */
static PetscErrorCode ShareOutline(const EqmPartFile *file, Outline *outline, PetscInt64 *appended,
                                   PetscBool *understood)
{
  PetscInt64 facts[3] = {0, 0, 0};

  PetscFunctionBegin;
  outline->length = 0;
  PetscCall(PetscMalloc1(file->rank == 0 ? LONGEST_OUTLINE : 1, &outline->text));
  if (file->rank == 0) {
    facts[0] = MakeOutline(file, outline, &facts[1]);
    facts[2] = (PetscInt64)outline->length;
  }
  PetscCallMPI(MPI_Bcast(facts, 3, MPIU_INT64, 0, file->comm));
  *understood = facts[0] ? PETSC_TRUE : PETSC_FALSE;
  *appended = facts[1];
  outline->length = (size_t)facts[2];
  PetscCall(PetscRealloc(outline->length + 1, &outline->text));
  PetscCallMPI(MPI_Bcast(outline->text, (PetscMPIInt)facts[2], MPI_CHAR, 0, file->comm));
  PetscFunctionReturn(0);
}

/* Has this rank's share of the document only characters that need no parser of XML to be told to be right? The texts of
   arrays are not shown to it. */
static PetscBool IsPlain(const EqmPartFile *file, PetscInt64 length)
{
  EqmFileWindow window = {.file = file};
  PetscBool plain = PETSC_TRUE;
  PetscInt64 first, count;

  EqmPartFileShare(file, length, &first, &count);
  for (PetscInt64 at = first; at < first + count && plain;) {
    const size_t some = (size_t)PetscMin(EQM_PART_HEAD, first + count - at);
    const char *const bytes = EqmFileWindowAt(&window, at, some);

    if (!bytes) plain = PETSC_FALSE;
    for (size_t k = 0; k < some && plain; ++k) {
      const unsigned char c = (unsigned char)bytes[k];

      if (c == '&' || c == ']' || c > '~' || (c < ' ' && c != '\t' && c != '\n' && c != '\r')) plain = PETSC_FALSE;
    }
    at += (PetscInt64)some;
  }
  return EqmFileWindowReset(&window) ? PETSC_FALSE : plain;
}

/* One piece, and of a surface nothing but polygons: rows of fields are then those of the cells. */
static PetscBool IsSimple(xmlNodePtr root)
{
  static const char *const others[] = {"NumberOfVerts", "NumberOfLines", "NumberOfStrips"};
  const xmlNodePtr grid = EqmXmlChild(root, "UnstructuredGrid"), surface = EqmXmlChild(root, "PolyData");
  const xmlNodePtr piece = EqmXmlChild(grid ? grid : surface, "Piece");
  PetscInt64 count;

  if (!piece || EqmXmlNext(piece, "Piece")) return PETSC_FALSE;
  for (int k = 0; k < 3 && !grid; ++k) {
    if (EqmXmlInteger(piece, others[k], &count) && count) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

static PetscBool ParseOutline(EqmVtuEncoding *encoding, const Outline *outline, EqmBuilder *builder)
{
  xmlDocPtr document;
  PetscErrorCode code = EqmXmlParse(encoding->in, outline->text, outline->length, &document);

  if (!code && !IsSimple(xmlDocGetRootElement(document))) code = EQM_ERR_IO;
  if (!code) code = EqmVtuParseDocument(encoding, builder, xmlDocGetRootElement(document));
  if (document) xmlFreeDoc(document);
  return code ? PETSC_FALSE : PETSC_TRUE;
}

PetscErrorCode EqmVtuParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood)
{
  char unused[EQM_MESSAGE_MAX];
  EqmInput in;
  EqmBuilder builder;
  EqmVtuEncoding encoding = {.in = &in, .file = file, .file_bytes = (size_t)file->length};
  Outline outline;

  PetscFunctionBegin;
  EqmInputOpen(&in, NULL, 0, unused, sizeof(unused));
  EqmBuilderOpen(&builder, &in);
  PetscCall(ShareOutline(file, &outline, &encoding.appended_in_file, understood));
  if (*understood) *understood = IsPlain(file, encoding.appended_in_file ? encoding.appended_in_file : file->length);
  if (*understood) *understood = ParseOutline(&encoding, &outline, &builder);
  PetscCall(PetscFree(outline.text));
  PetscCall(EqmBuilderFinishPart(&builder, file->comm, understood, mesh));
  PetscFunctionReturn(0);
}
