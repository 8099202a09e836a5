/* equimap measure MESH MAP: distortion and folds of any map of the mesh. */
#include "app.h"

typedef struct {
  char density[PETSC_MAX_PATH_LEN], summary[PETSC_MAX_PATH_LEN], histogram[PETSC_MAX_PATH_LEN];
} MeasureOptions;

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

static PetscErrorCode Print(const EqmDistortion *d, PetscBool surface)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                        "  energy         %.10e   (image measure %.10g)\n  folds          %" PetscInt64_FMT "\n",
                        (double)d->energy, (double)d->image_measure, d->folds));
  PetscCall(PrintStatistics("ratio", &d->ratio));
  PetscCall(PrintStatistics("|ratio - 1|", &d->ratio_error));
  if (!surface) PetscFunctionReturn(0);
  PetscCall(PrintStatistics("angle error", &d->angle_error));
  PetscCall(PrintStatistics("quasiconformal", &d->quasiconformal));
  PetscFunctionReturn(0);
}

/* What has no area or volume, or no place, has no ratio. */
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

/* Measure and report; the map's status: folds or fine. */
static PetscErrorCode Measure(const EqmCommandLine *line, const MeasureOptions *options, EqmStatus *status)
{
  EqmLedger ledger;
  EqmSoup soup;
  EqmMesh mesh;
  EqmMap map;
  const EqmDistortion *distortion;
  PetscReal *coordinates, *x;
  PetscInt dim;

  PetscFunctionBegin;
  PetscCall(EqmLedgerCreate(PETSC_COMM_WORLD, &ledger));
  PetscCall(EqmSoupRead(PETSC_COMM_WORLD, line->argument[0], &soup));
  if (options->density[0]) PetscCall(EqmSoupReadDensity(soup, options->density));
  PetscCall(CheckMeasurable(soup));
  PetscCall(EqmMapRead(soup, line->argument[1], &map));
  PetscCall(EqmMeshCreate(soup, ledger, &mesh));
  PetscCall(EqmMapGetDimension(map, &dim));
  PetscCall(EqmMapGetCoordinates(map, &coordinates));
  PetscCall(PetscMalloc1(dim * mesh->num_local, &x));
  PetscCall(EqmMeshVerticesFromInput(mesh, soup, dim, coordinates, x));
  PetscCall(EqmMapMeasure(map, mesh, x));
  PetscCall(PetscFree(x));
  PetscCall(EqmMapGetDistortion(map, &distortion));
  *status = distortion->folds ? EQM_STATUS_FOLDS : EQM_STATUS_CONVERGED;
  PetscCall(EqmMapSetStatus(map, *status, ""));
  PetscCall(EqmMapSetEnergies(map, distortion->energy, distortion->energy));
  PetscCall(EqmMapSetCommand(map, "measure"));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s as a map of %s\n", line->argument[1], line->argument[0]));
  PetscCall(Print(distortion, (PetscBool)(soup->cell_size == 3)));
  if (options->summary[0]) PetscCall(EqmMapWriteSummary(map, options->summary));
  if (options->histogram[0]) PetscCall(EqmMapWriteHistogram(map, options->histogram));
  PetscCall(EqmMapDestroy(&map));
  PetscCall(EqmMeshDestroy(&mesh));
  PetscCall(EqmSoupDestroy(&soup));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCommandMeasure(const EqmCommandLine *line, EqmStatus *status)
{
  MeasureOptions options = {.density = ""};

  PetscFunctionBegin;
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "Files", NULL);
  PetscCall(PetscOptionsString("-density", "a positive weight per cell: measure mass instead of area", NULL, "",
                               options.density, sizeof(options.density), NULL));
  PetscCall(PetscOptionsString("-summary", "write the figures as JSON", NULL, "", options.summary,
                               sizeof(options.summary), NULL));
  PetscCall(PetscOptionsString("-histogram", "write the histogram of angle errors as CSV", NULL, "", options.histogram,
                               sizeof(options.histogram), NULL));
  PetscOptionsEnd();
  if (line->help) PetscFunctionReturn(0);
  PetscCall(EqmRejectUnknownOptions(line));
  if (line->num_arguments != 2) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE,
            "measure wants a mesh and a map, %d given; usage: equimap measure MESH MAP", line->num_arguments);
  }
  PetscCall(Measure(line, &options, status));
  PetscFunctionReturn(0);
}
