/* Meshes of which every rank reads a part, beside the same as one rank reads it alone. */
#ifndef EQM_TEST_PARTS_H
#define EQM_TEST_PARTS_H

#include "support/testing.h"
#include "format/format.h"
#include "mesh/soup_private.h"
#include "support/text.h"
#include <stdlib.h>
#include <unistd.h>

/* On rank 0, for all. */
static inline PetscErrorCode WriteFile(const char *file, const char *bytes, size_t length)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) {
    FILE *const stream = fopen(file, "wb");
    CHECK(stream && fwrite(bytes, 1, length, stream) == length && !fclose(stream), "cannot write %s", file);
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(0);
}

/* Is the file understood in parts? */
static inline PetscErrorCode ReadInParts(const char *file, const EqmFormat *format, EqmSerialMesh *mesh,
                                         PetscBool *understood)
{
  EqmPartFile opened;

  PetscFunctionBegin;
  *mesh = (EqmSerialMesh){0};
  PetscCall(EqmPartFileOpen(PETSC_COMM_WORLD, file, &opened, understood));
  CHECK(*understood, "cannot open %s", file);
  PetscCall(format->parse_part(&opened, mesh, understood));
  PetscCall(EqmPartFileClose(&opened));
  PetscFunctionReturn(0);
}

/* A rank without rows may have no array. */
static inline PetscBool IsSame(const void *a, const void *b, size_t bytes)
{
  return bytes == 0 || !memcmp(a, b, bytes) ? PETSC_TRUE : PETSC_FALSE;
}

/* The same mesh to the bit, with all that belongs to it. `what` is for messages. */
static inline PetscErrorCode CheckSame(const char *what, EqmSoup alone, EqmSoup together)
{
  const PetscInt v = together->vertex_start, c = together->cell_start, cs = alone->cell_size;
  const size_t num_vertices = (size_t)(together->vertex_end - v), num_cells = (size_t)(together->cell_end - c);

  PetscFunctionBegin;
  CHECK(together->num_vertices == alone->num_vertices && together->num_cells == alone->num_cells &&
            together->cell_size == cs,
        "%s: %d vertices, %d cells; alone %d, %d", what, (int)together->num_vertices, (int)together->num_cells,
        (int)alone->num_vertices, (int)alone->num_cells);
  CHECK(IsSame(together->vertices, alone->vertices + 3 * v, 3 * num_vertices * sizeof(PetscReal)), "%s: other vertices",
        what);
  CHECK(IsSame(together->cells, alone->cells + cs * c, (size_t)cs * num_cells * sizeof(PetscInt)), "%s: other cells",
        what);
  CHECK(together->checksum == alone->checksum, "%s: another checksum", what);
  CHECK(!strcmp(together->note, alone->note), "%s: '%s', alone '%s'", what, together->note, alone->note);
  CHECK(!strcmp(together->left, alone->left), "%s: left out '%s', alone '%s'", what, together->left, alone->left);
  CHECK(!together->metadata == !alone->metadata && (!alone->metadata || !strcmp(together->metadata, alone->metadata)),
        "%s: '%s', alone '%s'", what, together->metadata, alone->metadata);
  CHECK(together->num_fields == alone->num_fields, "%s: %d fields, alone %d", what, (int)together->num_fields,
        (int)alone->num_fields);
  for (PetscInt f = 0; f < alone->num_fields; f++) {
    const EqmMeshField *const a = &alone->fields[f], *const b = &together->fields[f];
    const size_t rows = a->on_cells ? num_cells : num_vertices;
    CHECK(!strcmp(a->name, b->name) && a->width == b->width && a->on_cells == b->on_cells, "%s: field %s, alone %s",
          what, b->name, a->name);
    CHECK(IsSame(b->values, a->values + a->width * (a->on_cells ? c : v), rows * (size_t)a->width * sizeof(PetscReal)),
          "%s: other values of %s", what, a->name);
  }
  PetscFunctionReturn(0);
}

static char folder[200], file[256];

/* The file that is read from here on. */
static inline void Name(const char *suffix)
{
  snprintf(file, sizeof(file), "%s/mesh.%s", folder, suffix);
}

/* Is the file understood in parts? */
static inline PetscErrorCode ReadsInParts(PetscBool *understood)
{
  EqmSerialMesh mesh;

  PetscFunctionBegin;
  PetscCall(ReadInParts(file, EqmFormatOfSuffix(file), &mesh, understood));
  PetscCall(EqmSerialMeshReset(&mesh));
  PetscFunctionReturn(0);
}

/* Every rank reads the file alone, too. */
static inline PetscErrorCode CheckFile(PetscInt num_fields)
{
  EqmSoup alone, together;
  PetscBool understood;

  PetscFunctionBegin;
  PetscCall(ReadsInParts(&understood));
  CHECK(understood, "%s: a good file is not understood in parts", file);
  PetscCall(EqmSoupRead(PETSC_COMM_SELF, file, &alone));
  PetscCall(EqmSoupRead(PETSC_COMM_WORLD, file, &together));
  CHECK(num_fields < 0 || alone->num_fields == num_fields, "%d fields instead of %d", (int)alone->num_fields,
        (int)num_fields);
  PetscCall(CheckSame(file, alone, together));
  PetscCall(EqmSoupDestroy(&alone));
  PetscCall(EqmSoupDestroy(&together));
  PetscFunctionReturn(0);
}

static inline PetscErrorCode CheckRead(const Text *text, PetscInt num_fields)
{
  PetscFunctionBegin;
  PetscCall(WriteFile(file, text->bytes, text->length));
  PetscCall(CheckFile(num_fields));
  PetscFunctionReturn(0);
}

/* The reader on one rank says what is wrong, with the line; here it is the same code on all. */
static inline PetscErrorCode CheckRefused(const Text *text, PetscErrorCode code)
{
  EqmSoup soup;
  PetscBool understood;

  PetscFunctionBegin;
  PetscCall(WriteFile(file, text->bytes, text->length));
  PetscCall(ReadsInParts(&understood));
  CHECK(!understood, "a bad file is understood in parts");
  CHECK_FAILS(code, EqmSoupRead(PETSC_COMM_WORLD, file, &soup));
  PetscFunctionReturn(0);
}

/* A folder of all ranks. */
static inline PetscErrorCode MakeFolder(void)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  snprintf(folder, sizeof(folder), "%s/equimap-parts-XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  if (rank == 0) CHECK(mkdtemp(folder), "no folder %s", folder);
  PetscCallMPI(MPI_Bcast(folder, sizeof(folder), MPI_CHAR, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(0);
}

/* With the files of these suffixes, which must be there. */
static inline PetscErrorCode RemoveFolder(size_t num, const char *const *suffixes)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  for (size_t f = 0; f < num && rank == 0; f++) {
    Name(suffixes[f]);
    CHECK(!unlink(file), "cannot remove %s", file);
  }
  if (rank == 0) CHECK(!rmdir(folder), "cannot remove %s", folder);
  PetscFunctionReturn(0);
}

#endif
