/* The version macros of the headers compare as PETSc's do and agree with the library. */
#include <equimap/base.h>
#include "support/testing.h"

int main(int argc, char **argv)
{
  char text[64];
  PetscBool same;

  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(PetscSNPrintf(text, sizeof(text), "%d.%d.%d", EQUIMAP_VERSION_MAJOR, EQUIMAP_VERSION_MINOR,
                          EQUIMAP_VERSION_SUBMINOR));
  PetscCall(PetscStrcmp(text, EqmVersion(), &same));
  CHECK(same, "headers %s, library %s", text, EqmVersion());
  CHECK(EQUIMAP_VERSION_GE(0, 0, 99) && !EQUIMAP_VERSION_LT(0, 0, 99), "an earlier minor version");
  CHECK(!EQUIMAP_VERSION_GE(EQUIMAP_VERSION_MAJOR + 1, 0, 0), "the next major version");
  CHECK(!EQUIMAP_VERSION_GT(EQUIMAP_VERSION_MAJOR, EQUIMAP_VERSION_MINOR, EQUIMAP_VERSION_SUBMINOR), "itself");
  CHECK(EQUIMAP_VERSION_LE(EQUIMAP_VERSION_MAJOR, EQUIMAP_VERSION_MINOR, EQUIMAP_VERSION_SUBMINOR), "itself");
  CHECK(EQUIMAP_VERSION_LT(EQUIMAP_VERSION_MAJOR, EQUIMAP_VERSION_MINOR, EQUIMAP_VERSION_SUBMINOR + 1), "the next");
  CHECK(EQUIMAP_VERSION_LT(EQUIMAP_VERSION_MAJOR, EQUIMAP_VERSION_MINOR + 1, 0), "the next minor version");
  PetscCall(EqmFinalize());
  return 0;
}
