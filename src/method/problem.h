/* What is minimised, and where: the problems that the map commands solve, each a row of problem.c. */
#ifndef EQM_PROBLEM_H
#define EQM_PROBLEM_H

#include "method/objective.h"

typedef struct EqmMethod EqmMethod;

/* A method as a problem offers it. */
typedef struct {
  const EqmMethod *method;
  const char *start; /* its first map unless -start names one */
  PetscInt max_it;
  PetscReal energy_rtol, ratio_tol, gradient_tol;
} EqmOffer;

/* Which first maps there are to choose from. */
typedef enum { EQM_STARTS_PLANE, EQM_STARTS_SPHERE, EQM_STARTS_BALL } EqmStartFamily;

typedef struct {
  const char *target;                            /* the command; several rows may share it, told apart by the mesh */
  const char *place;                             /* in messages: "-method rgd is not for the disk" */
  PetscErrorCode (*takes)(EqmMesh, PetscBool *); /* is this the row for the mesh? NULL: yes */
  PetscErrorCode (*options)(EqmSolver, PetscOptionItems *); /* of its own; NULL: none */
  PetscErrorCode (*create_domain)(EqmSolver, EqmDomain *);
  const EqmObjective *objective;
  PetscErrorCode (*unfold)(EqmSolver, PetscInt64 *before, PetscInt64 *after); /* mend folds; NULL: cannot */
  PetscErrorCode (*finish)(EqmSolver); /* a last change to the map when the method has ended; NULL: none */
  EqmStartFamily starts;
  PetscBool takes_balance; /* -balance has a meaning */
  const EqmOffer *offers;  /* the first is -method auto */
  PetscInt num_offers;
} EqmProblem;

/* The problem of a target for a mesh. Without a mesh (NULL) the target's first. Errors: EQM_ERR_USAGE. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemFind(MPI_Comm comm, const char *target, EqmMesh mesh, const EqmProblem **problem);
/* Does the target have one row only, so that its problem is known before the mesh is? Not collective. */
PETSC_INTERN PetscBool EqmProblemIsSettled(const char *target);
/* The offer of a method's name; "auto" is the first. Errors: EQM_ERR_USAGE. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemFindOffer(MPI_Comm comm, const EqmProblem *problem, const char *method,
                                                const EqmOffer **offer);
/* Names of the methods for a target, of all its rows, separated by commas. Not collective. */
PETSC_INTERN PetscErrorCode EqmProblemMethodNames(const char *target, char *text, size_t length);
/* Ask the options database for what the target's rows and their methods have of their own. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemAskOptions(EqmSolver solver, PetscOptionItems *PetscOptionsObject);

/* ---- options of one problem only (src/method/problem_options.c) */
PETSC_INTERN PetscErrorCode EqmAskCorners(EqmSolver solver, PetscOptionItems *PetscOptionsObject);
PETSC_INTERN PetscErrorCode EqmAskCenter(EqmSolver solver, PetscOptionItems *PetscOptionsObject);
PETSC_INTERN PetscErrorCode EqmAskConformal(EqmSolver solver, PetscOptionItems *PetscOptionsObject);
PETSC_INTERN PetscErrorCode EqmAskBall(EqmSolver solver, PetscOptionItems *PetscOptionsObject);

#endif
