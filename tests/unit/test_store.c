/* The store: results written on k ranks come back bit for bit, failures are alike on all ranks and damage nothing. */
#include <equimap/map.h>
#include "mesh/soup_private.h"
#include <cjson/cJSON.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>
#include "h5/h5.h"
#include "store/map_private.h"
#include "support/checks.h"

/* This rank's part of `total` things; the last ranks get nothing when there are more ranks than things. */
static void Deal(PetscInt total, PetscInt *start, PetscInt *end)
{
  PetscMPIInt rank, size;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  const PetscInt share = (total + size - 1) / size;
  *start = PetscMin(rank * share, total);
  *end = PetscMin(*start + share, total);
}

/* A strip of triangles: vertex i at (i/2, i mod 2, 0.1 i), cell j = (j, j+1, j+2). */
static PetscErrorCode MakeStrip(PetscInt num_vertices, EqmSoup *soup)
{
  PetscInt v0, v1, c0, c1, *cells;
  PetscReal *vertices;

  PetscFunctionBegin;
  Deal(num_vertices, &v0, &v1);
  Deal(num_vertices - 2, &c0, &c1);
  PetscCall(PetscMalloc1(3 * (v1 - v0), &vertices));
  PetscCall(PetscMalloc1(3 * (c1 - c0), &cells));
  for (PetscInt i = v0; i < v1; i++) {
    vertices[3 * (i - v0)] = (PetscReal)(i / 2);
    vertices[3 * (i - v0) + 1] = (PetscReal)(i % 2);
    vertices[3 * (i - v0) + 2] = 0.1 * (PetscReal)i;
  }
  for (PetscInt j = c0; j < c1; j++) {
    for (PetscInt k = 0; k < 3; k++) cells[3 * (j - c0) + k] = j + k;
  }
  PetscCall(
      EqmSoupCreateFromSlabs(PETSC_COMM_WORLD, 3, v1 - v0, vertices, c1 - c0, cells, "strip \"quoted\" ü.obj", soup));
  PetscFunctionReturn(0);
}

static PetscReal Coordinate(PetscInt vertex, PetscInt d)
{
  return 1.0 / (PetscReal)(3 + 7 * vertex + d); /* no short binary fraction */
}

static PetscErrorCode MakeMap(EqmSoup soup, PetscInt dim, PetscInt num_history, EqmMap *out)
{
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(EqmMapCreate(soup, dim, &map));
  for (PetscInt i = soup->vertex_start; i < soup->vertex_end; i++) {
    for (PetscInt d = 0; d < dim; d++) map->coordinates[dim * (i - soup->vertex_start) + d] = Coordinate(i, d);
    map->vertex_ratio[i - soup->vertex_start] = 2.0 / (PetscReal)(3 + i);
  }
  for (PetscInt j = soup->cell_start; j < soup->cell_end; j++)
    map->cell_ratio[j - soup->cell_start] = 1.0 / (PetscReal)(3 + j);
  PetscCall(PetscStrncpy(map->command, "disk", sizeof(map->command)));
  PetscCall(PetscStrncpy(map->method, "newton", sizeof(map->method)));
  PetscCall(PetscStrncpy(map->message, "said \"done\"\n", sizeof(map->message)));
  map->status = EQM_STATUS_NOT_CONVERGED;
  map->energy_initial = 1.0 / 3.0;
  map->energy_final = INFINITY;
  map->distortion.ratio.sd = 0.1;
  map->num_history = num_history;
  PetscCall(PetscCalloc1(num_history, &map->history));
  for (PetscInt i = 0; i < num_history; i++) {
    map->history[i].iteration = i;
    map->history[i].energy = 1.0 / (PetscReal)(i + 3);
    map->history[i].work.solves = 5000000000 + i;
  }
  *out = map;
  PetscFunctionReturn(0);
}

/* Slabs of every kind come back as they were. */
static PetscErrorCode CheckArrays(EqmSoup soup, const char *file)
{
  const PetscInt count = soup->cell_end - soup->cell_start;
  EqmSlab slab = {soup->num_cells, soup->cell_start, count, 3};
  PetscInt64 *cells, value;
  PetscReal *ratio, real;
  char text[64];
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * count, &cells, count, &ratio));
  PetscCall(EqmH5Open(PETSC_COMM_WORLD, file, &h5));
  PetscCall(EqmH5ReadIntegers(h5, "/mesh/cells", slab, cells));
  for (PetscInt j = 0; j < 3 * count; j++) CHECK(cells[j] == soup->cells[j]);
  slab.width = 0;
  PetscCall(EqmH5ReadReals(h5, "/cell/ratio", slab, ratio));
  for (PetscInt j = 0; j < count; j++) CHECK(ratio[j] == 1.0 / (PetscReal)(3 + j + soup->cell_start));
  PetscCall(EqmH5GetInteger(h5, "complete", 0, &value));
  CHECK(value == 1);
  PetscCall(EqmH5GetInteger(h5, "exit_code", 0, &value));
  CHECK(value == 4);
  PetscCall(EqmH5GetReal(h5, "energy_initial", 0.0, &real));
  CHECK(real == 1.0 / 3.0);
  PetscCall(EqmH5GetText(h5, "method", "?", text, sizeof(text)));
  CHECK(strcmp(text, "newton") == 0);
  PetscCall(EqmH5GetText(h5, "absent", "?", text, sizeof(text)));
  CHECK(strcmp(text, "?") == 0);
  PetscCall(EqmH5Close(&h5));
  PetscCall(PetscFree2(cells, ratio));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestRoundTrip(PetscInt num_vertices, PetscInt dim, PetscInt num_history)
{
  const char *file = "test_store.h5";
  EqmMap map, back;
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(MakeStrip(num_vertices, &soup));
  PetscCall(MakeMap(soup, dim, num_history, &map));
  PetscCall(EqmMapCheckWritable(PETSC_COMM_WORLD, file));
  PetscCall(EqmMapWrite(map, file));
  CHECK(access("test_store.xmf", R_OK) == 0);
  PetscCall(CheckArrays(soup, file));
  PetscCall(EqmMapRead(soup, file, &back));
  CHECK(back->dim == dim);
  for (PetscInt i = 0; i < dim * (soup->vertex_end - soup->vertex_start); i++)
    CHECK(back->coordinates[i] == map->coordinates[i]);
  PetscCall(EqmMapDestroy(&back));
  PetscCall(EqmMapDestroy(&map));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

/* A file's bytes as text; the caller frees them. */
static PetscErrorCode Slurp(const char *file, char **text)
{
  struct stat status;
  FILE *stream = fopen(file, "rb");

  PetscFunctionBegin;
  CHECK(stream && stat(file, &status) == 0);
  PetscCall(PetscCalloc1((size_t)status.st_size + 1, text));
  CHECK(fread(*text, 1, (size_t)status.st_size, stream) == (size_t)status.st_size);
  fclose(stream);
  PetscFunctionReturn(0);
}

static PetscErrorCode TestSummary(void)
{
  cJSON *root, *energy;
  EqmMap map;
  EqmSoup soup;
  char *text;

  PetscFunctionBegin;
  PetscCall(MakeStrip(12, &soup));
  PetscCall(MakeMap(soup, 2, 3, &map));
  PetscCall(EqmMapWriteSummary(map, "test_store.json"));
  PetscCall(Slurp("test_store.json", &text));
  root = cJSON_Parse(text);
  CHECK(root);
  energy = cJSON_GetObjectItemCaseSensitive(root, "energy");
  CHECK(cJSON_GetObjectItemCaseSensitive(energy, "initial")->valuedouble == 1.0 / 3.0);
  CHECK(cJSON_IsNull(cJSON_GetObjectItemCaseSensitive(energy, "final")));
  CHECK(strcmp(cJSON_GetObjectItemCaseSensitive(root, "message")->valuestring, map->message) == 0);
  CHECK(strcmp(cJSON_GetObjectItemCaseSensitive(root, "status")->valuestring, "not converged") == 0);
  CHECK(cJSON_GetObjectItemCaseSensitive(root, "exit_code")->valueint == 4);
  CHECK(strcmp(cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(root, "mesh"), "file")->valuestring,
               soup->file) == 0);
  cJSON_Delete(root);
  PetscCall(PetscFree(text));
  PetscCall(EqmMapDestroy(&map));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestHistory(void)
{
  EqmMap map;
  EqmSoup soup;
  char *text, *line;

  PetscFunctionBegin;
  PetscCall(MakeStrip(12, &soup));
  PetscCall(MakeMap(soup, 2, 3, &map));
  PetscCall(EqmMapWriteHistory(map, "test_store.csv"));
  PetscCall(Slurp("test_store.csv", &text));
  CHECK(strncmp(text, "iteration,energy,sd,folds,", 26) == 0);
  line = text;
  for (int i = 0; i < 3; i++) {
    int iteration;
    double energy;
    line = strchr(line, '\n') + 1;
    CHECK(sscanf(line, "%d,%lf,", &iteration, &energy) == 2);
    CHECK(iteration == i && energy == 1.0 / (double)(i + 3));
  }
  CHECK(strstr(line, ",5000000002,"));
  PetscCall(PetscFree(text));
  PetscCall(EqmMapDestroy(&map));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

/* Texts of either kind are read alike, cut to the length of the buffer. */
static PetscErrorCode TestTexts(void)
{
  const EqmSlab one = {1, 0, 1, 0};
  const PetscReal value = 1.0;
  char text[64];

  PetscFunctionBegin;
  for (int fixed = 0; fixed < 2; fixed++) {
    EqmH5 h5;
    EqmSlab slab = one;
    PetscCall(EqmH5Create(PETSC_COMM_WORLD, "texts.h5", &h5));
    h5->fixed_texts = (PetscBool)fixed;
    if (h5->rank > 0) slab.count = 0;
    PetscCall(EqmH5DeclareReals(h5, "/one", 1, 0));
    PetscCall(EqmH5PutText(h5, "empty", ""));
    if (!fixed) PetscCall(EqmH5PutText(h5, "name", "before"));
    PetscCall(EqmH5PutText(h5, "name", "größer als zuvor"));
    PetscCall(EqmH5Reserve(h5));
    PetscCall(EqmH5WriteReals(h5, "/one", slab, &value));
    PetscCall(EqmH5Commit(&h5));
    PetscCall(EqmH5Open(PETSC_COMM_WORLD, "texts.h5", &h5));
    PetscCall(EqmH5GetText(h5, "empty", "?", text, sizeof(text)));
    CHECK(strcmp(text, "") == 0);
    PetscCall(EqmH5GetText(h5, "name", "?", text, sizeof(text)));
    CHECK(strcmp(text, "größer als zuvor") == 0);
    PetscCall(EqmH5GetText(h5, "name", "?", text, 4));
    CHECK(strlen(text) == 3);
    PetscCall(EqmH5Close(&h5));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode TestFailures(void)
{
  EqmMap map, back;
  EqmSoup soup, other;
  char *before, *after;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(MakeStrip(12, &soup));
  PetscCall(MakeStrip(13, &other));
  PetscCall(MakeMap(soup, 2, 3, &map));
  CHECK_FAILS(EQM_ERR_IO, EqmMapWrite(map, "no/such/directory/x.h5"));
  CHECK_FAILS(EQM_ERR_IO, EqmMapCheckWritable(PETSC_COMM_WORLD, "no/such/directory/x.h5"));
  CHECK_FAILS(EQM_ERR_IO, EqmMapWriteSummary(map, "no/such/directory/x.json"));
  CHECK_FAILS(EQM_ERR_IO, EqmMapWriteHistory(map, "no/such/directory/x.csv"));
  CHECK_FAILS(EQM_ERR_USAGE, EqmMapCheckWritable(PETSC_COMM_WORLD, "x.h5,x.docx"));
  CHECK_FAILS(EQM_ERR_USAGE, EqmMapWrite(map, "x.docx"));
  CHECK_FAILS(EQM_ERR_IO, EqmMapRead(soup, "test_store.csv.h5", &back));
  PetscCall(EqmMapWrite(map, "test_store.h5"));
  CHECK_FAILS(EQM_ERR_MESH, EqmMapRead(other, "test_store.h5", &back));
  PetscCall(EqmMapAddCount(map, "format_version", 99)); /* replaces the version that is */
  PetscCall(EqmMapWrite(map, "future.h5"));
  CHECK_FAILS(EQM_ERR_IO, EqmMapRead(soup, "future.h5", &back));
  map->num_figures = 0;

  /* /dev/full takes a file's bytes and gives none back: a link there is a full disk for anyone. */
  PetscCall(Slurp("test_store.h5", &before));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  if (rank == 0) {
    (void)unlink("test_store_full.json");
    CHECK(symlink("/dev/full", "test_store_full.json") == 0);
    CHECK(truncate("test_store.h5", 100) == 0);
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  CHECK_FAILS(EQM_ERR_IO, EqmMapWriteSummary(map, "test_store_full.json"));
  CHECK_FAILS(EQM_ERR_IO, EqmMapRead(soup, "test_store.h5", &back)); /* cut short */
  PetscCall(EqmMapWrite(map, "test_store.h5"));
  PetscCall(Slurp("test_store.h5", &after));
  CHECK(memcmp(before, "\211HDF", 4) == 0 && memcmp(after, "\211HDF", 4) == 0);
  PetscCall(PetscFree(before));
  PetscCall(PetscFree(after));
  PetscCall(EqmMapDestroy(&map));
  PetscCall(EqmSoupDestroy(&soup));
  PetscCall(EqmSoupDestroy(&other));
  PetscFunctionReturn(0);
}

/* A write that fails in the middle: the file that was there stays, no temporary is left. */
static PetscErrorCode TestOldFileSurvives(void)
{
  const EqmSlab wrong = {4, 0, 4, 0};
  const PetscReal values[4] = {1, 2, 3, 4};
  char *before, *after;
  struct stat status;
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(Slurp("test_store.h5", &before));
  PetscCall(EqmH5Create(PETSC_COMM_WORLD, "test_store.h5", &h5));
  PetscCall(EqmH5DeclareReals(h5, "/map/coordinates", 3, 2)); /* one-dimensional values will not fit */
  PetscCall(EqmH5Reserve(h5));
  CHECK_FAILS(EQM_ERR_IO, EqmH5WriteReals(h5, "/map/coordinates", wrong, values));
  CHECK_FAILS(EQM_ERR_IO, EqmH5WriteReals(h5, "/absent", wrong, values));
  CHECK(stat(h5->atomic.temporary, &status) == 0);
  char temporary[PETSC_MAX_PATH_LEN];
  PetscCall(PetscStrncpy(temporary, h5->atomic.temporary, sizeof(temporary)));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscCall(EqmH5Close(&h5));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  CHECK(stat(temporary, &status) != 0);
  PetscCall(Slurp("test_store.h5", &after));
  CHECK(stat("test_store.h5", &status) == 0 && memcmp(before, after, (size_t)status.st_size) == 0);
  PetscCall(PetscFree(before));
  PetscCall(PetscFree(after));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  char directory[64] = "/tmp/equimap_store_XXXXXX", command[128];
  PetscMPIInt rank;

  PetscCall(EqmInitialize(&argc, &argv));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) CHECK(mkdtemp(directory));
  PetscCallMPI(MPI_Bcast(directory, sizeof(directory), MPI_CHAR, 0, PETSC_COMM_WORLD));
  CHECK(chdir(directory) == 0);
  PetscCall(TestRoundTrip(1001, 2, 4));
  PetscCall(TestRoundTrip(1000, 3, 0));
  PetscCall(TestRoundTrip(3, 2, 1)); /* one cell: most ranks have none */
  PetscCall(TestSummary());
  PetscCall(TestHistory());
  PetscCall(TestTexts());
  PetscCall(TestFailures());
  PetscCall(TestOldFileSurvives());
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  (void)snprintf(command, sizeof(command), "rm -r '%s'", directory);
  if (rank == 0) CHECK(chdir("/") == 0 && system(command) == 0);
  PetscCall(EqmFinalize());
  return 0;
}
