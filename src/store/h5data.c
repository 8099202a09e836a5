/* Arrays and attributes of HDF5 files: declared, then written or read in slabs, all collectively. */
#include "h5.h"
#include <string.h>

/* Longest text of an attribute: HDF5 keeps attributes of up to 64 KiB in the object header. */
#define LONGEST_TEXT 60000

/* Groups on the way are made as needed; no fill values, for every entry will be written. */
static PetscErrorCode Declare(EqmH5 h5, const char *path, hid_t type, PetscInt total, PetscInt width)
{
  const hsize_t shape[2] = {(hsize_t)total, (hsize_t)width};
  hid_t space, link, creation, dataset = H5I_INVALID_HID;
  PetscBool fine = PETSC_FALSE;

  PetscFunctionBegin;
  space = H5Screate_simple(width > 0 ? 2 : 1, shape, NULL);
  link = H5Pcreate(H5P_LINK_CREATE);
  creation = H5Pcreate(H5P_DATASET_CREATE);
  if (space >= 0 && link >= 0 && creation >= 0 && H5Pset_create_intermediate_group(link, 1) >= 0 &&
      H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER) >= 0 && H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY) >= 0) {
    dataset = H5Dcreate2(h5->file, path, type, space, link, creation, H5P_DEFAULT);
    fine = (PetscBool)(dataset >= 0);
  }
  if (dataset >= 0 && H5Dclose(dataset) < 0) fine = PETSC_FALSE;
  if (creation >= 0) (void)H5Pclose(creation);
  if (link >= 0) (void)H5Pclose(link);
  if (space >= 0) (void)H5Sclose(space);
  PetscCall(EqmH5Agree(h5, fine, path));
  PetscFunctionReturn(0);
}

/* Announce an array of float64, total × width (total alone if width is 0). Errors: EQM_ERR_IO. Collective. */
PetscErrorCode EqmH5DeclareReals(EqmH5 h5, const char *path, PetscInt total, PetscInt width)
{
  PetscFunctionBegin;
  PetscCall(Declare(h5, path, H5T_IEEE_F64LE, total, width));
  PetscFunctionReturn(0);
}

/* Announce an array of int64. Errors: EQM_ERR_IO. Collective. */
PetscErrorCode EqmH5DeclareIntegers(EqmH5 h5, const char *path, PetscInt total, PetscInt width)
{
  PetscFunctionBegin;
  PetscCall(Declare(h5, path, H5T_STD_I64LE, total, width));
  PetscFunctionReturn(0);
}

/* Select this rank's slab in the file; a rank without rows takes part with an empty selection. */
static PetscBool Select(hid_t space, EqmSlab slab)
{
  const hsize_t start[2] = {(hsize_t)slab.start, 0};
  const hsize_t count[2] = {(hsize_t)slab.count, (hsize_t)slab.width};

  if (slab.count == 0) return (PetscBool)(H5Sselect_none(space) >= 0);
  return (PetscBool)(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0);
}

/* Open an array and the two selections of a transfer; an empty one still needs a space to select nothing of. */
static PetscBool OpenTransfer(EqmH5 h5, const char *path, EqmSlab slab, hid_t *dataset, hid_t *space, hid_t *memory)
{
  const hsize_t count[2] = {(hsize_t)PetscMax(slab.count, 1), (hsize_t)slab.width};

  *space = H5I_INVALID_HID;
  *dataset = H5Dopen2(h5->file, path, H5P_DEFAULT);
  if (*dataset >= 0) *space = H5Dget_space(*dataset);
  *memory = H5Screate_simple(slab.width > 0 ? 2 : 1, count, NULL);
  if (*space < 0 || *memory < 0 || !Select(*space, slab)) return PETSC_FALSE;
  return (PetscBool)(slab.count > 0 || H5Sselect_none(*memory) >= 0);
}

/* Read into `out`, or write `in` if there is no `out`. HDF5 wants a buffer even for no rows. */
static PetscErrorCode Transfer(EqmH5 h5, const char *path, hid_t type, EqmSlab slab, const void *in, void *out)
{
  const PetscInt64 nothing = 0;
  hid_t dataset, space, memory;
  herr_t moved = 0;
  PetscErrorCode error;

  PetscFunctionBegin;
  if (slab.total == 0) PetscFunctionReturn(0); /* an array without rows has no place in the file */
  error = EqmH5Agree(h5, OpenTransfer(h5, path, slab, &dataset, &space, &memory), path);
  if (!error) {
    if (out)
      moved = H5Dread(dataset, type, memory, space, h5->transfer, out);
    else
      moved = H5Dwrite(dataset, type, memory, space, h5->transfer, in ? in : &nothing);
    error = EqmH5Agree(h5, (PetscBool)(moved >= 0), path);
  }
  if (memory >= 0) (void)H5Sclose(memory);
  if (space >= 0) (void)H5Sclose(space);
  if (dataset >= 0) (void)H5Dclose(dataset);
  PetscCall(error);
  PetscFunctionReturn(0);
}

/* Write this rank's rows of a declared array. Errors: EQM_ERR_IO on all ranks. Collective. */
PetscErrorCode EqmH5WriteReals(EqmH5 h5, const char *path, EqmSlab slab, const PetscReal *values)
{
  PetscFunctionBegin;
  PetscCall(Transfer(h5, path, H5T_NATIVE_DOUBLE, slab, values, NULL));
  PetscFunctionReturn(0);
}

/* The same for integers. Collective. */
PetscErrorCode EqmH5WriteIntegers(EqmH5 h5, const char *path, EqmSlab slab, const PetscInt64 *values)
{
  PetscFunctionBegin;
  PetscCall(Transfer(h5, path, H5T_NATIVE_INT64, slab, values, NULL));
  PetscFunctionReturn(0);
}

/* Read this rank's rows of an array of numbers of any type. Errors: EQM_ERR_IO. Collective. */
PetscErrorCode EqmH5ReadReals(EqmH5 h5, const char *path, EqmSlab slab, PetscReal *values)
{
  PetscReal nothing;

  PetscFunctionBegin;
  PetscCall(Transfer(h5, path, H5T_NATIVE_DOUBLE, slab, NULL, values ? values : &nothing));
  PetscFunctionReturn(0);
}

/* The same for integers. Collective. */
PetscErrorCode EqmH5ReadIntegers(EqmH5 h5, const char *path, EqmSlab slab, PetscInt64 *values)
{
  PetscInt64 nothing;

  PetscFunctionBegin;
  PetscCall(Transfer(h5, path, H5T_NATIVE_INT64, slab, NULL, values ? values : &nothing));
  PetscFunctionReturn(0);
}

/* Write a root attribute of one element, or replace it. */
static PetscErrorCode Put(EqmH5 h5, const char *name, hid_t file_type, hid_t memory_type, const void *value)
{
  hid_t space, attribute = H5I_INVALID_HID;
  PetscBool fine = PETSC_FALSE;
  htri_t there;

  PetscFunctionBegin;
  space = H5Screate(H5S_SCALAR);
  there = H5Aexists(h5->file, name);
  if (there > 0) {
    attribute = H5Aopen(h5->file, name, H5P_DEFAULT);
  } else if (there == 0 && space >= 0) {
    attribute = H5Acreate2(h5->file, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
  }
  if (attribute >= 0) {
    fine = (PetscBool)(H5Awrite(attribute, memory_type, value) >= 0);
    if (H5Aclose(attribute) < 0) fine = PETSC_FALSE;
  }
  if (space >= 0) (void)H5Sclose(space);
  PetscCall(EqmH5Agree(h5, fine, name));
  PetscFunctionReturn(0);
}

/* Write a root attribute, float64, with rank 0's value. Errors: EQM_ERR_IO. Collective. */
PetscErrorCode EqmH5PutReal(EqmH5 h5, const char *name, PetscReal value)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&value, 1, MPIU_REAL, 0, h5->comm)); /* HDF5 wants the same bytes from every rank */
  PetscCall(Put(h5, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value));
  PetscFunctionReturn(0);
}

/* Write a root attribute, int64, with rank 0's value. Errors: EQM_ERR_IO. Collective. */
PetscErrorCode EqmH5PutInteger(EqmH5 h5, const char *name, PetscInt64 value)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&value, 1, MPIU_INT64, 0, h5->comm));
  PetscCall(Put(h5, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value));
  PetscFunctionReturn(0);
}

static hid_t TextType(size_t length)
{
  const hid_t type = H5Tcopy(H5T_C_S1);

  if (type >= 0 && (H5Tset_size(type, length) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0)) {
    (void)H5Tclose(type);
    return H5I_INVALID_HID;
  }
  return type;
}

/* Write a root attribute, UTF-8 text of fixed length, with rank 0's text, cut at 60,000 bytes. Errors: EQM_ERR_IO.
   Collective. */
PetscErrorCode EqmH5PutText(EqmH5 h5, const char *name, const char *text)
{
  PetscMPIInt length = (PetscMPIInt)PetscMin(strlen(text), LONGEST_TEXT) + 1;
  char *copy;
  hid_t type;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&length, 1, MPI_INT, 0, h5->comm));
  PetscCall(PetscCalloc1((size_t)length, &copy));
  if (h5->rank == 0) memcpy(copy, text, (size_t)length - 1);
  PetscCallMPI(MPI_Bcast(copy, length, MPI_CHAR, 0, h5->comm));
  type = TextType((size_t)length);
  error = EqmH5Agree(h5, (PetscBool)(type >= 0), name);
  if (!error) error = Put(h5, name, type, type, copy);
  if (type >= 0) (void)H5Tclose(type);
  PetscCall(PetscFree(copy));
  PetscCall(error);
  PetscFunctionReturn(0);
}

/* Whether there is an array of that name. Collective. */
PetscErrorCode EqmH5HasDataset(EqmH5 h5, const char *path, PetscBool *has)
{
  hid_t dataset;

  PetscFunctionBegin;
  dataset = H5Dopen2(h5->file, path, H5P_DEFAULT);
  *has = (PetscBool)(dataset >= 0);
  if (dataset >= 0) (void)H5Dclose(dataset);
  PetscFunctionReturn(0);
}

/* Rows and entries per row (0: one-dimensional) of an array. Errors: EQM_ERR_IO (no such array, more than two
   dimensions). Collective. */
PetscErrorCode EqmH5GetShape(EqmH5 h5, const char *path, PetscInt64 *total, PetscInt64 *width)
{
  hid_t dataset, space = H5I_INVALID_HID;
  hsize_t shape[2] = {0, 0};
  int rank = 0;

  PetscFunctionBegin;
  dataset = H5Dopen2(h5->file, path, H5P_DEFAULT);
  if (dataset >= 0) space = H5Dget_space(dataset);
  if (space >= 0) rank = H5Sget_simple_extent_ndims(space);
  if (rank == 1 || rank == 2) {
    if (H5Sget_simple_extent_dims(space, shape, NULL) < 0) rank = 0;
  } else {
    rank = 0;
  }
  if (space >= 0) (void)H5Sclose(space);
  if (dataset >= 0) (void)H5Dclose(dataset);
  PetscCall(EqmH5Agree(h5, (PetscBool)(rank > 0), path));
  *total = (PetscInt64)shape[0];
  *width = (PetscInt64)(rank == 2 ? shape[1] : 0);
  PetscFunctionReturn(0);
}

/* A root attribute's value; left alone where the file has none of that name and kind. */
static void Get(EqmH5 h5, const char *name, hid_t type, void *value)
{
  hid_t attribute;

  if (H5Aexists(h5->file, name) <= 0) return;
  attribute = H5Aopen(h5->file, name, H5P_DEFAULT);
  if (attribute < 0) return;
  (void)H5Aread(attribute, type, value);
  (void)H5Aclose(attribute);
}

/* Read a root attribute as a real; `fallback` where there is none. Collective. */
PetscErrorCode EqmH5GetReal(EqmH5 h5, const char *name, PetscReal fallback, PetscReal *value)
{
  PetscFunctionBegin;
  *value = fallback;
  Get(h5, name, H5T_NATIVE_DOUBLE, value);
  PetscFunctionReturn(0);
}

/* Read a root attribute as an integer; `fallback` where there is none. Collective. */
PetscErrorCode EqmH5GetInteger(EqmH5 h5, const char *name, PetscInt64 fallback, PetscInt64 *value)
{
  PetscFunctionBegin;
  *value = fallback;
  Get(h5, name, H5T_NATIVE_INT64, value);
  PetscFunctionReturn(0);
}

/* Read a root attribute of fixed-length text; `fallback` where there is none. Collective. */
PetscErrorCode EqmH5GetText(EqmH5 h5, const char *name, const char *fallback, char *text, size_t length)
{
  hid_t attribute, type;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(text, fallback, length));
  if (H5Aexists(h5->file, name) <= 0) PetscFunctionReturn(0);
  attribute = H5Aopen(h5->file, name, H5P_DEFAULT);
  if (attribute < 0) PetscFunctionReturn(0);
  type = H5Aget_type(attribute);
  if (type >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) {
    const size_t size = H5Tget_size(type);
    char *buffer;
    PetscCall(PetscCalloc1(size + 1, &buffer));
    if (H5Aread(attribute, type, buffer) >= 0) PetscCall(PetscStrncpy(text, buffer, length));
    PetscCall(PetscFree(buffer));
  }
  if (type >= 0) (void)H5Tclose(type);
  (void)H5Aclose(attribute);
  PetscFunctionReturn(0);
}
