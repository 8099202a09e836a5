/* The table of commands; usage, version and man page of the program. */
#include "commands.h"
#include "base/nearest.h"
#include "mesh/target.h"
#include <stdio.h>
#include <string.h>

/* The purpose of a map command is that of its target. */
static const EqmCommandRow commands[] = {
    {"disk", EqmCommandMap, "MESH -o OUT", NULL},
    {"square", EqmCommandMap, "MESH -o OUT", NULL},
    {"sphere", EqmCommandMap, "MESH -o OUT", NULL},
    {"conformal", EqmCommandMap, "MESH -o OUT", NULL},
    {"ball", EqmCommandMap, "MESH -o OUT", NULL},
    {"cube", EqmCommandMap, "MESH -o OUT", NULL},
    {"register", EqmCommandRegister, "A B -o OUT", "measure-preserving correspondence between two surfaces or solids"},
    {"resample", EqmCommandResample, "RESULT -grid N -o OUT",
     "a mesh made anew through its map: regular, or as another one"},
    {"check", EqmCommandCheck, "MESH", "diagnose a mesh: what it is, what is wrong, what each command would say"},
    {"measure", EqmCommandMeasure, "MESH MAP", "distortion and folds of any map, also one made elsewhere"},
    {"convert", EqmCommandConvert, "IN OUT", "between mesh formats"},
    {"generate", EqmCommandGenerate, "SHAPE -n N -o OUT", "test surfaces and solids of any size"},
    {"report", EqmCommandReport, "RESULT -o FILE", "pictures and plots of a result"},
};
enum { NUM_COMMANDS = sizeof(commands) / sizeof(commands[0]) };

const char *EqmCommandPurpose(const EqmCommandRow *row)
{
  return row->purpose ? row->purpose : EqmTargetFind(row->name)->purpose;
}

PetscErrorCode EqmCommandFind(const char *name, const EqmCommandRow **row)
{
  char names[256] = "", hint[128];

  PetscFunctionBegin;
  for (int k = 0; k < NUM_COMMANDS; k++) {
    PetscCall(PetscStrlcat(names, commands[k].name, sizeof(names)));
    PetscCall(PetscStrlcat(names, " ", sizeof(names)));
    *row = &commands[k];
    if (!strcmp(name, commands[k].name)) PetscFunctionReturn(0);
  }
  PetscCall(EqmDidYouMean(name, names, hint, sizeof(hint)));
  EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "there is no command '%s'%s; equimap --help lists the commands", name, hint);
}

static void PrintUsage(void)
{
  printf("equimap %s: area-, volume- and angle-preserving maps of triangle and tetrahedral meshes\n\n"
         "usage: equimap COMMAND ARGUMENTS [-options]      (alone or under mpirun -n N)\n\n",
         EqmVersion());
  for (int k = 0; k < NUM_COMMANDS; k++)
    printf("  equimap %-9s %-18s %s\n", commands[k].name, commands[k].usage, EqmCommandPurpose(&commands[k]));
  printf("\nequimap COMMAND --help lists the options of a command. One dash or two: -method lm, --method lm and\n"
         "--method=lm are the same option. To begin with:\n"
         "  equimap generate hills -n 20000 -o hills.obj\n"
         "  equimap disk hills.obj -o hills.h5 && equimap report hills.h5 -o hills.png\n");
}

/* equimap(1) in roff. */
static void PrintMan(void)
{
  static const EqmStatus codes[] = {EQM_STATUS_CONVERGED, EQM_STATUS_INTERNAL,      EQM_STATUS_USAGE,
                                    EQM_STATUS_MESH,      EQM_STATUS_NOT_CONVERGED, EQM_STATUS_FOLDS,
                                    EQM_STATUS_IO,        EQM_STATUS_CHECKPOINT,    EQM_STATUS_STOPPED};

  printf(".TH EQUIMAP 1 \"\" \"equimap %s\" \"equimap\"\n.SH NAME\nequimap \\- area\\-, volume\\- and "
         "angle\\-preserving maps of triangle and tetrahedral meshes\n.SH SYNOPSIS\n.B equimap\n.I COMMAND ARGUMENTS\n"
         "[\\-options]\n.br\n.B mpirun \\-n\n.I N\n.B equimap\n.I COMMAND ARGUMENTS\n[\\-options]\n.SH COMMANDS\n",
         EqmVersion());
  for (int k = 0; k < NUM_COMMANDS; k++)
    printf(".TP\n.BI %s \" %s\"\n%s; see\n.BR equimap\\-%s (1)\n", commands[k].name, commands[k].usage,
           EqmCommandPurpose(&commands[k]), commands[k].name);
  printf(".TP\n.BI help \" COMMAND\"\nlist the options of a command, as \\-\\-help behind it does\n.SH EXIT STATUS\n");
  for (size_t k = 0; k < sizeof(codes) / sizeof(codes[0]); k++)
    printf(".TP\n.B %d\n%s\n", (int)codes[k], EqmStatusName(codes[k]));
  printf(".PP\nWith 0, 4 and 5 the map is written, with 75 a checkpoint; else nothing is.\n.SH EXAMPLES\n.nf\n"
         "equimap generate hills \\-n 20000 \\-o hills.obj\nequimap disk hills.obj \\-o hills.h5 \\-balance .01\n"
         "equimap report hills.h5 \\-o hills.png\n.fi\n.SH ENVIRONMENT\n.TP\n.B OMP_NUM_THREADS\nthreads per rank, "
         "where \\-threads does not say\n.TP\n.B PETSC_OPTIONS\noptions before those of the command line\n");
}

EqmStatus EqmIntroduce(const EqmCommandLine *line, int rank)
{
  if (rank == 0 && line->version) {
    printf("equimap %s (commit %s, PETSc %d.%d.%d)\n", EqmVersion(), EqmCommit(), PETSC_VERSION_MAJOR,
           PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR);
  } else if (rank == 0 && line->help_format && !strcmp(line->help_format, "man")) {
    PrintMan();
  } else if (rank == 0) {
    PrintUsage();
  }
  return line->version || line->help ? EQM_STATUS_CONVERGED : EQM_STATUS_USAGE;
}
