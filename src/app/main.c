/* equimap COMMAND ARGUMENTS -options: find the command, hand over, turn its end into an exit code. */
#include "catalogue.h"
#include "commandline.h"
#include "commands.h"
#include "environment.h"
#include "loading.h"
#include "optionsfile.h"
#include "base/fatal.h"
#include <omp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Options from files; what stands on the command line wins. Not left to PETSc, which answers -history with a copy of
   the screen in the file. */
static PetscErrorCode InsertOptions(const EqmCommandLine *line, int argc, char **argv)
{
  char viewer[PETSC_MAX_PATH_LEN] = "";
  PetscBool log_view, logs_already; /* where the command line or PETSC_OPTIONS asks, PETSc has begun by itself */

  PetscFunctionBegin;
  PetscCall(PetscOptionsHasName(NULL, NULL, "-log_view", &logs_already));
  PetscCall(EqmNoteForeignOptions(argc, argv));
  for (int k = 0; k < line->num_options_files; k++) PetscCall(EqmOptionsFileInsert(NULL, line->options_file[k]));
  PetscCall(PetscOptionsInsertArgs(NULL, argc - 1, argv + 1));
  if (line->history) PetscCall(PetscOptionsSetValue(NULL, "-history", line->history));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-log_view", viewer, sizeof(viewer), &log_view));
  if (log_view && !logs_already) {
    const PetscBool nested = (PetscBool)(strstr(viewer, "ascii_xml") || strstr(viewer, "ascii_flamegraph"));
    PetscCall(nested ? PetscLogNestedBegin() : PetscLogDefaultBegin());
  }
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
  if (given && threads == -1) PetscCall(DefaultThreads(&threads));
  if (given && threads < 1)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-threads %" PetscInt_FMT ": give 1 or more", threads);
  omp_set_num_threads((int)threads);
  PetscFunctionReturn(0);
}

/* One rank prints the options, in the form that was asked for. */
static PetscErrorCode PrintHelp(const EqmCommandRow *row, const EqmCommandLine *line)
{
  const char *const format = line->help_format ? line->help_format : "text";
  static const char *const formats[] = {"text", "man", "json", "words"};
  PetscMPIInt rank;
  size_t f = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  while (f < sizeof(formats) / sizeof(formats[0]) && strcmp(format, formats[f])) f++;
  if (f == sizeof(formats) / sizeof(formats[0]))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "--help=%s: choose one of text, man, json, words", format);
  if (rank) PetscFunctionReturn(0);
  if (f == 0) {
    printf("equimap %s %s\n  %s\n", row->name, row->usage, EqmCommandPurpose(row));
    EqmHelpText(line->catalogue);
  } else if (f == 1) {
    EqmHelpMan(line->catalogue, row->name, row->usage, EqmCommandPurpose(row));
  } else if (f == 2) {
    PetscCall(EqmHelpJson(line->catalogue, row->name, row->usage, EqmCommandPurpose(row)));
  } else {
    EqmHelpWords(line->catalogue, row->name);
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Run(EqmCommandLine *line, EqmStatus *status)
{
  const EqmCommandRow *row;
  EqmCatalogue catalogue;

  PetscFunctionBegin;
  PetscCall(EqmCommandFind(line->command, &row));
  PetscCall(EqmCatalogueCreate(row->run, line, &catalogue));
  line->catalogue = &catalogue;
  if (line->help) {
    PetscCall(PrintHelp(row, line));
  } else {
    PetscCall(EqmCheckOptionValues(line));
    PetscCall(EqmTakeResume());
    PetscCall(SetThreads());
    PetscCall(row->run(line, status));
    PetscCall(EqmWarnOfUnusedOptions());
  }
  line->catalogue = NULL;
  PetscCall(EqmCatalogueDestroy(&catalogue));
  PetscFunctionReturn(0);
}

/* The number that a launcher has given this process, 0 without one. Known before MPI_Init. */
static int RankOfLauncher(PetscBool *launched)
{
  static const char *const names[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK",   "PMI_RANK",
                                      "MPI_RANKID",           "ALPS_APP_PE", "SLURM_PROCID"};

  for (size_t k = 0; k < sizeof(names) / sizeof(names[0]); k++) {
    const char *const value = getenv(names[k]);
    *launched = (PetscBool)(value != NULL);
    if (value) return atoi(value);
  }
  return 0;
}

static void CrashForMemory(int number)
{
  (void)number;
  EqmRefuseToBegin(0);
  _exit(EQM_STATUS_INTERNAL);
}

int main(int argc, char **argv)
{
  EqmCommandLine line = {0};
  EqmStatus status = EQM_STATUS_CONVERGED;
  PetscBool launched;
  PetscErrorCode error;
  const int rank = RankOfLauncher(&launched);
  int num_options;
  char **options;

  if (EqmCommandLineParse(argc, argv, &line, &num_options, &options)) {
    EqmRefuseToBegin(rank);
    return EQM_STATUS_INTERNAL;
  }
  if (line.version || !line.command) return EqmIntroduce(&line, rank);
  EqmStartAgain(&line, argv);
  EqmWatchExits(); /* HDF5 without memory exits */
  if (!EqmLoadHdf5(CrashForMemory)) {
    EqmRefuseToBegin(rank);
    return EQM_STATUS_INTERNAL;
  }
  if (!launched) EqmStartWithoutDaemon();
  argc = num_options;
  argv = options;
  if (EqmInitialize(&argc, &argv)) return EQM_STATUS_INTERNAL;
  (void)signal(SIGPIPE, SIG_DFL); /* equimap check MESH | head ends like any other program, without PETSc's trace */
  error = InsertOptions(&line, argc, argv);
  if (!error) error = Run(&line, &status);
  if (error) status = EqmStatusOfError(error);
  if (EqmForgetForeignOptions() || EqmFinalize()) return EQM_STATUS_INTERNAL;
  EqmCommandLineFree(&line, options);
  return (int)status;
}
