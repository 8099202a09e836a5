/* Attributes of HDF5 files: of the root, and of arrays. */
#include "h5/h5.h"
#include <string.h>
#include <time.h>

/* Longest text of an attribute: HDF5 keeps attributes of up to 64 KiB in the object header. */
#define LONGEST_TEXT 60000

/* Write an attribute of one element, or replace it; of an object or, with the file's handle, of the root. */
static PetscErrorCode PutOn(EqmH5 h5, hid_t object, const char *name, hid_t file_type, hid_t memory_type,
                            const void *value)
{
  hid_t space, attribute = H5I_INVALID_HID;
  PetscBool fine = PETSC_FALSE;
  htri_t there;

  PetscFunctionBegin;
  space = H5Screate(H5S_SCALAR);
  there = H5Aexists(object, name);
  if (there > 0) {
    attribute = H5Aopen(object, name, H5P_DEFAULT);
  } else if (there == 0 && space >= 0) {
    attribute = H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
  }
  if (attribute >= 0) {
    fine = (PetscBool)(H5Awrite(attribute, memory_type, value) >= 0);
    if (H5Aclose(attribute) < 0) fine = PETSC_FALSE;
  }
  if (space >= 0) (void)H5Sclose(space);
  PetscCall(EqmH5Agree(h5, fine, name));
  PetscFunctionReturn(0);
}

static PetscErrorCode Put(EqmH5 h5, const char *name, hid_t file_type, hid_t memory_type, const void *value)
{
  PetscFunctionBegin;
  PetscCall(PutOn(h5, h5->file, name, file_type, memory_type, value));
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

/* UTF-8 of that many bytes, or of any length: H5T_VARIABLE. */
static hid_t TextType(size_t length)
{
  const hid_t type = H5Tcopy(H5T_C_S1);

  if (type >= 0 && (H5Tset_size(type, length) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0)) {
    (void)H5Tclose(type);
    return H5I_INVALID_HID;
  }
  return type;
}

/* Write a root attribute, UTF-8 text, with rank 0's text, cut at 60,000 bytes. Readers such as h5py take a text of
   variable length for a string, one of fixed length for bytes. Errors: EQM_ERR_IO. Collective. */
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
  type = TextType(h5->fixed_texts ? (size_t)length : H5T_VARIABLE);
  error = EqmH5Agree(h5, (PetscBool)(type >= 0), name);
  if (!error) error = Put(h5, name, type, type, h5->fixed_texts ? (const void *)copy : (const void *)&copy);
  if (type >= 0) (void)H5Tclose(type);
  PetscCall(PetscFree(copy));
  PetscCall(error);
  PetscFunctionReturn(0);
}

/* An attribute's value; left alone where the object has none of that name and kind. */
static void GetFrom(hid_t object, const char *name, hid_t type, void *value)
{
  hid_t attribute;

  if (H5Aexists(object, name) <= 0) return;
  attribute = H5Aopen(object, name, H5P_DEFAULT);
  if (attribute < 0) return;
  (void)H5Aread(attribute, type, value);
  (void)H5Aclose(attribute);
}

static void Get(EqmH5 h5, const char *name, hid_t type, void *value)
{
  GetFrom(h5->file, name, type, value);
}

/* Read a root attribute as a real; `fallback` where there is none. Collective. */
PetscErrorCode EqmH5GetReal(EqmH5 h5, const char *name, PetscReal fallback, PetscReal *value)
{
  PetscFunctionBegin;
  *value = fallback;
  Get(h5, name, H5T_NATIVE_DOUBLE, value);
  PetscCall(EqmH5CheckMemory(h5));
  PetscFunctionReturn(0);
}

/* Read a root attribute as an integer; `fallback` where there is none. Collective. */
PetscErrorCode EqmH5GetInteger(EqmH5 h5, const char *name, PetscInt64 fallback, PetscInt64 *value)
{
  PetscFunctionBegin;
  *value = fallback;
  Get(h5, name, H5T_NATIVE_INT64, value);
  PetscCall(EqmH5CheckMemory(h5));
  PetscFunctionReturn(0);
}

/* The text of an attribute of variable length; left alone where it cannot be read. */
static PetscErrorCode ReadVariable(hid_t attribute, char *text, size_t length)
{
  const hid_t type = TextType(H5T_VARIABLE);
  char *found = NULL;

  PetscFunctionBegin;
  if (type >= 0 && H5Aread(attribute, type, &found) >= 0 && found) PetscCall(PetscStrncpy(text, found, length));
  if (found) (void)H5free_memory(found);
  if (type >= 0) (void)H5Tclose(type);
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadFixed(hid_t attribute, hid_t type, char *text, size_t length)
{
  const size_t size = H5Tget_size(type);
  char *buffer;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(size + 1, &buffer));
  if (H5Aread(attribute, type, buffer) >= 0) PetscCall(PetscStrncpy(text, buffer, length));
  PetscCall(PetscFree(buffer));
  PetscFunctionReturn(0);
}

/* Read a root attribute of text, of fixed or variable length; `fallback` where there is none. Collective. */
PetscErrorCode EqmH5GetText(EqmH5 h5, const char *name, const char *fallback, char *text, size_t length)
{
  hid_t attribute, type;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(text, fallback, length));
  attribute = H5Aexists(h5->file, name) > 0 ? H5Aopen(h5->file, name, H5P_DEFAULT) : H5I_INVALID_HID;
  PetscCall(EqmH5CheckMemory(h5));
  if (attribute < 0) PetscFunctionReturn(0);
  type = H5Aget_type(attribute);
  if (type >= 0 && H5Tget_class(type) == H5T_STRING) {
    if (H5Tis_variable_str(type) > 0)
      PetscCall(ReadVariable(attribute, text, length));
    else
      PetscCall(ReadFixed(attribute, type, text, length));
  }
  if (type >= 0) (void)H5Tclose(type);
  (void)H5Aclose(attribute);
  PetscCall(EqmH5CheckMemory(h5));
  PetscFunctionReturn(0);
}

/* The checksum of an array's contents (CRC-32 of the numbers as 64-bit words in the machine's order), kept with it as
   the attribute crc32; every rank knows it. Errors: EQM_ERR_IO. Collective. */
PetscErrorCode EqmH5PutChecksum(EqmH5 h5, const char *path, PetscInt64 checksum)
{
  hid_t dataset = H5Dopen2(h5->file, path, H5P_DEFAULT);
  PetscErrorCode error;

  PetscFunctionBegin;
  error = EqmH5Agree(h5, (PetscBool)(dataset >= 0), path);
  if (!error) error = PutOn(h5, dataset, "crc32", H5T_STD_I64LE, H5T_NATIVE_INT64, &checksum);
  if (dataset >= 0) (void)H5Dclose(dataset);
  PetscCall(error);
  PetscFunctionReturn(0);
}

/* -1 where there is none. Collective. */
PetscErrorCode EqmH5GetChecksum(EqmH5 h5, const char *path, PetscInt64 *checksum)
{
  hid_t dataset = H5Dopen2(h5->file, path, H5P_DEFAULT);

  PetscFunctionBegin;
  *checksum = -1;
  if (dataset >= 0) {
    GetFrom(dataset, "crc32", H5T_NATIVE_INT64, checksum);
    (void)H5Dclose(dataset);
  }
  PetscCall(EqmH5CheckMemory(h5));
  PetscFunctionReturn(0);
}

/* Who made the file, when and how. `options` are those of the run. Errors: EQM_ERR_IO. Collective. */
PetscErrorCode EqmH5PutProvenance(EqmH5 h5, const char *mesh_file, PetscInt ranks)
{
  char *options = NULL, date[32] = "";
  const time_t now = time(NULL);
  struct tm parts;

  PetscFunctionBegin;
  if (gmtime_r(&now, &parts)) (void)strftime(date, sizeof(date), "%Y-%m-%dT%H:%M:%SZ", &parts);
  PetscCall(EqmH5PutText(h5, "version", EqmVersion()));
  PetscCall(EqmH5PutText(h5, "git_commit", EqmCommit()));
  PetscCall(EqmH5PutText(h5, "date", date));
  PetscCall(PetscOptionsGetAll(NULL, &options));
  PetscCall(EqmH5PutText(h5, "options", options));
  PetscCall(PetscFree(options));
  PetscCall(EqmH5PutText(h5, "mesh_file", mesh_file));
  PetscCall(EqmH5PutInteger(h5, "ranks", ranks));
  PetscFunctionReturn(0);
}
