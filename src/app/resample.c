/* equimap resample RESULT -grid N -o OUT: a mesh made anew through its map. */
#include "app.h"
#include "base/rows.h"
#include "format/format.h"
#include "mesh/generate.h"
#include "mesh/soup_private.h"
#include "resample/resample.h"
#include "store/output.h"
#include <string.h>

typedef struct {
  char output[PETSC_MAX_PATH_LEN], onto[PETSC_MAX_PATH_LEN], transfer[PETSC_MAX_PATH_LEN], image[EQM_FIELD_NAME];
  PetscBool has_output, has_onto, has_grid;
  PetscInt grid;
} ResampleOptions;

static const char manual[] =
    "\n"
    "usage: equimap resample RESULT.h5 -grid N -o OUT, or equimap resample MESH MAP -grid N -o OUT\n"
    "The map is one to the disk, the square, the sphere, the ball or the cube. Fields of the mesh are carried along, "
    "and\n"
    "`target` is where each new vertex lies in the target.\n";

static PetscErrorCode ReadOptions(ResampleOptions *options)
{
  PetscFunctionBegin;
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "Resampling (resample)", NULL);
  PetscCall(PetscOptionsString("-o",
                               "where the new mesh goes: any mesh format, and for the square .png or .tif, a geometry "
                               "image; several with commas",
                               NULL, "", options->output, sizeof(options->output), &options->has_output));
  PetscCall(PetscOptionsInt(
      "-grid",
      "a regular mesh of the target: N x N vertices of the square, N rings of the disk, the "
      "icosahedron with its edges cut into N, N layers of the ball, 2 N + 1 vertices along each edge of the "
      "cube",
      NULL, options->grid, &options->grid, &options->has_grid));
  PetscCall(PetscOptionsString("-onto",
                               "in place of -grid the connectivity of this mesh: a result of the same target, or a "
                               "mesh that lies in the target (of any size)",
                               NULL, "", options->onto, sizeof(options->onto), &options->has_onto));
  PetscCall(PetscOptionsString("-transfer",
                               "carry these along, too: a dataset of the result (/vertex/ratio) or a .csv with a row "
                               "per vertex or cell; several with commas",
                               NULL, "", options->transfer, sizeof(options->transfer), NULL));
  PetscCall(PetscOptionsString("-image", "what .png and .tif show: position, normal, or the name of a field", NULL,
                               options->image, options->image, sizeof(options->image), NULL));
  PetscOptionsEnd();
  PetscFunctionReturn(0);
}

/* Check before the work what would fail after it. */
static PetscErrorCode CheckArguments(const EqmCommandLine *line, const ResampleOptions *options)
{
  char **files;
  int count;

  PetscFunctionBegin;
  if (line->num_arguments < 1 || line->num_arguments > 2)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE,
            "resample wants a result, or a mesh and a map, %d files given; usage: equimap resample RESULT.h5 -grid N "
            "-o OUT",
            line->num_arguments);
  if (!options->has_output) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "no output named; add -o OUT");
  if (options->has_grid == options->has_onto)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "say what the new mesh is: either -grid N or -onto MESH");
  for (int k = 0; k < line->num_arguments; k++)
    PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, line->argument[k], options->output));
  if (options->has_onto) PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, options->onto, options->output));
  PetscCall(PetscStrToArray(options->output, ',', &count, &files));
  for (int k = 0; k < count; k++) {
    if (EqmIsGeometryImage(files[k])) {
      if (options->has_onto)
        EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "%s: a geometry image is made of the square, by -grid N", files[k]);
      PetscCall(EqmGeometryImageCheck(PETSC_COMM_WORLD, files[k]));
    } else {
      PetscCall(EqmMapCheckWritable(PETSC_COMM_WORLD, files[k]));
    }
  }
  PetscCall(PetscStrToArrayDestroy(count, files));
  PetscFunctionReturn(0);
}

/* The new mesh in the target, and the places of its vertices. */
static PetscErrorCode MakeNew(const ResampleOptions *options, const EqmResampleSource *source, EqmLedger ledger,
                              EqmSoup *soup, PetscReal **place)
{
  PetscInt count;

  PetscFunctionBegin;
  if (options->has_onto) {
    PetscCall(EqmResamplePlaces(source, options->onto, ledger, soup, place));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmSoupGenerateTarget(source->given->comm, source->target, options->grid, soup));
  count = (*soup)->vertex_end - (*soup)->vertex_start;
  PetscCall(PetscMalloc1(source->dim * count + 1, place));
  for (PetscInt k = 0; k < source->dim * count; k++)
    (*place)[k] = (*soup)->vertices[3 * (k / source->dim) + k % source->dim];
  PetscFunctionReturn(0);
}

static PetscErrorCode Write(const ResampleOptions *options, EqmSoup soup)
{
  char **files;
  int count;

  PetscFunctionBegin;
  PetscCall(PetscStrToArray(options->output, ',', &count, &files));
  for (int k = 0; k < count; k++) {
    if (EqmIsGeometryImage(files[k])) {
      PetscCall(EqmGeometryImageWrite(soup, options->grid, options->image, files[k]));
    } else {
      PetscCall(EqmSoupWrite(soup, files[k]));
      PetscCall(EqmPrintDropped(soup, files[k], PETSC_FALSE));
    }
  }
  PetscCall(PetscStrToArrayDestroy(count, files));
  PetscFunctionReturn(0);
}

static PetscErrorCode View(const ResampleOptions *options, const EqmResampleSource *source, EqmSoup soup,
                           const EqmResampleFigures *figures)
{
  const char *const measure = soup->cell_size == 3 ? "area" : "volume";

  PetscFunctionBegin;
  PetscCall(PetscPrintf(soup->comm,
                        "%s through its map to the %s: %" PetscInt_FMT " vertices, %" PetscInt_FMT
                        " %s -> %s\n  %s        %.6g, of the mesh %.6g\n",
                        source->given->file, source->target, soup->num_vertices, soup->num_cells,
                        soup->cell_size == 3 ? "triangles" : "tetrahedra", options->output, measure,
                        (double)figures->measure, (double)figures->measure_before));
  if (figures->clamped)
    PetscCall(PetscPrintf(soup->comm,
                          "  outside     %" PetscInt64_FMT
                          " vertices beyond the image's boundary edges, up to %.2g, taken to its closest point\n",
                          figures->clamped, (double)figures->farthest));
  if (source->folds)
    PetscCall(PetscPrintf(soup->comm,
                          "warning: the map has %" PetscInt64_FMT
                          " folds: where it is folded, a vertex is taken from one of its sheets\n",
                          source->folds));
  PetscFunctionReturn(0);
}

/* Run `equimap resample`. Collective on PETSC_COMM_WORLD. Errors: EQM_ERR_USAGE, and those of EqmResampleSourceRead,
   EqmResamplePlaces, EqmSoupWrite and EqmGeometryImageWrite. */
PetscErrorCode EqmCommandResample(const EqmCommandLine *line, EqmStatus *status)
{
  ResampleOptions options = {.image = "position"};
  EqmResampleSource source;
  EqmResampleFigures figures;
  EqmLedger ledger;
  EqmSoup soup;
  PetscReal *place;

  PetscFunctionBegin;
  *status = EQM_STATUS_CONVERGED;
  if (line->help) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s", manual));
  PetscCall(ReadOptions(&options));
  if (line->help) PetscFunctionReturn(0);
  PetscCall(EqmRejectUnknownOptions(line));
  PetscCall(CheckArguments(line, &options));
  PetscCall(EqmLedgerCreate(PETSC_COMM_WORLD, &ledger));
  PetscCall(EqmResampleSourceRead(PETSC_COMM_WORLD, line->argument[0],
                                  line->num_arguments > 1 ? line->argument[1] : NULL, ledger, &source));
  PetscCall(MakeNew(&options, &source, ledger, &soup, &place));
  PetscCall(EqmResample(&source, options.transfer, soup, place, &figures));
  PetscCall(PetscFree(place));
  PetscCall(Write(&options, soup));
  PetscCall(View(&options, &source, soup, &figures));
  PetscCall(EqmSoupDestroy(&soup));
  PetscCall(EqmResampleSourceReset(&source));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscFunctionReturn(0);
}
