/* Options that commands share, and unknown options, which are errors before the work starts. */
#include "base/nearest.h"
#include "catalogue.h"
#include <string.h>
#include <strings.h>

/* Options that PETSc reads later, during the work or in PetscFinalize. */
static const char *const late_names[] = {
    "build_twosided",    "citations",     "debugger_pause", "debugger_ranks",
    "get_total_flops",   "log_threshold", "log_view",       "log_view_memory",
    "log_view_gpu_time", "malloc_dump",   "malloc_view",    "malloc_view_threshold",
    "memory_view",       "mpidump",       "not_shared_tmp", "nox",
    "nox_warning",       "objects_dump",  "options_left",   "options_suppress_deprecated_warnings",
    "options_view",      "random_seed",   "random_type",    "shared_tmp"};

/* Prefixes of options that PETSc's matrices, vectors and solvers read when they are created. */
static const char *const late_prefixes[] = {"hessian_eps_",
                                            "hessian_st_",
                                            "mat_",
                                            "linear_ksp_",
                                            "linear_pc_",
                                            "linear_mat_",
                                            "linear_vec_",
                                            "linear_mg_",
                                            "linear_sub_",
                                            "linear_redundant_",
                                            "linear_fieldsplit_",
                                            "multigrid_",
                                            "sf_",
                                            "unfold_",
                                            "vecscatter_",
                                            "vec_"};

/* The options that were accepted for their prefixes. */
enum { MOST_TRUSTED = 32, LONGEST_NAME = 128 };
static char trusted[MOST_TRUSTED][LONGEST_NAME];
static PetscInt num_trusted;

/* Options from a petscrc file and PETSC_OPTIONS, which may be meant for other programs. */
static char **foreign;
static PetscInt num_foreign;

static PetscBool IsLate(const char *name)
{
  for (size_t k = 0; k < sizeof(late_names) / sizeof(late_names[0]); k++) {
    if (!strcmp(name, late_names[k])) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* May an object read it later? EqmWarnOfUnusedOptions checks that. */
static PetscBool IsTrusted(const char *name)
{
  for (size_t k = 0; k < sizeof(late_prefixes) / sizeof(late_prefixes[0]); k++) {
    if (strncmp(name, late_prefixes[k], strlen(late_prefixes[k])) || strlen(name) >= LONGEST_NAME) continue;
    if (num_trusted == MOST_TRUSTED) return PETSC_FALSE;
    strcpy(trusted[num_trusted++], name);
    return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

PetscErrorCode EqmLayoutHelpOptions(PetscOptionItems *PetscOptionsObject)
{
  PetscInt threads = -1; /* main has read it */
  PetscBool resume = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscOptionsInt("-threads",
                            "threads per rank (-1: OMP_NUM_THREADS, else all the cores that the rank may use)", NULL,
                            threads, &threads, NULL));
  PetscCall(EqmMeshHelpOptions(PetscOptionsObject));
  PetscCall(PetscOptionsBool("-resume",
                             "go on from -checkpoint if it is there, else begin: the same command the first time and "
                             "after every interruption",
                             NULL, resume, &resume, NULL)); /* EqmTakeResume has read it */
  PetscFunctionReturn(0);
}

/* Is there a checkpoint of that name, of a registration's first minimisation, or the one before either? On rank 0. */
static PetscErrorCode HasCheckpoint(const char *file, PetscBool *there)
{
  static const char *const endings[] = {"", ".previous", ".1", ".1.previous"};

  PetscFunctionBegin;
  *there = PETSC_FALSE;
  for (size_t k = 0; k < sizeof(endings) / sizeof(endings[0]) && !*there; k++) {
    char name[PETSC_MAX_PATH_LEN];

    PetscCall(PetscSNPrintf(name, sizeof(name), "%s%s", file, endings[k]));
    PetscCall(PetscTestFile(name, 'r', there));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmTakeResume(void)
{
  char file[PETSC_MAX_PATH_LEN], from[PETSC_MAX_PATH_LEN] = "";
  PetscBool resume = PETSC_FALSE, has_checkpoint, restarts, automatic, there = PETSC_FALSE;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-resume", &resume, NULL));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-restart", from, sizeof(from), &restarts));
  automatic = (PetscBool)!strcmp(from, "auto"); /* another word for -resume */
  if (!resume && !automatic) PetscFunctionReturn(0);
  PetscCall(PetscOptionsGetString(NULL, NULL, "-checkpoint", file, sizeof(file), &has_checkpoint));
  if (!has_checkpoint || (restarts && !automatic))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "%s goes with -checkpoint FILE%s", automatic ? "-restart auto" : "-resume",
            automatic ? "" : ", and without -restart");
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) PetscCall(HasCheckpoint(file, &there));
  PetscCallMPI(MPI_Bcast(&there, 1, MPIU_BOOL, 0, PETSC_COMM_WORLD));
  if (there)
    PetscCall(PetscOptionsSetValue(NULL, "-restart", file));
  else if (automatic)
    PetscCall(PetscOptionsClearValue(NULL, "-restart"));
  PetscFunctionReturn(0);
}

static PetscBool IsForeign(const char *name)
{
  for (PetscInt k = 0; k < num_foreign; k++) {
    if (!strcmp(name, foreign[k])) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

PetscErrorCode EqmNoteForeignOptions(int argc, char **argv)
{
  PetscInt num_left;
  char **names, **values;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &num_left, &names, &values));
  PetscCall(PetscMalloc1(num_left, &foreign));
  for (PetscInt k = 0; k < num_left; k++) {
    PetscBool ours = PETSC_FALSE;
    for (int w = 1; w < argc && !ours; w++)
      ours = (PetscBool)(argv[w][0] == '-' && !strcasecmp(names[k], argv[w] + strspn(argv[w], "-")));
    if (!ours) PetscCall(PetscStrallocpy(names[k], &foreign[num_foreign++]));
  }
  PetscCall(PetscOptionsLeftRestore(NULL, &num_left, &names, &values));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmForgetForeignOptions(void)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < num_foreign; k++) PetscCall(PetscFree(foreign[k]));
  PetscCall(PetscFree(foreign));
  num_foreign = 0;
  PetscFunctionReturn(0);
}

/* Append "-name", with the nearest name that the command has. */
static PetscErrorCode AddUnknown(const EqmCatalogue *catalogue, const char *name, char *unknown, size_t length)
{
  const int num = catalogue ? catalogue->num_options : 0;
  size_t size = 1;
  char *names, hint[128], dashed[LONGEST_NAME];

  PetscFunctionBegin;
  for (int k = 0; k < num; k++) size += strlen(catalogue->option[k].name) + 1;
  PetscCall(PetscCalloc1(size, &names));
  for (int k = 0; k < num; k++) {
    PetscCall(PetscStrlcat(names, catalogue->option[k].name, size));
    PetscCall(PetscStrlcat(names, " ", size));
  }
  PetscCall(PetscSNPrintf(dashed, sizeof(dashed), "-%s", name));
  PetscCall(EqmDidYouMean(dashed, names, hint, sizeof(hint)));
  PetscCall(PetscFree(names));
  PetscCall(PetscStrlcat(unknown, unknown[0] ? ", -" : "-", length));
  PetscCall(PetscStrlcat(unknown, name, length));
  PetscCall(PetscStrlcat(unknown, hint, length));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRejectUnknownOptions(const EqmCommandLine *line)
{
  PetscInt num_left, count = 0;
  char **names, **values, unknown[EQM_MESSAGE_MAX] = "";

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &num_left, &names, &values));
  for (PetscInt k = 0; k < num_left; k++) {
    if (IsLate(names[k]) || IsTrusted(names[k])) continue;
    if (IsForeign(names[k])) {
      PetscCall(PetscFPrintf(PETSC_COMM_WORLD, PETSC_STDERR,
                             "equimap: warning: -%s of PETSC_OPTIONS or a petscrc file means nothing here\n",
                             names[k]));
      continue;
    }
    PetscCall(AddUnknown(line->catalogue, names[k], unknown, sizeof(unknown)));
    count++;
  }
  PetscCall(PetscOptionsLeftRestore(NULL, &num_left, &names, &values));
  if (count) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "unknown option%s %s; equimap %s --help lists the options of this command",
            count > 1 ? "s" : "", unknown, line->command);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmWarnOfUnusedOptions(void)
{
  PetscBool dry_run = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(
      PetscOptionsGetBool(NULL, NULL, "-dry_run", &dry_run, NULL)); /* then no object was created that could read it */
  for (PetscInt k = 0; k < num_trusted && !dry_run; k++) {
    PetscBool used;
    PetscCall(PetscOptionsUsed(NULL, trusted[k], &used));
    if (!used)
      PetscCall(PetscFPrintf(PETSC_COMM_WORLD, PETSC_STDERR,
                             "equimap: warning: the run had no use for the option -%s; is it spelt right?\n",
                             trusted[k]));
  }
  PetscFunctionReturn(0);
}
