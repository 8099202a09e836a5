/* Connected components and orientation across ranks: disjoint sets on each rank, labels that travel between them. */
#include "mesh/diagnose.h"

/* Every item a set of its own. Free with EqmForestReset. Not collective. */
PetscErrorCode EqmForestCreate(PetscInt num_items, EqmForest *forest)
{
  PetscFunctionBegin;
  forest->num_items = num_items;
  PetscCall(PetscMalloc1(num_items, &forest->parent));
  PetscCall(PetscCalloc1(num_items, &forest->turned));
  for (PetscInt i = 0; i < num_items; i++) forest->parent[i] = i;
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmForestReset(EqmForest *forest)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(forest->parent));
  PetscCall(PetscFree(forest->turned));
  PetscFunctionReturn(0);
}

static PetscInt Root(EqmForest *forest, PetscInt item, unsigned char *turned)
{
  *turned = 0;
  while (forest->parent[item] != item) {
    const PetscInt parent = forest->parent[item];

    forest->turned[item] ^= forest->turned[parent];
    forest->parent[item] = forest->parent[parent];
    *turned ^= forest->turned[item];
    item = forest->parent[item];
  }
  return item;
}

/* Put two items into one set, `turned` against each other or not. False if they are in one set already and turned
   otherwise there. Not collective. */
PetscBool EqmForestJoin(EqmForest *forest, PetscInt a, PetscInt b, PetscBool turned)
{
  unsigned char turned_a, turned_b;
  const PetscInt root_a = Root(forest, a, &turned_a), root_b = Root(forest, b, &turned_b);
  const unsigned char between = (unsigned char)(turned_a ^ turned_b ^ (turned ? 1 : 0));

  if (root_a == root_b) return (PetscBool)!between;
  forest->parent[PetscMax(root_a, root_b)] = PetscMin(root_a, root_b);
  forest->turned[PetscMax(root_a, root_b)] = between;
  return PETSC_TRUE;
}

/* A set's key is 2 * (lowest item number known) + (its root is turned against that item). Keys are reals because
   PetscSF takes the minimum of those in every build, and they hold whole numbers to 2^53. */
static PetscReal TurnKey(PetscReal key, unsigned char turned)
{
  const PetscReal label = PetscFloorReal(key / 2.0);

  return turned ? 4.0 * label + 1.0 - key : key;
}

static PetscErrorCode ExchangeKeys(MPI_Comm comm, PetscSF sf, EqmForest *forest, PetscReal *set_key, PetscBool *changed)
{
  PetscReal *own, *heard[2];
  PetscBool here = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(forest->num_items, &own, forest->num_items, &heard[0], forest->num_items, &heard[1]));
  for (PetscInt i = 0; i < forest->num_items; i++) {
    unsigned char turned;
    const PetscInt root = Root(forest, i, &turned);

    own[i] = heard[0][i] = heard[1][i] = TurnKey(set_key[root], turned);
  }
  PetscCall(PetscSFBcastBegin(sf, MPIU_REAL, own, heard[0], MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, MPIU_REAL, own, heard[0], MPI_REPLACE));
  PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, own, heard[1], MPI_MIN));
  PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, own, heard[1], MPI_MIN));
  for (PetscInt i = 0; i < forest->num_items; i++) {
    for (int way = 0; way < 2; way++) {
      unsigned char turned;
      PetscInt root;

      if (heard[way][i] >= own[i]) continue;
      root = Root(forest, i, &turned);
      if (TurnKey(heard[way][i], turned) >= set_key[root]) continue;
      set_key[root] = TurnKey(heard[way][i], turned);
      here = PETSC_TRUE;
    }
  }
  PetscCall(PetscFree3(own, heard[0], heard[1]));
  PetscCallMPI(MPI_Allreduce(&here, changed, 1, MPIU_BOOL, MPI_LOR, comm));
  PetscFunctionReturn(0);
}

/* Label all items of the sets, joined over all ranks through the star forest `sf` (roots and leaves at item numbers, a
   leaf being a copy of its root). `number` is each item's number in the whole; `label` becomes the lowest one of its
   component, `turned` (may be NULL) whether it is turned against the item of that number. `conflict` (may be NULL) is
   set for items whose copies cannot agree on that. Collective. */
PetscErrorCode EqmForestLabel(MPI_Comm comm, PetscSF sf, EqmForest *forest, const PetscInt *number, PetscInt *label,
                              PetscBool *turned, PetscBool *conflict)
{
  PetscReal *set_key, *key, *heard;
  PetscMPIInt size;
  PetscBool changed;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc3(forest->num_items, &set_key, forest->num_items, &key, forest->num_items, &heard));
  for (PetscInt i = 0; i < forest->num_items; i++) set_key[i] = PETSC_MAX_REAL;
  for (PetscInt i = 0; i < forest->num_items; i++) {
    unsigned char against;
    const PetscInt root = Root(forest, i, &against);

    set_key[root] = PetscMin(set_key[root], 2.0 * (PetscReal)number[i] + against);
  }
  changed = (PetscBool)(size > 1);
  while (changed) PetscCall(ExchangeKeys(comm, sf, forest, set_key, &changed));
  for (PetscInt i = 0; i < forest->num_items; i++) {
    unsigned char against;
    const PetscInt root = Root(forest, i, &against);

    key[i] = heard[i] = TurnKey(set_key[root], against);
    label[i] = (PetscInt)PetscFloorReal(key[i] / 2.0);
    if (turned) turned[i] = (PetscBool)(key[i] > 2.0 * (PetscReal)label[i]);
  }
  if (conflict && size > 1) {
    PetscCall(PetscSFBcastBegin(sf, MPIU_REAL, key, heard, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(sf, MPIU_REAL, key, heard, MPI_REPLACE));
    for (PetscInt i = 0; i < forest->num_items; i++) conflict[i] = (PetscBool)(conflict[i] || key[i] != heard[i]);
  }
  PetscCall(PetscFree3(set_key, key, heard));
  PetscFunctionReturn(0);
}
