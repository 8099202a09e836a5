/* What a target means for a mesh: domain, objective, first maps, methods and their settings. One table, formulation.c.
 */
#ifndef EQM_FORMULATION_H
#define EQM_FORMULATION_H

#include <equimap/solver.h>
#include "method/method.h"
#include "start/start.h"

/* Default settings of a method for a formulation. */
typedef struct {
  const char *name;   /* of -method */
  const char *method; /* as it is registered */
  const char *start;
  PetscInt max_it;
  PetscReal energy_rtol, ratio_tol, gradient_tol;
  PetscErrorCode (*configure)(EqmMethod); /* settings of the method's own; NULL: as it is created */
  const char *domain;                     /* NULL: the formulation's */
} EqmMethodDefaults;

/* Mends folds; counts them before and after. */
typedef PetscErrorCode (*EqmUnfold)(EqmProblem, EqmIterate, PetscInt64 *before, PetscInt64 *after);

/* A start that is tried where the default's leads to a map with more energy than `far_energy`, per measure of the
   image, or with folds. */
typedef struct {
  const char *name;
  PetscReal far_energy;
} EqmOtherStart;

typedef struct {
  const char *target, *domain; /* of the tables in mesh/target.c; the mesh decides between several rows of a target */
  const EqmObjective *objective;
  /* Folds mended, and that as the paper prints it; NULL: cannot. */
  EqmUnfold unfold, unfold_as_printed;
  PetscErrorCode (*finish)(EqmSolver); /* a last change to the map when the method has ended; NULL: none */
  EqmStartFamily starts;
  const EqmOtherStart *other_starts; /* one after the other, up to one without a name; NULL: none */
  const char *where_limbs_fold;      /* what to try there, unless the start was `resolved`; NULL: nothing special */
  PetscBool takes_balance;           /* -balance has a meaning */
  const EqmMethodDefaults *methods;  /* the first is -method auto */
  PetscInt num_methods;
} EqmFormulation;

/* The formulation of a target for a mesh. Without a mesh (NULL) the target's first. Errors: EQM_ERR_USAGE. Collective.
 */
PETSC_INTERN PetscErrorCode EqmFormulationFind(MPI_Comm comm, const char *target, EqmMesh mesh,
                                               const EqmFormulation **formulation);
/* The next one of the same target after `formulation`, of NULL the first; NULL where there is none. Not collective. */
PETSC_INTERN const EqmFormulation *EqmFormulationNext(const char *target, const EqmFormulation *formulation);
/* The default settings of a method by name; "auto" is the first. A registered method that the table does not list gets
   the general defaults. Errors: EQM_ERR_USAGE. Collective. */
PETSC_INTERN PetscErrorCode EqmFormulationFindMethod(MPI_Comm comm, const EqmFormulation *formulation, const char *name,
                                                     EqmMethodDefaults *defaults);
/* Names of the methods for a target, or for one formulation of it unless that is NULL, separated by commas. Not
   collective. */
PETSC_INTERN PetscErrorCode EqmFormulationMethodNames(const char *target, const EqmFormulation *formulation, char *text,
                                                      size_t length);

#endif
