/* The samples of the unit tests as files: seeds FOLDER makes FOLDER/SUFFIX/NUMBER for every format. */
#include <equimap/soup.h>
#include <sys/stat.h>
#include "format_samples.h"

static void Save(const char *folder, const char *suffix, int number, const char *bytes, size_t length)
{
  char name[PETSC_MAX_PATH_LEN];
  FILE *file;

  snprintf(name, sizeof(name), "%s/%s", folder, suffix);
  (void)mkdir(name, 0777);
  snprintf(name, sizeof(name), "%s/%s/%d", folder, suffix, number);
  file = fopen(name, "wb");
  if (!file || fwrite(bytes, 1, length, file) != length || fclose(file)) {
    perror(name);
    exit(1);
  }
}

int main(int argc, char **argv)
{
  static const char *const csv[] = {"a,b\n0,1\n2,3\n", "vertex;u;v\n1;.5;1e3\n0;0;0\n", "density\n1\n2\n",
                                    "0 1 2\n3 4 5\n"};
  static const char npy[] = "\223NUMPY\1\0v\0{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2), }"
                            "                                                          \n0123456701234567";
  Sample *samples = malloc(MAX_SAMPLES * sizeof(*samples));
  int count;

  if (argc != 2 || !samples) return 2;
  count = MakeSamples(samples);
  for (int i = 0; i < count; ++i) Save(argv[1], samples[i].suffix, i, samples[i].bytes, samples[i].length);
  for (int i = 0; i < 4; ++i) {
    Save(argv[1], "points", i, csv[i], strlen(csv[i]));
    Save(argv[1], "density", i, csv[i], strlen(csv[i]));
    Save(argv[1], "table", i, csv[i], strlen(csv[i]));
  }
  Save(argv[1], "points", 4, npy, sizeof(npy) - 1);
  free(samples);
  return 0;
}
