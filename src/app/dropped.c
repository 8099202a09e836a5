/* What of an input is not in the files that are written. */
#include "app.h"
#include "format/format.h"
#include "mesh/soup_private.h"
#include <string.h>

PetscErrorCode EqmPrintDropped(EqmSoup soup, const char *files, PetscBool is_map)
{
  char text[512], **names;
  int count;

  PetscFunctionBegin;
  PetscCall(PetscStrToArray(files, ',', &count, &names));
  for (int k = 0; k < count; k++) {
    EqmFormatDescribeDropped(names[k], is_map, soup->num_fields, soup->fields, text, sizeof(text));
    if (text[0]) PetscCall(PetscPrintf(soup->comm, "note: not in %s: %s of %s\n", names[k], text, soup->file));
  }
  PetscCall(PetscStrToArrayDestroy(count, names));
  if (soup->left[0] && !is_map)
    PetscCall(PetscPrintf(soup->comm, "note: left out: %s of %s\n", soup->left, soup->file));
  PetscFunctionReturn(0);
}
