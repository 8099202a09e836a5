/* equimap report RESULT -o FILE: pictures and plots of a result for people. */
#include "app.h"
#include "picture/picture.h"

/* Draw one page of a result: the surface and its image coloured by area ratio, a checkerboard pulled back, histogram,
   convergence, numbers. Options: -o FILE (.png .pdf .svg .html), -width PIXELS. Errors: EQM_ERR_USAGE, EQM_ERR_IO.
   Collective. */
PetscErrorCode EqmCommandReport(const EqmCommandLine *line, EqmStatus *status)
{
  char output[PETSC_MAX_PATH_LEN] = "";
  PetscInt width = 2000;
  PetscBool given;

  PetscFunctionBegin;
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "equimap report RESULT.h5 -o FILE", "");
  PetscCall(
      PetscOptionsString("-o", "the picture: .png, .pdf, .svg or .html", "", output, output, sizeof(output), &given));
  PetscCall(PetscOptionsBoundedInt("-width", "width of the page in pixels", "", width, &width, NULL, 200));
  PetscOptionsEnd();
  if (line->help) PetscFunctionReturn(0);
  PetscCall(EqmRejectUnknownOptions(line));
  if (line->num_arguments != 1 || !given || !output[0]) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE,
            "usage: equimap report RESULT.h5 -o FILE.png|.pdf|.svg|.html [-width PIXELS]");
  }
  if (width > 8000) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-width %" PetscInt_FMT ": at most 8000 pixels", width);
  PetscCall(EqmReportWrite(PETSC_COMM_WORLD, line->argument[0], output, width));
  *status = EQM_STATUS_CONVERGED;
  PetscFunctionReturn(0);
}
