/* How much memory a rank may still take: the machine's, the batch job's, or what the user says. */
#include "linalg/linalg.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Share of the free memory that factors may use: estimates are not exact, and vectors need memory as well. */
static const PetscReal usable = .8;

/* The number behind `key` in a file of lines "key number", or the file's first number if `key` is NULL; `missing` if
   there is none ("max", no such file). */
static PetscReal ReadNumber(const char *folder, const char *name, const char *key, PetscReal missing)
{
  char path[3 * PETSC_MAX_PATH_LEN], word[64] = "";
  double value = 0.;
  PetscReal found = missing;
  FILE *file;

  (void)snprintf(path, sizeof(path), "%s/%s", folder, name);
  file = fopen(path, "r");
  if (!file) return missing;
  if (!key) {
    if (fscanf(file, "%lf", &value) == 1) found = value;
  } else {
    while (fscanf(file, "%63s %lf%*[^\n]", word, &value) >= 1) {
      if (strcmp(word, key)) continue;
      found = value;
      break;
    }
  }
  (void)fclose(file);
  return found;
}

/* The files of a control group, versions 2 and 1. */
typedef struct {
  const char *marker, *root; /* in /proc/self/cgroup; where the groups are mounted */
  const char *limit, *usage, *cache;
} Hierarchy;

static const Hierarchy hierarchies[] = {{"0::", "/sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"},
                                        {":memory:", "/sys/fs/cgroup/memory", "memory.limit_in_bytes",
                                         "memory.usage_in_bytes", "total_inactive_file"}};

/* What the group and those round it leave; the page cache counts as free. */
static PetscReal FreeInGroups(const Hierarchy *h, const char *group)
{
  char folder[2 * PETSC_MAX_PATH_LEN];
  PetscReal least = INFINITY;

  (void)snprintf(folder, sizeof(folder), "%s%s", h->root, group);
  for (;;) {
    const PetscReal limit = ReadNumber(folder, h->limit, NULL, INFINITY);
    const PetscReal usage = ReadNumber(folder, h->usage, NULL, 0.),
                    cache = ReadNumber(folder, "memory.stat", h->cache, 0.);
    char *const slash = strrchr(folder, '/');
    least = PetscMin(least, PetscMax(limit - usage + cache, 0.));
    if (!slash || strlen(folder) <= strlen(h->root)) return least;
    *slash = '\0';
  }
}

static PetscReal FreeForJob(void)
{
  char line[PETSC_MAX_PATH_LEN];
  PetscReal least = INFINITY;
  FILE *const file = fopen("/proc/self/cgroup", "r");

  while (file && fgets(line, sizeof(line), file)) {
    line[strcspn(line, "\n")] = '\0';
    for (size_t k = 0; k < sizeof(hierarchies) / sizeof(hierarchies[0]); k++) {
      const char *const marker = strstr(line, hierarchies[k].marker);
      if (marker) least = PetscMin(least, FreeInGroups(&hierarchies[k], marker + strlen(hierarchies[k].marker)));
    }
  }
  if (file) (void)fclose(file);
  return least;
}

/* Bytes that this rank may give to factors: -memory_limit (GiB per rank), or its share of what its node has free.
   Collective. */
PetscErrorCode EqmMemoryLimit(MPI_Comm comm, PetscReal *bytes)
{
  const PetscReal gib = 1024. * 1024. * 1024.;
  PetscReal limit = 0., available;
  PetscMPIInt ranks_on_node;
  MPI_Comm node;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-memory_limit", &limit, NULL));
  PetscCallMPI(MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node));
  PetscCallMPI(MPI_Comm_size(node, &ranks_on_node));
  available = PetscMin(1024. * ReadNumber("/proc", "meminfo", "MemAvailable:", INFINITY), FreeForJob());
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &available, 1, MPIU_REAL, MPIU_MIN, node));
  PetscCallMPI(MPI_Comm_free(&node));
  *bytes = limit > 0. ? limit * gib : usable * available / ranks_on_node;
  PetscFunctionReturn(0);
}
