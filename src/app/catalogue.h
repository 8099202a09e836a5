/* Every option that a command reads: name, kind, default, purpose. Help, man pages and completion are made of it, and
   the user's options are checked against it. */
#ifndef EQM_CATALOGUE_H
#define EQM_CATALOGUE_H

#include "app.h"

typedef enum {
  EQM_OPTION_FLAG, /* true where it stands without a value */
  EQM_OPTION_INT,
  EQM_OPTION_REAL,
  EQM_OPTION_TEXT,
  EQM_OPTION_CHOICE,
  EQM_OPTION_INTS,
  EQM_OPTION_REALS,
  EQM_NUM_OPTION_KINDS
} EqmOptionKind;

typedef struct {
  EqmOptionKind kind;
  int section;
  char name[64];     /* with its dash */
  char initial[256]; /* the default, as PETSc prints it; "" for lists */
  char *choices;     /* of EQM_OPTION_CHOICE: words with blanks between; else "" */
  char *purpose;
} EqmOption;

struct _EqmCatalogue {
  int num_options, num_sections;
  EqmOption *option; /* each name once */
  char (*section)[128];
  char *notes; /* the command's notes beside its options, on rank 0 */
};

/* Let `run` read its options with an empty database and record them. Collective on PETSC_COMM_WORLD. */
PETSC_INTERN PetscErrorCode EqmCatalogueCreate(EqmCommand run, const EqmCommandLine *line, EqmCatalogue *catalogue);
PETSC_INTERN PetscErrorCode EqmCatalogueDestroy(EqmCatalogue *catalogue);
/* A word for the kind of value: "N", "X", ... Not collective. */
PETSC_INTERN const char *EqmOptionValueName(const EqmOption *option);
/* The options of one method begin with its name, and so does their purpose, "lm: ...": the length of that name, 0 for
   others; `purpose` (or NULL) is what follows. Not collective. */
PETSC_INTERN int EqmOptionGroup(const EqmOption *option, const char **purpose);

/* The forms of help. Not collective: one rank prints. */
PETSC_INTERN void EqmHelpNotes(const EqmCatalogue *catalogue);
PETSC_INTERN void EqmHelpText(const EqmCatalogue *catalogue);
PETSC_INTERN void EqmHelpMan(const EqmCatalogue *catalogue, const char *command, const char *usage,
                             const char *purpose);
PETSC_INTERN void EqmHelpWords(const EqmCatalogue *catalogue, const char *command);
PETSC_INTERN PetscErrorCode EqmHelpJson(const EqmCatalogue *catalogue, const char *command, const char *usage,
                                        const char *purpose);

#endif
