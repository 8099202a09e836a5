/* The table of mesh formats, and what is looked up in it. */
#include "format.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

/* The order is that of recognition: formats that say clearly what they are come first. */
static const EqmFormat formats[] = {
    {"HDF5", "h5 hdf5", EqmRecogniseHdf5, NULL, NULL, EqmSoupReadHdf5, EqmSoupWriteHdf5, NULL},
    {"PLY", "ply", EqmRecognisePly, EqmParsePly, EqmWritePly, NULL, NULL, NULL},
    {"VTU", "vtu", EqmRecogniseVtu, EqmParseVtu, EqmWriteVtu, NULL, NULL, NULL},
    {"VTP", "vtp", EqmRecogniseVtu, EqmParseVtu, NULL, NULL, NULL, NULL},
    {"GIFTI", "gii", EqmRecogniseGifti, EqmParseGifti, EqmWriteGifti, NULL, NULL, NULL},
    {"legacy VTK", "vtk", EqmRecogniseVtk, EqmParseVtk, EqmWriteVtk, NULL, NULL, NULL},
    {"Gmsh MSH", "msh", EqmRecogniseGmsh, EqmParseGmsh, EqmWriteGmsh, NULL, NULL, NULL},
    {"Medit mesh", "mesh", EqmRecogniseMedit, EqmParseMedit, EqmWriteMedit, NULL, NULL, NULL},
    {"Medit meshb", "meshb", EqmRecogniseMeshb, EqmParseMeshb, EqmWriteMeshb, NULL, NULL, NULL},
    {"OFF", "off coff noff", EqmRecogniseOff, EqmParseOff, EqmWriteOff, NULL, NULL, NULL},
    {"STL", "stl", EqmRecogniseStl, EqmParseStl, EqmWriteStl, NULL, NULL, NULL},
    {"TetGen", "node ele", EqmRecogniseTetgen, EqmParseTetgen, EqmWriteTetgen, NULL, NULL, EqmLoadTetgen},
    {"OBJ", "obj", EqmRecogniseObj, EqmParseObj, EqmWriteObj, NULL, NULL, NULL},
};

#define NUM_FORMATS (sizeof(formats) / sizeof(formats[0]))

/* EqmFormatAt - a row of the table, or NULL behind its end. Not collective. */
const EqmFormat *EqmFormatAt(PetscInt row)
{
  return row >= 0 && (size_t)row < NUM_FORMATS ? &formats[row] : NULL;
}

/* EqmFormatOfContent - the format that a file's bytes show, or NULL. Not collective. */
const EqmFormat *EqmFormatOfContent(const char *bytes, size_t length)
{
  for (size_t i = 0; i < NUM_FORMATS; ++i) {
    if (formats[i].recognise(bytes, length)) return &formats[i];
  }
  return NULL;
}

/* Is `suffix` one of the words of `list`, in upper or lower case? */
static PetscBool IsListed(const char *list, const char *suffix, size_t length)
{
  for (const char *word = list; *word; word += strcspn(word, " "), word += strspn(word, " ")) {
    if (strcspn(word, " ") == length && !strncasecmp(word, suffix, length)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* EqmFormatOfSuffix - the format that a file's name shows, or NULL. Not collective. */
const EqmFormat *EqmFormatOfSuffix(const char *file)
{
  const char *dot = strrchr(file, '.');

  if (!dot || strchr(dot, '/')) return NULL;
  for (size_t i = 0; i < NUM_FORMATS; ++i) {
    if (IsListed(formats[i].suffixes, dot + 1, strlen(dot + 1))) return &formats[i];
  }
  return NULL;
}

/* EqmFormatListSuffixes - ".ply .vtu ..." of the formats that can be written, or read, for messages. Not collective. */
void EqmFormatListSuffixes(PetscBool writable, char *text, size_t length)
{
  size_t used = 0;

  if (length) text[0] = '\0';
  for (size_t i = 0; i < NUM_FORMATS; ++i) {
    const PetscBool can =
        writable ? formats[i].write || formats[i].write_parallel : formats[i].parse || formats[i].read_parallel;
    const size_t left = used < length ? length - used : 0;

    if (can)
      used += (size_t)snprintf(text + used, left, "%s.%.*s", used ? " " : "", (int)strcspn(formats[i].suffixes, " "),
                               formats[i].suffixes);
    if (used >= length) return;
  }
}

/* EqmRequireSmall - refuse a mesh that a format with 32-bit numbers cannot count. Not collective. Errors: EQM_ERR_USAGE
   (quiet, reason in `error`). */
PetscErrorCode EqmRequireSmall(const EqmSerialMesh *mesh, const char *format, char *error, size_t length)
{
  if ((PetscInt64)mesh->num_vertices < INT32_MAX && (PetscInt64)mesh->num_cells < INT32_MAX) return 0;
  snprintf(error, length, "%s files cannot count that many vertices or cells; choose .h5", format);
  return EQM_ERR_USAGE;
}

/* EqmRequireTriangles - refuse a mesh that a surface format cannot hold. Not collective. Errors: EQM_ERR_USAGE (quiet,
   reason in `error`). */
PetscErrorCode EqmRequireTriangles(const EqmSerialMesh *mesh, const char *format, char *error, size_t length)
{
  if (mesh->cell_size == 3) return EqmRequireSmall(mesh, format, error, length);
  snprintf(error, length, "%s files cannot hold tetrahedra; choose .h5, .vtu, .msh or .mesh", format);
  return EQM_ERR_USAGE;
}
