/* Arrays of HDF5 files: declared, then written or read in slabs, all collectively. */
#include "h5/h5.h"

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
  if (slab.total == 0) PetscFunctionReturn(0); /* an array without rows takes no space in the file */
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

/* Whether there is an array of that name. Collective. */
PetscErrorCode EqmH5HasDataset(EqmH5 h5, const char *path, PetscBool *has)
{
  hid_t dataset;

  PetscFunctionBegin;
  dataset = H5Dopen2(h5->file, path, H5P_DEFAULT);
  *has = (PetscBool)(dataset >= 0);
  if (dataset >= 0) (void)H5Dclose(dataset);
  PetscCall(EqmH5CheckMemory(h5));
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

/* Refuse rows that PetscInt cannot count or that the file cannot hold, so that a small file asks for no large memory.
   Errors: EQM_ERR_IO. Collective. */
PetscErrorCode EqmH5CheckRows(EqmH5 h5, const char *path, PetscInt64 total)
{
  const hsize_t best_packing = 1032; /* of HDF5's deflate filter */
  hsize_t file_bytes = 0;
  char what[EQM_MESSAGE_MAX / 2];

  PetscFunctionBegin;
  (void)snprintf(what, sizeof(what), "%s has %lld rows: too many for the file, or for indices", path, (long long)total);
  if (H5Fget_filesize(h5->file, &file_bytes) < 0) file_bytes = 0;
  PetscCall(EqmH5Agree(h5,
                       (PetscBool)(total >= 0 && total <= PETSC_MAX_INT && (hsize_t)total / best_packing <= file_bytes),
                       what));
  PetscFunctionReturn(0);
}
