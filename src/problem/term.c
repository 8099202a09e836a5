#include "problem/term.h"
#include "problem/objective.h"

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

PetscErrorCode EqmProblemEvaluate(EqmProblem problem, EqmIterate iterate, const EqmPlace *place, PetscReal *image,
                                  PetscReal *value, Vec gradient)
{
  PetscFunctionBegin;
  PetscCall(problem->objective->evaluate(problem, iterate, place, image, value, gradient));
  for (EqmTerm term = problem->terms; term; term = term->next)
    PetscCall(term->add(term, problem, place, image, value, gradient));
  PetscFunctionReturn(0);
}
