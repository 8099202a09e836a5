/* The registry of starts, and their options. */
#include "start/start.h"
#include "base/nearest.h"
#include <string.h>

enum { MOST_STARTS = 64 };
static const EqmStartType *starts[MOST_STARTS] = {
    &EqmStartPlaneHarmonic,  &EqmStartPlaneFixedPoint,  &EqmStartPlaneTutte,       &EqmStartPlaneGuarded,
    &EqmStartPlaneArcLength, &EqmStartSphereLinearType, &EqmStartSphereFixedPoint, &EqmStartSphereDescending,
    &EqmStartSphereGuarded,  &EqmStartSphereConformal,  &EqmStartSphereResolved,   &EqmStartSphereNormals,
    &EqmStartSphereGauss,    &EqmStartSphereTutte,      &EqmStartBallHarmonic,     &EqmStartBallFixedPoint,
    &EqmStartBallGuarded,    &EqmStartPlaneCascade,     &EqmStartSphereCascade,    &EqmStartSphereSolidAngle,
};

PetscErrorCode EqmStartRegister(const EqmStartType *type)
{
  PetscInt k = 0;

  PetscFunctionBegin;
  while (k < MOST_STARTS && starts[k]) k++;
  PetscCheck(k < MOST_STARTS, PETSC_COMM_SELF, PETSC_ERR_SUP, "no room for more than %d starts", MOST_STARTS);
  starts[k] = type;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStartFind(MPI_Comm comm, EqmStartFamily family, const char *place, const char *name,
                            const EqmStartType **type)
{
  static const EqmStartType *const of_file[] = {&EqmStartFilePlane, &EqmStartFileSphere, &EqmStartFileBall};
  char names[EQM_MESSAGE_MAX], hint[128];

  PetscFunctionBegin;
  *type = of_file[family];
  if (EqmStartIsFile(name)) PetscFunctionReturn(0);
  for (PetscInt k = 0; k < MOST_STARTS && starts[k]; k++) {
    PetscBool same;
    PetscCall(PetscStrcmp(name, starts[k]->name, &same));
    if (!same || starts[k]->family != family) continue;
    *type = starts[k];
    PetscFunctionReturn(0);
  }
  PetscCall(EqmStartNames(family, names, sizeof(names)));
  PetscCall(EqmDidYouMean(name, names, hint, sizeof(hint)));
  EqmFail(comm, EQM_ERR_USAGE, "-start %s: there is no such start for the %s; choose one of %s, or a file%s", name,
          place, names, hint);
}

PetscErrorCode EqmStartNames(EqmStartFamily family, char *text, size_t length)
{
  PetscFunctionBegin;
  text[0] = '\0';
  for (PetscInt k = 0; k < MOST_STARTS && starts[k]; k++) {
    if (starts[k]->family != family) continue;
    PetscCall(PetscStrlcat(text, text[0] ? ", " : "", length));
    PetscCall(PetscStrlcat(text, starts[k]->name, length));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStartOptionsDefault(EqmStartOptions *options)
{
  PetscFunctionBegin;
  *options = (EqmStartOptions){.steps = -1, .anisotropic_scaling = PETSC_TRUE};
  PetscFunctionReturn(0);
}

static const char *const hemisphere_weights[] = {
    "uniform", "harmonic", "mean-value", "semi-cotangent", "EqmHemisphereWeights", "", NULL};

PetscErrorCode EqmStartSetFromOptions(EqmStartFamily family, EqmStartOptions *options,
                                      PetscOptionItems *PetscOptionsObject)
{
  char text[EQM_MESSAGE_MAX] = "the first map, a path or one of: ";

  PetscFunctionBegin;
  PetscCall(EqmStartNames(family, text + strlen(text), sizeof(text) - strlen(text)));
  PetscCall(PetscOptionsString("-start", text, "EqmSolverSetFromOptions", options->name, options->name,
                               sizeof(options->name), NULL));
  PetscCall(PetscOptionsInt("-start_steps", "fixed-point steps after the first map (-1: as the start has it)",
                            "EqmSolverSetFromOptions", options->steps, &options->steps, NULL));
  if (family == EQM_STARTS_SPHERE)
    PetscCall(PetscOptionsEnum("-start_weights",
                               "of the start tutte: each vertex of a hemisphere is the mean of its neighbours with "
                               "these weights (004 section 5.1); harmonic ones may fold",
                               "EqmSolverSetFromOptions", hemisphere_weights, (PetscEnum)options->hemisphere_weights,
                               (PetscEnum *)&options->hemisphere_weights, NULL));
  if (family == EQM_STARTS_SPHERE)
    PetscCall(PetscOptionsBool("-start_center",
                               "after the first map the Mobius map that brings its mass centre to the sphere's",
                               "EqmSolverSetFromOptions", options->center, &options->center, NULL));
  if (family == EQM_STARTS_BALL)
    PetscCall(PetscOptionsBool("-anisotropic_scaling",
                               "start: turn and scale the solid to fill a cube, axis by axis, before its first map",
                               "EqmSolverSetFromOptions", options->anisotropic_scaling, &options->anisotropic_scaling,
                               NULL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStartRun(const EqmStartType *type, EqmProblem problem, EqmIterate iterate,
                           const EqmStartOptions *options)
{
  EqmStartOptions settled = *options;

  PetscFunctionBegin;
  if (settled.steps < 0) settled.steps = type->steps;
  PetscCall(type->run(problem, iterate, &settled));
  PetscCall(EqmPlaceMakeFrames(problem->domain, &iterate->place));
  if (options->center) PetscCall(EqmIterateCenter(problem, iterate));
  PetscFunctionReturn(0);
}
