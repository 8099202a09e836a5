/* Text files that every rank reads a part of: the same mesh, with all that belongs to it, as one rank reads alone,
   wherever the parts are cut; and files that are not as they should be are left to the reader on one rank. */
#include "support/parts.h"

static PetscErrorCode TestObj(Text *text)
{
  static const char *const ends[] = {"\n", "\r\n", "\r"};
  static const struct {
    int kinds;
    PetscInt num_fields;
  } cases[] = {{0, 0},
               {BACKWARDS, 0},
               {QUADS | MIXED, 1},
               {TEXTURE | BACKWARDS | MIXED, 1},
               {GROUPS, 1},
               {QUADS | TEXTURE | GROUPS | NUMBERS | MIXED | BACKWARDS, 3},
               {QUADS | TEXTURE | NUMBERS | BACKWARDS, 3}};

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(cases); k++) {
    for (PetscInt n = 2; n <= 23; n += 7) {
      MakeObjText(text, n, cases[k].kinds, ends[((size_t)n + k) % 3]);
      PetscCall(CheckRead(text, cases[k].num_fields));
    }
  }
  MakeObjText(text, 9, 0, "\n");
  Line(text, "f 1 2 82");
  PetscCall(CheckRefused(text, EQM_ERR_IO));
  MakeObjText(text, 9, BACKWARDS, "\n");
  Line(text, "f -1 -2 -82");
  PetscCall(CheckRefused(text, EQM_ERR_IO));
  MakeObjText(text, 9, 0, "\n");
  memcpy(strstr(text->bytes + text->length / 2, "f "), "v ", 2); /* counts as a vertex, and is none */
  text->bytes[text->length / 2 + 200] = '?';
  PetscCall(CheckRefused(text, EQM_ERR_IO));
  *text = (Text){.end = "\n"};
  for (int k = 0; k < 50; k++) Line(text, "v %d 0 0", k);
  PetscCall(CheckRefused(text, EQM_ERR_MESH));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  static const char *const suffixes[] = {"obj"};
  Text *text;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(MakeFolder());
  PetscCall(PetscMalloc1(1, &text));
  Name("obj");
  PetscCall(TestObj(text));
  PetscCall(PetscFree(text));
  PetscCall(RemoveFolder(PETSC_STATIC_ARRAY_LENGTH(suffixes), suffixes));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
