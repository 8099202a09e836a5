/* The bytes of the fuzzer as a file: one in memory, which readers open under names of a folder of its own. */
#ifndef EQM_FUZZ_MEMORY_H
#define EQM_FUZZ_MEMORY_H

#include "fuzz.h"
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

/* Where the file `name` of the folder, one below TMPDIR, is. The text is constant until the next call. */
static const char *NameInFolder(const char *name)
{
  static char folder[1024], path[1100];
  const char *const above = getenv("TMPDIR");

  if (!folder[0]) {
    snprintf(folder, sizeof(folder), "%s/equimap_fuzz_XXXXXX", above ? above : "/tmp");
    CLAIM(mkdtemp(folder));
  }
  snprintf(path, sizeof(path), "%s/%s", folder, name);
  return path;
}

/* A file of that name in the folder, the same one in memory for all names, has these bytes. */
static const char *FileOfBytes(const char *name, const uint8_t *bytes, size_t length)
{
  static int descriptor = -1;
  char memory[64];

  if (descriptor < 0) descriptor = memfd_create("fuzz", 0);
  CLAIM(descriptor >= 0 && !ftruncate(descriptor, 0) && pwrite(descriptor, bytes, length, 0) == (ssize_t)length);
  snprintf(memory, sizeof(memory), "/proc/self/fd/%d", descriptor);
  if (access(NameInFolder(name), F_OK)) CLAIM(!symlink(memory, NameInFolder(name)));
  return NameInFolder(name);
}

#endif
