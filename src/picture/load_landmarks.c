/* Read the landmarks of a registration for a report. */
#include "picture/load.h"

/* The points of B to which the landmarks belong: named by vertices of B, or by coordinates. */
static PetscErrorCode LoadGoals(EqmH5 h5, EqmResult *result)
{
  const PetscInt n = result->num_landmarks;
  PetscReal *vertices = NULL, *number = NULL;
  PetscInt rows, count;
  PetscBool named;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * n, &result->landmark_goal));
  PetscCall(EqmH5HasDataset(h5, "/register/landmarks/vertex_b", &named));
  if (!named) {
    PetscInt64 total, width;
    PetscCall(EqmH5GetShape(h5, "/register/landmarks/point", &total, &width));
    PetscCall(EqmLoadReals(h5, "/register/landmarks/point", width, &count, &vertices));
    for (PetscInt k = 0; k < n * PetscMin(width, 3) && count == n; k++)
      result->landmark_goal[3 * (k / width) + k % width] = vertices[k];
    PetscCall(PetscFree(vertices));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmLoadReals(h5, "/register/landmarks/vertex_b", 0, &count, &number));
  PetscCall(EqmLoadReals(h5, "/mesh_b/vertices", 3, &rows, &vertices));
  for (PetscInt k = 0; k < 3 * n && count == n; k++) {
    const PetscReal v = number[k / 3];
    if (v >= 0. && v < rows) result->landmark_goal[k] = vertices[3 * (PetscInt)v + k % 3];
  }
  PetscCall(PetscFree(number));
  PetscCall(PetscFree(vertices));
  PetscFunctionReturn(0);
}

/* Where the landmarks should go in the target, and which curves they are vertices of. */
static PetscErrorCode LoadTargetsAndCurves(EqmH5 h5, EqmResult *result)
{
  const PetscInt n = result->num_landmarks, dim = result->target_dim;
  PetscReal *places, *number;
  PetscInt count;
  PetscBool has;

  PetscFunctionBegin;
  PetscCall(EqmH5HasDataset(h5, "/register/landmarks/goal", &has));
  if (has) {
    PetscCall(EqmLoadReals(h5, "/register/landmarks/goal", dim, &count, &places));
    PetscCall(PetscCalloc1(3 * n, &result->landmark_target));
    for (PetscInt k = 0; k < dim * n && count == n; k++) result->landmark_target[3 * (k / dim) + k % dim] = places[k];
    PetscCall(PetscFree(places));
  }
  PetscCall(EqmH5HasDataset(h5, "/register/landmarks/curve", &has));
  if (!has) PetscFunctionReturn(0);
  PetscCall(EqmLoadReals(h5, "/register/landmarks/curve", 0, &count, &number));
  PetscCall(PetscMalloc1(n, &result->curve));
  for (PetscInt k = 0; k < n; k++) result->curve[k] = count == n ? (PetscInt)number[k] : -1;
  PetscCall(PetscFree(number));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLoadLandmarks(EqmH5 h5, EqmResult *result)
{
  PetscReal *number;
  PetscBool has;

  PetscFunctionBegin;
  PetscCall(EqmH5HasDataset(h5, "/register/landmarks/vertex", &has));
  if (!has) PetscFunctionReturn(0);
  PetscCall(EqmLoadReals(h5, "/register/landmarks/vertex", 0, &result->num_landmarks, &number));
  PetscCall(PetscMalloc1(result->num_landmarks, &result->landmark));
  for (PetscInt k = 0; k < result->num_landmarks; k++)
    result->landmark[k] = (PetscInt)PetscClipInterval(number[k], 0., (PetscReal)result->num_vertices - 1.);
  PetscCall(PetscFree(number));
  PetscCall(LoadGoals(h5, result));
  if (result->target) PetscCall(LoadTargetsAndCurves(h5, result));
  PetscFunctionReturn(0);
}
