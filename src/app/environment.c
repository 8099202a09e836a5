/* What the libraries that the program is linked with read from the environment, before they do. What the user has set
   stays. */
#define _GNU_SOURCE
#include "environment.h"
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* EqmStartWithoutDaemon - alone, Open MPI would first start a daemon, which takes longer than a small map. Without the
   daemon all such runs of a user have one folder for temporary files, which the first that ends removes from under the
   others: no folder, then, and no shared file pointers, which would lie there and which we do not use. */
void EqmStartWithoutDaemon(void)
{
  (void)setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  (void)setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  (void)setenv("OMPI_MCA_sharedfp", "^sm,lockedfile", 0);
}

/* Will there be one thread, whatever the options say? */
static PetscBool HasOneThread(char **argv)
{
  if (omp_get_max_threads() > 1 || getenv("PETSC_OPTIONS")) return PETSC_FALSE;
  for (char **word = argv; *word; word++) {
    if (strstr(*word, "threads") || strstr(*word, "options")) return PETSC_FALSE; /* a file of options may, too */
  }
  return PETSC_TRUE;
}

/* Threads that wait are to sleep, not to spin: on a busy machine spinning takes the cores from whoever works. */
static PetscBool SetWaiting(char **argv)
{
  if (getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT") || HasOneThread(argv)) return PETSC_FALSE;
  return (PetscBool)!setenv("OMP_WAIT_POLICY", "passive", 0);
}

/* Does the system give large pages to who asks for them, and to nobody else? */
static PetscBool MustAskForLargePages(void)
{
  FILE *const file = fopen("/sys/kernel/mm/transparent_hugepage/enabled", "r");
  char text[128] = "";
  PetscBool must;

  if (!file) return PETSC_FALSE;
  must = (PetscBool)(fgets(text, sizeof(text), file) && strstr(text, "[madvise]"));
  (void)fclose(file);
  return must;
}

/* A large run takes its memory in large pages: with pages of 4 kB their first use is an eighth of its time. To start
   again is a tenth of a second, which a small run is not asked for. */
static PetscBool SetPages(const EqmCommandLine *line)
{
  const off_t large = 8000000; /* bytes of the largest file, some 100,000 triangles */
  struct stat about;
  PetscBool is_large = PETSC_FALSE;

  if (getenv("GLIBC_TUNABLES")) return PETSC_FALSE;
  for (int k = 0; k < line->num_arguments; k++) {
    if (!stat(line->argument[k], &about) && about.st_size >= large) is_large = PETSC_TRUE;
  }
  if (!is_large || !MustAskForLargePages()) return PETSC_FALSE;
  return (PetscBool)!setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 0);
}

/* EqmStartAgain - the OpenMP library and the C library read their settings when they are loaded, so where something is
   to be set the program starts once more with it; where it cannot, it goes on as it is. Under its own path: as
   /proc/self/exe its name would be exe to ps and pkill. */
void EqmStartAgain(const EqmCommandLine *line, char **argv)
{
  char path[PETSC_MAX_PATH_LEN];
  const PetscBool waiting = SetWaiting(argv), pages = SetPages(line);

  if (!waiting && !pages) return;
  const ssize_t length = readlink("/proc/self/exe", path, sizeof(path) - 1);
  if (length <= 0) return;
  path[length] = '\0';
  (void)execv(path, argv);
}
