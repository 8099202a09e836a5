/* equimap report RESULT... -o FILE: pictures and plots of results. */
#include "app.h"
#include "picture/picture.h"
#include <string.h>

static const char usage[] =
    "usage: equimap report RESULT.h5 [MORE.h5 ...] -o FILE.png|.pdf|.svg|.html [-view AZIMUTH,ELEVATION] [-up AXIS] "
    "[-start START.h5] [-width PIXELS]";

static PetscErrorCode ReadOptions(EqmReportOptions *options, char *output, size_t length)
{
  static const char *const curves[] = {"auto", "energy", "excess", "gradient"}; /* as EqmCurve */
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
  PetscCall(PetscOptionsString("-start",
                               "a map of the same mesh that is drawn beside the image: the start of the run, made with "
                               "-max_it 0, or any other",
                               "", options->start, options->start, sizeof(options->start), NULL));
  PetscCall(PetscOptionsEList("-convergence",
                              "what the curves show: the energy, its excess over its smallest value, the gradient's "
                              "norm; auto: energy, of conformal maps the gradient",
                              "", curves, 4, curves[options->curve], &options->curve, NULL));
  PetscCall(PetscOptionsString("-lines",
                               "curves to draw on the surface and on its image (on A and B): a CSV file with a header "
                               "and rows curve,vertex in the order along each curve",
                               "", options->lines, options->lines, sizeof(options->lines), NULL));
  PetscCall(PetscOptionsReal("-sharp", "draw edges where faces meet at more than so many degrees, on both sides", "",
                             options->sharp, &options->sharp, NULL));
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
  if (options->sharp < 0. || options->sharp > 180.)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-sharp %.6g: give an angle between 0 and 180 degrees",
            (double)options->sharp);
  for (size_t k = 0; k < sizeof(axes) / sizeof(axes[0]); k++)
    known = (PetscBool)(known || !strcmp(options->up, axes[k]));
  if (!known) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-up %s: give one of x, y, z, -x, -y, -z", options->up);
  PetscFunctionReturn(0);
}

/* Draw one page: of each result the surface or solid and its image, coloured by ratio or, where angles are to be kept,
   by stretch, a pattern pulled back; distribution, convergence, figures. Options: -o FILE (.png .pdf .svg .html),
   -width PIXELS, -view AZIMUTH,ELEVATION, -up AXIS, -start RESULT, -convergence NAME, -lines FILE, -sharp DEGREES.
   Errors: EQM_ERR_USAGE, EQM_ERR_IO. Collective. */
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
