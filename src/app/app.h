/* The program's commands: one file each. */
#ifndef EQM_APP_H
#define EQM_APP_H

#include <equimap.h>

typedef struct _EqmCatalogue EqmCatalogue; /* the command's options: catalogue.h */

/* The parts of the command line that are not options: `equimap COMMAND MESH [MORE] -options`. */
typedef struct {
  const char *command;
  int num_arguments;
  const char *argument[8];
  PetscBool help;          /* COMMAND --help: read every option, print notes and return */
  const char *help_format; /* --help=FORMAT: text, man, json, words; NULL: text */
  PetscBool version;
  int num_options_files;
  const char *options_file[8];
  const char *history; /* -history FILE, which PETSc would take for its own option of that name; NULL: not given */
  const EqmCatalogue *catalogue;
  char **words; /* what the others point into, with a NULL at the end */
} EqmCommandLine;

/* A command: with line->help it reads every option between PetscOptionsBegin and PetscOptionsEnd, prints its notes with
   PetscPrintf, and returns; else it runs collectively on PETSC_COMM_WORLD; sets the status that becomes the exit code
   when it returns 0. */
typedef PetscErrorCode (*EqmCommand)(const EqmCommandLine *line, EqmStatus *status);

PETSC_INTERN PetscErrorCode EqmCommandMap(const EqmCommandLine *line, EqmStatus *status); /* disk, square, ... */
PETSC_INTERN PetscErrorCode EqmCommandRegister(const EqmCommandLine *line, EqmStatus *status);
PETSC_INTERN PetscErrorCode EqmCommandCheck(const EqmCommandLine *line, EqmStatus *status);
PETSC_INTERN PetscErrorCode EqmCommandMeasure(const EqmCommandLine *line, EqmStatus *status);
PETSC_INTERN PetscErrorCode EqmCommandConvert(const EqmCommandLine *line, EqmStatus *status);
PETSC_INTERN PetscErrorCode EqmCommandGenerate(const EqmCommandLine *line, EqmStatus *status);
PETSC_INTERN PetscErrorCode EqmCommandResample(const EqmCommandLine *line, EqmStatus *status);
PETSC_INTERN PetscErrorCode EqmCommandReport(const EqmCommandLine *line, EqmStatus *status);

/* Options of the parallel layout: -threads, which main reads before any command (read again so that --help lists it),
   and those of the mesh. Collective. */
PETSC_INTERN PetscErrorCode EqmLayoutHelpOptions(PetscOptionItems *PetscOptionsObject);
/* -resume: where the file of -checkpoint is there already, it becomes that of -restart. Errors: EQM_ERR_USAGE.
   Collective. */
PETSC_INTERN PetscErrorCode EqmTakeResume(void);
/* Say in one line what of the mesh's file will not be in `files`, a list with commas: fields that their formats do not
   hold, and, of a mesh, what its reader left out. is_map - they hold the map, not the mesh. Collective. */
PETSC_INTERN PetscErrorCode EqmPrintDropped(EqmSoup soup, const char *files, PetscBool is_map);
/* Remember which options PETSc has that are none of the command line's. Call before others are inserted. Collective. */
PETSC_INTERN PetscErrorCode EqmNoteForeignOptions(int argc, char **argv);
PETSC_INTERN PetscErrorCode EqmForgetForeignOptions(void);
/* Fail with EQM_ERR_USAGE if an option of the command has no value, one that does not fit its kind, or the name of a
   folder where a file is written. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckOptionValues(const EqmCommandLine *line);
/* Fail with EQM_ERR_USAGE if an option was given that no code has read, and name the nearest; of a foreign one only
   warn. Call after all options have been read, before the work starts. Collective. */
PETSC_INTERN PetscErrorCode EqmRejectUnknownOptions(const EqmCommandLine *line);
/* Options of matrices, vectors and solvers are read only when these are created: warn after the run of those that were
   not read. Collective. */
PETSC_INTERN PetscErrorCode EqmWarnOfUnusedOptions(void);

#endif
