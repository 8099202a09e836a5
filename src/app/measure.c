/* equimap measure MESH MAP: distortion and folds of any map of the mesh. */
#include "app.h"
#include "csvtable.h"
#include "mesh/mesh_private.h"
#include "format/format.h"
#include "format/image.h"
#include "measure/foreign.h"
#include "store/output.h"

typedef struct {
  char output[PETSC_MAX_PATH_LEN], density[PETSC_MAX_PATH_LEN], summary[PETSC_MAX_PATH_LEN],
      histogram[PETSC_MAX_PATH_LEN], ratios[PETSC_MAX_PATH_LEN], cells[PETSC_MAX_PATH_LEN],
      vertices[PETSC_MAX_PATH_LEN];
  EqmImageSource source;
} MeasureOptions;

/* What is measured. */
typedef struct {
  EqmLedger ledger;
  EqmSoup soup;   /* as it was read */
  EqmImage image; /* of a file that is no result */
  EqmMesh mesh;   /* of the map's soup */
  EqmMap map;
  EqmImagePlacement placement;
} Measured;

static PetscErrorCode PrintStatistics(const char *name, const EqmStatistics *s)
{
  PetscFunctionBegin;
  PetscCall(
      PetscPrintf(PETSC_COMM_WORLD,
                  "  %-14s mean %.6g  sd %.6g  min %.6g  25%% %.6g  median %.6g  75%% %.6g  95%% %.6g  max %.6g\n",
                  name, (double)s->mean, (double)s->sd, (double)s->min, (double)s->p25, (double)s->p50, (double)s->p75,
                  (double)s->p95, (double)s->max));
  PetscFunctionReturn(0);
}

/* Which numbers of the file are the map, and what they fill. */
static PetscErrorCode PrintImage(const Measured *m)
{
  const EqmImagePlacement *const p = &m->placement;
  const PetscBool known =
      (PetscBool)(p->shape != EQM_FILLS_PLANE && p->shape != EQM_FILLS_SPACE && p->shape != EQM_FILLS_SOLID);

  PetscFunctionBegin;
  if (m->image.texture) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  read           texture coordinates"));
  if (m->image.texture && m->image.num_copies) {
    PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                          "; the surface is cut along their seams, where vertices have %" PetscInt_FMT
                          " more images, numbered after the others",
                          m->image.num_copies));
  }
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s  image          %s", m->image.texture ? "\n" : "",
                        EqmDomainShapeName(p->shape)));
  if (p->size != 1. && known) {
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, " of %s %.6g at (%.6g, %.6g, %.6g)",
                          p->shape == EQM_FILLS_SQUARE || p->shape == EQM_FILLS_CUBE ? "side" : "radius",
                          (double)p->size, (double)p->center[0], (double)p->center[1], (double)p->center[2]));
  }
  if (p->size != 1.) {
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, ": measured at %s 1",
                          p->shape == EQM_FILLS_SQUARE || p->shape == EQM_FILLS_CUBE ? "side"
                          : known                                                    ? "radius"
                          : p->shape == EQM_FILLS_SOLID                              ? "volume"
                                                                                     : "area"));
  }
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "\n"));
  PetscFunctionReturn(0);
}

static PetscErrorCode PrintDistortion(const EqmDistortion *d, PetscBool surface, PetscBool in_space)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  energy         %.10e   (image measure %.10g)\n", (double)d->energy,
                        (double)d->image_measure));
  if (in_space)
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  folds          not counted: triangles in space have no side\n"));
  else
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  folds          %" PetscInt64_FMT "\n", d->folds));
  PetscCall(PrintStatistics("ratio", &d->ratio));
  PetscCall(PrintStatistics("|ratio - 1|", &d->ratio_error));
  if (!surface) PetscFunctionReturn(0);
  PetscCall(PrintStatistics("angle error", &d->angle_error));
  PetscCall(PrintStatistics("quasiconformal", &d->quasiconformal));
  PetscFunctionReturn(0);
}

static PetscErrorCode Write(const MeasureOptions *options, Measured *m)
{
  const PetscReal *per_cell, *per_vertex, *quasi, *factor;
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmMapGetSoup(m->map, &soup));
  PetscCall(EqmMapGetRatios(m->map, &per_cell, &per_vertex));
  PetscCall(EqmMapGetQuasiConformal(m->map, &quasi));
  PetscCall(EqmMapGetConformalFactor(m->map, &factor));
  if (options->cells[0]) {
    PetscCall(EqmCsvTableWrite(soup->comm, options->cells, quasi ? "cell,ratio,quasi_conformal" : "cell,ratio",
                               soup->num_cells, soup->cell_end - soup->cell_start, per_cell, quasi));
  }
  if (options->vertices[0]) {
    PetscCall(EqmCsvTableWrite(soup->comm, options->vertices, factor ? "vertex,ratio,conformal_factor" : "vertex,ratio",
                               soup->num_vertices, soup->vertex_end - soup->vertex_start, per_vertex, factor));
  }
  PetscCall(EqmMapSetCost(m->map, m->ledger));
  if (options->output[0]) PetscCall(EqmMapWrite(m->map, options->output));
  if (options->summary[0]) PetscCall(EqmMapWriteSummary(m->map, options->summary));
  if (options->histogram[0]) PetscCall(EqmMapWriteHistogram(m->map, options->histogram));
  if (options->ratios[0]) PetscCall(EqmMapWriteRatioHistogram(m->map, options->ratios));
  PetscFunctionReturn(0);
}

/* Cells without area or volume, or without positions, have no ratio: refused. */
static PetscErrorCode CheckMeasurable(EqmSoup soup)
{
  EqmDiagnosis diagnosis;
  PetscInt64 damaged;

  PetscFunctionBegin;
  PetscCall(EqmSoupDiagnose(soup, &diagnosis));
  damaged = diagnosis.finding[EQM_FINDING_NOT_FINITE].count + diagnosis.finding[EQM_FINDING_BAD_INDEX].count +
            diagnosis.finding[EQM_FINDING_DEGENERATE_CELL].count;
  if (damaged) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_MESH,
            "no map of %s can be measured: it has %" PetscInt64_FMT
            " flat or damaged cells or vertices; equimap check %s names them",
            soup->file, damaged, soup->file);
  }
  PetscFunctionReturn(0);
}

/* A result has the map itself; every other file an image. */
static PetscErrorCode ReadMap(const MeasureOptions *options, const char *file, Measured *m)
{
  const EqmFormat *const format = EqmFormatOfSuffix(file);
  PetscReal *coordinates;

  PetscFunctionBegin;
  if (format && format->read_parallel) {
    PetscCall(EqmMapRead(m->soup, file, &m->map));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmImageRead(m->soup, file, options->source, &m->image));
  PetscCall(EqmMapCreate(m->image.soup, m->image.dim, &m->map));
  PetscCall(EqmMapGetCoordinates(m->map, &coordinates));
  PetscCall(PetscArraycpy(coordinates, m->image.coordinates,
                          m->image.dim * (m->image.soup->vertex_end - m->image.soup->vertex_start)));
  PetscFunctionReturn(0);
}

/* Measure; an image that is the mesh itself is no map. */
static PetscErrorCode MeasureMap(const char *file, Measured *m)
{
  PetscReal *coordinates, *x;
  PetscInt dim;
  EqmSoup soup;
  PetscBool repeats;

  PetscFunctionBegin;
  PetscCall(EqmMapGetSoup(m->map, &soup));
  PetscCall(EqmMeshCreate(soup, m->ledger, &m->mesh));
  PetscCall(EqmMapGetDimension(m->map, &dim));
  PetscCall(EqmMapGetCoordinates(m->map, &coordinates));
  PetscCall(PetscMalloc1(dim * m->mesh->num_local, &x));
  PetscCall(EqmMeshVerticesFromInput(m->mesh, soup, dim, coordinates, x));
  PetscCall(EqmMapMeasureForeign(m->map, m->mesh, x, &m->placement, &repeats));
  PetscCall(PetscFree(x));
  if (repeats) {
    EqmFail(
        PETSC_COMM_WORLD, EQM_ERR_MESH,
        "the vertices of %s are those of %s itself, and it has no texture coordinates at all corners: there is no map "
        "in it. Give the file that the flattening program wrote, or coordinates as CSV or NPY",
        file, m->soup->file);
  }
  PetscFunctionReturn(0);
}

/* Measure and report; the map's status: folds or fine. */
static PetscErrorCode Measure(const EqmCommandLine *line, const MeasureOptions *options, EqmStatus *status)
{
  Measured m = {.map = NULL};
  PetscInt unit;
  const EqmDistortion *distortion;

  PetscFunctionBegin;
  PetscCall(EqmLedgerCreate(PETSC_COMM_WORLD, &m.ledger));
  PetscCall(EqmSoupRead(PETSC_COMM_WORLD, line->argument[0], &m.soup));
  if (options->density[0]) PetscCall(EqmSoupReadDensity(m.soup, options->density));
  PetscCall(EqmSoupBringIntoRange(m.soup, &unit));
  PetscCall(CheckMeasurable(m.soup));
  PetscCall(ReadMap(options, line->argument[1], &m));
  PetscCall(MeasureMap(line->argument[1], &m));
  PetscCall(EqmMapRestoreUnit(m.map, unit));
  PetscCall(EqmMapGetDistortion(m.map, &distortion));
  *status = distortion->folds ? EQM_STATUS_FOLDS : EQM_STATUS_CONVERGED;
  PetscCall(EqmMapSetStatus(m.map, *status, ""));
  PetscCall(EqmMapSetEnergies(m.map, distortion->energy, distortion->energy));
  PetscCall(EqmMapSetCommand(m.map, "measure"));
  PetscCall(EqmMapAddText(m.map, "image.shape", EqmDomainShapeName(m.placement.shape)));
  PetscCall(EqmMapAddFigure(m.map, "image.size", m.placement.size));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s as a map of %s\n", line->argument[1], line->argument[0]));
  PetscCall(PrintImage(&m));
  PetscCall(PrintDistortion(distortion, (PetscBool)(m.soup->cell_size == 3),
                            (PetscBool)(m.placement.shape == EQM_FILLS_SPACE)));
  PetscCall(Write(options, &m));
  PetscCall(EqmMapDestroy(&m.map));
  PetscCall(EqmMeshDestroy(&m.mesh));
  PetscCall(EqmImageReset(&m.image));
  PetscCall(EqmSoupDestroy(&m.soup));
  PetscCall(EqmLedgerDestroy(&m.ledger));
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadOptions(MeasureOptions *options)
{
  static const char *const sources[] = {"auto", "vertices", "texture"};
  PetscInt source = EQM_IMAGE_AUTO;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(options, sizeof(*options)));
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "Files", NULL);
  PetscCall(
      PetscOptionsEList("-map_in",
                        "which numbers of a mesh file are the map: its vertices, its texture coordinates, or auto: the "
                        "texture coordinates where the vertices repeat the mesh",
                        NULL, sources, 3, sources[0], &source, NULL));
  PetscCall(PetscOptionsString("-density", "a positive weight per cell: measure mass instead of area", NULL, "",
                               options->density, sizeof(options->density), NULL));
  PetscCall(PetscOptionsString("-o",
                               "write map and distortion: .h5 (everything, for equimap report), or the image in a mesh "
                               "format; several with commas",
                               NULL, "", options->output, sizeof(options->output), NULL));
  PetscCall(PetscOptionsString("-cells", "write ratio and quasiconformal distortion of every cell as CSV", NULL, "",
                               options->cells, sizeof(options->cells), NULL));
  PetscCall(PetscOptionsString("-vertices", "write ratio and conformal factor around every vertex as CSV", NULL, "",
                               options->vertices, sizeof(options->vertices), NULL));
  PetscCall(PetscOptionsString("-summary", "write the figures as JSON", NULL, "", options->summary,
                               sizeof(options->summary), NULL));
  PetscCall(PetscOptionsString("-histogram", "write the histogram of angle errors as CSV", NULL, "", options->histogram,
                               sizeof(options->histogram), NULL));
  PetscCall(PetscOptionsString("-ratio_histogram", "write the histogram of the ratios as CSV", NULL, "",
                               options->ratios, sizeof(options->ratios), NULL));
  PetscOptionsEnd();
  options->source = (EqmImageSource)source;
  PetscFunctionReturn(0);
}

/* Check before the work what would fail after it. */
static PetscErrorCode CheckOutputs(const EqmCommandLine *line, const MeasureOptions *options)
{
  const char *const files[] = {options->output,  options->cells,     options->vertices,
                               options->summary, options->histogram, options->ratios};

  PetscFunctionBegin;
  if (options->output[0]) PetscCall(EqmMapCheckWritable(PETSC_COMM_WORLD, options->output));
  for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++) {
    if (!files[i][0]) continue;
    for (int a = 0; a < 2; a++) PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, line->argument[a], files[i]));
  }
  PetscFunctionReturn(0);
}

/* Run `equimap measure`. Collective on PETSC_COMM_WORLD. Errors: EQM_ERR_USAGE, EQM_ERR_MESH (the mesh cannot be
   measured; the file holds no map), and those of EqmSoupRead, EqmSoupReadDensity, EqmImageRead and EqmMapWrite. */
PetscErrorCode EqmCommandMeasure(const EqmCommandLine *line, EqmStatus *status)
{
  MeasureOptions options;

  PetscFunctionBegin;
  PetscCall(ReadOptions(&options));
  if (line->help) PetscFunctionReturn(0);
  PetscCall(EqmRejectUnknownOptions(line));
  if (line->num_arguments != 2) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE,
            "measure wants a mesh and a map, %d given; usage: equimap measure MESH MAP", line->num_arguments);
  }
  PetscCall(CheckOutputs(line, &options));
  PetscCall(Measure(line, &options, status));
  PetscFunctionReturn(0);
}
