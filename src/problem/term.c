#include "problem/term.h"
#include "problem/objective.h"
#include "mesh/mesh_private.h"

PetscErrorCode EqmProblemAddTerm(EqmProblem problem, EqmTerm term)
{
  EqmTerm *last = &problem->terms;

  PetscFunctionBegin;
  while (*last) last = &(*last)->next;
  term->next = NULL;
  *last = term;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemRemoveTerm(EqmProblem problem, EqmTerm term)
{
  EqmTerm *link = &problem->terms;

  PetscFunctionBegin;
  while (*link && *link != term) link = &(*link)->next;
  if (*link) *link = term->next;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemDestroyTerms(EqmProblem problem)
{
  PetscFunctionBegin;
  while (problem->terms) {
    const EqmTerm term = problem->terms;
    problem->terms = term->next;
    if (term->destroy) PetscCall(term->destroy(term));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmTermsAdd(EqmProblem problem, const EqmPlace *place, const PetscReal *image, PetscReal *value,
                           Vec gradient)
{
  PetscFunctionBegin;
  for (EqmTerm term = problem->terms; term; term = term->next)
    PetscCall(term->add(term, problem, place, image, value, gradient));
  PetscFunctionReturn(0);
}

void EqmTermsAddMatrix(EqmProblem problem, const EqmPlace *place, const PetscReal *image, PetscInt cell,
                       const EqmCellFrame *frame, PetscReal factor, PetscReal *matrix)
{
  for (EqmTerm term = problem->terms; term; term = term->next)
    if (term->add_matrix) term->add_matrix(term, problem, place, image, cell, frame, factor, matrix);
}

PetscErrorCode EqmTermsAddCurve(EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                                const PetscReal *velocity, const PetscReal *acceleration, PetscReal factor, Vec result)
{
  PetscFunctionBegin;
  for (EqmTerm term = problem->terms; term; term = term->next) {
    if (term->add_curve)
      PetscCall(term->add_curve(term, problem, place, image, velocity, acceleration, factor, result));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProblemEvaluate(EqmProblem problem, EqmIterate iterate, const EqmPlace *place, PetscReal *image,
                                  PetscReal *value, Vec gradient)
{
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(problem->mesh->ledger, &work));
  work->evaluations++;
  PetscCall(problem->objective->evaluate(problem, iterate, place, image, value, gradient));
  PetscCall(EqmTermsAdd(problem, place, image, value, gradient));
  PetscFunctionReturn(0);
}
