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

static void SaveTexts(const char *folder, const char *name, int count, const char *const text[])
{
  for (int i = 0; i < count; ++i) Save(folder, name, i, text[i], strlen(text[i]));
}

/* For each reader of the sample; formats that share a parser share a reader. */
static void SaveSample(const char *folder, const Sample *sample, int number)
{
  static const char *const reader[][2] = {{"tetgen", "node"}, {"vtp", "vtu"}};

  Save(folder, sample->suffix, number, sample->bytes, sample->length);
  for (int k = 0; k < 2; ++k) {
    if (!strcmp(sample->suffix, reader[k][0])) Save(folder, reader[k][1], number, sample->bytes, sample->length);
  }
}

/* The writer's own, a surface and a solid. */
static void SaveHdf5(const char *folder)
{
  static const char *const shapes[] = {"hills", "ball"};
  char name[PETSC_MAX_PATH_LEN];

  snprintf(name, sizeof(name), "%s/hdf5", folder);
  (void)mkdir(name, 0777);
  for (int k = 0; k < 2; ++k) {
    EqmSoup soup;

    snprintf(name, sizeof(name), "%s/hdf5/%s.h5", folder, shapes[k]);
    if (EqmSoupGenerate(PETSC_COMM_SELF, shapes[k], 12, 0, &soup) || EqmSoupWrite(soup, name) || EqmSoupDestroy(&soup))
      exit(1);
  }
}

#define XDMF_ARRAY(dimensions, format, text)                                                                           \
  "<DataItem DataType=\"Float\" Dimensions=\"" dimensions "\" Format=\"" format "\">" text "</DataItem>"
#define XDMF_FILE(points, topology, cells, field)                                                                      \
  "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\"><Domain><Grid Name=\"g\"><Geometry GeometryType=\"XYZ\">" points     \
  "</Geometry><Topology TopologyType=\"" topology "\">" cells                                                          \
  "</Topology><Attribute Name=\"w\" Center=\"Cell\">" field "</Attribute></Grid></Domain></Xdmf>"

/* Arrays in the text, and those of the mesh that the target puts beside. */
static const char *const xdmf[] = {XDMF_FILE(XDMF_ARRAY("4 3", "XML", "0 0 0 1 0 0 1 1 0 0 1 .5"), "Triangle",
                                             XDMF_ARRAY("2 3", "XML", "0 1 2 0 2 3"),
                                             XDMF_ARRAY("2", "XML", "0.5 2.5")),
                                   XDMF_FILE(XDMF_ARRAY("4 3", "XML", "0 0 0 1 0 0 1 1 0 0 1 .5"), "Tetrahedron",
                                             XDMF_ARRAY("4", "XML", "0 1 2 3"), XDMF_ARRAY("1 2", "XML", "0.5 2.5")),
                                   XDMF_FILE(XDMF_ARRAY("12 3", "HDF", "mesh.h5:/mesh/vertices"), "Triangle",
                                             XDMF_ARRAY("12 3", "HDF", "mesh.h5:/mesh/cells"),
                                             XDMF_ARRAY("12", "HDF", "mesh.h5:/cell/density"))};
static const char *const options[] = {"max_it: 100\nmethod: lm\nbalance: 1e-3\n",
                                      "lm:\n  inner: 0\nfix: [1, 2]\n---\nquiet:\n",
                                      "-max_it 100 -method lm\n# comment\n-fix_points 0,1,.5,0\n-quiet\n",
                                      "-prefix_push lm_\n-inner 3\n-prefix_pop\n"};

int main(int argc, char **argv)
{
  static const char *const csv[] = {"a,b\n0,1\n2,3\n", "vertex;u;v\n1;.5;1e3\n0;0;0\n", "density\n1\n2\n",
                                    "0 1 2\n3 4 5\n"};
  static const char npy[] = "\223NUMPY\1\0v\0{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2), }"
                            "                                                          \n0123456701234567";
  Sample *samples = malloc(MAX_SAMPLES * sizeof(*samples));
  int count;

  if (argc != 2 || !samples) return 2;
  if (EqmInitialize(&argc, &argv)) return 1;
  count = MakeSamples(samples);
  for (int i = 0; i < count; ++i) SaveSample(argv[1], &samples[i], i);
  SaveHdf5(argv[1]);
  SaveTexts(argv[1], "points", 4, csv);
  SaveTexts(argv[1], "density", 4, csv);
  SaveTexts(argv[1], "table", 4, csv);
  SaveTexts(argv[1], "xdmf", 3, xdmf);
  SaveTexts(argv[1], "options", 4, options);
  Save(argv[1], "points", 4, npy, sizeof(npy) - 1);
  free(samples);
  return EqmFinalize() ? 1 : 0;
}
