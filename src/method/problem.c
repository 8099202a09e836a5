/* The table of problems: energy x domain, and the methods that solve them. */
#include "method/method.h"
#include <string.h>

/* ---- domains */
static PetscErrorCode CreateDisk(EqmSolver solver, EqmDomain *domain)
{
  PetscFunctionBegin;
  PetscCall(EqmDomainCreateDisk(solver->mesh, domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode CreateSquare(EqmSolver solver, EqmDomain *domain)
{
  PetscFunctionBegin;
  PetscCall(
      EqmDomainCreateSquare(solver->mesh, solver->settings.has_corners ? solver->settings.corners : NULL, domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode CreateSphere(EqmSolver solver, EqmDomain *domain)
{
  PetscFunctionBegin;
  PetscCall(EqmDomainCreateSphere(solver->mesh, domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode CreateBall(EqmSolver solver, EqmDomain *domain)
{
  PetscFunctionBegin;
  PetscCall(EqmDomainCreateBall(solver->mesh, domain));
  if (solver->method == &EqmMethodNcg) PetscCall(EqmDomainTakeSphericalCoordinates(*domain));
  PetscFunctionReturn(0);
}

/* ---- meshes */
static PetscErrorCode HasBoundary(EqmMesh mesh, PetscBool *has)
{
  PetscFunctionBegin;
  *has = (PetscBool)(mesh->num_boundary_vertices > 0);
  PetscFunctionReturn(0);
}

static PetscErrorCode IsClosed(EqmMesh mesh, PetscBool *closed)
{
  PetscFunctionBegin;
  *closed = (PetscBool)(mesh->num_boundary_vertices == 0);
  PetscFunctionReturn(0);
}

/* ---- methods: name, first map, -max_it, -energy_rtol, -ratio_tol, -gradient_tol */
static const EqmOffer in_plane[] = {
    {&EqmMethodLm, "guarded", 60, .05, 1e-4, 0.},      {&EqmMethodFixedPoint, "harmonic", 100, 1e-4, 0., 0.},
    {&EqmMethodNcg, "fixed-point", 100, 1e-4, 0., 0.}, {&EqmMethodLbfgs, "guarded", 200, 1e-3, 0., 0.},
    {&EqmMethodRgd, "guarded", 100, 1e-6, 0., 0.},
};

static const EqmOffer on_sphere[] = {
    {&EqmMethodLm, "guarded", 60, .05, 1e-4, 0.},     {&EqmMethodFixedPoint, "linear", 100, 1e-4, 0., 0.},
    {&EqmMethodNcg, "guarded", 100, 1e-4, 0., 0.},    {&EqmMethodLbfgs, "guarded", 200, 1e-3, 0., 0.},
    {&EqmMethodRgd, "descending", 100, 1e-6, 0., 0.},
};

static const EqmOffer conformal_in_disk[] = {
    {&EqmMethodRiemann, "arc-length", 100, 0., 0., 1e-5},
    {&EqmMethodCovering, "harmonic", 500, 0., 0., 0.},
};

static const EqmOffer conformal_on_sphere[] = {
    {&EqmMethodLbfgs, "conformal", 100, 0., 0., 1e-5},
    {&EqmMethodQiem, "normals", 500, 0., 0., 0.},
    {&EqmMethodEulerExplicit, "gauss", 10000, 0., 0., 0.},
    {&EqmMethodEulerImplicit, "gauss", 500, 0., 0., 0.},
};

static const EqmOffer in_ball[] = {
    {&EqmMethodLbfgs, "fixed-point", 500, 1e-8, 0., 0.},
    {&EqmMethodNewton, "fixed-point", 300, 1e-9, 0., 0.},
    {&EqmMethodFixedPoint, "harmonic", 500, 1e-6, 0., 0.},
    {&EqmMethodNcg, "fixed-point", 500, 1e-6, 0., 0.},
};

#define OFFERS(list) .offers = (list), .num_offers = sizeof(list) / sizeof((list)[0])

static const EqmProblem problems[] = {
    {.target = "disk",
     .place = "disk",
     .create_domain = CreateDisk,
     .objective = &EqmObjectiveAuthalic,
     .starts = EQM_STARTS_PLANE,
     .takes_balance = PETSC_TRUE,
     OFFERS(in_plane)},
    {.target = "square",
     .place = "square",
     .options = EqmAskCorners,
     .create_domain = CreateSquare,
     .objective = &EqmObjectiveAuthalic,
     .starts = EQM_STARTS_PLANE,
     .takes_balance = PETSC_TRUE,
     OFFERS(in_plane)},
    {.target = "sphere",
     .place = "sphere",
     .options = EqmAskCenter,
     .create_domain = CreateSphere,
     .objective = &EqmObjectiveAuthalic,
     .unfold = EqmSphereUnfold,
     .starts = EQM_STARTS_SPHERE,
     OFFERS(on_sphere)},
    {.target = "conformal",
     .place = "disk",
     .takes = HasBoundary,
     .create_domain = CreateDisk,
     .objective = &EqmObjectiveConformal,
     .unfold = EqmDiskUnfold,
     .starts = EQM_STARTS_PLANE,
     OFFERS(conformal_in_disk)},
    {.target = "conformal",
     .place = "sphere",
     .takes = IsClosed,
     .options = EqmAskConformal,
     .create_domain = CreateSphere,
     .objective = &EqmObjectiveConformal,
     .unfold = EqmSphereUnfold,
     .finish = EqmConformalFinish,
     .starts = EQM_STARTS_SPHERE,
     OFFERS(conformal_on_sphere)},
    {.target = "ball",
     .place = "ball",
     .options = EqmAskBall,
     .create_domain = CreateBall,
     .objective = &EqmObjectiveAuthalic,
     .unfold = EqmBallUnfold,
     .starts = EQM_STARTS_BALL,
     OFFERS(in_ball)},
};
enum { NUM_PROBLEMS = sizeof(problems) / sizeof(problems[0]) };

PetscErrorCode EqmProblemFind(MPI_Comm comm, const char *target, EqmMesh mesh, const EqmProblem **problem)
{
  PetscFunctionBegin;
  *problem = NULL;
  for (PetscInt k = 0; k < NUM_PROBLEMS && !*problem; k++) {
    PetscBool takes = PETSC_TRUE;
    if (strcmp(problems[k].target, target)) continue;
    if (mesh && problems[k].takes) PetscCall(problems[k].takes(mesh, &takes));
    if (takes) *problem = &problems[k];
  }
  if (!*problem) EqmFail(comm, EQM_ERR_USAGE, "there is no map of this mesh to the target '%s'", target);
  PetscFunctionReturn(0);
}

PetscBool EqmProblemIsSettled(const char *target)
{
  PetscInt rows = 0;

  for (PetscInt k = 0; k < NUM_PROBLEMS; k++) rows += !strcmp(problems[k].target, target);
  return (PetscBool)(rows == 1);
}

PetscErrorCode EqmProblemFindOffer(MPI_Comm comm, const EqmProblem *problem, const char *method, const EqmOffer **offer)
{
  char names[EQM_MESSAGE_MAX];

  PetscFunctionBegin;
  *offer = strcmp(method, "auto") ? NULL : &problem->offers[0];
  for (PetscInt k = 0; k < problem->num_offers && !*offer; k++) {
    if (!strcmp(problem->offers[k].method->name, method)) *offer = &problem->offers[k];
  }
  if (*offer) PetscFunctionReturn(0);
  PetscCall(EqmProblemMethodNames(problem->target, names, sizeof(names)));
  EqmFail(comm, EQM_ERR_USAGE, "-method %s: there is no such method for the %s; choose one of %s", method,
          problem->place, names);
}

/* Call `visit` for every method that the target's rows offer, once for each name: its options are the same. */
static PetscErrorCode ForEachMethod(const char *target, PetscErrorCode (*visit)(const EqmMethod *, void *),
                                    void *context)
{
  const EqmMethod *seen[32];
  PetscInt num_seen = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < NUM_PROBLEMS; k++) {
    if (strcmp(problems[k].target, target)) continue;
    for (PetscInt o = 0; o < problems[k].num_offers; o++) {
      const EqmMethod *const method = problems[k].offers[o].method;
      PetscInt s = 0;
      while (s < num_seen && strcmp(seen[s]->name, method->name)) s++;
      if (s < num_seen) continue;
      seen[num_seen++] = method;
      PetscCall(visit(method, context));
    }
  }
  PetscFunctionReturn(0);
}

typedef struct {
  char *text;
  size_t length;
} NameList;

static PetscErrorCode AppendName(const EqmMethod *method, void *context)
{
  NameList *const list = context;

  PetscFunctionBegin;
  PetscCall(PetscStrlcat(list->text, ", ", list->length));
  PetscCall(PetscStrlcat(list->text, method->name, list->length));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemMethodNames(const char *target, char *text, size_t length)
{
  NameList list = {text, length};

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(text, "auto", length));
  PetscCall(ForEachMethod(target, AppendName, &list));
  PetscFunctionReturn(0);
}

typedef struct {
  EqmSolver solver;
  PetscOptionItems *items;
} Asking;

static PetscErrorCode AskMethod(const EqmMethod *method, void *context)
{
  const Asking *const asking = context;

  PetscFunctionBegin;
  if (method->options) PetscCall(method->options(asking->solver, asking->items));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemAskOptions(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  Asking asking = {solver, PetscOptionsObject};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < NUM_PROBLEMS; k++) {
    if (strcmp(problems[k].target, solver->target) || !problems[k].options) continue;
    PetscCall(problems[k].options(solver, PetscOptionsObject));
  }
  PetscCall(ForEachMethod(solver->target, AskMethod, &asking));
  PetscFunctionReturn(0);
}
