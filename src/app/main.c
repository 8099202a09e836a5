/* equimap COMMAND ARGUMENTS -options: find the command, hand over, turn its end into an exit code. */
#include "app.h"
#include <omp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct {
  const char *name;
  EqmCommand run;
  const char *usage, *purpose;
} CommandRow;

static const CommandRow commands[] = {
    {"disk", EqmCommandMap, "MESH -o OUT", "area-preserving map of a disk-type surface to the unit disk"},
    {"square", EqmCommandMap, "MESH -o OUT", "the same to the unit square"},
    {"sphere", EqmCommandMap, "MESH -o OUT", "area-preserving map of a closed genus-0 surface to the unit sphere"},
    {"conformal", EqmCommandMap, "MESH -o OUT",
     "angle-preserving map: closed surface to the unit sphere, disk-type to the unit disk"},
    {"ball", EqmCommandMap, "MESH -o OUT", "volume-preserving map of a solid ball of tetrahedra to the unit ball"},
    {"register", EqmCommandRegister, "A B -o OUT", "measure-preserving correspondence between two surfaces or solids"},
    {"check", EqmCommandCheck, "MESH", "diagnose a mesh: what it is, what is wrong, what each command would say"},
    {"measure", EqmCommandMeasure, "MESH MAP", "distortion and folds of any map, also one made elsewhere"},
    {"convert", EqmCommandConvert, "IN OUT", "between mesh formats"},
    {"generate", EqmCommandGenerate, "SHAPE -n N -o OUT", "test surfaces and solids of any size"},
    {"report", EqmCommandReport, "RESULT -o FILE", "pictures and plots of a result"},
};
enum { NUM_COMMANDS = sizeof(commands) / sizeof(commands[0]) };

/* Options without a value: what follows them on the command line is an argument, not their value. */
static const char *const flags[] = {"-quiet",    "-help",         "-repair", "-dry_run",
                                    "-log_view", "-options_left", "-unique", "-version"};

/* ... but these words, which no mesh is called. */
static const char *const truths[] = {"0", "1", "true", "false", "yes", "no", "on", "off"};
#define IS_ONE_OF(word, list) IsOneOf(word, list, sizeof(list) / sizeof((list)[0]))

static PetscBool IsOneOf(const char *word, const char *const list[], size_t length)
{
  for (size_t k = 0; k < length; k++) {
    if (!strcmp(word, list[k])) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static PetscBool IsOption(const char *word)
{
  return (PetscBool)(word[0] == '-' && word[1] != '\0' && !strchr("0123456789.", word[1]));
}

/* Is word k the value of the option before it? */
static PetscBool IsValue(char **argv, int k)
{
  if (k < 2 || !IsOption(argv[k - 1]) || IsOption(argv[k])) return PETSC_FALSE;
  return (PetscBool)(!IS_ONE_OF(argv[k - 1], flags) || IS_ONE_OF(argv[k], truths));
}

/* Split the command line into command, arguments, options files and what is left for PETSc. `argv` keeps its first
   entry and the options. */
static void ParseCommandLine(int *argc, char **argv, EqmCommandLine *line, PetscBool *version)
{
  int kept = 1;

  for (int k = 1; k < *argc; k++) {
    const PetscBool has_value = (PetscBool)(k + 1 < *argc && IsValue(argv, k + 1));

    if (!strcmp(argv[k], "--help") || !strcmp(argv[k], "-help") || !strcmp(argv[k], "-h")) {
      line->help = PETSC_TRUE;
    } else if (!strcmp(argv[k], "--version") || !strcmp(argv[k], "-version")) {
      *version = PETSC_TRUE;
    } else if (!strcmp(argv[k], "-options_file") && has_value &&
               line->num_options_files < (int)(sizeof(line->options_file) / sizeof(line->options_file[0]))) {
      line->options_file[line->num_options_files++] = argv[++k];
    } else if (!strcmp(argv[k], "-history")) {
      line->history = has_value ? argv[++k] : "";
    } else if (IsOption(argv[k]) || IsValue(argv, k)) {
      argv[kept++] = argv[k];
    } else if (!line->command) {
      line->command = argv[k];
    } else if (line->num_arguments < (int)(sizeof(line->argument) / sizeof(line->argument[0]))) {
      line->argument[line->num_arguments++] = argv[k];
    }
  }
  argv[kept] = NULL;
  *argc = kept;
}

/* Is there a file of that name that rank 0 can read? */
static PetscErrorCode CheckReadable(const char *file)
{
  PetscMPIInt rank;
  PetscBool readable = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) PetscCall(PetscTestFile(file, 'r', &readable));
  PetscCallMPI(MPI_Bcast(&readable, 1, MPIU_BOOL, 0, PETSC_COMM_WORLD));
  if (!readable) EqmFail(PETSC_COMM_WORLD, EQM_ERR_IO, "cannot read the options file '%s'", file);
  PetscFunctionReturn(0);
}

/* Options from files, YAML if they are called .yaml or .yml; what stands on the command line wins. Not left to PETSc,
   which answers a missing file with a trace, and -history with a copy of the screen in the file. */
static PetscErrorCode InsertOptions(const EqmCommandLine *line, int argc, char **argv)
{
  PetscBool log_view;

  PetscFunctionBegin;
  PetscCall(EqmNoteForeignOptions(argc, argv));
  for (int k = 0; k < line->num_options_files; k++) {
    PetscErrorCode error;

    PetscCall(CheckReadable(line->options_file[k]));
    PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
    error = PetscOptionsInsertFile(PETSC_COMM_WORLD, NULL, line->options_file[k], PETSC_TRUE);
    PetscCall(PetscPopErrorHandler());
    if (error) {
      EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE,
              "cannot understand the options file '%s': in a .yaml file write lines like max_it: 100, in others lines "
              "like -max_it 100",
              line->options_file[k]);
    }
  }
  PetscCall(PetscOptionsInsertArgs(NULL, argc - 1, argv + 1));
  if (line->history) PetscCall(PetscOptionsSetValue(NULL, "-history", line->history));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-log_view", &log_view));
  if (log_view) PetscCall(PetscLogDefaultBegin()); /* PETSc has begun long ago where the command line asked for it */
  PetscFunctionReturn(0);
}

static PetscErrorCode PrintUsage(void)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                        "equimap %s: area-, volume- and angle-preserving maps of triangle and tetrahedral meshes\n\n"
                        "usage: equimap COMMAND ARGUMENTS [-options]      (alone or under mpirun -n N)\n\n",
                        EqmVersion()));
  for (int k = 0; k < NUM_COMMANDS; k++) {
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  equimap %-9s %-18s %s\n", commands[k].name, commands[k].usage,
                          commands[k].purpose));
  }
  PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                        "\nequimap COMMAND --help lists the options of a command. To begin with:\n"
                        "  equimap generate hills -n 20000 -o hills.obj\n"
                        "  equimap disk hills.obj -o hills.h5 && equimap report hills.h5 -o hills.png\n"));
  PetscFunctionReturn(0);
}

/* Unless told otherwise: the cores that this rank may use, shared with the ranks of the same node where nothing binds
   them to cores of their own. */
static PetscErrorCode DefaultThreads(PetscInt *threads)
{
  MPI_Comm node;
  PetscMPIInt ranks_on_node;
  const PetscInt mine = omp_get_num_procs(), all = (PetscInt)sysconf(_SC_NPROCESSORS_ONLN);

  PetscFunctionBegin;
  *threads = omp_get_max_threads();
  if (getenv("OMP_NUM_THREADS")) PetscFunctionReturn(0);
  PetscCallMPI(MPI_Comm_split_type(PETSC_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node));
  PetscCallMPI(MPI_Comm_size(node, &ranks_on_node));
  PetscCallMPI(MPI_Comm_free(&node));
  *threads = mine < all ? mine : PetscMax(1, all / ranks_on_node);
  PetscFunctionReturn(0);
}

static PetscErrorCode SetThreads(void)
{
  PetscInt threads;
  PetscBool given;

  PetscFunctionBegin;
  PetscCall(DefaultThreads(&threads));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-threads", &threads, &given));
  if (given && threads < 1)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-threads %" PetscInt_FMT ": give 1 or more", threads);
  omp_set_num_threads((int)threads);
  PetscFunctionReturn(0);
}

static PetscErrorCode Run(const EqmCommandLine *line, EqmStatus *status)
{
  PetscFunctionBegin;
  if (!line->command) {
    PetscCall(PrintUsage());
    *status = line->help ? EQM_STATUS_CONVERGED : EQM_STATUS_USAGE;
    PetscFunctionReturn(0);
  }
  PetscCall(SetThreads());
  for (int k = 0; k < NUM_COMMANDS; k++) {
    if (strcmp(line->command, commands[k].name)) continue;
    if (line->help) {
      PetscCall(PetscPrintf(PETSC_COMM_WORLD, "equimap %s %s\n  %s\n", commands[k].name, commands[k].usage,
                            commands[k].purpose));
      PetscHelpPrintf = EqmHelpPrintf;
      PetscCall(PetscOptionsSetValue(NULL, "-help", NULL));
    }
    PetscCall(commands[k].run(line, status));
    PetscCall(EqmWarnOfUnusedOptions());
    PetscCall(PetscOptionsClearValue(NULL, "-help")); /* or PETSc would add the options of its own last acts */
    PetscFunctionReturn(0);
  }
  EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "there is no command '%s'; equimap --help lists the commands",
          line->command);
}

int main(int argc, char **argv)
{
  EqmCommandLine line = {0};
  EqmStatus status = EQM_STATUS_CONVERGED;
  PetscBool version = PETSC_FALSE;
  PetscErrorCode error;

  ParseCommandLine(&argc, argv, &line, &version);
  if (EqmInitialize(&argc, &argv)) return EQM_STATUS_INTERNAL;
  (void)signal(SIGPIPE, SIG_DFL); /* equimap check MESH | head ends like any other program, without PETSc's trace */
  if (version) {
    error = PetscPrintf(PETSC_COMM_WORLD, "equimap %s (commit %s, PETSc %d.%d.%d)\n", EqmVersion(), EqmCommit(),
                        PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR);
  } else {
    error = InsertOptions(&line, argc, argv);
    if (!error) error = Run(&line, &status);
  }
  if (error) status = EqmStatusOfError(error);
  if (EqmForgetForeignOptions() || EqmFinalize()) return EQM_STATUS_INTERNAL;
  return (int)status;
}
