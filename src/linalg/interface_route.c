#include "linalg/interface_route.h"
#include "base/narrow.h"

PetscErrorCode EqmStripCreate(const EqmFront *front, PetscMPIInt side, PetscMPIInt parts, PetscMPIInt part,
                              EqmStrip *strip)
{
  const PetscInt block = front->from_grid[side].block;

  PetscFunctionBegin;
  strip->count = EqmDealtCount(front->num_from[side], block, parts, part);
  PetscCall(PetscMalloc2(strip->count, &strip->index, strip->count, &strip->place));
  for (PetscInt k = 0; k < strip->count; k++) {
    strip->index[k] = EqmDealtFrom(k, block, parts, part);
    strip->place[k] = front->place[side][strip->index[k]];
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStripDestroy(EqmStrip *strip)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(strip->index, strip->place));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStripSelect(const EqmFront *front, const EqmStrip *strip, PetscMPIInt part,
                              PetscMPIInt (*owner)(const EqmFront *, PetscInt), PetscInt *count, PetscInt **list)
{
  PetscFunctionBegin;
  *count = 0;
  PetscCall(PetscMalloc1(strip->count, list));
  for (PetscInt k = 0; k < strip->count; k++) {
    if (owner(front, strip->place[k]) == part) (*list)[(*count)++] = k;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmForEachRun(const EqmFront *front, const EqmStrip *rows, const EqmStrip *columns, PetscMPIInt to,
                             void (*visit)(void *, const EqmRun *), void *context)
{
  const PetscMPIInt part[2] = {EqmGridRow(front->grid, to), EqmGridColumn(front->grid, to)};
  PetscInt count[2], *list[2], next[2] = {0, 0};

  PetscFunctionBegin;
  PetscCall(EqmStripSelect(front, rows, part[0], EqmRowOwner, &count[0], &list[0]));
  PetscCall(EqmStripSelect(front, rows, part[1], EqmColumnOwner, &count[1], &list[1]));
  for (PetscInt c = 0; c < columns->count; c++) {
    const PetscBool has[2] = {(PetscBool)(EqmColumnOwner(front, columns->place[c]) == part[1]),
                              (PetscBool)(EqmRowOwner(front, columns->place[c]) == part[0])};
    for (int turned = 0; turned < 2; turned++) {
      PetscInt *const k = &next[turned];
      while (*k < count[turned] && rows->index[list[turned][*k]] < columns->index[c]) ++*k;
      if (!has[turned]) continue;
      const EqmRun run = {rows, columns, c, count[turned] - *k, list[turned] + *k, (PetscBool)turned};
      visit(context, &run);
    }
  }
  PetscCall(PetscFree(list[0]));
  PetscCall(PetscFree(list[1]));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSendingCreate(size_t entries, PetscMPIInt count, PetscMPIInt first, PetscMPIInt step, PetscMPIInt tag,
                                EqmSending *sending)
{
  PetscFunctionBegin;
  *sending = (EqmSending){.first = first, .step = step, .count = count, .tag = tag};
  PetscCall(PetscMalloc1(entries, &sending->packed));
  PetscCall(PetscMalloc2(count + 1, &sending->begin, count, &sending->request));
  for (PetscMPIInt k = 0; k < count; k++) sending->request[k] = MPI_REQUEST_NULL;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSendingBegin(EqmInterface tree, EqmSending *sending)
{
  PetscFunctionBegin;
  for (PetscMPIInt k = 0; k < sending->count; k++) {
    const size_t entries = sending->begin[k + 1] - sending->begin[k];
    const PetscMPIInt to = sending->first + k * sending->step;
    if (to == tree->rank) continue; /* it takes them from here */
    PetscCall(EqmCheckFits((PetscInt64)entries, sizeof(PetscMPIInt), "MPI", "entries of a dense front"));
    PetscCallMPI(MPI_Isend(sending->packed + sending->begin[k], (PetscMPIInt)entries, MPIU_SCALAR, to, sending->tag,
                           tree->comm, &sending->request[k]));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSendingEnd(EqmSending *sending)
{
  PetscFunctionBegin;
  if (!sending->count) PetscFunctionReturn(0);
  PetscCallMPI(MPI_Waitall(sending->count, sending->request, MPI_STATUSES_IGNORE));
  PetscCall(PetscFree(sending->packed));
  PetscCall(PetscFree2(sending->begin, sending->request));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSendingReceive(EqmInterface tree, PetscMPIInt from, PetscMPIInt tag, const EqmSending *sending,
                                 PetscScalar **buffer, const PetscScalar **entries)
{
  MPI_Status status;
  PetscMPIInt count;

  PetscFunctionBegin;
  *buffer = NULL;
  if (from == tree->rank) {
    *entries = sending->packed + sending->begin[(from - sending->first) / sending->step];
    PetscFunctionReturn(0);
  }
  PetscCallMPI(MPI_Probe(from, tag, tree->comm, &status));
  PetscCallMPI(MPI_Get_count(&status, MPIU_SCALAR, &count));
  PetscCall(PetscMalloc1(count, buffer));
  PetscCallMPI(MPI_Recv(*buffer, count, MPIU_SCALAR, from, tag, tree->comm, MPI_STATUS_IGNORE));
  *entries = *buffer;
  PetscFunctionReturn(0);
}
