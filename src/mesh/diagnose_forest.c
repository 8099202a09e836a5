/* Connected components and orientation across ranks: disjoint sets on each rank, labels exchanged between them. */
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

/* A set's key is 2 * (lowest item number seen) + (its root is turned against that item). Keys are reals because
   PetscSF takes the minimum of those in every build, and they hold whole numbers to 2^53. */
static PetscReal TurnKey(PetscReal key, unsigned char turned)
{
  const PetscReal label = PetscFloorReal(key / 2.0);

  return turned ? 4.0 * label + 1.0 - key : key;
}

/* Give a set the key that one of its items has received, if that is lower; returns whether it is. */
static PetscBool LowerKey(EqmForest *forest, PetscInt item, PetscReal received, PetscReal *set_key)
{
  unsigned char turned;
  const PetscInt root = Root(forest, item, &turned);

  if (TurnKey(received, turned) >= set_key[root]) return PETSC_FALSE;
  set_key[root] = TurnKey(received, turned);
  return PETSC_TRUE;
}

static PetscErrorCode ExchangeKeys(MPI_Comm comm, PetscSF sf, EqmForest *forest, PetscReal *set_key, PetscBool *changed)
{
  PetscReal *own, *received[2];
  PetscBool here = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(forest->num_items, &own, forest->num_items, &received[0], forest->num_items, &received[1]));
  for (PetscInt i = 0; i < forest->num_items; i++) {
    unsigned char turned;
    const PetscInt root = Root(forest, i, &turned);

    own[i] = received[0][i] = received[1][i] = TurnKey(set_key[root], turned);
  }
  PetscCall(PetscSFBcastBegin(sf, MPIU_REAL, own, received[0], MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, MPIU_REAL, own, received[0], MPI_REPLACE));
  PetscCall(PetscSFReduceBegin(sf, MPIU_REAL, own, received[1], MPI_MIN));
  PetscCall(PetscSFReduceEnd(sf, MPIU_REAL, own, received[1], MPI_MIN));
  for (PetscInt i = 0; i < forest->num_items; i++) {
    if (LowerKey(forest, i, received[0][i], set_key)) here = PETSC_TRUE;
    if (LowerKey(forest, i, received[1][i], set_key)) here = PETSC_TRUE;
  }
  PetscCall(PetscFree3(own, received[0], received[1]));
  PetscCallMPI(MPI_Allreduce(&here, changed, 1, MPIU_BOOL, MPI_LOR, comm));
  PetscFunctionReturn(0);
}

/* The keys of items by the items' numbers, distributed. */
typedef struct {
  PetscLayout layout; /* of the numbers */
  PetscSF entries;    /* roots: the numbers; leaves: the items, each on the one rank where it is no copy */
  PetscReal *key;     /* per number of this rank's part of the layout */
} Directory;

static PetscErrorCode DirectoryCreate(MPI_Comm comm, PetscSF sf, PetscInt num_items, const PetscInt *number,
                                      Directory *directory)
{
  PetscInt num_leaves, last = -1, num_entries = 0, *item, *entry;
  const PetscInt *leaf;
  PetscBool *is_copy;

  PetscFunctionBegin;
  PetscCall(PetscSFGetGraph(sf, NULL, &num_leaves, &leaf, NULL));
  PetscCall(PetscCalloc1(num_items, &is_copy));
  for (PetscInt k = 0; k < num_leaves; k++) is_copy[leaf ? leaf[k] : k] = PETSC_TRUE;
  PetscCall(PetscMalloc2(num_items, &item, num_items, &entry));
  for (PetscInt i = 0; i < num_items; i++) {
    last = PetscMax(last, number[i]);
    if (is_copy[i]) continue;
    item[num_entries] = i;
    entry[num_entries++] = number[i];
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &last, 1, MPIU_INT, MPI_MAX, comm));
  PetscCall(PetscLayoutCreateFromSizes(comm, PETSC_DECIDE, last + 1, 1, &directory->layout));
  PetscCall(PetscSFCreate(comm, &directory->entries));
  PetscCall(PetscSFSetGraphLayout(directory->entries, directory->layout, num_entries, item, PETSC_COPY_VALUES, entry));
  PetscCall(PetscCalloc1(directory->layout->n, &directory->key));
  PetscCall(PetscFree2(item, entry));
  PetscCall(PetscFree(is_copy));
  PetscFunctionReturn(0);
}

static PetscErrorCode DirectoryReset(Directory *directory)
{
  PetscFunctionBegin;
  PetscCall(PetscLayoutDestroy(&directory->layout));
  PetscCall(PetscSFDestroy(&directory->entries));
  PetscCall(PetscFree(directory->key));
  PetscFunctionReturn(0);
}

/* A set whose label (`before`) is the number of an item elsewhere sends its lower key to that item and receives the
   item's. So labels merge along a tree, in a few rounds; from neighbour to neighbour alone it would take as many rounds
   as the mesh has ranks in a row. */
static PetscErrorCode PropagateLabels(MPI_Comm comm, Directory *directory, EqmForest *forest, const PetscInt *number,
                                      const PetscReal *before, PetscReal *set_key)
{
  const PetscInt n = forest->num_items;
  PetscInt num_sets = 0, *root, *label;
  PetscReal *key, *message;
  PetscSF label_roots;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(n, &key, n, &message, n, &root, n, &label));
  for (PetscInt i = 0; i < n; i++) {
    unsigned char turned;
    const PetscInt top = Root(forest, i, &turned);

    key[i] = TurnKey(set_key[top], turned);
    if (top != i || before[i] == 2.0 * (PetscReal)number[i]) continue;
    root[num_sets] = i;
    label[num_sets] = (PetscInt)PetscFloorReal(before[i] / 2.0);
    message[num_sets] = TurnKey(set_key[i], before[i] > 2.0 * (PetscReal)label[num_sets]);
    num_sets++;
  }
  PetscCall(PetscSFReduceBegin(directory->entries, MPIU_REAL, key, directory->key, MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(directory->entries, MPIU_REAL, key, directory->key, MPI_REPLACE));
  PetscCall(PetscSFCreate(comm, &label_roots));
  PetscCall(PetscSFSetGraphLayout(label_roots, directory->layout, num_sets, NULL, PETSC_OWN_POINTER, label));
  PetscCall(PetscSFReduceBegin(label_roots, MPIU_REAL, message, directory->key, MPI_MIN));
  PetscCall(PetscSFReduceEnd(label_roots, MPIU_REAL, message, directory->key, MPI_MIN));
  PetscCall(PetscSFBcastBegin(label_roots, MPIU_REAL, directory->key, message, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(label_roots, MPIU_REAL, directory->key, message, MPI_REPLACE));
  PetscCall(PetscSFBcastBegin(directory->entries, MPIU_REAL, directory->key, key, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(directory->entries, MPIU_REAL, directory->key, key, MPI_REPLACE));
  PetscCall(PetscSFDestroy(&label_roots));
  for (PetscInt s = 0; s < num_sets; s++) {
    (void)LowerKey(forest, root[s], TurnKey(message[s], before[root[s]] > 2.0 * (PetscReal)label[s]), set_key);
  }
  for (PetscInt i = 0; i < n; i++) (void)LowerKey(forest, i, key[i], set_key);
  PetscCall(PetscFree4(key, message, root, label));
  PetscFunctionReturn(0);
}

/* Exchange the sets' keys between the ranks until none changes. */
static PetscErrorCode ConvergeKeys(MPI_Comm comm, PetscSF sf, EqmForest *forest, const PetscInt *number,
                                   PetscReal *set_key)
{
  Directory directory;
  PetscReal *before;
  PetscBool changed = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(DirectoryCreate(comm, sf, forest->num_items, number, &directory));
  PetscCall(PetscMalloc1(forest->num_items, &before));
  while (changed) {
    PetscCall(PetscArraycpy(before, set_key, forest->num_items));
    PetscCall(ExchangeKeys(comm, sf, forest, set_key, &changed));
    if (changed) PetscCall(PropagateLabels(comm, &directory, forest, number, before, set_key));
  }
  PetscCall(PetscFree(before));
  PetscCall(DirectoryReset(&directory));
  PetscFunctionReturn(0);
}

/* Label all items of the sets, joined over all ranks through the star forest `sf` (roots and leaves at item numbers, a
   leaf being a copy of its root). `number` is each item's number in the whole; `label` becomes the lowest one of its
   component, `turned` (may be NULL) whether it is turned against the item of that number. `conflict` (may be NULL) is
   set for items whose copies cannot agree on that. Collective. */
PetscErrorCode EqmForestLabel(MPI_Comm comm, PetscSF sf, EqmForest *forest, const PetscInt *number, PetscInt *label,
                              PetscBool *turned, PetscBool *conflict)
{
  PetscReal *set_key, *key, *received;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc3(forest->num_items, &set_key, forest->num_items, &key, forest->num_items, &received));
  for (PetscInt i = 0; i < forest->num_items; i++) set_key[i] = PETSC_MAX_REAL;
  for (PetscInt i = 0; i < forest->num_items; i++) {
    unsigned char against;
    const PetscInt root = Root(forest, i, &against);

    set_key[root] = PetscMin(set_key[root], 2.0 * (PetscReal)number[i] + against);
  }
  if (size > 1) PetscCall(ConvergeKeys(comm, sf, forest, number, set_key));
  for (PetscInt i = 0; i < forest->num_items; i++) {
    unsigned char against;
    const PetscInt root = Root(forest, i, &against);

    key[i] = received[i] = TurnKey(set_key[root], against);
    label[i] = (PetscInt)PetscFloorReal(key[i] / 2.0);
    if (turned) turned[i] = (PetscBool)(key[i] > 2.0 * (PetscReal)label[i]);
  }
  if (conflict && size > 1) {
    PetscCall(PetscSFBcastBegin(sf, MPIU_REAL, key, received, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(sf, MPIU_REAL, key, received, MPI_REPLACE));
    for (PetscInt i = 0; i < forest->num_items; i++) conflict[i] = (PetscBool)(conflict[i] || key[i] != received[i]);
  }
  PetscCall(PetscFree3(set_key, key, received));
  PetscFunctionReturn(0);
}
