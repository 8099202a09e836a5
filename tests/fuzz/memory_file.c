/* The bytes of the fuzzer as a file: one in memory, which readers open under names of a folder of its own. */
#define _GNU_SOURCE
#include "fuzz.h"
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

const char *EqmFuzzFolder(const char *name)
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

const char *EqmFuzzFile(const char *name, const uint8_t *bytes, size_t length)
{
  static int descriptor = -1;
  char memory[64];

  if (descriptor < 0) descriptor = memfd_create("fuzz", 0);
  CLAIM(descriptor >= 0 && !ftruncate(descriptor, 0) && pwrite(descriptor, bytes, length, 0) == (ssize_t)length);
  snprintf(memory, sizeof(memory), "/proc/self/fd/%d", descriptor);
  if (access(EqmFuzzFolder(name), F_OK)) CLAIM(!symlink(memory, EqmFuzzFolder(name)));
  return EqmFuzzFolder(name);
}
