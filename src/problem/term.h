/* Terms that an objective consists of beside its leading one: a linked list of the problem's, which the methods of
   descent (lbfgs, ncg, rgd) minimise together. A new term is one file: a structure that begins with struct _p_EqmTerm.
 */
#ifndef EQM_TERM_H
#define EQM_TERM_H

#include "problem/problem.h"

typedef struct _p_EqmTerm *EqmTerm;
struct _p_EqmTerm {
  const char *name;
  PetscReal weight;
  /* Add weight times the value at a place and, unless NULL, of the gradient in degrees of freedom; `image` holds the
     measures of the cells there. Collective. */
  PetscErrorCode (*add)(EqmTerm, EqmProblem, const EqmPlace *place, const PetscReal *image, PetscReal *value,
                        Vec gradient);
  PetscErrorCode (*destroy)(EqmTerm); /* free the structure; NULL: somebody else does */
  EqmTerm next;
};

/* The problem's objective gets another term, which belongs to the problem if it has a destroy function. Not collective.
 */
PETSC_INTERN PetscErrorCode EqmProblemAddTerm(EqmProblem problem, EqmTerm term);
/* Take a term out again, without destroying it. Not collective. */
PETSC_INTERN PetscErrorCode EqmProblemRemoveTerm(EqmProblem problem, EqmTerm term);
PETSC_INTERN PetscErrorCode EqmProblemDestroyTerms(EqmProblem problem);
/* The whole objective: leading term and added ones. The iterate is the map that a step is tried from; `image` returns
   the measures of the cells. Counts an evaluation. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemEvaluate(EqmProblem problem, EqmIterate iterate, const EqmPlace *place,
                                               PetscReal *image, PetscReal *value, Vec gradient);

/* ---- the terms of this folder */
/* E_D - A, the angle energy of a surface's map, with the mesh's cotangents (METHODS of descent: -balance). Collective.
 */
PETSC_INTERN PetscErrorCode EqmTermCreateAngle(EqmProblem problem, PetscReal weight, EqmTerm *term);
/* sum |x(v_i) - q_i|^2 over the problem's landmarks (000 (46), 001 section 6.6). Collective. */
PETSC_INTERN PetscErrorCode EqmTermCreateLandmarks(EqmProblem problem, PetscReal weight, EqmTerm *term);

#endif
