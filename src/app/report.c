/* equimap report RESULT... -o FILE: pictures and plots of results. */
#include "app.h"
#include "picture/picture.h"
#include <string.h>

static const char usage[] =
    "usage: equimap report RESULT.h5 [MORE.h5 ...] -o FILE.png|.pdf|.svg|.html [-view AZIMUTH,ELEVATION] [-up AXIS] "
    "[-width PIXELS]";

static PetscErrorCode ReadOptions(EqmReportOptions *options, char *output, size_t length)
{
  PetscReal eye[2] = {0., 0.};
  PetscInt count = 2;

  PetscFunctionBegin;
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "equimap report RESULT.h5 -o FILE", "");
  PetscCall(PetscOptionsString("-o", "the picture: .png, .pdf, .svg or .html", "", output, output, length, NULL));
  PetscCall(
      PetscOptionsBoundedInt("-width", "width of the page in pixels", "", options->width, &options->width, NULL, 200));
  PetscCall(PetscOptionsRealArray("-view",
                                  "azimuth,elevation: look from so many degrees around the upward axis and above the "
                                  "horizon, in place of where the mesh seems to want it",
                                  "", eye, &count, &options->has_eye));
  PetscCall(PetscOptionsString("-up", "the axis that points up: x, y, z, -x, -y or -z", "", options->up, options->up,
                               sizeof(options->up), NULL));
  PetscOptionsEnd();
  if (options->has_eye && count != 2)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-view: give two numbers, azimuth,elevation in degrees");
  options->azimuth = eye[0];
  options->elevation = eye[1];
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckOptions(const EqmCommandLine *line, const EqmReportOptions *options, const char *output)
{
  static const char *const axes[] = {"", "x", "y", "z", "-x", "-y", "-z"};
  PetscBool known = PETSC_FALSE;

  PetscFunctionBegin;
  if (line->num_arguments < 1 || !output[0]) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "%s", usage);
  if (options->width > 8000)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-width %" PetscInt_FMT ": at most 8000 pixels", options->width);
  for (size_t k = 0; k < sizeof(axes) / sizeof(axes[0]); k++)
    known = (PetscBool)(known || !strcmp(options->up, axes[k]));
  if (!known) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-up %s: give one of x, y, z, -x, -y, -z", options->up);
  PetscFunctionReturn(0);
}

/* Draw one page: of each result the surface or solid and its image, coloured by ratio or, where angles are to be kept,
   by stretch, a pattern pulled back; distribution, convergence, figures. Options: -o FILE (.png .pdf .svg .html),
   -width PIXELS, -view AZIMUTH,ELEVATION, -up AXIS. Errors: EQM_ERR_USAGE, EQM_ERR_IO. Collective. */
PetscErrorCode EqmCommandReport(const EqmCommandLine *line, EqmStatus *status)
{
  EqmReportOptions options = {.width = 2000};
  char output[PETSC_MAX_PATH_LEN] = "";

  PetscFunctionBegin;
  PetscCall(ReadOptions(&options, output, sizeof(output)));
  if (line->help) PetscFunctionReturn(0);
  PetscCall(EqmRejectUnknownOptions(line));
  PetscCall(CheckOptions(line, &options, output));
  PetscCall(EqmReportWrite(PETSC_COMM_WORLD, line->num_arguments, line->argument, output, &options));
  *status = EQM_STATUS_CONVERGED;
  PetscFunctionReturn(0);
}
