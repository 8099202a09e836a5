/* From whom to whom entries of fronts go, and in which order. Who sends an entry and who receives it both go through
   the sender's part of the matrix in the same order, so that no message has indices in it. */
#ifndef EQM_INTERFACE_ROUTE_H
#define EQM_INTERFACE_ROUTE_H

#include "linalg/interface_private.h"

/* The rows or columns of what a group passes on that one rank has: their numbers, ascending, and places in the front.
 */
typedef struct {
  PetscInt count, *index, *place;
} EqmStrip;
/* Those of part `part` of `parts` of the rows or columns of group `side`. */
PETSC_INTERN PetscErrorCode EqmStripCreate(const EqmFront *front, PetscMPIInt side, PetscMPIInt parts, PetscMPIInt part,
                                           EqmStrip *strip);
PETSC_INTERN PetscErrorCode EqmStripDestroy(EqmStrip *strip);
/* List those whose places belong to a row or a column of the front's grid. */
PETSC_INTERN PetscErrorCode EqmStripSelect(const EqmFront *front, const EqmStrip *strip, PetscMPIInt part,
                                           PetscMPIInt (*owner)(const EqmFront *, PetscInt), PetscInt *count,
                                           PetscInt **list);

/* Row of the panel at a place, the grid's row that has it, this rank's number of it there; the same of columns, of the
   panel or of what is passed on. */
static inline PetscInt EqmPanelRow(const EqmFront *front, PetscInt place)
{
  return place < front->num_out ? place : place - front->num_out + front->kept_begin;
}

static inline PetscMPIInt EqmRowOwner(const EqmFront *front, PetscInt place)
{
  return EqmDealtTo(EqmPanelRow(front, place), front->grid.block, front->grid.rows);
}

static inline PetscInt EqmLocalRow(const EqmFront *front, PetscInt place)
{
  return EqmDealtAs(EqmPanelRow(front, place), front->grid.block, front->grid.rows);
}

static inline PetscInt EqmPanelColumn(const EqmFront *front, PetscInt place)
{
  return place < front->num_out ? place : place - front->num_out;
}

static inline PetscInt EqmLocalColumn(const EqmFront *front, PetscInt place)
{
  return EqmDealtAs(EqmPanelColumn(front, place), front->grid.block, front->grid.columns);
}

static inline PetscMPIInt EqmColumnOwner(const EqmFront *front, PetscInt place)
{
  return EqmDealtTo(EqmPanelColumn(front, place), front->grid.block, front->grid.columns);
}

/* Entries of one column of the sender's part: rows `row` of its strip, as far as they stand, for `turned`, before the
   column in the front, where their transpose is meant, else behind it. */
typedef struct {
  const EqmStrip *rows, *columns;
  PetscInt column, count;
  const PetscInt *row;
  PetscBool turned;
} EqmRun;

static inline PetscBool EqmIsInRun(const EqmRun *run, PetscInt row)
{
  return (PetscBool)((run->rows->place[row] < run->columns->place[run->column]) == run->turned);
}

/* Go through the entries of the lower triangle that rank `to` gets of the part with these rows and columns. */
PETSC_INTERN PetscErrorCode EqmForEachRun(const EqmFront *front, const EqmStrip *rows, const EqmStrip *columns,
                                          PetscMPIInt to, void (*visit)(void *, const EqmRun *), void *context);

/* Messages that this rank sends: the k-th, packed[begin[k]] to packed[begin[k + 1]], to rank first + k * step. */
typedef struct {
  PetscMPIInt first, step, count, tag;
  PetscScalar *packed;
  size_t *begin;
  MPI_Request *request;
} EqmSending;

/* Allocate for so many numbers in so many messages, the place of none of which is known. */
PETSC_INTERN PetscErrorCode EqmSendingCreate(size_t entries, PetscMPIInt count, PetscMPIInt first, PetscMPIInt step,
                                             PetscMPIInt tag, EqmSending *sending);
PETSC_INTERN PetscErrorCode EqmSendingBegin(EqmInterface tree, EqmSending *sending);
PETSC_INTERN PetscErrorCode EqmSendingEnd(EqmSending *sending);
/* What a rank has sent to this one: in `buffer`, to be freed, unless it comes from this rank itself. */
PETSC_INTERN PetscErrorCode EqmSendingReceive(EqmInterface tree, PetscMPIInt from, PetscMPIInt tag,
                                              const EqmSending *sending, PetscScalar **buffer,
                                              const PetscScalar **entries);

#endif
