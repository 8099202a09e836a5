/* Samples of every format, as they are and changed, read by all ranks in parts: what they understand is the mesh that
   one rank reads alone, to the bit; what that one refuses they do not understand. */
#include "support/parts.h"
#include "format_samples.h"
#include "mutations.h"

enum { MUTATIONS = 20, CUTS = 6 }; /* of each sample */

/* Samples that one rank reads alone, by their names' beginnings: arrays of text, several pieces, sets of texture
   coordinates of two kinds, numbers that do not keep to lines. */
static const char *const left_alone[] = {"PLY with texture points", "VTU ASCII", "MSH 2.2 binary, parameters"};

static PetscBool IsLeftAlone(const char *name)
{
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(left_alone); k++) {
    if (!strncmp(name, left_alone[k], strlen(left_alone[k]))) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Every rank parses the bytes alone, too. */
static PetscErrorCode TryParts(const char *what, const char *bytes, size_t length, PetscBool *understood)
{
  const EqmFormat *const format = EqmFormatOfContent(bytes, length);
  EqmSerialMesh mesh = {0}, part;
  EqmSoup alone, together;
  char error[256] = "";
  PetscErrorCode code;

  PetscFunctionBegin;
  *understood = PETSC_FALSE;
  if (!format || !format->parse_part) PetscFunctionReturn(0);
  PetscCall(WriteFile(file, bytes, length));
  PetscCall(ReadInParts(file, format, &part, understood));
  if (*understood) {
    code = format->parse(bytes, length, &mesh, error, sizeof(error));
    CHECK(!code, "%s is understood in parts, and alone: %s", what, error);
    PetscCall(EqmSoupCreateFromRoot(PETSC_COMM_SELF, &mesh, file, &alone));
    PetscCall(EqmSoupCreateFromParts(PETSC_COMM_WORLD, &part, file, &together));
    PetscCall(CheckSame(what, alone, together));
    PetscCall(EqmSoupDestroy(&alone));
    PetscCall(EqmSoupDestroy(&together));
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD)); /* before the file changes */
  PetscFunctionReturn(0);
}

static PetscErrorCode TestSample(const Sample *s, PetscInt which)
{
  const EqmFormat *const format = EqmFormatOfContent(s->bytes, s->length);
  uint64_t state = (uint64_t)which;
  Sample *changed;
  PetscBool understood;
  char what[256];

  PetscFunctionBegin;
  PetscCall(TryParts(s->name, s->bytes, s->length, &understood));
  CHECK(understood == (format->parse_part && !IsLeftAlone(s->name)), "%s is%s understood in parts", s->name,
        understood ? "" : " not");
  if (!understood) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(1, &changed));
  for (size_t k = 0; k < CUTS; k++) {
    snprintf(what, sizeof(what), "%s, cut to %zu of %d", s->name, k, CUTS);
    PetscCall(TryParts(what, s->bytes, s->length * k / CUTS, &understood));
  }
  for (int k = 0; k < MUTATIONS; k++) {
    *changed = *s;
    snprintf(what, sizeof(what), "%s, mutation %d", s->name, k);
    PetscCall(TryParts(what, changed->bytes, Mutate(changed->bytes, s->length, &state), &understood));
  }
  PetscCall(PetscFree(changed));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  static const char *const suffixes[] = {"any"};
  Sample *samples;
  int count;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(MakeFolder());
  Name(suffixes[0]);
  PetscCall(PetscMalloc1(MAX_SAMPLES, &samples));
  count = MakeSamples(samples);
  for (int i = 0; i < count; i++) PetscCall(TestSample(&samples[i], i));
  PetscCall(PetscFree(samples));
  PetscCall(RemoveFolder(1, suffixes));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
