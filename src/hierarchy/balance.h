#ifndef EQM_BALANCE_H
#define EQM_BALANCE_H

#include "hierarchy/levelmap.h"
#include "hierarchy/levelsystem.h"

/* Places of inner vertices of a planar map at the mean of their neighbours', boundary vertices held: no fold where the
   boundary's image is convex and no edge joins two vertices of one side (Tutte 1963). Not collective. */
PETSC_INTERN PetscErrorCode EqmTutteLevel(EqmLevelMap *map);
typedef struct {
  PetscInt most_steps;
  PetscReal gain;      /* enough where a whole step gains less than that part of the objective */
  PetscReal tolerance; /* of the linear systems, where they are not factored */
  PetscReal damping;   /* at first */
} EqmBalanceOptions;

/* Bring the objective towards its minimum by Gauss-Newton steps, each of which keeps the map free of folds. `map` is
   followed by those of `coarser` ever coarser levels, which multigrid uses and whose places it sets; without any the
   matrices are factored. Not collective. */
PETSC_INTERN PetscErrorCode EqmBalanceLevel(EqmLevelMap *map, PetscInt coarser, const EqmBalanceOptions *options);

/* ---- the parts of a step */
/* The system of the directions that the map's vertices have. Not collective. */
PETSC_INTERN PetscErrorCode EqmBalanceSystemCreate(const EqmLevelMap *map, EqmLevelSystem *system);
/* Its matrix and right-hand side at the present map; `residual`: that of its value. `success` is false where the matrix
   is not definite. Not collective. */
PETSC_INTERN PetscErrorCode EqmBalanceAssemble(const EqmLevelMap *map, PetscReal damping, PetscReal residual,
                                               EqmLevelSystem *system, PetscBool *success);
/* The places at length t along a step, two numbers per vertex. Not collective. */
PETSC_INTERN void EqmBalanceMove(const EqmLevelMap *map, const PetscReal *step, PetscReal t, PetscReal *to);
/* Halve the step until the objective falls, and once more if that is better still; the map is then there. `value`: the
   map's, before and after. `t`: the step taken, 0: none. As collective as `evaluate`, which is EqmLevelMapEvaluate or
   the like. */
typedef PetscErrorCode (*EqmBalanceEvaluate)(void *context, EqmLevelMap *map, const PetscReal *x, EqmLevelValue *value);
PETSC_INTERN PetscErrorCode EqmBalanceSearch(EqmLevelMap *map, const PetscReal *step, EqmBalanceEvaluate evaluate,
                                             void *context, EqmLevelValue *value, PetscReal *t);
/* Less damping after whole steps, more after short ones. Not collective. */
PETSC_INTERN PetscReal EqmBalanceNextDamping(PetscReal damping, PetscReal t);

/* Of one cell: matrix (6 x 6, row by row) and half the negative gradient of one cell's part of the objective in the
   directions of its corners' frames, `frame` 6 per corner; `size` of them in `unknown` order. */
typedef struct {
  PetscInt count[3];     /* directions per corner */
  PetscReal frame[3][6]; /* of EqmMotionFrame */
  PetscReal matrix[36], right[6];
} EqmCellSystem;
/* `damping`: factor of the residual-weighted Laplacian; `floor`: what is added to |rho| there. Not collective. */
PETSC_INTERN void EqmBalanceCell(const EqmLevelMap *map, PetscInt cell, PetscReal damping, PetscReal floor,
                                 EqmCellSystem *system);
/* Add it to the system. Not collective. */
PETSC_INTERN void EqmBalanceAddCell(const EqmLevelMap *map, PetscInt cell, PetscReal damping, PetscReal floor,
                                    EqmLevelSystem *system);

#endif
