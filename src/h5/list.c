/* Which arrays a group of an HDF5 file has. */
#include "h5/h5.h"
#include <string.h>

enum { MOST_ARRAYS = 256 };

typedef struct {
  PetscInt num;
  char (*names)[EQM_H5_NAME];
} List;

/* Is it an array of one or two dimensions of numbers? */
static PetscBool IsNumbers(hid_t group, const char *name)
{
  const hid_t dataset = H5Dopen2(group, name, H5P_DEFAULT);
  hid_t type = H5I_INVALID_HID, space = H5I_INVALID_HID;
  PetscBool is = PETSC_FALSE;
  H5T_class_t kind;
  int rank;

  if (dataset < 0) return PETSC_FALSE;
  type = H5Dget_type(dataset);
  space = H5Dget_space(dataset);
  if (type >= 0 && space >= 0) {
    kind = H5Tget_class(type);
    rank = H5Sget_simple_extent_ndims(space);
    is = (PetscBool)((kind == H5T_INTEGER || kind == H5T_FLOAT) && (rank == 1 || rank == 2));
  }
  if (type >= 0) (void)H5Tclose(type);
  if (space >= 0) (void)H5Sclose(space);
  (void)H5Dclose(dataset);
  return is;
}

static herr_t Visit(hid_t group, const char *name, const H5L_info_t *info, void *context)
{
  List *const list = context;

  (void)info;
  if (list->num == MOST_ARRAYS) return 1;
  if (strlen(name) < EQM_H5_NAME && IsNumbers(group, name)) strcpy(list->names[list->num++], name);
  return 0;
}

/* The arrays of numbers in a group, of one or two dimensions, in the order of their names; none if there is no such
   group. names - to be freed with PetscFree. Collective. */
PetscErrorCode EqmH5ListNumbers(EqmH5 h5, const char *group, PetscInt *num, char (**names)[EQM_H5_NAME])
{
  List list = {0};
  hid_t object;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(MOST_ARRAYS, &list.names));
  if (H5Lexists(h5->file, group, H5P_DEFAULT) > 0) {
    object = H5Gopen2(h5->file, group, H5P_DEFAULT);
    if (object >= 0) {
      (void)H5Literate(object, H5_INDEX_NAME, H5_ITER_INC, NULL, Visit, &list);
      (void)H5Gclose(object);
    }
  }
  PetscCall(EqmH5CheckMemory(h5));
  *num = list.num;
  *names = list.names;
  PetscFunctionReturn(0);
}
