/* Temporary files of EqmAtomicFile: which there are, and how those are removed that nobody will finish. */
#define _GNU_SOURCE
#include "base/temporaries.h"
#include "base/atomicfile.h"
#include <dirent.h>
#include <libgen.h>
#include <string.h>
#include <unistd.h>

/* The temporaries that are there now, for whoever must end in the middle: global by nature, as they belong to the
   process. More than so many are not noted. */
enum { MOST_NOTED = 16 };
static char noted[MOST_NOTED][PETSC_MAX_PATH_LEN];

void EqmNoteTemporary(const char *name)
{
  for (int k = 0; k < MOST_NOTED; k++) {
    if (noted[k][0]) continue;
    strcpy(noted[k], name);
    return;
  }
}

void EqmForgetTemporary(const char *name)
{
  for (int k = 0; k < MOST_NOTED; k++) {
    if (!strcmp(noted[k], name)) noted[k][0] = '\0';
  }
}

/* EqmAtomicAbandonAll - remove all temporaries of this process, which is about to end. Not collective; may be called
   from a signal handler. */
void EqmAtomicAbandonAll(void)
{
  static const char *const ends[] = {"", ".data.0", ".metadata.0"}; /* Open MPI's own, beside a file of a single rank */
  char name[PETSC_MAX_PATH_LEN + 16];

  for (int k = 0; k < MOST_NOTED; k++) {
    for (size_t end = 0; noted[k][0] && end < sizeof(ends) / sizeof(ends[0]); end++) {
      strcpy(name, noted[k]);
      strcat(name, ends[end]);
      (void)unlink(name);
    }
  }
}

/* Is this the name of a temporary of `base`, base.NUMBER-NUMBER.tmp, or of a file that Open MPI keeps beside it? */
static PetscBool IsTemporaryOf(const char *base, const char *name)
{
  const size_t length = strlen(base);
  const char *end = name + length;

  if (strncmp(name, base, length) || *end != '.') return PETSC_FALSE;
  end += 1 + strspn(end + 1, "0123456789");
  if (*end != '-') return PETSC_FALSE;
  end += 1 + strspn(end + 1, "0123456789");
  return (PetscBool)(!strcmp(end, ".tmp") || !strncmp(end, ".tmp.", 5));
}

/* EqmAtomicSweep - remove the temporaries of `path` that killed runs have left behind. Only for a file that no other
   run writes at the same time. Not collective. */
void EqmAtomicSweep(const char *path)
{
  char copy[PETSC_MAX_PATH_LEN], name[PETSC_MAX_PATH_LEN], leftover[2 * PETSC_MAX_PATH_LEN];
  const char *base, *folder;
  DIR *directory;

  if (strlen(path) >= sizeof(copy)) return;
  strcpy(copy, path);
  strcpy(name, path);
  base = basename(name);
  folder = dirname(copy);
  directory = opendir(folder);
  if (!directory) return;
  for (const struct dirent *entry = readdir(directory); entry; entry = readdir(directory)) {
    if (!IsTemporaryOf(base, entry->d_name)) continue;
    (void)snprintf(leftover, sizeof(leftover), "%s/%s", folder, entry->d_name);
    (void)unlink(leftover);
  }
  (void)closedir(directory);
}
