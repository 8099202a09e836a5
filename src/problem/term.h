/* Terms that an objective consists of beside its leading one: a linked list of the problem's, which every method that
   takes terms minimises with it. A new term is one file: a structure that begins with struct _p_EqmTerm. */
#ifndef EQM_TERM_H
#define EQM_TERM_H

#include "problem/problem.h"
#include "energy/cellframe.h"

typedef struct _p_EqmTerm *EqmTerm;
struct _p_EqmTerm {
  const char *name;
  PetscReal weight;
  /* Add weight times the value at a place, infinite where there is none, and, unless NULL, of the gradient in degrees
     of freedom; `image` holds the measures of the cells there. Collective. */
  PetscErrorCode (*add)(EqmTerm, EqmProblem, const EqmPlace *place, const PetscReal *image, PetscReal *value,
                        Vec gradient);
  /* Add factor times weight times half the Hessian, as far as it is positive semidefinite, of what a cell contributes,
     in the degrees of freedom of its corners. For a sum of squares this is the Gauss-Newton matrix. NULL: it is not
     known cell by cell, and left out. Not collective. */
  void (*add_matrix)(EqmTerm, EqmProblem, const EqmPlace *place, const PetscReal *image, PetscInt cell,
                     const EqmCellFrame *frame, PetscReal factor, PetscReal *matrix);
  /* Of a sum of squares of residuals rho, J their derivative: add factor times weight times J^T rho'', rho'' the second
     derivative along the curve with the given velocity and acceleration (per local vertex, in space), to a vector of
     degrees of freedom. NULL: rho is linear in the places, or rho'' is neglected. Collective. */
  PetscErrorCode (*add_curve)(EqmTerm, EqmProblem, const EqmPlace *place, const PetscReal *image,
                              const PetscReal *velocity, const PetscReal *acceleration, PetscReal factor, Vec result);
  PetscErrorCode (*destroy)(EqmTerm); /* free the structure; NULL: the structure belongs to the caller */
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

/* ---- the added terms alone, one operation of each after the other */
PETSC_INTERN PetscErrorCode EqmTermsAdd(EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                                        PetscReal *value, Vec gradient);
PETSC_INTERN void EqmTermsAddMatrix(EqmProblem problem, const EqmPlace *place, const PetscReal *image, PetscInt cell,
                                    const EqmCellFrame *frame, PetscReal factor, PetscReal *matrix);
PETSC_INTERN PetscErrorCode EqmTermsAddCurve(EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                                             const PetscReal *velocity, const PetscReal *acceleration, PetscReal factor,
                                             Vec result);

/* ---- the terms of this folder */
/* E_D - A, the angle energy of a surface's map, with the mesh's cotangents (docs/methods.md, Uniqueness: -balance).
   Collective. */
PETSC_INTERN PetscErrorCode EqmTermCreateAngle(EqmProblem problem, PetscReal weight, EqmTerm *term);
/* sum w_i |x(v_i) - q_i|^2 over the problem's landmarks (000 (46), 001 section 6.6). Collective. */
PETSC_INTERN PetscErrorCode EqmTermCreateLandmarks(EqmProblem problem, PetscReal weight, EqmTerm *term);
/* Maps to the sphere: sum w log^2(h / a), h half the determinant of a triangle's corners and a its area: infinite where
   a triangle is seen from its edge from the centre, so that none tips over. Collective. */
PETSC_INTERN PetscErrorCode EqmTermCreateUpright(EqmProblem problem, PetscReal weight, EqmTerm *term);

#endif
