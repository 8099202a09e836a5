/* equimap generate SHAPE -n N -o OUT: test surfaces and solids of any size. */
#include "app.h"
#include "mesh/soup_private.h"

typedef struct {
  PetscInt n, seed;
  char out[PETSC_MAX_PATH_LEN];
} GenerateOptions;

static PetscErrorCode ReadOptions(GenerateOptions *options)
{
  PetscFunctionBegin;
  options->n = 10000;
  options->seed = 0;
  options->out[0] = '\0';
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "Test meshes (generate)", "generate");
  PetscCall(PetscOptionsInt("-n", "how many vertices, about: each shape takes the nearest size it can have", "generate",
                            options->n, &options->n, NULL));
  PetscCall(PetscOptionsInt("-seed",
                            "another number gives other bumps and another irregularity; the same number the same "
                            "mesh, on any number of ranks",
                            "generate", options->seed, &options->seed, NULL));
  PetscCall(PetscOptionsString("-o", "the file to write; its suffix chooses the format", "generate", options->out,
                               options->out, sizeof(options->out), NULL));
  PetscOptionsEnd();
  PetscFunctionReturn(0);
}

static PetscErrorCode PrintShapes(void)
{
  const char *const *names, *const *descriptions;
  int n;

  PetscFunctionBegin;
  PetscCall(EqmGenerateShapes(&names, &descriptions, &n));
  PetscCall(
      PetscPrintf(PETSC_COMM_WORLD, "\nusage: equimap generate SHAPE -n N [-seed S] -o OUT, with SHAPE one of\n"));
  for (int i = 0; i < n; i++) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  %-9s %s\n", names[i], descriptions[i]));
  PetscCall(PetscFree(names));
  PetscCall(PetscFree(descriptions));
  PetscFunctionReturn(0);
}

/* Run `equimap generate`. Collective on PETSC_COMM_WORLD. Errors: EQM_ERR_USAGE (no or unknown shape, n out of range,
   unknown suffix), EQM_ERR_IO (the file cannot be written). */
PetscErrorCode EqmCommandGenerate(const EqmCommandLine *line, EqmStatus *status)
{
  GenerateOptions options;
  EqmSoup soup;

  PetscFunctionBegin;
  *status = EQM_STATUS_CONVERGED;
  PetscCall(ReadOptions(&options));
  if (line->help) {
    PetscCall(PrintShapes());
    PetscFunctionReturn(0);
  }
  PetscCall(EqmRejectUnknownOptions(line));
  if (line->num_arguments != 1) {
    PetscCall(PrintShapes());
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "generate takes one shape, %d given", line->num_arguments);
  }
  if (!options.out[0]) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "say where to write the mesh: -o FILE");
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, line->argument[0], options.n, options.seed, &soup));
  PetscCall(EqmSoupWrite(soup, options.out));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s: %" PetscInt_FMT " vertices, %" PetscInt_FMT " %s -> %s\n",
                        line->argument[0], soup->num_vertices, soup->num_cells,
                        soup->cell_size == 3 ? "triangles" : "tetrahedra", options.out));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}
